//! Refused numbers of motions.

use crate::base::pose::PoseError;

/// Fault of the numbers of a motion.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// A pose is no rigid placement. The body named is A for the first pose given, B for the
    /// second.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// A velocity, an acceleration, an axis or a point is NaN or infinite, or its square leaves
    /// f64.
    #[error("{what} is out of range: {value}")]
    Value {
        /// The name of the value.
        what: &'static str,
        /// The coordinate that is largest, or NaN.
        value: f64,
    },
    /// A bound or a duration is negative, NaN or infinite; a duration is zero.
    #[error("{what} must be positive and finite, and is {value}")]
    Size {
        /// The name of the size.
        what: &'static str,
        /// The size.
        value: f64,
    },
}
