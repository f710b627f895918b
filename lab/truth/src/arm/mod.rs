//! A six-axis arm in its cell: what stands there, how the arm moves, and a picture in three dimensions.

pub mod cell;
pub mod draw;
pub mod motion;
pub mod robot;

/// What may go wrong while a cell is loaded or an arm is built.
pub type Trouble = Box<dyn std::error::Error>;
