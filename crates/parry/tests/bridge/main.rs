//! Promises of the crate, in both precisions.

#[cfg(feature = "f64")]
mod double;
#[cfg(feature = "f32")]
mod single;
