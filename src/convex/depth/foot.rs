//! The deepest points of an overlap, from the features of the deepest facet.
//!
//! If faces lie flush, many pairs of points are equally deep, and the vertex that names the facet
//! may overhang the opposite face: then another feature pair has the witnesses ([`flush`]).

use crate::body::polyhedron::fans::LARGE;
use nalgebra::{Point3, Vector3};

use crate::base::num::extremes::Bounded;
use crate::base::num::scalar::Vec3;
use crate::base::tolerance::{AGREE_DEPTH, FOOT};
use crate::body::polyhedron::topology::Topology;
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, HalfEdgeId, VertexId};
use crate::pair::difference_facet::DifferenceFacet;
use crate::pair::face::{Face, FaceLocation};
use crate::pair::posed::PosedPair;

/// Faces of up to this many edges are tried edge by edge for the features of a depth, the product
/// of two such numbers in all. Not measured.
const SMALL: usize = 8;

/// A point of A and a point of B, in their stored frames.
pub(super) type WitnessPoints = (Point3<f64>, Point3<f64>);

/// Returns a point of A and a point of B that differ by `height` along the unit `normal`, A's
/// ahead; `None` if the features of the facet contain no such points.
pub(super) fn foot(
    posed: &PosedPair,
    facet: DifferenceFacet,
    (normal, height): &(Vec3<f64>, f64),
) -> Option<WitnessPoints> {
    let (ahead, close) = (Vector3::from(*normal) * *height, AGREE_DEPTH * posed.size());
    let (p, q) = match facet {
        DifferenceFacet::FaceVertex(f, v) => {
            let q = posed.b.points[v.index()];
            let p = posed.point_in_a(&q) + ahead;
            (is_on(posed.a, f, &p, close).then_some(p)?, q)
        }
        DifferenceFacet::VertexFace(v, f) if posed.same_scale() => {
            let p = posed.a.points[v.index()];
            let q = posed.point_in_b(&(p - ahead));
            (p, is_on(posed.b, f, &q, close).then_some(q)?)
        }
        DifferenceFacet::Edges(e, g) => crossing(posed, e, g, &ahead, close)?,
        DifferenceFacet::VertexFace(..) => return None,
    };
    Some((p.into(), q.into()))
}

/// Returns witnesses on two flush faces, the facet naming either face, and the features that
/// contain the witnesses: a vertex of a face over the opposite face or, if both faces are small,
/// two crossing edges.
#[cold]
pub(super) fn flush(
    posed: &PosedPair,
    facet: DifferenceFacet,
    best: &(Vec3<f64>, f64),
) -> Option<(DifferenceFacet, WitnessPoints)> {
    let n = Vector3::from(best.0);
    let (f, g) = match facet {
        DifferenceFacet::FaceVertex(f, v) => (f, face_towards(posed.b, v, &-posed.direction_in_b(&n))?),
        DifferenceFacet::VertexFace(v, g) => (face_towards(posed.a, v, &n)?, g),
        DifferenceFacet::Edges(..) => return None,
    };
    let with_witnesses = |facet| Some((facet, foot(posed, facet, best)?));
    let t = [&posed.a.topology, &posed.b.topology];
    let of_b = || sample_rim(posed.b, g).map(|h| DifferenceFacet::FaceVertex(f, t[1].from(h)));
    let of_a = || sample_rim(posed.a, f).map(|h| DifferenceFacet::VertexFace(t[0].from(h), g));
    if let Some(found) = of_b().chain(of_a()).find_map(with_witnesses) {
        return Some(found);
    }
    let is_small = |t: &Topology, face: FaceId| t.rim(face).nth(SMALL).is_none();
    if !(is_small(t[0], f) && is_small(t[1], g)) {
        return None;
    }
    let pairs = t[0].rim(f).flat_map(|h| t[1].rim(g).map(move |k| (h, k)));
    let edges = |(h, k)| DifferenceFacet::Edges(t[0].edge(h), t[1].edge(k));
    pairs.map(edges).find_map(with_witnesses)
}

/// Returns the face at a vertex whose normal is closest to `outward`; `None` if the body has no
/// faces.
fn face_towards(body: &ConvexPolyhedron, v: VertexId, outward: &Vector3<f64>) -> Option<FaceId> {
    let t = &body.topology;
    let mut best = (0.0, None);
    for h in t.fan(v).iter().take(LARGE) {
        let f = t.half_edge(h).face;
        let along = body.planes[f.index()].normal.dot(outward);
        if along > best.0 {
            best = (along, Some(f));
        }
    }
    best.1
}

/// Returns the half-edges of a face; of a large face, an evenly spaced sample.
pub(super) fn sample_rim(body: &ConvexPolyhedron, f: FaceId) -> impl Iterator<Item = HalfEdgeId> + '_ {
    let t = &body.topology;
    let ring = t.ring(f);
    let sampled = ring
        .into_iter()
        .flat_map(|r| r.iter().copied().step_by(r.len().div_ceil(LARGE)));
    let whole = if ring.is_none() { LARGE } else { 0 };
    t.rim(f).take(whole).chain(sampled)
}

/// Returns whether a point lies on a face, or at most `close` off the face.
fn is_on(body: &ConvexPolyhedron, f: FaceId, x: &Vector3<f64>, close: f64) -> bool {
    let (t, plane) = (&body.topology, &body.planes[f.index()]);
    let inside = |h: HalfEdgeId| {
        let (from, to) = (body.points[t.from(h).index()], body.points[t.half_edge(h).to.index()]);
        let u = to - from;
        plane.normal.cross(&u).dot(&(x - from)) >= -close * u.abs().sum()
    };
    // NaN is outside.
    if !((plane.normal.dot(x) - plane.offset).abs() <= close) {
        return false;
    }
    match t.ring(f) {
        None => t.rim(f).take(LARGE).all(inside),
        Some(ring) => {
            let face = Face {
                body,
                face: f,
                normal: &plane.normal,
            };
            !matches!(face.locate_large(ring, x, close / FOOT), FaceLocation::Outside(_))
        }
    }
}

/// Returns the points of two edges that differ by `ahead`.
fn crossing(
    posed: &PosedPair,
    e: EdgeId,
    g: EdgeId,
    ahead: &Vector3<f64>,
    close: f64,
) -> Option<(Vector3<f64>, Vector3<f64>)> {
    let ends = |body: &ConvexPolyhedron, e: EdgeId| {
        let (t, h) = (&body.topology, e.half_edge());
        (body.points[t.from(h).index()], body.points[t.half_edge(h).to.index()])
    };
    let ((p0, p1), (q0, q1)) = (ends(posed.a, e), ends(posed.b, g));
    let (u, v) = (p1 - p0, posed.vector_in_a(&(q1 - q0)));
    let gap = p0 - posed.point_in_a(&q0) - ahead;
    let c = u.cross(&v);
    let squared = c.norm_squared();
    // gap + s u - t v = 0, multiplied by v and by u.
    let s = (-gap.cross(&v).dot(&c) / squared).clamped(0.0, 1.0);
    let t = (-gap.cross(&u).dot(&c) / squared).clamped(0.0, 1.0);
    // For parallel edges s and t do not exist: NaN, or a residual.
    let rest = gap + u * s - v * t;
    (rest.norm_squared() <= close * close).then(|| (p0 + u * s, q0 + (q1 - q0) * t))
}
