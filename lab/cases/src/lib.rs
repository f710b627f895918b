//! Hard pairs of convex bodies with their exact answers; points, rays and pairs of meshes, and casts.
//!
//! Nothing here uses code of an engine. The package works on plain data: a point is `[f64; 3]`, a
//! face is a list of point indices counter-clockwise from outside, a pose is [`Pose`]. The program
//! `cases` writes files in the format of `tests/CASES.md`.
//!
//! | module | contents |
//! |---|---|
//! | [`families`] | the families of cases, and the suites made of them |
//! | [`maker`] | writes the cases of one family, and puts a body at a wanted distance |
//! | [`minkowski`] | exact contact state, distance, normal and witness points of bodies of any size |
//! | [`queries`], [`solid`] | points, rays and pairs of meshes, casts of convex bodies, and their exact answers |
//! | [`volumes`] | the exact volume that two meshes share |
//! | [`exact`] | the naive oracle of the same for small bodies, which judges `minkowski` |
//! | [`bound`] | exact checks of an outcome for bodies of any size |
//! | [`suite`] | reads and writes files of cases |
//! | [`shapes`] | deliberately hard bodies |
//! | [`brute_hull`] | exact faces of a few points |
//! | [`body`], [`rational`], [`verdict`] | bodies at exact poses, exact arithmetic, the result of the oracle |
//! | [`pose`], [`rng`] | poses and a few vector helpers, and a seeded generator |
//! | [`command`] | entry point of programs with options |

pub mod body;
pub mod bound;
pub mod brute_hull;
pub mod command;
pub mod exact;
pub mod families;
pub mod maker;
pub mod minkowski;
mod polytope;
pub mod pose;
pub mod queries;
pub mod rational;
#[path = "../../../tests/support/rng.rs"]
pub mod rng;
pub mod shapes;
pub mod solid;
pub mod suite;
pub mod verdict;
pub mod volumes;

pub use body::Body;
pub use pose::{Point, Pose};
pub use verdict::{ContactState, Exact};

/// A face: indices of points, counter-clockwise seen from outside.
pub type Face = Vec<u32>;
