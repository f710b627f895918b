//! Prediction of the closest features of a moving body.
//!
//! On face boundaries and fans of thousands of edges the closest features move by many vertices per
//! query, and in a steady motion by about as many as in the query before. A start at the predicted
//! features saves the Newton jump (see [`newton_jump`](super::newton_jump)).

use crate::body::polyhedron::{ConvexPolyhedron, Feature, FeaturePair};
use crate::convex::walk::rings::curve::RingLocation;

/// Extrapolates the motion from `before` to `now`, each feature along its ring. A feature that is
/// on no ring, or does not move, stays.
#[cold]
#[inline(never)]
pub(crate) fn predict(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    before: FeaturePair,
    now: FeaturePair,
) -> FeaturePair {
    let next = |body: &ConvexPolyhedron, before: Feature, now: Feature| {
        let moves = body.has_large_rings && before != now && body.has(before);
        moves
            .then(|| body.extrapolate_feature(before, now))
            .flatten()
            .unwrap_or(now)
    };
    FeaturePair {
        a: next(a, before.a, now.a),
        b: next(b, before.b, now.b),
    }
}

impl ConvexPolyhedron {
    /// Extrapolates the motion from `before` to `now` along a ring; `None` if the two features
    /// share none.
    fn extrapolate_feature(&self, before: Feature, now: Feature) -> Option<Feature> {
        let (RingLocation::Ring(old_ring, from) | RingLocation::Spokes(old_ring, from)) = self.ring_location(before)?;
        let location = self.ring_location(now)?;
        let (RingLocation::Ring(ring, to) | RingLocation::Spokes(ring, to)) = location;
        let index = ring.extrapolate(&old_ring, from, to)?;
        Some(match (location, now) {
            (RingLocation::Ring(..), Feature::Vertex(_)) => Feature::Vertex(ring.vertex(index)),
            (RingLocation::Ring(..), _) => Feature::Edge(ring.edge(index)),
            (RingLocation::Spokes(..), Feature::Edge(_)) => Feature::Edge(ring.spoke(index)?),
            (RingLocation::Spokes(..), _) => Feature::Face(ring.side_face(index)),
        })
    }
}
