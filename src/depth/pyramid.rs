//! A proof of the depth by one facet: the pyramid of the facet and a point deep in P = A - B holds
//! the ball.
//!
//! ```text
//!        n  ^
//!    F -----+---------     facet of P, at height r above the origin
//!     \     | r     '      o  origin
//!      \    o     '        c  a point deep in P: the difference of two points inside the bodies
//!       \       '          The sides of the pyramid join the edges of F to c.
//!        \    '
//!          c
//! ```
//!
//! The pyramid lies in P. If the origin lies in the pyramid, and every side is at least as far from
//! the origin as F, then P contains the ball of radius `r` about the origin, and the depth is `r`:
//! F lies in a supporting plane. Shallow overlaps are proven like this; of all others nothing is
//! said.
//!
//! The sides are judged as the triangles of a surface are
//! ([`verify_surface`](super::verify_surface)).

use nalgebra::Vector3;

use crate::depth::foot::sample_rim;
use crate::depth::result::Best;
use crate::depth::verify_surface::Target;
use crate::num::scalar::{Vec3, neg};
use crate::pair::posed::PosedPair;
use crate::polyhedron::{ConvexPolyhedron, Feature, FeaturePair};
use crate::tolerance::AGREE_DEPTH;

/// Returns whether the pyramid over a facet proves the height of the facet to be the depth.
pub(super) fn proves(posed: &PosedPair, facet: FeaturePair, best: &Best<f64>) -> bool {
    let target = Target::new(best, posed.size());
    if !target.is_deep() {
        return false;
    }
    // The means of the vertices lie in the bodies, and off the surface of solid bodies.
    let apex = posed.a.vertex_mean - posed.point_in_a(&posed.b.vertex_mean);
    let sides = Sides {
        target,
        apex: apex.into(),
    };
    match (facet.a, facet.b) {
        (Feature::Face(f), Feature::Vertex(v)) => {
            let q = posed.point_in_a(&posed.b.points[v.index()]);
            is_flat(posed.a, f.0, posed.size()) && sides.are_far(rim(posed.a, f.0).map(|p| p - q))
        }
        (Feature::Vertex(v), Feature::Face(f)) => {
            let p = posed.a.points[v.index()];
            // The reflection of a face turns the other way.
            let sides = sides.reflected();
            is_flat(posed.b, f.0, posed.size()) && sides.are_far(rim(posed.b, f.0).map(|q| posed.point_in_a(&q) - p))
        }
        (Feature::Edge(e), Feature::Edge(g)) => {
            let ends = |body: &ConvexPolyhedron, h: u32| {
                let t = &body.topology;
                [t.from(h), t.half_edge(h).to].map(|v| body.points[v as usize])
            };
            let ([p, q], [x, y]) = (ends(posed.a, e.0), ends(posed.b, g.0).map(|q| posed.point_in_a(&q)));
            let n = Vector3::from(best.normal);
            let corners = [p - x, q - x, q - y, p - y];
            let is_left = n.dot(&(q - p).cross(&(x - y))) > 0.0;
            let low = corners.iter().fold(f64::INFINITY, |low, w| low.min(n.dot(w)));
            let order = |k: usize| corners[if is_left { k } else { 3 - k }];
            low >= best.height - 0.5 * AGREE_DEPTH * posed.size() && sides.are_far((0..4).map(order))
        }
        _ => false,
    }
}

/// The sides of a pyramid.
struct Sides {
    target: Target,
    apex: Vec3<f64>,
}

impl Sides {
    /// Returns the sides of the pyramid reflected in the origin.
    fn reflected(self) -> Self {
        Self {
            target: self.target.reflected(),
            apex: neg(&self.apex),
        }
    }

    /// Returns whether all sides over a polygon, counter-clockwise seen from outside, are beyond
    /// the target.
    fn are_far(&self, mut corners: impl Iterator<Item = Vector3<f64>>) -> bool {
        let Some(first) = corners.next() else { return false };
        let mut from = first;
        let mut is_far = |to: Vector3<f64>| {
            let side = [to.into(), from.into(), self.apex];
            from = to;
            self.target.judge(&side) == Some(true)
        };
        corners.all(&mut is_far) && is_far(first)
    }
}

/// Returns the corners of a face; of a large face, of a sample.
fn rim(body: &ConvexPolyhedron, f: u32) -> impl Iterator<Item = Vector3<f64>> + '_ {
    sample_rim(body, f).map(|h| body.points[body.topology.from(h) as usize])
}

/// Returns whether the corners of a face lie in the plane of the face, up to the rounding that the
/// depth leaves.
fn is_flat(body: &ConvexPolyhedron, f: u32, size: f64) -> bool {
    let plane = &body.planes[f as usize];
    rim(body, f).all(|p| plane.normal.dot(&p) >= plane.offset - 0.25 * AGREE_DEPTH * size)
}
