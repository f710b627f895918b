//! Pairs of geometries of any two kinds.
//!
//! ```text
//! PairTracker       which pair was asked last, by fingerprints         tracker.rs
//!   Engine          which tracker measures two kinds; converted copies engine.rs, of_*.rs
//!     BorrowedPair  the bodies, the borrowed tracker, the questions    borrowed_pair.rs
//!       MeshPair, ...  the pair of two kinds, in the memory of its tracker
//! ```

// First, so that the documentation of `PairTracker` begins with `new` and `closest`.
mod tracker;

mod borrowed_pair;
#[cfg(feature = "meshes")]
mod contacts;
mod engine;
pub(crate) mod geometry;
mod leave;
#[cfg(feature = "meshes")]
mod mesh_questions;
#[cfg(feature = "meshes")]
mod of_parts;
#[cfg(feature = "surfaces")]
mod of_surfaces;
#[cfg(feature = "meshes")]
mod overlaps;

pub use borrowed_pair::MovingPair;
#[cfg(feature = "meshes")]
pub use overlaps::OverlapError;
pub use tracker::{PairError, PairTracker, PairWork};

pub(crate) use borrowed_pair::BorrowedPair;
#[cfg(feature = "meshes")]
pub(crate) use contacts::{PairContacts, patches_of};
#[cfg(feature = "serde")]
pub(crate) use engine::StoredEngine;
pub(crate) use engine::{Engine, TrackedPair};
