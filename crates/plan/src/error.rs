//! Errors of configuration spaces, worlds and checkers.

use std::string::String;

use lin_canny::PoseError;
use lin_canny::broad::BroadPhaseError;
use lin_canny::impact::ImpactError;
use lin_canny::motion::MotionError;

/// Error of a call of this crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// Returned if a configuration has too few or too many numbers.
    #[error("configuration has {found} numbers (expected {expected})")]
    Length {
        /// Number of coordinates of the space.
        expected: usize,
        /// Length of the configuration.
        found: usize,
    },
    /// Returned if a coordinate of a configuration is not finite or outside the bounds.
    #[error("coordinate {index} of the configuration is out of bounds: {value:?}")]
    Coordinate {
        /// Index of the coordinate.
        index: usize,
        /// Value of the coordinate.
        value: f64,
    },
    /// Returned if the squared norm of a quaternion differs from 1 by more than 1e-12.
    #[error(
        "quaternion of the configuration is not a unit quaternion: squared norm {squared_norm} (expected 1 to 1e-12)"
    )]
    Rotation {
        /// Squared norm of the quaternion.
        squared_norm: f64,
    },
    /// Returned if a bound, limit, length, index or count of a space or a search is out of range.
    #[error("{what} is out of range: {value:?}")]
    Value {
        /// Name of the number.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// Returned if the space and the world have different numbers of robot bodies.
    #[error("number of robot bodies differs: {space} in the space, {world} in the world")]
    Bodies {
        /// Number of bodies that the space moves.
        space: usize,
        /// Number of robot bodies in the world.
        world: usize,
    },
    /// Returned if no body has this name.
    #[error("body {0:?} does not exist")]
    Unnamed(String),
    /// Returned if the robot is in contact, or closer than the margin, at the start or the goal.
    #[error("{a} and {b} are in contact or closer than the margin at the {end}")]
    Contact {
        /// `start` or `goal`.
        end: &'static str,
        /// Name of the first body.
        a: String,
        /// Name of the second body.
        b: String,
    },
    /// Returned if a path has no configuration.
    #[error("path is empty (expected at least one configuration)")]
    Empty,
    /// Returned if a pose is invalid.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// Returned if a number of a motion is out of range.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// Returned if a cast is invalid.
    #[error(transparent)]
    Impact(#[from] ImpactError),
    /// Returned if the broad phase rejects a box.
    #[error(transparent)]
    Broad(#[from] BroadPhaseError),
}
