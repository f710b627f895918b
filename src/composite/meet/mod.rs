//! Two bodies of parts at a pose: the search down both trees to the closest pair, and what it asks
//! of boxes, leaves and triangles.

pub(crate) mod bounds;
mod common;
#[cfg(feature = "exact")]
pub(crate) mod exact_ray;
#[cfg(feature = "exact")]
pub(crate) mod exact_side;
pub(crate) mod frame;
pub(in crate::composite) mod inside;
mod leaves;
pub(in crate::composite) mod look_ahead;
pub(crate) mod ray;
pub(crate) mod search;
mod seed;
pub(in crate::composite) mod segment;
pub(in crate::composite) mod shared;
pub(in crate::composite) mod state;
pub(crate) mod triangle;
