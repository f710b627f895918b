//! The deepest points of an overlap, from the features of its deepest facet.

use nalgebra::{Point3, Vector3};

use crate::closest::placed::Placed;
use crate::polyhedron::{ConvexPolyhedron, Feature, FeaturePair};
use crate::scalar::Vec3;
use crate::tolerance::AGREE_DEPTH;

/// Rims longer than this are left to the surface.
const LARGE: usize = 24;

/// A point of A and one of B, in their stored frames.
pub(super) type Witnesses = (Point3<f64>, Point3<f64>);

/// The points that are `height` apart along the unit `normal`, A's ahead: where the
/// features of a facet at that height hold such points.
pub(super) fn foot(placed: &Placed, facet: FeaturePair, (normal, height): &(Vec3<f64>, f64)) -> Option<Witnesses> {
    let (ahead, close) = (Vector3::from(*normal) * *height, AGREE_DEPTH * placed.size());
    let (p, q) = match (facet.a, facet.b) {
        (Feature::Face(f), Feature::Vertex(v)) => {
            let q = placed.b.points[v.index()];
            let p = placed.point_in_a(&q) + ahead;
            (is_on(placed.a, f.0, &p, close).then_some(p)?, q)
        }
        (Feature::Vertex(v), Feature::Face(f)) if placed.has_one_unit() => {
            let p = placed.a.points[v.index()];
            let q = placed.point_in_b(&(p - ahead));
            (p, is_on(placed.b, f.0, &q, close).then_some(q)?)
        }
        (Feature::Edge(e), Feature::Edge(g)) => crossing(placed, e.0, g.0, &ahead, close)?,
        _ => return None,
    };
    Some((p.into(), q.into()))
}

/// Whether a point is on a face, or off it by no more than rounding.
fn is_on(body: &ConvexPolyhedron, f: u32, x: &Vector3<f64>, close: f64) -> bool {
    let (t, plane) = (&body.topology, &body.planes[f as usize]);
    let inside = |h: u32| {
        let (from, to) = (body.points[t.from(h) as usize], body.points[t.half_edge(h).to as usize]);
        let u = to - from;
        plane.normal.cross(&u).dot(&(x - from)) >= -close * u.abs().sum()
    };
    // Written so that NaN is outside.
    (plane.normal.dot(x) - plane.offset).abs() <= close && t.ring(f).is_none() && t.rim(f).take(LARGE).all(inside)
}

/// The points of two edges that differ by `ahead`.
fn crossing(placed: &Placed, e: u32, g: u32, ahead: &Vector3<f64>, close: f64) -> Option<(Vector3<f64>, Vector3<f64>)> {
    let ends = |body: &ConvexPolyhedron, h: u32| {
        let t = &body.topology;
        (body.points[t.from(h) as usize], body.points[t.half_edge(h).to as usize])
    };
    let ((p0, p1), (q0, q1)) = (ends(placed.a, e), ends(placed.b, g));
    let (u, v) = (p1 - p0, placed.vector_in_a(&(q1 - q0)));
    let gap = p0 - placed.point_in_a(&q0) - ahead;
    let c = u.cross(&v);
    let squared = c.norm_squared();
    // gap + s u - t v = 0, multiplied by v and by u.
    let s = (-gap.cross(&v).dot(&c) / squared).clamp(0.0, 1.0);
    let t = (-gap.cross(&u).dot(&c) / squared).clamp(0.0, 1.0);
    // Parallel edges have no such numbers: NaN, or a rest.
    let rest = gap + u * s - v * t;
    (rest.norm_squared() <= close * close).then(|| (p0 + u * s, q0 + (q1 - q0) * t))
}
