//! The answer of a query of two geometries of any kinds.

use core::ops::Deref;

use nalgebra::Unit;

use super::outcome::{Distance, Outcome};
use crate::base::num::each::Each;
use crate::base::pose::RelativePose;
use crate::body::polyhedron::{FaceId, Feature, FeaturePair};

/// The place of a witness on a geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WitnessLocation {
    /// The piece of a compound, the triangle of a mesh or the patch of a surface, by the caller's
    /// index; zero for a convex geometry. Beside a mesh a compound of polyhedra is the mesh of its
    /// surface ([`Compound::to_mesh`](crate::Compound::to_mesh)).
    pub subshape: u32,
    /// The feature that holds the witness: of a polyhedron, of the core of a convex shape, or of
    /// the piece. Of two meshes, a vertex has the number of its point, an edge that of the point at
    /// which the edge of the triangle begins, a face that of its triangle; beside another geometry
    /// a triangle is a polygon of three vertices. A patch is a face, with the number of the patch.
    pub feature: Feature,
    /// The parameters u and v of the patch; zero for other geometries.
    pub parameters: [f64; 2],
}

impl WitnessLocation {
    /// Returns a point of a patch by its parameters u and v, each between 0 and 1.
    #[must_use]
    pub const fn on_patch(patch: u32, parameters: [f64; 2]) -> Self {
        Self {
            subshape: patch,
            feature: Feature::Face(FaceId(patch)),
            parameters,
        }
    }

    /// Returns a place on a part without parameters.
    #[inline]
    pub(crate) const fn new(subshape: u32, feature: Feature) -> Self {
        Self {
            subshape,
            feature,
            parameters: [0.0; 2],
        }
    }
}

/// The closest points of two geometries of any kinds, with proof: an [`Outcome`], to which the
/// answer dereferences, and the places of the witnesses.
///
/// The distance is that of the geometries as sets of points: positive if they are apart, negative
/// by the penetration depth if two convex geometries overlap, zero if other geometries do. The
/// depth of those is bounded by [`PairTracker::penetration`](crate::PairTracker::penetration); here
/// the lower bound of their overlap is minus infinity.
///
/// [`Outcome::features`] are those of the two spots. [`Outcome::solver`] and [`Outcome::work`] tell
/// of two convex geometries; the work for others is counted by
/// [`PairTracker::work`](crate::PairTracker::work).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PairOutcome {
    /// Class, bounds, witnesses and normal.
    pub outcome: Outcome,
    /// The places of the witnesses on A and on B.
    pub locations: [WitnessLocation; 2],
    /// Whether the bounds are no farther apart than was asked for: always true unless a geometry is
    /// a Bézier surface. If false, the budget of splits was used up or is too small by far (see
    /// [`patch`](crate::surface)), or the width is below `2^-42` times the size of the pair; the
    /// bounds hold all the same.
    pub is_converged: bool,
}

/// Returns the features of the places on A and B.
pub(crate) fn features_on(on: &[WitnessLocation; 2]) -> FeaturePair {
    FeaturePair {
        a: on[0].feature,
        b: on[1].feature,
    }
}

impl PairOutcome {
    /// Returns the answer of two geometries of one part each.
    #[inline]
    pub(crate) fn of_convex(outcome: Outcome) -> Self {
        let locations = [outcome.features.a, outcome.features.b].each(|feature| WitnessLocation::new(0, feature));
        Self {
            outcome,
            locations,
            is_converged: true,
        }
    }

    /// Returns the answer of B and A as that of A and B, at the pose of A and B.
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

    /// Returns the answer with an overlap of unknown depth: of geometries whose depth is not
    /// searched.
    #[cfg(feature = "meshes")]
    pub(crate) fn without_depth(self) -> Self {
        Self {
            outcome: self.outcome.without_depth(),
            ..self
        }
    }

    /// Returns the numbers of the closest parts.
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
