//! Draws every picture of the README and the documentation, from runs of the crate and from the records of its measurements:
//! `cargo run --release --example figures`.

mod contact;
mod hero;
mod plane;
mod records;
mod svg;
mod ulps;

type Trouble = Box<dyn std::error::Error>;

fn main() -> Result<(), Trouble> {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = root.join("images");
    std::fs::create_dir_all(&folder)?;
    let mut pictures = vec![
        ("hero.svg", hero::picture()?),
        ("manifold.svg", contact::picture()?),
        ("regions.svg", plane::regions()?),
        ("walk.svg", plane::walk()?),
        ("ulps.svg", ulps::picture()?),
    ];
    pictures.extend(records::pictures(&root.join("benches/record"))?);
    for (name, text) in pictures {
        std::fs::write(folder.join(name), &text)?;
        println!("images/{name}: {} bytes", text.len());
    }
    Ok(())
}
