//! Promotion of the closest features to the features that bear the contact: the face, or else the
//! edge, most nearly perpendicular to the normal.

use crate::body::polyhedron::fans::MANY;
use nalgebra::Vector3;

use crate::base::tolerance::{STAY, STEEP};
use crate::body::polyhedron::fans::{Cycle, Fan};
use crate::body::polyhedron::{ConvexPolyhedron, FaceId, Feature, HalfEdgeId};

/// A body's outward contact direction, and the largest angle of a face or edge from it.
pub(super) struct Promotion<'a> {
    pub(super) body: &'a ConvexPolyhedron,
    /// Unit direction away from the body, in the body's own frame.
    pub(super) outward: Vector3<f64>,
    /// Sine of the largest angle.
    pub(super) sine: f64,
    /// Feature that bore the contact before: it may be a quarter further off.
    pub(super) previous: Option<Feature>,
}

impl Promotion<'_> {
    /// Returns the face at `feature` most nearly perpendicular to the normal if any is within the
    /// angle; else the edge; else `feature`.
    ///
    /// Tests the faces at the feature: the two faces of an edge, or the faces of a vertex's whole
    /// fan; in a large fan only the neighbourhood of the outermost face, found by bisection.
    pub(super) fn promote(&self, feature: Feature) -> Feature {
        let t = &self.body.topology;
        match feature {
            Feature::Face(f) => self.face([f]).unwrap_or(feature),
            Feature::Edge(e) => {
                let h = t.half_edge(e.half_edge());
                self.face([h.face, t.half_edge(h.twin).face]).unwrap_or(feature)
            }
            Feature::Vertex(v) => {
                let face = |h: HalfEdgeId| t.half_edge(h).face;
                let outward = |h: HalfEdgeId| self.body.planes[face(h).index()].normal.dot(&self.outward);
                let faces = self.sample_fan(t.fan(v), outward).map(face);
                let edges = || self.sample_fan(t.fan(v), |h| -self.rise(h));
                self.face(faces).or_else(|| self.edge(edges())).unwrap_or(feature)
            }
        }
    }

    /// Returns the half-edges of a fan; of a large fan, the half-edge of greatest measure and its
    /// two neighbours.
    fn sample_fan<M: Fn(HalfEdgeId) -> f64>(&self, fan: Fan, measure: M) -> impl Iterator<Item = HalfEdgeId> + use<M> {
        let m = fan.len();
        let (first, count) = if m <= MANY {
            (0, m)
        } else {
            (fan.top_index(measure) + m - 1, 3)
        };
        (first..first + count).map(move |k| fan.wrapped(k))
    }

    /// Returns the squared sine of the angle between an edge and the plane perpendicular to the
    /// outward direction.
    fn rise(&self, h: HalfEdgeId) -> f64 {
        let t = &self.body.topology;
        let u = self.body.points[t.half_edge(h).to.index()] - self.body.points[t.from(h).index()];
        let rise = u.dot(&self.outward);
        rise * rise / u.norm_squared()
    }

    /// Returns the largest squared sine accepted for a feature.
    fn max_squared_sine(&self, feature: Feature) -> f64 {
        let sine = if self.previous == Some(feature) {
            STAY * self.sine
        } else {
            self.sine
        };
        sine * sine
    }

    fn face(&self, faces: impl IntoIterator<Item = FaceId>) -> Option<Feature> {
        let mut best: Option<(f64, Feature)> = None;
        for f in faces {
            let n = &self.body.planes[f.index()].normal;
            let off = n.cross(&self.outward).norm_squared();
            let feature = Feature::Face(f);
            // The null face of a segment has no normal.
            if n.dot(&self.outward) > STEEP
                && off <= self.max_squared_sine(feature)
                && best.is_none_or(|(least, _)| off < least)
            {
                best = Some((off, feature));
            }
        }
        best.map(|(_, f)| f)
    }

    fn edge(&self, fan: impl Iterator<Item = HalfEdgeId>) -> Option<Feature> {
        let mut best: Option<(f64, Feature)> = None;
        for h in fan {
            let off = self.rise(h);
            let feature = Feature::Edge(self.body.topology.edge(h));
            if off <= self.max_squared_sine(feature) && best.is_none_or(|(least, _)| off < least) {
                best = Some((off, feature));
            }
        }
        best.map(|(_, f)| f)
    }
}
