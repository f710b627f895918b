//! The outcome of a query of two geometries of any kind.

use core::ops::Deref;

use nalgebra::Unit;

use super::outcome::{Distance, Outcome};
use crate::base::num::each::Each;
use crate::base::pose::RelativePose;
use crate::body::polyhedron::{FaceId, Feature, FeaturePair};

/// The location of a witness on a geometry: subshape, feature and parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct WitnessLocation {
    /// Index of the piece, triangle or patch, as the caller numbered it; zero for a convex
    /// geometry.
    ///
    /// In a pair with a mesh, a compound of polyhedra is measured as the mesh of its surface
    /// ([`Compound::to_mesh`](crate::Compound::to_mesh)).
    pub subshape: u32,
    /// The feature that contains the witness: of a polyhedron, of the core of a convex shape, or of
    /// the piece.
    ///
    /// - **Two meshes**: a vertex has the index of its point. An edge has the index of the point at
    ///   which the edge of the triangle starts. A face has the index of its triangle.
    /// - **A mesh and another geometry**: a triangle is a polygon of three vertices.
    /// - **A patch**: a face, with the index of the patch.
    pub feature: Feature,
    /// The parameters u and v of the patch; zero for other geometries.
    pub parameters: [f64; 2],
}

impl WitnessLocation {
    /// Returns the location on a patch with parameters u and v, each in 0..=1.
    #[must_use]
    pub const fn on_patch(patch: u32, parameters: [f64; 2]) -> Self {
        Self {
            subshape: patch,
            feature: Feature::Face(FaceId(patch)),
            parameters,
        }
    }

    /// Returns a location on a subshape without parameters.
    #[inline]
    pub(crate) const fn new(subshape: u32, feature: Feature) -> Self {
        Self {
            subshape,
            feature,
            parameters: [0.0; 2],
        }
    }
}

/// The closest points of two geometries of any kind, with proven bounds.
///
/// A `PairOutcome` dereferences to its [`Outcome`] and adds the locations of the witnesses. The
/// distance is positive if the geometries are separated. If they overlap, the distance of two
/// convex geometries is minus the penetration depth. The distance of other overlapping geometries
/// is zero, with the lower bound minus infinity, unless one of them is a half-space;
/// [`PairTracker::penetration`](crate::PairTracker::penetration) bounds their depth.
///
/// [`Outcome::features`] are the features of the two locations. [`Outcome::solver`] and
/// [`Outcome::work`] describe queries of two convex geometries only.
/// [`PairTracker::work`](crate::PairTracker::work) counts the work for all others.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PairOutcome {
    /// State, bounds, witnesses and normal.
    pub outcome: Outcome,
    /// The locations of the witnesses on A and on B.
    pub locations: [WitnessLocation; 2],
    /// Whether the bounds are at most as far apart as requested; always true without a Bézier
    /// surface.
    ///
    /// Reasons for false: the query has used up its budget of splits; the budget is far too small
    /// (see [`surface`](crate::surface)); or the width is below `2^-42` times the pair size. The
    /// bounds hold in these cases too.
    pub is_converged: bool,
}

/// Returns the features of the locations on A and B.
pub(crate) fn features_on(on: &[WitnessLocation; 2]) -> FeaturePair {
    FeaturePair {
        a: on[0].feature,
        b: on[1].feature,
    }
}

impl PairOutcome {
    /// Returns the outcome of two convex geometries.
    #[inline]
    pub(crate) fn of_convex(outcome: Outcome) -> Self {
        let locations = [outcome.features.a, outcome.features.b].each(|feature| WitnessLocation::new(0, feature));
        Self {
            outcome,
            locations,
            is_converged: true,
        }
    }

    /// Returns an outcome of B and A as an outcome of A and B, at the pose of A and B.
    pub(crate) fn swapped(self, a_from_b: &RelativePose) -> Self {
        let o = self.outcome;
        Self {
            outcome: Outcome {
                features: o.features.swapped(),
                point_on_a: o.point_on_b,
                point_on_b: o.point_on_a,
                normal: Unit::new_unchecked(-(a_from_b.rotation() * *o.normal)),
                ..o
            },
            locations: [self.locations[1], self.locations[0]],
            ..self
        }
    }

    /// Returns the outcome with an overlap of unknown depth, for geometries whose depth is not
    /// searched.
    #[cfg(feature = "meshes")]
    pub(crate) fn without_depth(self) -> Self {
        Self {
            outcome: self.outcome.without_depth(),
            ..self
        }
    }

    /// Returns the indices of the closest subshapes.
    pub(crate) fn parts(&self) -> [u32; 2] {
        self.locations.each(|spot| spot.subshape)
    }
}

impl Deref for PairOutcome {
    type Target = Outcome;

    #[inline]
    fn deref(&self) -> &Outcome {
        &self.outcome
    }
}

impl From<&PairOutcome> for Distance {
    fn from(answer: &PairOutcome) -> Self {
        Self::from(&answer.outcome)
    }
}
