//! A six-axis arm in its cell: the obstacles, the motion of the arm, and a picture in three
//! dimensions.

pub mod cell;
pub mod chain;
pub mod draw;
pub mod motion;
pub mod robot;

/// Error of loading a cell or building an arm.
pub type Trouble = Box<dyn std::error::Error>;
