//! Queries of two meshes or compounds at a pose: the search down both trees to the closest pair,
//! and the bounds and tests of boxes, leaves and triangles.

pub(crate) mod box_gaps;
#[cfg(feature = "exact")]
pub(crate) mod exact;
pub(crate) mod frame;
pub(crate) mod inside;
pub(crate) mod near;
pub(super) mod overlap;
pub(crate) mod ray;
mod refined;
pub(crate) mod search;
pub(crate) mod state;
pub(crate) mod triangle;
