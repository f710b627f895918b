//! Where the features of a moving body will be next.
//!
//! On rims and fans of thousands of edges the features of a step are many corners from where they were, and in a motion that goes on
//! evenly about as many as in the step before. To start there saves the leap (see [`leap`](super::leap)).

use crate::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId};
use crate::walk::rings::curve::RingLocation;

/// The pair as far beyond `now` as that is from `before`, each feature along its curve; the same feature where it is on none.
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
    /// As far along a curve beyond `now` as that is from `before`.
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
