//! Robots from their files.
#![forbid(unsafe_code)]

mod error;
mod geometry;
mod mesh_file;
mod packages;
mod robot;
mod srdf;
mod urdf;
mod xml;

pub use error::{FileError, FileProblem};
pub use geometry::{MeshOptions, MeshUse};
pub use lin_canny;
pub use packages::Packages;
pub use robot::{Coordinate, LinkBody, LoadOptions, MotionKind, Robot, RobotJoint, RobotLink};
pub use srdf::{IgnoredPair, Srdf};
