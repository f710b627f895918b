//! An edge beside an edge: the feet of their common perpendicular must lie on both, and the perpendicular between the
//! planes of the faces of each.
//!
//! With `n = u x w` for the edge vectors `u` of A and `w` of B, the feet come from cross products over `n . n`, never
//! from `1 - cos^2`, which is where every wrong answer of the closed form was seen to end. By the Binet-Cauchy identity
//! the four plane tests are four products: `n` turned towards B is `alpha nL + beta nR` on A with
//! `alpha = -sign w . nR` and `beta = sign w . nL`, and its opposite the same on B with `u` for `w`.

use nalgebra::Vector3;

use super::fan::one_norm;
use super::placed::{OfA, OfB, Placed};
use super::slide::{Slide, slide};
use super::state::{Found, State, Step};
use crate::polyhedron::ConvexPolyhedron;
use crate::pose::Which;
use crate::scalar::sqrt;
use crate::tolerance::{DIFFERENCE, DIRECTION, NEARLY_PARALLEL, ON_BOUNDARY, PARALLEL};

/// An edge with its ends and the planes of its faces.
struct Edge<'a> {
    name: u32,
    tail: u32,
    head: u32,
    left: u32,
    right: u32,
    p: Vector3<f64>,
    q: Vector3<f64>,
    body: &'a ConvexPolyhedron,
}

impl<'a> Edge<'a> {
    #[inline]
    fn new(body: &'a ConvexPolyhedron, edge: u32) -> Self {
        let e = body.topology.half_edge(edge);
        let twin = body.topology.half_edge(e.twin);
        let (p, q) = (body.points[twin.to as usize], body.points[e.to as usize]);
        Self {
            name: edge,
            tail: twin.to,
            head: e.to,
            left: e.face,
            right: twin.face,
            p,
            q,
            body,
        }
    }

    /// How far `t` leaves the face on the left and on the right behind, for a normal turned by `sign`: both are weights
    /// of the normal over the planes and not negative inside.
    #[inline]
    fn weights(&self, t: &Vector3<f64>, sign: f64) -> (f64, f64) {
        let (l, r) = (
            &self.body.planes[self.left as usize],
            &self.body.planes[self.right as usize],
        );
        (-sign * t.dot(&r.normal), sign * t.dot(&l.normal))
    }

    /// How high the body is along `n`, by the planes of the edge's faces.
    #[inline]
    fn height(&self, n: &Vector3<f64>, weights: (f64, f64)) -> f64 {
        let (left, right) = (
            &self.body.planes[self.left as usize],
            &self.body.planes[self.right as usize],
        );
        self.body.edge_bound(n, left, right, weights.0, weights.1)
    }
}

// Not inlined: the walk's loop would hoist the loads of every kind of pair and spill them.
#[inline(never)]
pub(crate) fn look<const CERTIFY: bool>(placed: &Placed, a: u32, b: u32, found: &mut Found) -> Step {
    let (ea, eb) = (Edge::new(placed.a, a), Edge::new(placed.b, b));
    let (u, w_in_b) = (ea.q - ea.p, eb.q - eb.p);
    let (w, p2) = (placed.vector_in_a(&w_in_b), placed.point_in_a(&eb.p));
    let r = p2 - ea.p;
    let (uu, ww) = (u.norm_squared(), w.norm_squared());
    let mut n = u.cross(&w);
    let mut nn = n.norm_squared();
    if nn < NEARLY_PARALLEL * uu * ww {
        n -= u * (n.dot(&u) / uu);
        nn = n.norm_squared();
        if nn <= PARALLEL * uu * ww {
            return Step::Move(ends(&ea, &eb, &r, &u, &w));
        }
    }
    let per_square = 1.0 / nn;
    let (s, t) = (r.cross(&w).dot(&n) * per_square, r.cross(&u).dot(&n) * per_square);
    if beyond(s, uu, placed.size()) || beyond(t, ww, placed.size()) {
        return Step::Move(ends(&ea, &eb, &r, &u, &w));
    }
    let across = r.dot(&n);
    let sign = if across < 0.0 { -1.0 } else { 1.0 };
    let u_in_b = placed.vector_in_b(&u);
    let (weights_a, weights_b) = (ea.weights(&w, sign), eb.weights(&u_in_b, sign));
    let (s, t) = (s.clamp(0.0, 1.0), t.clamp(0.0, 1.0));
    let (least_a, least_b) = (weights_a.0.min(weights_a.1), weights_b.0.min(weights_b.1));
    if least_a < 0.0 || least_b < 0.0 {
        let out_a = least_a < -DIRECTION * one_norm(&w);
        let out_b = least_b < -DIRECTION * one_norm(&u_in_b);
        // The weights are as long as the other edge: compare sines.
        if out_a && (!out_b || least_a * sqrt(uu) <= least_b * placed.unit_of_b() * sqrt(ww)) {
            let face = if weights_a.0 < weights_a.1 { ea.right } else { ea.left };
            return over_face_of_a(placed, &eb, face, a, &(p2 + w * t), &w);
        }
        if out_b {
            let face = if weights_b.0 < weights_b.1 { eb.right } else { eb.left };
            return over_face_of_b(placed, &ea, face, b, &(ea.p + u * s), &u_in_b);
        }
    }
    let (point_a, point_b) = (ea.p + u * s, eb.p + w_in_b * t);
    let between = (p2 + w * t) - point_a;
    let distance = sqrt(between.norm_squared());
    if distance <= ON_BOUNDARY * placed.size() {
        return Step::Lost;
    }
    let normal = n * (sign * sqrt(nn) * per_square);
    let lower = if CERTIFY {
        let high_a = ea.height(&normal, weights_a);
        let high_b = eb.height(&-placed.direction_in_b(&normal), weights_b);
        placed.lift(&normal) - high_a - high_b
    } else {
        f64::NEG_INFINITY
    };
    *found = Found {
        normal,
        point_a,
        point_b,
        distance,
        lower,
    };
    Step::Found
}

/// Whether a parameter is off its edge by more than rounding does to a length.
#[inline]
fn beyond(s: f64, squared_length: f64, size: f64) -> bool {
    let off = if s < 0.0 { -s } else { s - 1.0 };
    off > 0.0 && off * sqrt(squared_length) > DIFFERENCE * size
}

/// Slides the edge of B over a face of A, downhill from `start` (A's frame).
fn over_face_of_a(p: &Placed, e: &Edge, face: u32, rim: u32, start: &Vector3<f64>, w: &Vector3<f64>) -> Step {
    let rising = p.a.planes[face as usize].normal.dot(w) > 0.0;
    let half_edge = if rising {
        e.body.topology.half_edge(e.name).twin
    } else {
        e.name
    };
    slide(
        &OfB(p),
        &Slide {
            half_edge,
            start: *start,
            face,
            from_rim: Some(rim),
        },
    )
}

/// Slides the edge of A over a face of B, downhill from `start` (A's frame).
fn over_face_of_b(p: &Placed, e: &Edge, face: u32, rim: u32, start: &Vector3<f64>, u: &Vector3<f64>) -> Step {
    let rising = p.b.planes[face as usize].normal.dot(u) > 0.0;
    let half_edge = if rising {
        e.body.topology.half_edge(e.name).twin
    } else {
        e.name
    };
    let start = p.point_in_b(start);
    slide(
        &OfA(p),
        &Slide {
            half_edge,
            start,
            face,
            from_rim: Some(rim),
        },
    )
}

/// The nearest pair of points of the two segments where at least one of them is an end: clamp on A's edge, project on
/// B's, clamp, project back.
#[cold]
fn ends(ea: &Edge, eb: &Edge, r: &Vector3<f64>, u: &Vector3<f64>, w: &Vector3<f64>) -> State {
    let (uu, ww, uw) = (u.norm_squared(), w.norm_squared(), u.dot(w));
    let (ru, rw) = (r.dot(u), r.dot(w));
    // Squared distance from the point at s on A's edge to its nearest on B's, and where that is; and the reverse.
    let on_b = |s: f64| ((s * uw - rw) / ww).clamp(0.0, 1.0);
    let on_a = |t: f64| ((t * uw + ru) / uu).clamp(0.0, 1.0);
    let candidates = [(0.0, on_b(0.0)), (1.0, on_b(1.0)), (on_a(0.0), 0.0), (on_a(1.0), 1.0)];
    let gap = |&(s, t): &(f64, f64)| (r + w * t - u * s).norm_squared();
    let mut best = candidates[0];
    for c in &candidates[1..] {
        if gap(c) < gap(&best) {
            best = *c;
        }
    }
    let (s, t) = best;
    let end = |e: &Edge, x: f64| {
        if x == 0.0 {
            Some(e.tail)
        } else if x == 1.0 {
            Some(e.head)
        } else {
            None
        }
    };
    match (end(ea, s), end(eb, t)) {
        (Some(a), Some(b)) => State::VertexVertex { a, b },
        (Some(vertex), None) => State::VertexEdge {
            of: Which::A,
            vertex,
            edge: eb.name,
        },
        (None, Some(vertex)) => State::VertexEdge {
            of: Which::B,
            vertex,
            edge: ea.name,
        },
        // A projection that is NaN or at neither end: the tails stand in.
        (None, None) => State::VertexVertex { a: ea.tail, b: eb.tail },
    }
}
