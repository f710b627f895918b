//! Pairs of geometries of any two kinds.
//!
//! ```text
//! PairTracker   follow    which pair was asked last, by fingerprints      tracker.rs
//!   Engine      lend      which tracker measures two kinds; stand-ins     engine.rs, of_*.rs
//!     LentPair  ask       the pair, the borrowed tracker, the questions   lent_pair.rs
//!       MeshPair, ...     the pair of two kinds, in the room of its tracker
//! ```

// First, so that the documentation of `PairTracker` begins with `new` and `closest`.
mod tracker;

#[cfg(feature = "meshes")]
mod contacts;
mod engine;
pub(crate) mod geometry;
mod leave;
mod lent_pair;
#[cfg(feature = "meshes")]
mod mesh_questions;
#[cfg(feature = "meshes")]
mod of_parts;
#[cfg(feature = "surfaces")]
mod of_surfaces;

pub use lent_pair::MovingPair;
pub use tracker::{PairError, PairTracker, PairWork};

#[cfg(feature = "meshes")]
pub(crate) use contacts::{PatchwiseContacts, patches_of};
pub(crate) use engine::Engine;
#[cfg(feature = "serde")]
pub(crate) use engine::StoredEngine;
pub(crate) use lent_pair::LentPair;
