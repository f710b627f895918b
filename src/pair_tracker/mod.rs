//! Pairs of geometries of any two kinds.

mod contacts;
mod decomposition;
mod engine;
pub(crate) mod geometry;
mod mixed;
mod over;
mod pair;
mod state;
mod tracker;
mod work;

pub use contacts::PairError;
pub use over::OverTime;
pub use tracker::PairTracker;
pub use work::PairWork;

pub(crate) use contacts::patches_of;
pub(crate) use engine::{AnyTracker, BodyShapes, ContactAsk, Contacted, PairEngine, TrackerRef};
pub(crate) use mixed::MixedTracker;
#[cfg(feature = "serde")]
pub(crate) use mixed::StoredTracker;
