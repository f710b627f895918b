//! Error returned if parameters make no shape.

use crate::body::polyhedron::BuildError;

/// Error returned if parameters make no shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A parameter is not finite, or outside the range that the constructor names.
    #[error("{value:e} is no {what} of a shape")]
    BadParameter {
        /// Name of the parameter.
        what: &'static str,
        /// Value of the parameter.
        value: f64,
    },
    /// A capsule without a length.
    #[error("a capsule of half length zero is a ball: Shape::ball makes it")]
    NoLength,
    /// The points of a core make no body.
    #[error(transparent)]
    Core(#[from] BuildError),
}
