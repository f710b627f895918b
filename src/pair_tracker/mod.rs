//! Pairs of geometries of any two kinds.

mod engine;
mod mixed;
mod over;
mod surface;
mod tracker;

pub use over::OverTime;
pub use tracker::{Answer, PairError, PairTracker, Spot};

pub(crate) use engine::{AnyTracker, ContactAsk, Contacted, PairEngine, TrackerRef};
pub(crate) use mixed::MixedTracker;
#[cfg(feature = "serde")]
pub(crate) use mixed::StoredTracker;
