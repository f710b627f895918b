//! The point of the Minkowski difference A - B closest to the origin: the solver without a walk,
//! and the proof of overlap that a tracker caches.

pub(crate) mod gjk;
pub(crate) mod overlap_proof;
pub(crate) mod simplex;
pub(crate) mod start;
pub(crate) mod witnesses;
