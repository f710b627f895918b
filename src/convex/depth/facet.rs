//! Facets of the Minkowski difference: their heights, and a proof of the depth by the deepest
//! facet.
//!
//! Normals come from the features of the two bodies. A triangle on the facet identifies the
//! vertices; the face or the edges give a far more accurate normal than three rounded points.
//!
//! # A proof of the depth without growing
//!
//! The deepest facet proves the depth even if some triangles are slightly too low ([`holds_disc`]).
//!
//! A polytope that is close to the boundary at one pose lies a little below the boundary at the
//! next; if faces are flush, any motion has this effect. Let the origin lie behind every triangle,
//! let `r` be the height of a facet F of the difference P along the normal `n`, and call the
//! triangles not beyond `r` *below target*. Then P contains the ball of radius `r` around the
//! origin if F contains a disc around the foot `r n`, of the radius `rho` given below.
//!
//! ```text
//!             n
//!             ^
//!   F ========+===x====   facet at height r, contains the disc of radius rho about r n
//!             |  /
//!      .______|_y____     triangle below target: at height p along m, p < r
//!             |/      '
//!             o           origin
//! ```
//!
//! Proof. Let `x` be a point of the ball outside P. The segment from the origin to `x` leaves the
//! surface at a point `y` of a triangle below target, since `y` is nearer than `r`. For a unit
//! vector `m` along which the triangle is at least `p` high, `y = a m + v` with `v` perpendicular
//! to `m`, `p <= a <= r` and `|v|^2 <= r^2 - p^2`. So the distance of `y` from the axis along `n`
//! is at most `r |m x n| + sqrt(r^2 - p^2)`, and the distance of `x` at most `r / p` times as much;
//! `rho` is the largest such number. If `m` is within sixty degrees of `n` and `rho` is below half
//! of every triangle's height, then `y`, and so `x`, has positive height along `n`:
//! `n . y >= p / 2 - |v| sin 60`, and `|v| <= rho`. P contains the projection of `x` along `n` into
//! F, whose disc has the radius `rho`, and the projection of `x` along `n` down to height zero,
//! nearer to the origin than any triangle; hence P contains `x`, between the two.

use nalgebra::Vector3;

use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::packed::PackedVec3;
use crate::base::num::scalar::{Scalar, Vec3, cross, dot, neg, sqrt, sub};
use crate::base::tolerance::{AGREE_DEPTH, CERTIFICATE, DISC, DISC_MOST, NEARLY_PARALLEL, UNIT};
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, HalfEdgeId};
use crate::convex::depth::descent::{EdgeFacet, WitnessPoints, sample_rim};
use crate::convex::depth::polytope::{min_height, unit};
use crate::convex::depth::search::Best;
use crate::pair::difference::DifferenceFacet;
use crate::pair::difference::{MinkowskiPoint, difference_point, support};
use crate::pair::posed::PosedPair;
use crate::pair::star::EdgeSpan;
use crate::pair::transform::Transform;

impl DifferenceFacet {
    /// Returns the unit normal of the facet, and the support value of A - B along the normal. Equal
    /// facets give the same bits, for any path to the facet.
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

/// Returns normal and support value of a facet spanned by two edges, if both edges are extreme
/// along the normal.
///
/// The signs of a descent prove this, or otherwise the planes of the adjacent faces, as in the
/// walk. The edge of A is ahead along the normal.
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
    let is_between = on_a[0].smaller(on_a[1]).smaller(on_b[0]).smaller(on_b[1]) >= 0.0;
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
    unit(&[0, 1, 2].each(|k| T::from(to[k]) - T::from(from[k])))
}

/// Largest number of exchanges of a vertex on the path to the facet over the axis.
const MAX_EXCHANGES: usize = 48;

/// Returns three points of the facet pierced by `axis`, starting from a pierced triangle
/// (counter-clockwise seen from outside); `None` if `axis` misses the triangle. Points in `known`
/// spare support queries on the bodies.
pub(super) fn pierced_facet(
    posed: &PosedPair,
    frame: &Transform<f64>,
    axis: &Vec3<f64>,
    known: impl Iterator<Item = MinkowskiPoint<f64>> + Clone,
    mut at: [MinkowskiPoint<f64>; 3],
) -> Option<[MinkowskiPoint<f64>; 3]> {
    let is_left = |p: &MinkowskiPoint<f64>, q: &MinkowskiPoint<f64>| dot(axis, &cross(&p.w, &q.w)) >= 0.0;
    if !(is_left(&at[0], &at[1]) && is_left(&at[1], &at[2]) && is_left(&at[2], &at[0])) {
        return None;
    }
    for _ in 0..MAX_EXCHANGES {
        let [i, j, k] = at;
        let n = unit(&cross(&sub(&j.w, &i.w), &sub(&k.w, &i.w)));
        let flat = dot(&n, &i.w) + AGREE_DEPTH * posed.size();
        let mut top = i;
        let mut height = flat;
        for c in known.clone() {
            let h = dot(&n, &c.w);
            if h > height {
                (top, height) = (c, h);
            }
        }
        if height == flat {
            top = support(posed, frame, &n, &i);
            if !(dot(&n, &top.w) > flat) {
                return Some(at);
            }
        }
        at = if is_left(&j, &top) && !is_left(&i, &top) {
            [i, j, top]
        } else if is_left(&k, &top) && !is_left(&j, &top) {
            [j, k, top]
        } else {
            [k, i, top]
        };
    }
    None
}

/// Returns the radius of the disc that the facet must contain; `None` if a triangle below target is
/// too far below the facet, or rotated too far from the facet normal.
pub(super) fn disc_radius(
    below_target: impl Iterator<Item = [Vec3<f64>; 3]>,
    best: &Best<f64>,
    size: f64,
) -> Option<f64> {
    let margin = 2.0 * CERTIFICATE * UNIT * size;
    let r = best.height - AGREE_DEPTH * size;
    let (mut nearest, mut rho) = (r, 0.0);
    for w in below_target {
        let m = unit(&cross(&sub(&w[1], &w[0]), &sub(&w[2], &w[0])));
        let p = min_height(&m, &w) - margin;
        // NaN proves nothing.
        if !(p > 0.0 && dot(&m, &best.normal) > 0.5) {
            return None;
        }
        let turned = cross(&m, &best.normal);
        let off = r * sqrt(dot(&turned, &turned)) + sqrt((r * r - p * p).at_least(0.0));
        (nearest, rho) = (p.smaller(nearest), (off * r / p).larger(rho));
    }
    let rho = rho * DISC + margin;
    (rho < DISC_MOST * nearest).then_some(rho)
}

/// Returns the largest accepted offset of a facet point from the facet's height, within the
/// [`AGREE_DEPTH`] left below the height.
fn slack(posed: &PosedPair) -> f64 {
    0.25 * AGREE_DEPTH * posed.size()
}

/// Returns whether the facet, flat at its height up to rounding, contains the disc of radius `rho`
/// about its foot.
pub(super) fn holds_disc(
    posed: &PosedPair,
    facet: DifferenceFacet,
    [p, q]: &WitnessPoints,
    best: &Best<f64>,
    rho: f64,
) -> bool {
    let (p, q, n) = (p.coords, q.coords, Vector3::from(best.normal));
    match facet {
        DifferenceFacet::FaceVertex(f, _) => face_holds(posed.a, f, &p, rho, slack(posed)),
        DifferenceFacet::VertexFace(_, f) => face_holds(posed.b, f, &q, rho, slack(posed)),
        DifferenceFacet::Edges(e, g) => {
            let ends = |body: &ConvexPolyhedron, e: EdgeId| {
                let (t, h) = (&body.topology, e.half_edge());
                [t.from(h), t.half_edge(h).to].each(|v| body.points[v.index()])
            };
            let ([p0, p1], of_b) = (ends(posed.a, e), ends(posed.b, g));
            let ([q0, q1], q) = (of_b.each(|q| posed.point_in_a(&q)), posed.point_in_a(&q));
            let lowest = n.dot(&p0).smaller(n.dot(&p1)) - n.dot(&q0).larger(n.dot(&q1));
            let (perpendicular_a, perpendicular_b) = (n.cross(&(p1 - p0)), n.cross(&(q1 - q0)));
            // Distances from the sides of the parallelogram parallel to either edge.
            let is_clear = |x: Vector3<f64>, perpendicular: &Vector3<f64>| {
                perpendicular.dot(&x).abs() >= rho * perpendicular.abs().sum()
            };
            lowest >= best.height - 2.0 * slack(posed)
                && is_clear(p - p0, &perpendicular_b)
                && is_clear(p1 - p, &perpendicular_b)
                && is_clear(q - q0, &perpendicular_a)
                && is_clear(q1 - q, &perpendicular_a)
        }
    }
}

/// Returns whether a face contains a disc about a point in its plane, tested against all face
/// vertices or, if the face is large, against a sample.
fn face_holds(body: &ConvexPolyhedron, f: FaceId, x: &Vector3<f64>, rho: f64, slack: f64) -> bool {
    let (t, plane) = (&body.topology, &body.planes[f.index()]);
    let vertex = |h: HalfEdgeId| body.points[t.from(h).index()];
    let mut vertices = sample_rim(body, f).map(vertex);
    let Some(first) = vertices.next() else { return false };
    let mut from = first;
    let mut is_inside = |to: Vector3<f64>| {
        let side = plane.normal.cross(&(to - from));
        let inside = side.dot(&(x - from)) >= rho * side.abs().sum();
        from = to;
        inside && plane.normal.dot(&to) >= plane.offset - slack
    };
    plane.normal.dot(x) <= plane.offset + slack && vertices.all(&mut is_inside) && is_inside(first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convex::depth::descent::foot;
    use crate::rng::Rng;
    use crate::{ContactState, RelativePose, Tracker};
    use alloc::vec::Vec;
    use nalgebra::{Isometry3, Point3, UnitQuaternion};

    /// Tests random triangles slightly below a ball: a ray through a triangle leaves the ball no
    /// farther from the axis than the returned radius.
    #[test]
    fn rays_through_low_triangles_leave_the_ball_near_the_axis() {
        let mut rng = Rng::new(91);
        let (mut met, mut closest) = (0, f64::INFINITY);
        for _ in 0..4000 {
            let size = [1e-6, 1e-4, 1e-2][rng.below(3)];
            let vertex = |rng: &mut Rng| {
                [
                    rng.range(-1.0, 1.0),
                    rng.range(-1.0, 1.0),
                    1.0 - size * rng.range(0.0, 1.0),
                ]
            };
            let w: [Vec3<f64>; 3] = core::array::from_fn(|_| vertex(&mut rng));
            let best = Best {
                normal: [0.0, 0.0, 1.0],
                height: 1.0,
                facet: None,
            };
            let right = dot(&cross(&sub(&w[1], &w[0]), &sub(&w[2], &w[0])), &best.normal) > 0.0;
            let w = if right { w } else { [w[1], w[0], w[2]] };
            let Some(rho) = disc_radius([w].into_iter(), &best, 4.0) else {
                continue;
            };
            for _ in 0..400 {
                let (s, t) = (rng.range(0.0, 1.0), rng.range(0.0, 1.0));
                let y: Vec3<f64> =
                    core::array::from_fn(|k| (1.0 - s) * w[0][k] + s * ((1.0 - t) * w[1][k] + t * w[2][k]));
                let length = sqrt(dot(&y, &y));
                if length < 1.0 {
                    let off = sqrt(y[0] * y[0] + y[1] * y[1]) / length;
                    (met, closest) = (met + 1, closest.min(rho - off));
                }
            }
        }
        assert!(met > 500 && closest >= 0.0, "{met} {closest}");
    }

    fn hull(n: usize, rng: &mut Rng) -> ConvexPolyhedron {
        let points: Vec<Point3<f64>> = (0..n).map(|_| Point3::from(rng.unit())).collect();
        ConvexPolyhedron::from_points(&points).expect("a solid")
    }

    /// B moved by a vector of the disc still meets A: the vector is a point of A - B.
    #[test]
    fn a_facet_holds_the_disc_it_says() {
        let mut rng = Rng::new(92);
        let mut counts = [[0; 2]; 3];
        for _ in 0..600 {
            let (a, b) = (hull(6, &mut rng), hull(6, &mut rng));
            let turn = UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * rng.range(0.0, 3.0));
            let at = |by: Vector3<f64>| Isometry3::from_parts((Vector3::from([0.3, 0.1, 0.0]) + by).into(), turn);
            let pose = RelativePose::from_isometry(&at(Vector3::zeros())).expect("a pose");
            let o = Tracker::new().closest(&a, &b, &pose);
            let posed = PosedPair::new(&a, &b, &pose).ok().expect("near");
            let Some(facet) = DifferenceFacet::of(o.features) else {
                continue;
            };
            let Some((n, height)) = facet.height(&posed, &Transform::of(&posed)) else {
                continue;
            };
            let best = Best {
                normal: n,
                height,
                facet: Some(facet),
            };
            let Some(witnesses) = foot(&posed, facet, &best) else {
                continue;
            };
            for k in 1..8 {
                let rho = 0.5_f64.powi(k);
                let holds = holds_disc(&posed, facet, &witnesses, &best, rho);
                let kind = o.features.a.dimension();
                counts[kind][usize::from(holds)] += 1;
                let normal = Vector3::from(n);
                for _ in 0..if holds { 20 } else { 0 } {
                    let offset = normal.cross(&Vector3::from(rng.unit())).normalize() * rho;
                    let moved = RelativePose::from_isometry(&at(normal * height * (1.0 - 1e-12) + offset));
                    let there = Tracker::new().distance(&a, &b, &moved.expect("a pose"));
                    assert!(
                        there.state == ContactState::Overlapping || there.lower <= 1e-12,
                        "{there:?} {o:?} {rho}"
                    );
                }
            }
        }
        assert!(counts.iter().flatten().all(|&count| count > 100), "{counts:?}");
    }
}
