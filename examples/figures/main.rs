//! Draws every picture of the README and the documentation, from runs of the crate and from the records of its measurements:
//! `cargo run --release --example figures`.

mod contact;
mod hero;
mod plane;
mod records;
mod svg;
mod ulps;

use lin_canny::nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

type Trouble = Box<dyn std::error::Error>;

fn isometry(pose: &lab::Pose) -> Isometry3<f64> {
    let [x, y, z, w] = pose.q;
    let rotation = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
    Isometry3::from_parts(Translation3::from(pose.t), rotation)
}

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
