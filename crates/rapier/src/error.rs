//! Why a call was refused.

use lin_canny::{PoseError, scene::SceneError};

use crate::BodyId;

/// Reason for which a simulation refused a call; a refused call changes nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A number is not finite, or not in the range of its kind. With response the range is that of
    /// rapier's precision: in `f32`, coordinates of positions, velocities and gravity are at most
    /// 1.8e17, and time step and size lie between 1.1e-17 and that; in `f64`, and without response, the
    /// range is 1.5e-152 to 1.3e152. The mass of a moving solid has an inverse, which to rapier is one
    /// above 1e-20.
    #[error("{what} is {value}")]
    Number {
        /// Name of the number.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// An effect was called for that only bodies which push each other can have.
    #[error("{effect} is called for without response")]
    NeedsResponse {
        /// Name of the effect.
        effect: &'static str,
    },
    /// The default step, 1/60, is too long for bodies of the [`length_unit`](crate::Settings::length_unit) of the
    /// settings: one that is let go falls by more than an eighth of its size within it, and stacks
    /// of such bodies sink into each other or fall. Set [`time_step`](field@crate::Settings::time_step).
    #[error(
        "the default time step of 1/60 is too long for bodies of this size: set time_step, to at most {longest:.2e}"
    )]
    LongStep {
        /// The longest step in which such a body falls by no more than an eighth of its size.
        longest: f64,
    },
    /// [`Settings::queries`](crate::Settings::queries) together with response: with response,
    /// rapier's narrow phase has the contacts.
    #[error("a scene is observed without response only")]
    ObservedResponse,
    /// A shape without response that [`lin_canny`] does not have: a half-space, voxels, a custom
    /// shape, or one of which it refuses a number.
    #[error("the shape has no geometry in lin-canny")]
    Shape,
    /// The pose is not a rigid motion.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// The scene refused a body, or a body left the reach of the scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The body was removed, or belongs to another simulation.
    #[error("there is no body {}", body.0)]
    NoBody {
        /// The id.
        body: BodyId,
    },
}
