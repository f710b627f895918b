//! Pairs of geometries of any two kinds.

// First, so that the documentation of `PairTracker` begins with `new` and `closest`.
mod tracker;

#[cfg(feature = "meshes")]
mod contacts;
#[cfg(feature = "meshes")]
mod decomposition;
mod engine;
pub(crate) mod geometry;
mod manifold;
mod mixed;
mod over;
#[cfg(feature = "meshes")]
mod own;
mod pair;
#[cfg(feature = "meshes")]
mod parted;
#[cfg(feature = "surfaces")]
mod patched;
pub(crate) mod ray;
#[cfg(feature = "meshes")]
mod ray_hull;
#[cfg(feature = "meshes")]
mod ray_mesh;
mod state;
mod tracked;
mod work;

pub use manifold::PairError;
pub use over::OverTime;
pub use tracker::PairTracker;
pub use work::PairWork;

#[cfg(feature = "meshes")]
pub(crate) use contacts::patches_of;
pub(crate) use engine::{AnyTracker, BodyShapes, ContactAsk, Contacted, PairEngine, TrackerRef};
pub(crate) use mixed::MixedTracker;
#[cfg(feature = "serde")]
pub(crate) use mixed::StoredTracker;
