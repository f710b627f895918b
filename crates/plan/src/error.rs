//! Refused input of configuration spaces, worlds and checkers.

use std::string::String;

use lin_canny::PoseError;
use lin_canny::broad::BroadPhaseError;
use lin_canny::impact::ImpactError;
use lin_canny::motion::MotionError;

/// Reason why a planning call was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// A configuration with too few or too many numbers.
    #[error("a configuration has {expected} numbers, not {found}")]
    Length {
        /// The number of coordinates of the space.
        expected: usize,
        /// The number given.
        found: usize,
    },
    /// A coordinate of a configuration that is not finite or outside the bounds.
    #[error("coordinate {index} of a configuration is out of bounds: {value:?}")]
    Coordinate {
        /// The index of the coordinate.
        index: usize,
        /// The value given.
        value: f64,
    },
    /// The quaternion of a configuration is not of unit length, to 1e-12 of the squared norm.
    #[error("the quaternion of a configuration has a squared norm of {squared_norm}")]
    Rotation {
        /// The squared norm.
        squared_norm: f64,
    },
    /// Bounds, limits, lengths or counts that define no space or no search.
    #[error("{what} is out of range: {value:?}")]
    Value {
        /// The name of the number.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// The space moves another number of bodies than the world has bodies of the robot.
    #[error("the space moves {space} bodies, the world has {world} bodies of the robot")]
    Bodies {
        /// Bodies of the space.
        space: usize,
        /// Bodies of the robot in the world.
        world: usize,
    },
    /// No body has this name.
    #[error("no body is called {0}")]
    Unnamed(String),
    /// The robot is in contact, or nearer than the margin, at an end of the motion asked for.
    #[error("{a} and {b} are in contact, or within the margin, at the {end}")]
    Contact {
        /// `start` or `goal`.
        end: &'static str,
        /// The name of the first body.
        a: String,
        /// The name of the second body.
        b: String,
    },
    /// A path without a configuration.
    #[error("a path needs a configuration")]
    Empty,
    /// A pose that is no rigid placement.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// Numbers of a motion that are out of range.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// A cast that was refused.
    #[error(transparent)]
    Impact(#[from] ImpactError),
    /// A box that the broad phase refused.
    #[error(transparent)]
    Broad(#[from] BroadPhaseError),
}
