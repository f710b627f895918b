//! How many cells prove the least clearance of an arm and a wall: by number of joints and width.
//!
//! An arm of one to four joints reaches towards a wall, and is nearest to it when it is stretched. All ranges are 2 rad wide.
//! The number of cells grows with the logarithm of the width.
//!
//! Run with `cargo run --release -p lin-canny-plan --example ranges`.

use std::error::Error;

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny_plan::{Cell, CellBody, Checker, ClearanceWidth, Joint, JointTree, RangeOptions, RangeProver};

fn main() -> Result<(), Box<dyn Error>> {
    truth::command::no_options("How many cells prove the least clearance of an arm and a wall");
    println!("joints   width, m      cells   clearance, m");
    for joints in 1..=4 {
        for width in [1e-2, 1e-4, 1e-6] {
            let mut checker = arm(joints)?;
            let options = RangeOptions::default()
                .cells(1_000_000)
                .width(ClearanceWidth::Length(width));
            let (low, high) = (vec![-1.0; joints], vec![1.0; joints]);
            let (link, wall) = (CellBody::Robot(0), CellBody::Obstacle(0));
            let answer = RangeProver::new(&options).pair(&mut checker, link, wall, &low, &high)?;
            let (cells, lower, upper) = (answer.cells, answer.lower, answer.upper);
            println!("{joints:6} {width:10.0e} {cells:10}   {lower:.8} to {upper:.8}");
        }
    }
    Ok(())
}

/// Returns the last link of an arm of length 1 before a wall at 1.2, with turns about z and y.
fn arm(joints: usize) -> Result<Checker<JointTree>, Box<dyn Error>> {
    let length = 1.0 / joints as f64;
    let joint = |k: usize| {
        let at = Isometry3::translation(if k == 0 { 0.0 } else { length }, 0.0, 0.0);
        let axis = if k.is_multiple_of(2) {
            Vector3::z_axis()
        } else {
            Vector3::y_axis()
        };
        Joint::revolute(at, axis, [-1.0, 1.0])
    };
    let arm = JointTree::serial(
        Isometry3::identity(),
        (0..joints).map(joint).collect(),
        vec![joints],
        length,
    )?;
    let rod = solids::cuboid(Vector3::new(0.5 * length, 0.05, 0.05))?;
    let mut cell = Cell::new();
    cell.robot_body(
        "link",
        rod.transformed(&Isometry3::translation(0.5 * length, 0.0, 0.0))?,
    );
    let wall = solids::cuboid(Vector3::new(0.1, 2.0, 2.0))?;
    cell.add_obstacle("wall", wall, Isometry3::translation(1.3, 0.0, 0.0))?;
    Ok(Checker::new(arm, cell)?)
}
