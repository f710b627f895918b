//! Facets of the Minkowski difference, with normals taken from the features of the two bodies.
//!
//! A triangle on the facet names the vertices; the face or the edges give a far more
//! accurate normal than three rounded points do.

use crate::base::num::extremes::Extremes;
use crate::base::num::packed::PackedVec3;
use crate::base::num::scalar::{Scalar, Vec3, cross, dot, neg, sqrt};
use crate::base::tolerance::{AGREE_DEPTH, NEARLY_PARALLEL};
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId};
use crate::pair::difference::MinkowskiPoint;
use crate::pair::difference::difference_point;
use crate::pair::difference_facet::DifferenceFacet;
use crate::pair::edge::EdgeSpan;
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;

use crate::convex::depth::descent::EdgeFacet;
use crate::convex::depth::direction::unit;
use crate::pair::difference::support;

impl DifferenceFacet {
    /// Returns the unit normal of the facet, and the support of A - B along the normal: for equal
    /// facets the same bits, whatever way led to the facet.
    pub(super) fn height(self, posed: &PosedPair, frame: &Transform<f64>) -> Option<(Vec3<f64>, f64)> {
        // The plane offset is rounded up: no vertex lies beyond the plane of a face.
        let (n, height) = match self {
            Self::FaceVertex(f, v) => {
                let plane = &posed.a.planes[f.index()];
                let along = -posed.direction_in_b(&plane.normal);
                let b = posed.b.support_certified(&along, v).vertex;
                let at = posed.point_in_a(&posed.b.points[b.index()]);
                (plane.normal, plane.offset - plane.normal.dot(&at))
            }
            Self::VertexFace(v, f) if posed.same_scale() => {
                let plane = &posed.b.planes[f.index()];
                let n = -posed.vector_in_a(&plane.normal);
                let a = posed.a.support_certified(&n, v).vertex;
                let at = posed.point_in_b(&posed.a.points[a.index()]);
                (n, plane.offset - plane.normal.dot(&at))
            }
            Self::Edges(e, g) => {
                let proven = height_of_edges(posed, e, g);
                return proven.or_else(|| self.height_by_support(posed, frame));
            }
            Self::VertexFace(..) => return self.height_by_support(posed, frame),
        };
        let n: Vec3<f64> = n.into();
        // A degenerate face has no normal.
        (dot(&n, &n) > 0.5).then_some((n, height))
    }

    fn height_by_support(self, posed: &PosedPair, frame: &Transform<f64>) -> Option<(Vec3<f64>, f64)> {
        let (a, b) = self.features().vertices_of(posed.a, posed.b);
        let on = difference_point(posed, frame, a, b);
        let n = self.normal(posed, frame, &on)?;
        Some((n, dot(&n, &support(posed, frame, &n, &on).w)))
    }

    /// Returns the unit normal of the facet; `on` is a point of the facet.
    pub(super) fn normal<T: Scalar>(
        self,
        posed: &PosedPair,
        frame: &Transform<T>,
        on: &MinkowskiPoint<T>,
    ) -> Option<Vec3<T>> {
        let n = match self {
            Self::FaceVertex(f, _) => unit(&face(posed.a, f)),
            Self::VertexFace(_, f) => unit(&neg(&frame.vector(&face(posed.b, f)))),
            Self::Edges(e, g) => {
                let n = unit(&cross(&edge(posed.a, e), &unit(&frame.vector(&edge(posed.b, g)))));
                if dot(&n, &on.w) > T::from(0.0) { n } else { neg(&n) }
            }
        };
        (dot(&n, &n).value() > 0.5).then_some(n)
    }
}

/// Returns normal and support of a facet spanned by two edges if the edges are extreme along the
/// normal: by the signs of a descent, else by the planes of the adjacent faces, the test of the
/// walk, with the edge of A ahead.
fn height_of_edges(posed: &PosedPair, e: EdgeId, g: EdgeId) -> Option<(Vec3<f64>, f64)> {
    if !posed.same_scale() {
        return None;
    }
    if let Some(proven) = EdgeFacet::new(posed, e, g).and_then(|facet| facet.support()) {
        return Some(proven);
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
    let is_between = on_a.0.smaller(on_a.1).smaller(on_b.0).smaller(on_b.1) >= 0.0;
    if !(is_between && squared > NEARLY_PARALLEL * u.norm_squared() * v.norm_squared()) {
        return None;
    }
    let n = n * (sign / sqrt(squared));
    let high_a = posed.a.edge_bound(PackedVec3::new(&n), a.left, a.right, on_a, 1.0);
    let n_in_b = -posed.rotation.transposed_times(PackedVec3::new(&n));
    let high_b = posed.b.edge_bound(n_in_b, b.left, b.right, on_b, 1.0);
    let height = high_a + high_b - posed.height_of_b_origin(&n);
    // On thin bodies the bound proven by the planes may lie far above the edges.
    (height - n.dot(&ahead) <= AGREE_DEPTH * 0.5 * posed.size()).then_some((n.into(), height))
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
