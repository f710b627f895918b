//! The result of a search.

use crate::base::num::scalar::{Scalar, Vec3};
use crate::base::tolerance::AGREE_DEPTH;
use crate::body::polyhedron::FeaturePair;
use crate::pair::difference::MinkowskiPoint;

use crate::convex::depth::foot::WitnessPoints;
use crate::pair::difference_facet::DifferenceFacet;

/// Why a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SearchEnd {
    /// Both bounds agree.
    Closed,
    /// Rounding hides the next step.
    Stuck,
    /// The surface reached its triangle limit.
    Full,
}

/// Proven bounds and final state of a search.
pub(super) struct SearchResult<T> {
    pub(super) end: SearchEnd,
    /// Best unit direction and the support of A - B along the direction.
    pub(super) normal: Vec3<T>,
    pub(super) height: T,
    /// Every point outside A - B is at least this far from the origin; zero if nothing is known.
    pub(super) radius: T,
    /// Triangle that contains the deepest point, or a triangle of the facet.
    pub(super) vertices: [MinkowskiPoint<T>; 3],
    /// Deepest points of A and of B in their stored frames.
    pub(super) witnesses: Option<WitnessPoints>,
    pub(super) features: Option<FeaturePair>,
    /// Number of points added to the surface.
    pub(super) points_added: u32,
}

impl SearchResult<f64> {
    /// Returns the result if the difference contains the ball up to the best facet, which has
    /// witnesses.
    pub(super) fn proven(best: &Best<f64>, witnesses: WitnessPoints, size: f64) -> Self {
        Self::of_facet(best, witnesses, best.height - AGREE_DEPTH * size)
    }

    /// Returns the result if the difference contains a ball of this radius, with the best facet and
    /// its witnesses.
    pub(super) fn of_facet(best: &Best<f64>, witnesses: WitnessPoints, radius: f64) -> Self {
        Self {
            end: SearchEnd::Closed,
            normal: best.normal,
            height: best.height,
            radius,
            vertices: [MinkowskiPoint::default(); 3],
            witnesses: Some(witnesses),
            features: best.facet.map(DifferenceFacet::features),
            points_added: 0,
        }
    }
}

/// A direction, the support along the direction, and the facet it is the normal of.
#[derive(Clone, Copy)]
pub(super) struct Best<T> {
    pub(super) normal: Vec3<T>,
    pub(super) height: T,
    pub(super) facet: Option<DifferenceFacet>,
}

impl<T: Scalar> Best<T> {
    /// Returns normal and height rounded to f64.
    pub(super) fn rounded(&self) -> (Vec3<f64>, f64) {
        (self.normal.map(Scalar::value), self.height.value())
    }
}
