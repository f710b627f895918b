//! Foundations: arithmetic, poses, motions and bounds of rounding errors.

pub(crate) mod callbacks;
pub mod motion;
pub(crate) mod num;
pub(crate) mod pose;
pub(crate) mod tolerance;
