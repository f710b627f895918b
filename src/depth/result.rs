//! What a search finds.

use crate::num::scalar::{Scalar, Vec3};
use crate::pair::difference::MinkowskiPoint;
use crate::polyhedron::FeaturePair;

use crate::depth::foot::Witnesses;

/// Why a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// Both bounds agree.
    Closed,
    /// Rounding hides what to do next.
    Stuck,
    /// The surface has as many triangles as it may.
    Full,
}

/// What a search proves and where it ended.
pub(super) struct Found<T> {
    pub(super) end: End,
    /// The best unit direction and the height of the difference along it.
    pub(super) normal: Vec3<T>,
    pub(super) height: T,
    /// No point outside the difference is nearer to the origin; zero where nothing is known.
    pub(super) radius: T,
    /// The triangle that holds the deepest point, or one of the facet.
    pub(super) corners: [MinkowskiPoint<T>; 3],
    /// The deepest points of A and of B in their stored frames.
    pub(super) witnesses: Option<Witnesses>,
    pub(super) features: Option<FeaturePair>,
    /// Points the surface took in.
    pub(super) grown: u32,
}

/// A direction, its height, and the features it comes from.
#[derive(Clone, Copy)]
pub(super) struct Best<T> {
    pub(super) normal: Vec3<T>,
    pub(super) height: T,
    pub(super) features: Option<FeaturePair>,
}

impl<T: Scalar> Best<T> {
    /// Normal and height in f64.
    pub(super) fn rounded(&self) -> (Vec3<f64>, f64) {
        (self.normal.map(Scalar::value), self.height.value())
    }
}
