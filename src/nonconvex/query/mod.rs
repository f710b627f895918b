//! Two bodies of parts at a pose: the search down both trees to the closest pair, and what it asks
//! of boxes, leaves and triangles.

pub(crate) mod box_gaps;
#[cfg(feature = "exact")]
pub(crate) mod exact;
pub(crate) mod frame;
pub(super) mod inside;
pub(super) mod overlap;
pub(crate) mod ray;
pub(crate) mod search;
pub(super) mod state;
pub(crate) mod triangle;
