//! lin-canny
#![no_std]
extern crate alloc;
#[cfg(feature = "std")]
extern crate std;

mod certificate;
mod closest;
mod double_double;
pub mod polyhedron;
mod pose;
mod replay;
mod scalar;
mod soundness;
pub mod tolerance;
mod tracker;

pub use closest::outcome::{Class, Distance, Layer, Level, Outcome, Proposal, Work};
pub use nalgebra;
pub use polyhedron::{BuildError, BuildReport, ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId};
pub use pose::{PoseError, RelativePose, Which};
pub use replay::{Replay, ReplayError};
pub use tracker::{Totals, Tracker};
