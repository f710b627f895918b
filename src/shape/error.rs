//! Why a shape was refused.

use crate::polyhedron::BuildError;

/// Why parameters make no shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A parameter is not finite, or outside the range that its constructor names.
    #[error("{value:e} is no {what} of a shape")]
    BadParameter {
        /// Which parameter.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The points of a core make no body.
    #[error(transparent)]
    Core(#[from] BuildError),
}
