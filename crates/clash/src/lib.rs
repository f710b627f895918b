//! Clashes of the parts of a model: which overlap, how deep, which gaps are too small.
//!
//! ```text
//! Model::load   parts from mesh files, folders and cells, open meshes repaired
//! Rules         what pairs must keep, and which are not looked at, in the words of a cell
//! find          pairs of boxes, then a Row for each pair that is near enough
//! Row           kind, gap, depth, volume, point; JSON lines, CSV, JUnit, and what is worse than before
//! ```
//!
//! The contact state is exact for polyhedra and closed meshes, and gaps, depths and volumes have proven
//! bounds. So a flush face touches and does not clash, and a press fit of a micrometre overlaps.
//!
//! | kind | clash | |
//! |---|---|---|
//! | apart | no | the gap is at least what the pair must keep |
//! | touching | if the rules say so | they share points, and no volume |
//! | close | yes | the gap is less than the pair must keep |
//! | undecided | no, but reported | curved parts, if the bounds do not decide whether they touch |
//! | crossing | yes | surfaces cross, and a part has no inside |
//! | overlapping | unless allowed | they share a volume |
//! | inside | unless allowed | one is wholly in the other: up to 1e-9 of its volume |
//! | equal | unless allowed | the same solid in the same place, up to 1e-9 of its volume |
//!
//! A part inside the hollow of another one is apart. `inside` and `equal` are reported of polyhedra and closed
//! meshes that do not cover themselves; other parts overlap.
#![warn(clippy::disallowed_methods)]

mod error;
mod find;
mod model;
mod row;
mod rules;

pub use error::ClashError;
pub use find::{ClashOptions, Clashes, find};
pub use model::{Model, ModelOptions, Part, Unit};
pub use row::{Comparison, Kind, Row, is_unlikely_size, to_csv, to_junit, worst_first};
pub use rules::{Required, Rules};

/// Compiles the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
