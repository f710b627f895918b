//! From the closest features to those that bear the contact: the face, or else the edge, that is nearly at right angles to the normal.

use nalgebra::Vector3;

use crate::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature};
use crate::tolerance::STAY;

/// A body's outward direction of contact and how far off it a face may be.
pub(super) struct Promotion<'a> {
    pub(super) body: &'a ConvexPolyhedron,
    /// Unit, away from the body, in its own frame.
    pub(super) outward: Vector3<f64>,
    /// The sine of the largest angle.
    pub(super) sine: f64,
    /// What bore the contact before: it may be off by a quarter more.
    pub(super) kept: Option<Feature>,
}

impl Promotion<'_> {
    /// The face at `feature` most at right angles to the normal, if one is within the angle; else the edge; else the feature.
    ///
    /// Looks at the faces at the feature: two of an edge, all of the fan of a vertex.
    pub(super) fn of(&self, feature: Feature) -> Feature {
        let t = &self.body.topology;
        match feature {
            Feature::Face(f) => self.face([f.0]).unwrap_or(feature),
            Feature::Edge(e) => {
                let h = t.half_edge(e.0);
                self.face([h.face, t.half_edge(h.twin).face]).unwrap_or(feature)
            }
            Feature::Vertex(v) => {
                let fan = || t.fan(v.0);
                let faces = fan().map(|h| t.half_edge(h).face);
                self.face(faces).or_else(|| self.edge(fan())).unwrap_or(feature)
            }
        }
    }

    /// The squared sine a feature may be off by.
    fn most(&self, feature: Feature) -> f64 {
        let sine = if self.kept == Some(feature) {
            STAY * self.sine
        } else {
            self.sine
        };
        sine * sine
    }

    fn face(&self, faces: impl IntoIterator<Item = u32>) -> Option<Feature> {
        let mut best: Option<(f64, Feature)> = None;
        for f in faces {
            let n = &self.body.planes[f as usize].normal;
            let off = n.cross(&self.outward).norm_squared();
            let feature = Feature::Face(FaceId(f));
            // The null face of a segment has no normal.
            if n.dot(&self.outward) > 0.0 && off <= self.most(feature) && best.is_none_or(|(least, _)| off < least) {
                best = Some((off, feature));
            }
        }
        best.map(|(_, f)| f)
    }

    fn edge(&self, fan: impl Iterator<Item = u32>) -> Option<Feature> {
        let mut best: Option<(f64, Feature)> = None;
        for h in fan {
            let t = &self.body.topology;
            let u = self.body.points[t.half_edge(h).to as usize] - self.body.points[t.from(h) as usize];
            let rise = u.dot(&self.outward);
            let off = rise * rise / u.norm_squared();
            let feature = Feature::Edge(EdgeId(t.edge(h)));
            if off <= self.most(feature) && best.is_none_or(|(least, _)| off < least) {
                best = Some((off, feature));
            }
        }
        best.map(|(_, f)| f)
    }
}
