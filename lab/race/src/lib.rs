//! How `lin-canny` is measured: the competitors, the workloads that they are timed on, and what the instruments share. The
//! instruments are the programs of this package, each by `cargo run --release -p race --bin NAME`; the examples that need more
//! than the library are its examples.
//!
//! | module | what it gives |
//! |---|---|
//! | [`common`] | what the races here and the race with rapier share |
//! | [`parry_f32`] | parry in single precision; in double precision it is the reference engine of the package `truth` |
//! | [`record`], [`accuracy`] | measurements as CSV, and the pictures of what accuracy costs |
//! | [`plot`], [`progress`] | charts as SVG, progress bars |

pub mod accuracy;
pub mod common;
pub mod parry_f32;
pub mod plot;
pub mod progress;
pub mod record;
