//! Draws every picture of the README and the documentation.
//!
//! The sources are runs of the crate and records of its measurements:
//! `cargo run --release -p race --bin figures -- [FOLDER]`.

mod casts;
mod contact;
mod hero;
mod mbm;
mod plane;
mod records;
mod ulps;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;

type Trouble = Box<dyn std::error::Error>;

/// Draw the pictures of the README and the documentation
#[derive(Parser)]
struct Options {
    /// Output folder; `figures images` in a checkout replaces the pictures there
    #[arg(value_name = "FOLDER", default_value = "target/figures")]
    folder: PathBuf,
}

fn main() -> ExitCode {
    truth::command::main(|o: &Options| run(&o.folder))
}

fn run(folder: &Path) -> Result<(), Trouble> {
    println!("drawing to {}", folder.display());
    let records = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../benches/record");
    let mut pictures = vec![
        ("hero.svg", hero::picture()?),
        ("casts.svg", casts::picture()?),
        ("manifold.svg", contact::picture()?),
        ("regions.svg", plane::regions()?),
        ("walk.svg", plane::walk()?),
        ("ulps.svg", ulps::picture()?),
        ("mbm.svg", mbm::picture(&records)?),
    ];
    pictures.extend(records::pictures(&records)?);
    for (name, text) in pictures {
        truth::command::write(&folder.join(name), &text)?;
        println!("{name}: {} bytes", text.len());
    }
    Ok(())
}
