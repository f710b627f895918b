//! Facet normals of the Minkowski difference, taken from the features of the two bodies.
//!
//! A facet of A - B is a face of A with a vertex of B, a vertex of A with a face of B, or a pair of
//! edges. A triangle on the facet names the vertices; the face or the edges give a far more
//! accurate normal than three rounded points do.

use nalgebra::Vector3;

use crate::num::packed::PackedVec3;
use crate::num::scalar::{Scalar, Vec3, cross, dot, neg, sqrt};
use crate::pair::difference::MinkowskiPoint;
use crate::pair::difference::difference_point;
use crate::pair::edge::EdgeSpan;
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;
use crate::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId};
use crate::pose::Operand;
use crate::tolerance::{AGREE_DEPTH, NEARLY_PARALLEL};

use crate::depth::descent::EdgeFacet;
use crate::depth::direction::unit;
use crate::pair::difference::support;

/// Returns the facets that may contain three points of A - B, given by vertices of A and of B.
pub(super) fn facets(posed: &PosedPair, on_a: &[VertexId; 3], on_b: &[VertexId; 3]) -> [Option<FeaturePair>; 3] {
    let (fa, fb) = (posed.a.feature_of(on_a), posed.b.feature_of(on_b));
    let of_a = match fa {
        Feature::Face(f) => Some(FeaturePair::vertex_face(Operand::B, on_b[0], f)),
        _ => None,
    };
    let of_b = match fb {
        Feature::Face(f) => Some(FeaturePair::vertex_face(Operand::A, on_a[0], f)),
        _ => None,
    };
    let of_edges = match (fa, fb) {
        (Feature::Edge(e), Feature::Edge(f)) => Some(FeaturePair::edges(Operand::A, e, f)),
        _ => None,
    };
    [of_a, of_b, of_edges]
}

/// Returns the normal of the facet spanned by a feature pair, and the support of A - B along the
/// normal.
pub(super) fn height_of(posed: &PosedPair, frame: &Transform<f64>, facet: FeaturePair) -> Option<(Vec3<f64>, f64)> {
    // The plane offset is rounded up: no vertex lies beyond the plane of a face.
    let (n, height) = match (facet.a, facet.b) {
        (Feature::Face(f), Feature::Vertex(v)) => {
            let plane = &posed.a.planes[f.index()];
            let b = posed
                .b
                .support_certified(&-posed.direction_in_b(&plane.normal), v)
                .vertex;
            let at = posed.point_in_a(&posed.b.points[b.index()]);
            (plane.normal, plane.offset - plane.normal.dot(&at))
        }
        (Feature::Vertex(v), Feature::Face(f)) if posed.same_scale() => {
            let plane = &posed.b.planes[f.index()];
            let n = -posed.vector_in_a(&plane.normal);
            let a = posed.a.support_certified(&n, v).vertex;
            let at = posed.point_in_b(&posed.a.points[a.index()]);
            (n, plane.offset - plane.normal.dot(&at))
        }
        _ => {
            if let Some((n, height)) = height_of_edges(posed, facet) {
                return Some((n.into(), height));
            }
            let (a, b) = facet.vertices_of(posed.a, posed.b);
            let on = difference_point(posed, frame, a, b);
            let n = normal_of(posed, frame, facet, &on)?;
            return Some((n, dot(&n, &support(posed, frame, &n, &on).w)));
        }
    };
    let n: Vec3<f64> = n.into();
    // A degenerate face has no normal.
    (dot(&n, &n) > 0.5).then_some((n, height))
}

/// Returns normal and support of a facet spanned by two edges if the planes of the adjacent faces
/// prove the support: the test of the walk, with the edge of A ahead.
fn height_of_edges(posed: &PosedPair, facet: FeaturePair) -> Option<(Vector3<f64>, f64)> {
    let (Feature::Edge(e), Feature::Edge(g), true) = (facet.a, facet.b, posed.same_scale()) else {
        return None;
    };
    if let Some(proven) = EdgeFacet::new(posed, e, g).and_then(|facet| facet.support()) {
        return Some((proven.0.into(), proven.1));
    }
    let (a, b) = (EdgeSpan::new(posed.a, e), EdgeSpan::new(posed.b, g));
    let u = a.q - a.p;
    let (v, at_b) = (posed.vector_in_a(&(b.q - b.p)), posed.point_in_a(&b.p));
    let n = u.cross(&v);
    let (squared, ahead) = (n.norm_squared(), a.p - at_b);
    let sign = if n.dot(&ahead) < 0.0 { -1.0 } else { 1.0 };
    let (on_a, on_b) = (
        a.weights(PackedVec3::new(&v), sign),
        b.weights(posed.rotation.transposed_times(PackedVec3::new(&u)), sign),
    );
    // NaN proves nothing.
    let is_between = on_a.0.min(on_a.1).min(on_b.0).min(on_b.1) >= 0.0;
    if !(is_between && squared > NEARLY_PARALLEL * u.norm_squared() * v.norm_squared()) {
        return None;
    }
    let n = n * (sign / sqrt(squared));
    let high_a = posed.a.edge_bound(PackedVec3::new(&n), a.left, a.right, on_a, 1.0);
    let n_in_b = -posed.rotation.transposed_times(PackedVec3::new(&n));
    let high_b = posed.b.edge_bound(n_in_b, b.left, b.right, on_b, 1.0);
    let height = high_a + high_b - posed.height_of_b_origin(&n);
    // On thin bodies the bound proven by the planes may lie far above the edges.
    (height - n.dot(&ahead) <= AGREE_DEPTH * 0.5 * posed.size()).then_some((n, height))
}

/// Returns the normal of the facet spanned by a feature pair; `on` is a point of the facet.
pub(super) fn normal_of<T: Scalar>(
    posed: &PosedPair,
    frame: &Transform<T>,
    facet: FeaturePair,
    on: &MinkowskiPoint<T>,
) -> Option<Vec3<T>> {
    let n = match (facet.a, facet.b) {
        (Feature::Face(f), _) => unit(&face(posed.a, f)),
        (_, Feature::Face(f)) => unit(&neg(&frame.vector(&face(posed.b, f)))),
        (Feature::Edge(e), Feature::Edge(f)) => {
            let n = unit(&cross(&edge(posed.a, e), &unit(&frame.vector(&edge(posed.b, f)))));
            if dot(&n, &on.w) > T::from(0.0) { n } else { neg(&n) }
        }
        _ => return None,
    };
    (dot(&n, &n).value() > 0.5).then_some(n)
}

/// Returns the stored normal of a face.
fn face<T: Scalar>(body: &ConvexPolyhedron, f: FaceId) -> Vec3<T> {
    let n = body.planes[f.index()].normal;
    [T::from(n.x), T::from(n.y), T::from(n.z)]
}

/// Returns the unit direction of an edge.
pub(super) fn edge<T: Scalar>(body: &ConvexPolyhedron, e: EdgeId) -> Vec3<T> {
    let (t, h) = (&body.topology, e.half_edge());
    let (from, to) = (body.points[t.from(h).index()], body.points[t.half_edge(h).to.index()]);
    unit(&[0, 1, 2].map(|k| T::from(to[k]) - T::from(from[k])))
}
