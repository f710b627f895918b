//! Chains of many short links among posts.

use std::f64::consts::TAU;

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny_plan::{Cell, JointTree};

use super::Trouble;
use crate::plans::turn;

/// Returns an arm of links of 0.2 m that bend in turn about two axes, among twelve posts. All
/// joints have these limits; links that a joint connects may touch.
pub fn chain(joints: usize, limits: [f64; 2]) -> Result<(JointTree, Cell), Trouble> {
    let link = solids::cuboid(Vector3::new(0.1, 0.04, 0.03))?.transformed(&Isometry3::translation(0.11, 0.0, 0.0))?;
    let mut cell = Cell::new();
    let mut chain = Vec::new();
    for k in 0..joints {
        let origin = Isometry3::translation(if k == 0 { 0.0 } else { 0.22 }, 0.0, 0.0);
        chain.push(turn(k, origin, [Vector3::z_axis(), Vector3::y_axis()][k % 2], k));
        cell.robot_body(format!("link {k}"), link.clone());
    }
    posts(&mut cell, 1.1)?;
    for k in 1..joints {
        let [a, b] = [k - 1, k].map(|k| format!("link {k}"));
        cell.exclude(&a, &b)?;
    }
    let radii = vec![0.3; joints + 1];
    let links = (1..=joints).collect();
    let space = JointTree::new(Isometry3::identity(), chain, vec![limits; joints], links, radii)?;
    Ok((space, cell))
}

/// Adds twelve posts on a circle about the origin.
pub fn posts(cell: &mut Cell, radius: f64) -> Result<(), Trouble> {
    for k in 0..12 {
        let angle = TAU * f64::from(k) / 12.0;
        let post = solids::cuboid(Vector3::new(0.03, 0.03, 0.6))?;
        let place = Vector3::new(radius * angle.cos(), radius * angle.sin(), 0.0);
        cell.add_obstacle(format!("post {k}"), post, Isometry3::new(place, Vector3::z() * angle))
            .expect("an obstacle");
    }
    Ok(())
}
