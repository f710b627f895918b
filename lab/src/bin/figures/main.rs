//! Draws every picture of the README and the documentation, from runs of the crate and from the records of its measurements:
//! `cargo run --release -p lab --bin figures -- [FOLDER]`.

mod casts;
mod contact;
mod hero;
mod plane;
mod records;
mod ulps;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use lab::command::Arguments;

type Trouble = Box<dyn std::error::Error>;

const USAGE: &str = "\
usage: figures [FOLDER]

Draws the pictures of the README and the documentation into FOLDER (default: target/figures; `figures images` in a checkout
replaces the pictures there).";

fn parse(arguments: Option<Arguments>) -> Result<Option<PathBuf>, String> {
    let Some(arguments) = arguments else {
        return Ok(None);
    };
    let folder = arguments.files(1)?.into_iter().next();
    Ok(Some(folder.unwrap_or("target/figures".into()).into()))
}

fn main() -> ExitCode {
    lab::command::main("figures", USAGE, parse(Arguments::of_process()), |folder| run(folder))
}

fn run(folder: &Path) -> Result<(), Trouble> {
    println!("drawing to {}", folder.display());
    let records = Path::new(env!("CARGO_MANIFEST_DIR")).join("../benches/record");
    let mut pictures = vec![
        ("hero.svg", hero::picture()?),
        ("casts.svg", casts::picture()?),
        ("manifold.svg", contact::picture()?),
        ("regions.svg", plane::regions()?),
        ("walk.svg", plane::walk()?),
        ("ulps.svg", ulps::picture()?),
    ];
    pictures.extend(records::pictures(&records)?);
    for (name, text) in pictures {
        lab::command::write(&folder.join(name), &text)?;
        println!("{name}: {} bytes", text.len());
    }
    Ok(())
}
