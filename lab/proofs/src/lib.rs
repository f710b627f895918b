//! The error bounds of the crate, proved by exact arithmetic.
//!
//! Each kernel that carries a bound is transcribed once in [`kernels`], over a [`Number`]:
//!
//! | number | what a kernel yields with it |
//! |---|---|
//! | `f64`, `f32` | what the crate computes, bit for bit |
//! | [`Majorant`] | a bound of its rounding and of what underflow takes, for all inputs |
//! | [`Reach`] | the largest number and the finest grid on the way |
//! | [`Traced`] | the rounding of one input, for the search of large ones |
//! | [`measured::TracedTwice`] | the same in twice the precision |
//! | [`vectors::Within`], [`vectors::Arrow`] | the same as a majorant for numbers and vectors of known sizes |
//! | [`Factor`] | the same as a majorant for chains of positive numbers, with quotients and roots |
//!
//! [`bounds`] says for each constant of the crate what it has to cover; `tests/proofs` compares all of this with the
//! crate.
//!
//! The standard model is assumed: binary64 or binary32, to nearest, each operation rounded once.

pub mod bounds;
pub mod climb;
pub mod factor;
pub mod kernels;
pub mod majorant;
pub mod measured;
pub mod norm;
pub mod number;
pub mod polynomial;
pub mod reach;
pub mod traced;
pub mod vectors;

pub use factor::{Factor, Positive};
pub use majorant::Majorant;
pub use number::{Number, Vector};
pub use polynomial::Polynomial;
pub use reach::Reach;
pub use traced::Traced;
