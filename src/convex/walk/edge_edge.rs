//! Edge-edge test: the feet of the common perpendicular must lie on both edges, and the
//! perpendicular must lie between the planes of the adjacent faces of each edge.
//!
//! ```text
//!           p2                      p1, p2  tails of the edges of A and B, r = p2 - p1
//!             \                     u, w    edge vectors, heads minus tails
//!              + p2 + t w           n       u x w, along the common perpendicular
//!              |\                   s, t    positions of the feet on the edges, 0..1
//!            n | \ w                nL, nR  normals of the faces left and right of an edge
//!              |  v
//!   p1 --------+---------> u
//!              p1 + s u
//! ```
//!
//! The feet come from cross products divided by `n . n`, never from `1 - cos^2`: every wrong answer
//! of the closed form came from there. By the Binet-Cauchy identity the four plane tests are four
//! products. On A, `n` rotated towards B is (up to a positive factor) `alpha nL + beta nR` with
//! `alpha = -sign w . nR` and `beta = sign w . nL`. On B, the opposite of `n` is such a sum with
//! `u` for `w`.

use nalgebra::Vector3;

use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::packed::PackedVec3;
use crate::base::num::scalar::sqrt;
use crate::base::pose::Operand;
use crate::base::tolerance::{DIFFERENCE, DIRECTION, NEARLY_PARALLEL, ON_BOUNDARY, PARALLEL};
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, FeaturePair, HalfEdgeId};
use crate::convex::walk::Step;
use crate::convex::walk::slide::{Slide, slide};
use crate::pair::draft::Draft;
use crate::pair::posed::{AFirst, BFirst, PosedPair};
use crate::pair::star::EdgeSpan;
use crate::pair::star::falls_into_both_faces;

/// Squared sine of the angle of two edges below which their closest points are the best of four
/// projections of ends. Above it, they are a projection of the feet on the lines, whose rounding
/// grows with the inverse of the sine.
const SKEW: f64 = 1.0 / (1u64 << 20) as f64;

/// Tests an edge of A against an edge of B.
// Not inlined: otherwise the loop of the walk would hoist the loads of every kind of pair and spill
// them.
#[inline(never)]
pub(crate) fn test<const CERTIFY: bool>(posed: &PosedPair, a: EdgeId, b: EdgeId, draft: &mut Draft) -> Step {
    let (ea, eb) = (EdgeSpan::new(posed.a, a), EdgeSpan::new(posed.b, b));
    let (p1, p2_in_b) = (PackedVec3::new(&ea.p), PackedVec3::new(&eb.p));
    let (u, w_in_b) = (PackedVec3::new(&ea.q) - p1, PackedVec3::new(&eb.q) - p2_in_b);
    let w = posed.rotation.times(w_in_b);
    let p2 = posed.rotation.times(p2_in_b) + posed.translation;
    let r = p2 - p1;
    let (uu, ww) = (u.norm_squared(), w.norm_squared());
    let mut n = u.cross(w);
    let mut nn = n.norm_squared();
    if nn < NEARLY_PARALLEL * uu * ww {
        n = n - u * (n.dot(u) / uu);
        nn = n.norm_squared();
        if nn <= PARALLEL * uu * ww {
            return closest_with_endpoint(posed, a, b, draft);
        }
    }
    let per_square = 1.0 / nn;
    let (s, t) = (r.cross(w).dot(n) * per_square, r.cross(u).dot(n) * per_square);
    if s < 0.0 || t < 0.0 || s > 1.0 || t > 1.0 {
        let off = |s: f64, squared: f64| (s - s.clamped(0.0, 1.0)).abs() * sqrt(squared) > DIFFERENCE * posed.size();
        if off(s, uu) || off(t, ww) {
            if nn < SKEW * uu * ww {
                return closest_with_endpoint(posed, a, b, draft);
            }
            let products = [u.dot(w), r.dot(u), r.dot(w)];
            let feet = closest_feet([s, t], products, [uu, ww]);
            return move_to_endpoint([&ea, &eb], [a, b], feet, draft);
        }
    }
    let along = r.dot(n);
    let sign = if along < 0.0 { -1.0 } else { 1.0 };
    let u_in_b = posed.rotation.transposed_times(u);
    let (on_a, on_b) = (ea.weights(w, sign), eb.weights(u_in_b, sign));
    let (s, t) = (s.clamped(0.0, 1.0), t.clamped(0.0, 1.0));
    let proven = falls_into_both_faces(on_a, ww) && falls_into_both_faces(on_b, uu);
    if !proven && (on_a[0] < 0.0 || on_a[1] < 0.0 || on_b[0] < 0.0 || on_b[1] < 0.0) {
        // The weights are as long as the opposite edge: compare sines.
        let sine = |least: f64, other: PackedVec3| {
            if least < -DIRECTION * other.one_norm() {
                least / sqrt(other.norm_squared())
            } else {
                0.0
            }
        };
        let (out_a, out_b) = (
            sine(on_a[0].smaller(on_a[1]), w),
            sine(on_b[0].smaller(on_b[1]), u_in_b),
        );
        if out_a < 0.0 && out_a <= out_b {
            return slide_over_face_of_a(posed, a, b, on_a[0] < on_a[1], t, draft);
        }
        if out_b < 0.0 {
            return slide_over_face_of_b(posed, a, b, on_b[0] < on_b[1], s, draft);
        }
    }
    let (point_a, point_b) = (p1 + u * s, p2_in_b + w_in_b * t);
    let distance = sqrt((p2 + w * t - point_a).norm_squared());
    if distance <= ON_BOUNDARY * posed.size() {
        return Step::Lost;
    }
    let per_length = sqrt(nn) * per_square;
    let normal = n * (sign * per_length);
    let lower = if !CERTIFY {
        f64::NEG_INFINITY
    } else if proven {
        // Each edge is extreme along the normal, so the supporting planes are as far apart as the
        // lines.
        along.abs() * per_length
    } else {
        bound_by_planes(posed, [a, b], normal, on_a, on_b)
    };
    draft.accept(normal.vector(), (point_a.vector(), point_b.vector()), distance, lower)
}

/// Lower bound of the distance along a unit `normal` from the planes of the adjacent faces, if
/// signs do not prove the edges extreme.
#[cold]
#[inline(never)]
fn bound_by_planes(posed: &PosedPair, [a, b]: [EdgeId; 2], normal: PackedVec3, on_a: [f64; 2], on_b: [f64; 2]) -> f64 {
    let (ea, eb) = (EdgeSpan::new(posed.a, a), EdgeSpan::new(posed.b, b));
    let high_a = posed.a.edge_bound(normal, ea.left, ea.right, on_a, 1.0);
    let normal_in_b = -posed.rotation.transposed_times(normal);
    let high_b = posed.b.edge_bound(normal_in_b, eb.left, eb.right, on_b, 1.0);
    normal.dot(posed.translation) - high_a - high_b
}

/// Slides the edge of B over the right or left face of the edge of A, descending from `t`.
#[inline(never)]
fn slide_over_face_of_a(posed: &PosedPair, a: EdgeId, b: EdgeId, right: bool, t: f64, draft: &mut Draft) -> Step {
    let eb = EdgeSpan::new(posed.b, b);
    let start = posed.point_in_a(&(eb.p + (eb.q - eb.p) * t));
    let along = posed.vector_in_a(&(eb.q - eb.p));
    let (face, half_edge) = descending_half_edge(posed.a, a, right, &along, posed.b, b);
    slide(
        &BFirst(posed),
        &Slide {
            half_edge,
            start: PackedVec3::new(&start),
            face,
            entry_edge: Some(a),
        },
        draft,
    )
}

/// Slides the edge of A over the right or left face of the edge of B, descending from `s`.
#[inline(never)]
fn slide_over_face_of_b(posed: &PosedPair, a: EdgeId, b: EdgeId, right: bool, s: f64, draft: &mut Draft) -> Step {
    let ea = EdgeSpan::new(posed.a, a);
    let start = posed.point_in_b(&(ea.p + (ea.q - ea.p) * s));
    let along = posed.vector_in_b(&(ea.q - ea.p));
    let (face, half_edge) = descending_half_edge(posed.b, b, right, &along, posed.a, a);
    slide(
        &AFirst(posed),
        &Slide {
            half_edge,
            start: PackedVec3::new(&start),
            face,
            entry_edge: Some(b),
        },
        draft,
    )
}

/// Returns the face right or left of the edge `hinge`, and the half-edge of `edge` (pointing along
/// `along`) that descends towards the face.
fn descending_half_edge(
    body: &ConvexPolyhedron,
    hinge: EdgeId,
    right: bool,
    along: &Vector3<f64>,
    other: &ConvexPolyhedron,
    edge: EdgeId,
) -> (FaceId, HalfEdgeId) {
    let e = body.topology.half_edge(hinge.half_edge());
    let face = if right {
        body.topology.half_edge(e.twin).face
    } else {
        e.face
    };
    let rising = body.planes[face.index()].normal.dot(along) > 0.0;
    (
        face,
        if rising {
            other.topology.half_edge(edge.half_edge()).twin
        } else {
            edge.half_edge()
        },
    )
}

/// Returns the positions of the closest points of two segments whose lines are closest at `s` and
/// `t`, at least one of them off its segment: each position is cut to the segment, and is then the
/// best for the other. `products` are `u . w`, `r . u` and `r . w`.
#[inline(always)]
fn closest_feet([s, t]: [f64; 2], [uw, ru, rw]: [f64; 3], [uu, ww]: [f64; 2]) -> [f64; 2] {
    let cut = s.clamped(0.0, 1.0);
    let t = if cut == s { t } else { (cut * uw - rw) / ww };
    if (0.0..=1.0).contains(&t) {
        return [cut, t];
    }
    let t = t.clamped(0.0, 1.0);
    [((t * uw + ru) / uu).clamped(0.0, 1.0), t]
}

/// Moves to two closest points of the edges, at least one of them an endpoint.
#[inline(always)]
fn move_to_endpoint([ea, eb]: [&EdgeSpan; 2], [a, b]: [EdgeId; 2], [s, t]: [f64; 2], draft: &mut Draft) -> Step {
    let end = |e: &EdgeSpan, x: f64| {
        if x == 0.0 {
            Some(e.tail)
        } else if x == 1.0 {
            Some(e.head)
        } else {
            None
        }
    };
    draft.move_to(match (end(ea, s), end(eb, t)) {
        (Some(v), Some(w)) => FeaturePair::vertices(Operand::A, v, w),
        (Some(v), None) => FeaturePair::vertex_edge(Operand::A, v, b),
        (None, Some(v)) => FeaturePair::vertex_edge(Operand::B, v, a),
        // A position is NaN: use the tails.
        (None, None) => FeaturePair::vertices(Operand::A, ea.tail, eb.tail),
    })
}

/// Moves to the closest points of two nearly parallel segments with at least one endpoint among
/// them: each endpoint is projected on the opposite segment, and the best of the four pairs is
/// taken.
#[cold]
fn closest_with_endpoint(posed: &PosedPair, a: EdgeId, b: EdgeId, draft: &mut Draft) -> Step {
    let (ea, eb) = (EdgeSpan::new(posed.a, a), EdgeSpan::new(posed.b, b));
    let (u, w) = (ea.q - ea.p, posed.vector_in_a(&(eb.q - eb.p)));
    let r = posed.point_in_a(&eb.p) - ea.p;
    let (uu, ww, uw) = (u.norm_squared(), w.norm_squared(), u.dot(&w));
    let (ru, rw) = (r.dot(&u), r.dot(&w));
    let on_b = |s: f64| ((s * uw - rw) / ww).clamped(0.0, 1.0);
    let on_a = |t: f64| ((t * uw + ru) / uu).clamped(0.0, 1.0);
    let candidates = [[0.0, on_b(0.0)], [1.0, on_b(1.0)], [on_a(0.0), 0.0], [on_a(1.0), 1.0]];
    let gap = |[s, t]: [f64; 2]| r + w * t - u * s;
    // |g|^2 - |h|^2 = (g - h) . (g + h), where g - h comes from the differences of the positions:
    // edges in line overlap by little, and the squares would differ by less than their rounding.
    let is_closer = |c: [f64; 2], d: [f64; 2]| {
        let difference = w * (c[1] - d[1]) - u * (c[0] - d[0]);
        difference.dot(&(gap(c) + gap(d))) < 0.0
    };
    let mut best = candidates[0];
    for &c in &candidates[1..] {
        if is_closer(c, best) {
            best = c;
        }
    }
    move_to_endpoint([&ea, &eb], [a, b], best, draft)
}
