//! The options of a robot in its cell, as the tool `lin-canny` and other tools have them.
//!
//! A tool flattens [`RobotOptions`] into its own arguments, so that all tools read the same files in the same
//! way; [`values`] parses the values of options, and [`output`] prints.
#![forbid(unsafe_code)]
// They panic if the reader of a pipe has gone: see `output::put`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

#[macro_use]
pub mod output;
mod robot_options;
pub mod values;

pub use robot_options::{RobotOptions, warn_of_skipped};
