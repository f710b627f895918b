//! Benchmarks of `lin-canny`: rivals, workloads, and shared parts of the instruments.
//!
//! The instruments are the programs of this package; `cargo run --release -p race --bin NAME` runs
//! one. Examples that need more than the library are the examples of this package.
//!
//! | module | contents |
//! |---|---|
//! | [`common`] | shared parts of these races and of the race with rapier |
//! | [`parry_f32`] | parry in single precision; in double precision it is the reference engine of the package `truth` |
//! | [`record`], [`accuracy`] | measurements as CSV, and charts of the cost of accuracy |
//! | [`plot`], [`progress`] | charts as SVG, progress bars |

pub mod accuracy;
pub mod common;
pub mod parry_f32;
pub mod plot;
pub mod progress;
pub mod record;
