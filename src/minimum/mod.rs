//! The point of the Minkowski difference A - B nearest to the origin: the solver that does not walk, and the proof of
//! overlap that a tracker keeps.

pub(crate) mod gjk;
pub(crate) mod overlap_proof;
pub(crate) mod simplex;
pub(crate) mod witnesses;
