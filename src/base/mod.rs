//! What everything stands on: numbers, poses, motions, bounds of rounding errors, and the page of
//! costs.

pub(crate) mod callbacks;
pub mod cost;
pub mod motion;
pub(crate) mod num;
pub(crate) mod pose;
pub mod tolerance;
