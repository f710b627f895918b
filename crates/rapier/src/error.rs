//! The error of a simulation.

use lin_canny::{PoseError, scene::SceneError};

use crate::BodyId;

/// Error of a call of a simulation. The call changed nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// Returned if a number is not finite or out of range.
    ///
    /// | number | `f32` with response | `f64`, or without response |
    /// |---|---|---|
    /// | coordinates of positions, velocities and gravity | at most 1.8e17 | at most 1.3e152 |
    /// | time step and size | 1.1e-17 to 1.8e17 | 1.5e-152 to 1.3e152 |
    ///
    /// The inverse of the mass of a moving body must be above 1e-20 with response.
    #[error("{what} is out of range: {value}")]
    Number {
        /// Name of the number.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// Returned if an effect is enabled that needs response, but response is not.
    #[error("the effect {effect} needs `response`")]
    NeedsResponse {
        /// Name of the effect.
        effect: &'static str,
    },
    /// Returned if the default step of 1/60 is too long for bodies of this
    /// [`length_unit`](crate::Settings::length_unit): a falling body would fall by more than an eighth of its
    /// size within one step, and stacks of such bodies sink into each other or fall. Set
    /// [`time_step`](field@crate::Settings::time_step).
    #[error(
        "default time step 1/60 is too long for bodies of this size (expected at most {longest:.2e}); set `time_step`"
    )]
    LongStep {
        /// Longest step in which such a body falls by at most an eighth of its size.
        longest: f64,
    },
    /// Returned if [`Settings::queries`](crate::Settings::queries) is set together with response.
    /// With response, rapier's narrow phase has the contacts.
    #[error("`observe` cannot be combined with `response`")]
    ObservedResponse,
    /// Returned without response if [`lin_canny`] has no equivalent of a shape: a half-space,
    /// voxels, a custom shape, or a shape with a number out of range.
    #[error("shape has no equivalent in lin-canny: a half-space, voxels, a custom shape or an invalid size")]
    Shape,
    /// Returned if a pose is not a rigid motion.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// Returned if the scene rejects a body, or if a body has left the range of the scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Returned if the body was removed or belongs to another simulation.
    #[error("body {} does not exist", body.0)]
    NoBody {
        /// Id of the body.
        body: BodyId,
    },
}
