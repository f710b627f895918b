//! Why a call was refused.

use lin_canny::{PoseError, scene::SceneError};

use crate::BodyId;

/// Reason for which a simulation refused a call; a refused call changes nothing.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SimulationError {
    /// A number is not finite, or not in the range of its kind.
    Number {
        /// Name of the number.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// An effect was called for that only bodies which push each other can have.
    NeedsResponse {
        /// Name of the effect.
        effect: &'static str,
    },
    /// [`Settings::observe`](crate::Settings::observe) together with response: with response,
    /// rapier's narrow phase has the contacts.
    ObservedResponse,
    /// The pose is not a rigid motion.
    Pose(PoseError),
    /// The scene refused a body, or a body left the reach of the scene.
    Scene(SceneError),
    /// The body was removed, or belongs to another simulation.
    NoBody {
        /// The id.
        body: BodyId,
    },
}

impl std::fmt::Display for SimulationError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number { what, value } => write!(f, "{what} is {value}"),
            Self::NeedsResponse { effect } => write!(f, "{effect} is called for without response"),
            Self::ObservedResponse => f.pad("a scene is observed without response only"),
            Self::Pose(e) => e.fmt(f),
            Self::Scene(e) => e.fmt(f),
            Self::NoBody { body } => write!(f, "there is no body {}", body.0),
        }
    }
}

impl std::error::Error for SimulationError {}

impl From<PoseError> for SimulationError {
    fn from(e: PoseError) -> Self {
        Self::Pose(e)
    }
}

impl From<SceneError> for SimulationError {
    fn from(e: SceneError) -> Self {
        Self::Scene(e)
    }
}
