//! Foundations: arithmetic, poses, motions and bounds of rounding errors; also the page of costs.

pub(crate) mod callbacks;
pub mod cost;
pub mod motion;
pub(crate) mod num;
pub(crate) mod pose;
pub mod tolerance;
