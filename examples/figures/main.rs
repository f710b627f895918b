//! Draws every picture of the README and the documentation from runs of the crate: `cargo run --release --example figures`.

mod hero;
mod plane;
mod svg;

use lin_canny::nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

type Trouble = Box<dyn std::error::Error>;

fn isometry(pose: &lab::Pose) -> Isometry3<f64> {
    let [x, y, z, w] = pose.q;
    let rotation = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
    Isometry3::from_parts(Translation3::from(pose.t), rotation)
}

fn main() -> Result<(), Trouble> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("images");
    std::fs::create_dir_all(&folder)?;
    let pictures = [
        ("hero.svg", hero::picture()?),
        ("regions.svg", plane::regions()?),
        ("walk.svg", plane::walk()?),
    ];
    for (name, text) in pictures {
        std::fs::write(folder.join(name), &text)?;
        println!("images/{name}: {} bytes", text.len());
    }
    Ok(())
}
