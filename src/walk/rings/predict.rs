//! Prediction of the closest features of a moving body.
//!
//! On face boundaries and fans of thousands of edges the closest features move by many vertices per
//! query, and in a steady motion by about as many as in the query before. A start at the predicted
//! features saves the Newton jump (see [`newton_jump`](super::newton_jump)).

use crate::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId};
use crate::walk::rings::curve::RingLocation;

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
        let moves = body.has_bands && before != now && body.has(before);
        moves.then(|| body.beyond(before, now)).flatten().unwrap_or(now)
    };
    FeaturePair {
        a: next(a, before.a, now.a),
        b: next(b, before.b, now.b),
    }
}

impl ConvexPolyhedron {
    /// Extrapolates the motion from `before` to `now` along a ring; `None` if the two features
    /// share none.
    fn beyond(&self, before: Feature, now: Feature) -> Option<Feature> {
        let (RingLocation::Curve(ring, from) | RingLocation::Rib(ring, from)) = self.near(before)?;
        let there = self.near(now)?;
        let (RingLocation::Curve(band, to) | RingLocation::Rib(band, to)) = there;
        let place = band.beyond(&ring, from, to)?;
        Some(match (there, now) {
            (RingLocation::Curve(..), Feature::Vertex(_)) => Feature::Vertex(VertexId(band.corner(place))),
            (RingLocation::Curve(..), _) => Feature::Edge(EdgeId(band.edge(place))),
            (RingLocation::Rib(..), Feature::Edge(_)) => Feature::Edge(EdgeId(band.rib(place)?)),
            (RingLocation::Rib(..), _) => Feature::Face(FaceId(band.strip(place))),
        })
    }
}
