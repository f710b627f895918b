//! Errors of configuration spaces, cells and checkers.

use std::string::String;

use crate::names::{CellBody, CellPair};
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
    /// Returned if the lower end of a range is above its upper end.
    #[error("coordinate {index} of the range is empty: {low:?} to {high:?} (expected low <= high)")]
    Range {
        /// Index of the coordinate.
        index: usize,
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// Returned by proofs over ranges if the space does not move a body by joints.
    #[error("{0} is not moved by joints, so nothing is proven over ranges (expected a space with `joint_path`)")]
    WithoutJoints(CellBody),
    /// Returned if an answer is resumed that belongs to other bodies or joints.
    #[error("the answer about {0} does not belong to this checker or range")]
    OtherRange(CellPair),
    /// Returned if boxes of pairs belong to another robot. Names what differs.
    #[error("the boxes of pairs do not belong to this checker: {0}")]
    OtherPairBoxes(String),
    /// Returned if a curve leaves the bounds of a coordinate between its control points.
    #[error("coordinate {coordinate} of the curve is out of bounds at time {time:?}: {value:?}")]
    CurveLimit {
        /// Index of the coordinate.
        coordinate: usize,
        /// A time of the curve, from 0 to 1.
        time: f64,
        /// Value of the coordinate at this time.
        value: f64,
    },
    /// Returned if a space moves only along straight segments, because a coordinate belongs to a
    /// rotation.
    #[error("coordinate {coordinate} belongs to a rotation, so the curve has degree 1 at most (found {degree})")]
    CurveDegree {
        /// Index of the first such coordinate.
        coordinate: usize,
        /// Degree of the curve.
        degree: usize,
    },
    /// Returned if a curve of a spline does not start where the curve before ends.
    #[error("coordinate {coordinate} of curve {index} does not start where curve {} ends", index - 1)]
    CurveJump {
        /// Index of the curve.
        index: usize,
        /// Index of the coordinate.
        coordinate: usize,
    },
    /// Returned if the cell has a moving obstacle, and a motion or a configuration has no time.
    #[error("obstacle {0:?} moves (expected a motion with times, or a checker with a time)")]
    NoTime(String),
    /// Returned if a moving obstacle has no pose at a time of the query.
    #[error("obstacle {name:?} has no pose at time {time:?} (its poses cover {from:?} to {until:?})")]
    PoseTime {
        /// Name of the obstacle.
        name: String,
        /// The time.
        time: f64,
        /// The first time of the poses.
        from: f64,
        /// The last time of the poses.
        until: f64,
    },
    /// Returned by timed poses: the error of one of them.
    #[error("timed pose {row}: {error}")]
    TimedPose {
        /// Index of the pose.
        row: usize,
        /// Its error.
        error: std::boxed::Box<PlanError>,
    },
    /// Returned if a curve of a spline does not start at the time at which the curve before ends.
    #[error("curve {index} starts at time {start:?} (expected {end:?}, where curve {} ends)", index - 1)]
    CurveTime {
        /// Index of the curve.
        index: usize,
        /// The time at which it starts.
        start: f64,
        /// The time at which the curve before ends.
        end: f64,
    },
    /// Returned if a limit of velocity or acceleration is not a positive number in range, or cannot
    /// be kept.
    #[error("{what} limit of coordinate {coordinate} is out of range: {value:?} (expected a positive number)")]
    Limit {
        /// `velocity` or `acceleration`.
        what: &'static str,
        /// Index of the coordinate.
        coordinate: usize,
        /// The limit.
        value: f64,
    },
    /// Returned if a segment of a path is not proven free, or by less than rounding.
    #[error("segment {segment} of the path is not proven free")]
    Unproven {
        /// Index of the segment.
        segment: usize,
    },
    /// Returned if the squared norm of a quaternion differs from 1 by more than 1e-12.
    #[error(
        "quaternion of the configuration is not a unit quaternion: squared norm {squared_norm} (expected 1 to 1e-12)"
    )]
    Rotation {
        /// Squared norm of the quaternion.
        squared_norm: f64,
    },
    /// Returned if a bound, limit, length, index or count is out of range.
    #[error("{what} is out of range: {value:?}")]
    Value {
        /// Name of the number.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// Returned if the space and the cell have different numbers of robot bodies.
    #[error("number of robot bodies differs: {space} in the space, {cell} in the cell")]
    Bodies {
        /// Number of bodies that the space moves.
        space: usize,
        /// Number of robot bodies in the world.
        cell: usize,
    },
    /// Returned if no body or link has this name.
    #[error("body {name:?} does not exist{}", suggestion(near.as_deref()))]
    Unnamed {
        /// The name.
        name: String,
        /// The nearest name that exists, if one is near.
        near: Option<std::boxed::Box<str>>,
    },
    /// Returned if a body or a link has this name already.
    #[error("{kind} {name:?}: the name is taken (expected another one)")]
    NameTaken {
        /// What was to be added: `link`, `joint`, `obstacle` or `object`.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// Returned if a pair names a link that has no bodies, and thus no pairs.
    #[error("link {0:?} has no bodies, so it has no pairs")]
    WithoutBodies(String),
    /// Returned if both bodies of a pair are the same body or link.
    #[error("{0:?} has no pair with itself (expected two bodies)")]
    Itself(String),
    /// Returned if an attached object or obstacle existed, but was removed.
    #[error("{0} was removed")]
    Removed(CellBody),
    /// Returned if no body ever had this id.
    #[error("{0} does not exist")]
    NoBody(CellBody),
    /// Returned if a body that moves with the robot is a half-space.
    #[error("body {0:?} is a half-space (expected a bounded geometry for a body that moves with the robot)")]
    Unbounded(String),
    /// Returned if a body is of another kind than the call requires.
    #[error("{body} is not {kind}")]
    Kind {
        /// The name of the body.
        body: String,
        /// What was expected, such as `an obstacle`.
        kind: &'static str,
    },
    /// Returned if a name stands for several bodies, but the call takes only one.
    #[error("{count} bodies are named {name:?} (expected one)")]
    Ambiguous {
        /// The name.
        name: String,
        /// Number of bodies with the name.
        count: usize,
    },
    /// Returned by batches: the error of one configuration.
    #[error("configuration {row}: {error}")]
    Row {
        /// Index of the configuration.
        row: usize,
        /// Its error.
        error: std::boxed::Box<PlanError>,
    },
    /// Returned if a pair is in contact, or does not keep its required distance, at the start or the goal.
    #[error("{a} and {b} are in contact or closer than required at the {end}")]
    Contact {
        /// `start` or `goal`.
        end: &'static str,
        /// Name of the first body.
        a: String,
        /// Name of the second body.
        b: String,
    },
    /// Returned if the progress callback stopped a call that has no result so far.
    #[error("the call was stopped by its progress callback")]
    Stopped,
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
    /// Returned if the box of an obstacle is not finite, or the broad phase rejects it.
    #[error(transparent)]
    Broad(#[from] BroadPhaseError),
}

fn suggestion(near: Option<&str>) -> String {
    near.map_or(String::new(), |near| std::format!(" (nearest: {near:?})"))
}
