//! Exact oracles, generators of hard cases, brute force and corpora, shared by tests and benches of
//! `lin-canny`.
//!
//! Most modules work on plain data: a point is `[f64; 3]`, a face is a list of point indices
//! counter-clockwise from outside, a pose is [`Pose`]. So a judge never uses the code that it
//! judges. Only [`arm`], [`boxes`], [`casts`], [`crowd`], [`curved`], [`driven`], [`forms`],
//! [`pairs`], [`plans`], [`rooms`], [`support`] and [`contacts`] use types of the crate.
//!
//! | module | contents |
//! |---|---|
//! | [`motion`], [`workload`] | seeded motions of a pair, and the motions for timing |
//! | [`boxes`], [`crowd`] | scenes of moving boxes, and of moving hulls |
//! | [`contacts`] | scenes of two bodies in contact |
//! | [`casts`] | bodies thrown at each other, and conservative advancement |
//! | [`plans`] | cells and motions as tests of the planner write them |
//! | [`rooms`] | rooms full of hulls, and a robot that moves through them |
//! | [`cells`], [`arm`] | an arm of meshes in its cell; an arm of hulls in its cell, drawn |
//! | [`support`], [`forms`] | plain data as bodies and poses of the crate; bodies of every kind |
//! | [`mod@tally`] | counts that add themselves |
//! | [`mutants`] | mutants of a file |
//! | [`mod@rows`] | cases of a test as rows of a text |
//! | [`errors`] | errors that must say what is wrong |
//! | [`driven`] | calls drawn from bytes and seeds, judged by brute force; readers of files |
//! | [`answers`] | answers to the queries of case files, and their judge |
//! | [`pairs`] | pairs in the form of this crate and of parry, and their motions |
//! | [`nets`] | control points of curved surfaces |
//! | [`soups`], [`turned`], [`brute`] | nonconvex meshes, CAD-like meshes, and their naive oracle |
//! | [`near_points`] | the exact side and distance of points and meshes, and hard points |
//! | [`covers`] | whether balls contain a triangle or a tetrahedron, exactly |
//! | [`lattice_points`] | the exact side of points on a lattice, in microseconds |
//! | [`paths`] | the naive oracle of vertices on straight paths, and deliberately hard queries |
//! | [`curved`] | the judge of curved pairs: the duality gap in double-double |
//! | [`corpus`] | the named hard cases of `tests/corpus/` |
//! | [`parry`] | the reference engine |
//!
//! The package [`cases`] contains the naive oracle, exact checks, hard bodies, files of cases,
//! poses and random numbers; they have the same names here.

pub mod answers;
pub mod arm;
pub mod boxes;
pub mod brute;
pub mod casts;
pub mod cells;
pub mod contacts;
pub mod corpus;
pub mod covers;
pub mod crowd;
pub mod curved;
pub mod driven;
pub mod errors;
pub mod exact_meshes;
pub mod faults;
pub mod forms;
pub mod lattice_points;
pub mod motion;
pub mod mutants;
pub mod near_points;
pub mod nets;
pub mod pairs;
pub mod parry;
pub mod paths;
pub mod plans;
pub mod rooms;
pub mod rows;
pub mod soups;
pub mod support;
pub mod tally;
pub mod turned;
pub mod workload;

pub use cases::{Body, ContactState, Exact, Face, Point, Pose};
pub use cases::{body, bound, brute_hull, command, exact, families, maker, pose, queries, rational, rng, say};
pub use cases::{shapes, solid, suite, verdict, volumes};
