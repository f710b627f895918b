//! Bodies of the cell: the built-in cell, or meshes.

use lin_canny::ConvexPolyhedron;
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny_formats::MeshFile;

use super::Trouble;

/// A body of the cell: name, shape, pose.
pub type Thing = (String, ConvexPolyhedron, Isometry3<f64>);

/// Returns the hulls of the given meshes in the world frame, or the built-in cell.
pub fn things(files: &[String]) -> Result<Vec<Thing>, Trouble> {
    if files.is_empty() {
        return built_in();
    }
    let load = |file: &String| {
        let (points, _) = MeshFile::load(file)?.whole();
        let points: Vec<_> = points.into_iter().map(Point3::from).collect();
        let hull = ConvexPolyhedron::from_points(&points).map_err(|e| format!("{file}: {e}"))?;
        let name = std::path::Path::new(file).file_stem().unwrap_or_default();
        Ok((name.to_string_lossy().into_owned(), hull, Isometry3::identity()))
    };
    files.iter().map(load).collect()
}

fn built_in() -> Result<Vec<Thing>, Trouble> {
    let at = Isometry3::translation;
    let block = |name: &str, half: [f64; 3], [x, y, z]: [f64; 3]| -> Result<Thing, Trouble> {
        Ok((name.into(), solids::cuboid(Vector3::from(half))?, at(x, y, z)))
    };
    let mut things = vec![
        block("table", [0.65, 0.75, 0.02], [0.40, 0.0, -0.02])?,
        block("fence", [0.22, 0.01, 0.10], [0.62, 0.0, 0.10])?,
        block("lamp", [0.03, 0.55, 0.03], [0.10, 0.0, 1.02])?,
        ("post".into(), solids::prism(24, 0.45, 0.035)?, at(0.20, 0.68, 0.45)),
    ];
    for (name, y) in [("left bin", -0.38), ("right bin", 0.38)] {
        for side in [-1.0, 1.0] {
            things.push(block(name, [0.01, 0.17, 0.07], [0.55 + side * 0.14, y, 0.07])?);
            things.push(block(name, [0.13, 0.01, 0.07], [0.55, y + side * 0.16, 0.07])?);
        }
    }
    Ok(things)
}
