//! A six-axis arm in its cell: the obstacles, and the motion of the arm.

pub mod cell;
pub mod chain;
pub mod motion;
pub mod robot;

use lin_canny_plan::{Cell, JointTree};

/// Error of loading a cell or building an arm.
pub type Trouble = Box<dyn std::error::Error>;

/// Returns the arm and the world of the built-in cell.
pub fn in_cell() -> Result<(JointTree, Cell), Trouble> {
    let mut cell = Cell::new();
    let arm = robot::arm(&mut cell)?;
    for (name, shape, pose) in cell::things(&[])? {
        cell.add_obstacle(cell.free_name(&name), shape, pose)
            .expect("an obstacle");
    }
    robot::exclude(&mut cell, true)?;
    Ok((arm, cell))
}
