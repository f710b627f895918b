//! The normals that the bodies themselves offer for a triangle of the Minkowski difference.
//!
//! A facet of A - B is a face of A beside a vertex of B, a vertex of A beside a face of B, or two edges. A triangle on it
//! names the vertices; the face or the edges know its normal far better than three rounded points do.

use nalgebra::Vector3;

use crate::num::packed::Lanes;
use crate::num::scalar::{Scalar, Vec3, cross, dot, neg, sqrt};
use crate::pair::difference::Corner;
use crate::pair::difference::corner;
use crate::pair::edge::Edge;
use crate::pair::posed::Placed;
use crate::pair::transform::Frame;
use crate::polyhedron::{ConvexPolyhedron, Feature, FeaturePair};
use crate::pose::Which;
use crate::tolerance::{AGREE_DEPTH, NEARLY_PARALLEL};

use crate::depth::direction::unit;
use crate::depth::search::highest;

/// The facets that may hold three points, by the vertices of A and of B they are made of.
pub(super) fn facets(placed: &Placed, on_a: &[u32; 3], on_b: &[u32; 3]) -> [Option<FeaturePair>; 3] {
    let (fa, fb) = (placed.a.feature_of(on_a), placed.b.feature_of(on_b));
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
    [of_a, of_b, of_edges]
}

/// The normal of the facet of a pair of features, and how high the difference is along it.
pub(super) fn height_of(placed: &Placed, frame: &Frame<f64>, facet: FeaturePair) -> Option<(Vec3<f64>, f64)> {
    // No vertex is beyond the plane of a face: the offset is rounded up.
    let (n, height) = match (facet.a, facet.b) {
        (Feature::Face(f), Feature::Vertex(v)) => {
            let plane = &placed.a.planes[f.index()];
            let b = placed.b.extreme(&-placed.direction_in_b(&plane.normal), v.0).vertex;
            let at = placed.point_in_a(&placed.b.points[b as usize]);
            (plane.normal, plane.offset - plane.normal.dot(&at))
        }
        (Feature::Vertex(v), Feature::Face(f)) if placed.has_one_unit() => {
            let plane = &placed.b.planes[f.index()];
            let n = -placed.vector_in_a(&plane.normal);
            let a = placed.a.extreme(&n, v.0);
            (n, a.value + (plane.offset - placed.lift(&n)))
        }
        _ => {
            if let Some((n, height)) = height_of_edges(placed, facet) {
                return Some((n.into(), height));
            }
            let (a, b) = facet.vertices_of(placed.a, placed.b);
            let on = corner(placed, frame, a, b);
            let n = normal_of(placed, frame, facet, &on)?;
            return Some((n, dot(&n, &highest(placed, frame, &n, &on).w)));
        }
    };
    let n: Vec3<f64> = n.into();
    // A null face has no normal.
    (dot(&n, &n) > 0.5).then_some((n, height))
}

/// The same of two edges, where the planes of their faces prove it: as in the walk, but for the edge of A lying ahead.
fn height_of_edges(placed: &Placed, facet: FeaturePair) -> Option<(Vector3<f64>, f64)> {
    let (Feature::Edge(e), Feature::Edge(g), true) = (facet.a, facet.b, placed.has_one_unit()) else {
        return None;
    };
    let (a, b) = (Edge::new(placed.a, e.0), Edge::new(placed.b, g.0));
    let u = a.q - a.p;
    let (v, at_b) = (placed.vector_in_a(&(b.q - b.p)), placed.point_in_a(&b.p));
    let n = u.cross(&v);
    let (squared, ahead) = (n.norm_squared(), a.p - at_b);
    let sign = if n.dot(&ahead) < 0.0 { -1.0 } else { 1.0 };
    let (on_a, on_b) = (
        a.weights(Lanes::new(&v), sign),
        b.weights(placed.rotation.transposed_times(Lanes::new(&u)), sign),
    );
    // Written so that NaN proves nothing.
    let is_between = on_a.0.min(on_a.1).min(on_b.0).min(on_b.1) >= 0.0;
    if !(is_between && squared > NEARLY_PARALLEL * u.norm_squared() * v.norm_squared()) {
        return None;
    }
    let n = n * (sign / sqrt(squared));
    let high_a = placed.a.edge_bound(Lanes::new(&n), a.left, a.right, on_a, 1.0);
    let n_in_b = -placed.rotation.transposed_times(Lanes::new(&n));
    let high_b = placed.b.edge_bound(n_in_b, b.left, b.right, on_b, 1.0);
    let height = high_a + high_b - placed.lift(&n);
    // What the planes of thin bodies prove may be far above the edges.
    (height - n.dot(&ahead) <= AGREE_DEPTH * 0.5 * placed.size()).then_some((n, height))
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
pub(super) fn edge<T: Scalar>(body: &ConvexPolyhedron, h: u32) -> Vec3<T> {
    let t = &body.topology;
    let (from, to) = (body.points[t.from(h) as usize], body.points[t.half_edge(h).to as usize]);
    unit(&[0, 1, 2].map(|k| T::from(to[k]) - T::from(from[k])))
}
