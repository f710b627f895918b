//! The arm: six joints, and boxes and prisms on their links, in metres. It equals `arm.urdf` of the
//! package `lin-canny-robot`.

use lin_canny::ConvexPolyhedron;
use lin_canny::nalgebra::{Isometry3, Unit, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny_plan::{Cell, Joint, JointTree, PlanError};

use super::Trouble;

/// For each joint: height above the previous link, axis, and the limit on both sides.
pub const JOINTS: [(f64, Unit<Vector3<f64>>, f64); 6] = {
    const Y: Unit<Vector3<f64>> = Unit::new_unchecked(Vector3::new(0.0, 1.0, 0.0));
    const Z: Unit<Vector3<f64>> = Unit::new_unchecked(Vector3::new(0.0, 0.0, 1.0));
    [
        (0.12, Z, 2.9),
        (0.20, Y, 1.8),
        (0.45, Y, 2.6),
        (0.40, Z, 2.9),
        (0.15, Y, 2.2),
        (0.11, Z, 2.9),
    ]
};

/// The names of the bodies.
pub const NAMES: [&str; 7] = [
    "base",
    "shoulder",
    "upper arm",
    "forearm",
    "wrist 1",
    "wrist 2",
    "gripper",
];

/// Returns name, link and shape of each body.
pub fn pieces() -> Result<Vec<(&'static str, usize, ConvexPolyhedron)>, Trouble> {
    let tube = |link: usize, radius: f64, length: f64, height: f64| {
        let solid = solids::prism(48, 0.5 * length, radius)?;
        let placed = solid.transformed(&Isometry3::translation(0.0, 0.0, height))?;
        Ok::<_, Trouble>((NAMES[link], link, placed))
    };
    let block = |link: usize, size: [f64; 3], [y, z]: [f64; 2]| {
        let solid = solids::cuboid(Vector3::from(size) * 0.5)?;
        let placed = solid.transformed(&Isometry3::translation(0.0, y, z))?;
        Ok::<_, Trouble>((NAMES[link], link, placed))
    };
    Ok(vec![
        tube(0, 0.10, 0.12, 0.06)?,
        tube(1, 0.085, 0.20, 0.10)?,
        block(2, [0.11, 0.13, 0.56], [0.0, 0.225])?,
        block(3, [0.09, 0.10, 0.42], [0.0, 0.19])?,
        tube(4, 0.045, 0.14, 0.07)?,
        tube(5, 0.040, 0.13, 0.05)?,
        block(6, [0.05, 0.14, 0.05], [0.0, 0.03])?,
        block(6, [0.025, 0.02, 0.07], [0.05, 0.09])?,
        block(6, [0.025, 0.02, 0.07], [-0.05, 0.09])?,
    ])
}

/// Adds the bodies to the world and returns the space.
pub fn arm(cell: &mut Cell) -> Result<JointTree, Trouble> {
    let pieces = pieces()?;
    let links = pieces.iter().map(|p| p.1).collect();
    for (name, _, shape) in pieces {
        cell.robot_body(name, shape);
    }
    let joint = |(height, axis, limit): (f64, Unit<Vector3<f64>>, f64)| {
        Joint::revolute(Isometry3::translation(0.0, 0.0, height), axis, [-limit, limit])
    };
    let joints = JOINTS.map(joint).into();
    Ok(JointTree::serial(Isometry3::identity(), joints, links, 0.15)?)
}

/// Excludes links that one or two joints connect, and the base with the table below it.
pub fn exclude(cell: &mut Cell, has_table: bool) -> Result<(), PlanError> {
    for (k, name) in NAMES.iter().enumerate() {
        for other in NAMES.iter().skip(k + 1).take(2) {
            cell.exclude(name, other)?;
        }
    }
    if has_table {
        cell.exclude("base", "table")?;
    }
    Ok(())
}
