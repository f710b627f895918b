//! Exact oracles, generators of hard cases, brute force and corpora: what the tests and benches of `lin-canny` share.
//!
//! Everything here works on plain data: a point is `[f64; 3]`, a face is a list of point indices counter-clockwise
//! from outside, a pose is [`Pose`]. So a judge never borrows the code it judges;
//! only [`arm`], [`boxes`], [`casts`], [`crowd`], [`curved`], [`driven`], [`forms`], [`pairs`], [`rooms`], [`support`] and
//! [`contacts`] speak the crate's own types.
//!
//! | module | what it gives |
//! |---|---|
//! | [`rng`] | a seeded generator: the same numbers on every machine |
//! | [`shapes`] | bodies that are hard on purpose |
//! | [`motion`], [`workload`] | seeded motions of a pair, and those that engines are timed on |
//! | [`boxes`], [`crowd`] | scenes of moving boxes, and of moving hulls |
//! | [`contacts`] | scenes of two bodies in contact |
//! | [`casts`] | bodies thrown at each other, and conservative advancement |
//! | [`rooms`] | rooms full of hulls, and a robot that goes through them |
//! | [`cells`], [`arm`] | an arm of meshes in its cell; an arm of hulls in its cell, drawn |
//! | [`support`], [`forms`] | plain data as bodies and poses of the crate; bodies of every kind |
//! | [`driven`] | calls drawn from bytes and seeds, judged by brute force |
//! | [`pairs`] | pairs in the form of this crate and of parry, and their motions |
//! | [`nets`] | control points of curved surfaces |
//! | [`soups`], [`turned`], [`brute`] | meshes that are not convex, some as CAD has them, and their naive oracle |
//! | [`exact`] | the naive oracle: exact contact state and distance of two small bodies |
//! | [`paths`] | the naive oracle of vertices on straight paths, and queries that are hard on purpose |
//! | [`curved`] | the judge of curved pairs: the duality gap in double-double |
//! | [`brute_hull`] | exact faces of a few points |
//! | [`bound`] | exact checks of an answer for bodies of any size |
//! | [`suite`] | files of cases with or without their truth |
//! | [`corpus`] | the named hard cases of `tests/corpus/` |
//! | [`parry`] | the reference engine |
//! | [`meshes`] | OBJ and STL files |
//! | [`command`], [`svg`] | the frame of a program with options, shapes as SVG: for the examples of all packages |
//!
//! Below `exact` and `bound` lie [`body`] (placed bodies), [`rational`] (exact arithmetic) and [`verdict`] (the oracle's
//! answer); [`pose`] holds the pose and a few vector helpers.

pub mod arm;
pub mod body;
pub mod bound;
pub mod boxes;
pub mod brute;
pub mod brute_hull;
pub mod casts;
pub mod cells;
pub mod command;
pub mod contacts;
pub mod corpus;
pub mod crowd;
pub mod curved;
pub mod driven;
mod ears;
pub mod exact;
pub mod exact_meshes;
pub mod faults;
pub mod forms;
pub mod meshes;
pub mod motion;
pub mod nets;
pub mod pairs;
pub mod parry;
pub mod paths;
pub mod pose;
pub mod rational;
#[path = "../../../tests/support/rng.rs"]
pub mod rng;
pub mod rooms;
pub mod shapes;
pub mod soups;
pub mod suite;
pub mod support;
pub mod svg;
pub mod turned;
pub mod verdict;
pub mod workload;

pub use body::Body;
pub use pose::{Point, Pose};
pub use verdict::{ContactState, Exact};

/// A face: indices of points, counter-clockwise seen from outside.
pub type Face = Vec<u32>;
