//! Errors of patches and surfaces.

use crate::base::num::axis_name;

/// Error returned if numbers do not form a valid patch or surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// A degree is not between 1 and 7.
    #[error("degree in direction {direction} is out of range: {degree} (expected 1..=7)")]
    Degree {
        /// The direction: 0 for u, 1 for v.
        direction: usize,
        /// The degree.
        degree: usize,
    },
    /// The number of control points does not fit the degrees or the knots.
    #[error("number of control points is invalid: {given} (expected {expected})")]
    Count {
        /// Number of control points given.
        given: usize,
        /// Number of control points needed.
        expected: usize,
    },
    /// The number of weights is not the number of control points.
    #[error("number of weights is invalid: {given} (expected {expected}, one per control point)")]
    WeightCount {
        /// Number of weights given.
        given: usize,
        /// Number of control points.
        expected: usize,
    },
    /// A coordinate of a control point is not finite, or beyond `2^200`.
    #[error("control point {index} is out of range: {} is {value} (expected -2^200..=2^200)", axis_name(*.axis))]
    Coordinate {
        /// Index of the control point.
        index: usize,
        /// Index of the coordinate: 0, 1 or 2.
        axis: usize,
        /// The value.
        value: f64,
    },
    /// A weight is not positive and finite, or below `2^-40` of the largest weight.
    #[error("weight {index} is out of range: {value} (expected a positive number, at least 2^-40 of the largest)")]
    Weight {
        /// Index of the weight.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A knot is not finite, less than the previous knot, or repeated too often for the degree.
    #[error(
        "knot {index} in direction {direction} is invalid: {value} is not finite, out of order, or repeated too often"
    )]
    Knot {
        /// The direction: 0 for u, 1 for v.
        direction: usize,
        /// Index of the knot.
        index: usize,
        /// The value.
        value: f64,
    },
    /// The number of knots is not `points + degree + 1`.
    #[error("number of knots in direction {direction} is invalid: {given} (expected {expected})")]
    KnotCount {
        /// The direction: 0 for u, 1 for v.
        direction: usize,
        /// Number of knots given.
        given: usize,
        /// Number of knots needed.
        expected: usize,
    },
    /// The surface is trimmed: only whole patches are supported.
    #[error("trimmed surfaces are not supported: {curves} trimming curves")]
    Trimmed {
        /// Number of trimming curves.
        curves: usize,
    },
    /// The radius of a patch from a file is out of range, or less than the radius of its points.
    #[error("radius of a patch is invalid: {value} is not finite, or less than that of its points")]
    Reach {
        /// The value.
        value: f64,
    },
    /// The surface has no patch.
    #[error("the surface has no patches")]
    Empty,
}
