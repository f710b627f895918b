//! Foundations: arithmetic, poses, motions and bounds of rounding errors; also the page of costs.

pub mod cost;
pub mod motion;
pub(crate) mod notice;
pub(crate) mod num;
pub(crate) mod pose;
pub mod tolerance;
