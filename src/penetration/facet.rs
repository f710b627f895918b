//! The normals that the bodies themselves offer for a triangle of the Minkowski difference.
//!
//! A facet of A - B is a face of A beside a vertex of B, a vertex of A beside a face of B, or two edges. A triangle on it
//! names the vertices; the face or the edges know its normal far better than three rounded points do.

use crate::closest::placed::{Frame, Placed};
use crate::closest::simplex::Corner;
use crate::polyhedron::{ConvexPolyhedron, Feature, FeaturePair};
use crate::pose::Which;
use crate::scalar::{Scalar, Vec3, cross, dot, neg};

use super::surface::unit;

/// A unit normal and the features it comes from.
pub(super) type Normal<T> = (Vec3<T>, FeaturePair);

/// The normals of the facets that hold the corners, out of the difference.
pub(super) fn normals<T: Scalar>(
    placed: &Placed,
    frame: &Frame<T>,
    corners: &[Corner<T>; 3],
) -> [Option<Normal<T>>; 3] {
    let (on_a, on_b) = (corners.map(|c| c.a), corners.map(|c| c.b));
    let (fa, fb) = (placed.a.feature_of(&on_a), placed.b.feature_of(&on_b));
    let of_a = match fa {
        Feature::Face(f) => Some(FeaturePair::vertex_face(Which::B, on_b[0], f.0)),
        _ => None,
    };
    let of_b = match fb {
        Feature::Face(f) => Some(FeaturePair::vertex_face(Which::A, on_a[0], f.0)),
        _ => None,
    };
    let of_edges = match (fa, fb) {
        (Feature::Edge(e), Feature::Edge(f)) => Some(FeaturePair::edges(Which::A, e.0, f.0)),
        _ => None,
    };
    [of_a, of_b, of_edges].map(|facet| facet.and_then(|f| Some((normal_of(placed, frame, f, &corners[0])?, f))))
}

/// The normal of a facet that is known by its features, `on` a point of it.
pub(super) fn normal_of<T: Scalar>(
    placed: &Placed,
    frame: &Frame<T>,
    facet: FeaturePair,
    on: &Corner<T>,
) -> Option<Vec3<T>> {
    let n = match (facet.a, facet.b) {
        (Feature::Face(f), _) => unit(&face(placed.a, f.0)),
        (_, Feature::Face(f)) => unit(&neg(&frame.vector(&face(placed.b, f.0)))),
        (Feature::Edge(e), Feature::Edge(f)) => {
            let n = unit(&cross(&edge(placed.a, e.0), &unit(&frame.vector(&edge(placed.b, f.0)))));
            if dot(&n, &on.w) > T::from(0.0) { n } else { neg(&n) }
        }
        _ => return None,
    };
    (dot(&n, &n).value() > 0.5).then_some(n)
}

/// The stored normal of a face.
fn face<T: Scalar>(body: &ConvexPolyhedron, f: u32) -> Vec3<T> {
    let n = body.planes[f as usize].normal;
    [T::from(n.x), T::from(n.y), T::from(n.z)]
}

/// The unit direction of an edge.
fn edge<T: Scalar>(body: &ConvexPolyhedron, h: u32) -> Vec3<T> {
    let t = &body.topology;
    let (from, to) = (body.points[t.from(h) as usize], body.points[t.half_edge(h).to as usize]);
    unit(&[0, 1, 2].map(|k| T::from(to[k]) - T::from(from[k])))
}
