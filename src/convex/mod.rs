//! Pairs of convex bodies: the walk, the solvers behind it, depths, contacts, curved cores, and the
//! state between queries.

pub(crate) mod contact;
pub(crate) mod depth;
#[cfg(feature = "exact")]
pub(crate) mod exact;
pub(crate) mod minimum;
pub(crate) mod replay;
pub(crate) mod shape_tracker;
pub(crate) mod smooth;
pub(crate) mod solve;
pub(crate) mod tracker;
pub(crate) mod walk;
