//! The naive exact oracle: contact state and signed distance of two small convex bodies, over the
//! integers.
//!
//! It is designed to be obviously correct, not fast (16 vertices per body take about 10 ms). It
//! relies on two facts:
//!
//! 1. **Contact state and depth.** For every direction n,
//!    `(min over B of n.b - max over A of n.a) / |n|` is at most the signed distance. If the bodies
//!    meet, some face normal of A or B, or some cross product of an edge of each, attains it: these
//!    are the facet normals of the difference A - B, which then contains the origin. If they are
//!    separated, one of these directions has a positive gap. So the largest gap is positive, zero
//!    or negative exactly if the bodies are separated, touch or overlap. If it is not positive, it
//!    is minus the depth.
//! 2. **Distance.** Separated bodies are closest at a vertex and a vertex, edge or face, or at two
//!    edges. Each candidate is the distance of two points of the bodies, so the least candidate is
//!    the distance.
//!
//! Squared distances are fractions of integers, compared by cross multiplication. Only the final
//! root rounds.

pub use crate::body::Body;
use crate::body::{Edge, Placed, place_two};
use crate::rational::{IntVec, cross, dot, sub};
pub use crate::verdict::{ContactState, Exact};
use crate::{Point, Pose};
use dashu_int::IBig;
use dashu_ratio::RBig;

/// The square of a length as numerator and positive denominator.
pub type Frac = (IBig, IBig);

/// Returns the lesser of two fractions.
pub fn less(a: Frac, b: Frac) -> Frac {
    if &a.0 * &b.1 <= &b.0 * &a.1 { a } else { b }
}

/// Squared distance of a point and a vertex.
pub fn to_corner(p: &IntVec, q: &IntVec) -> Frac {
    let w = sub(p, q);
    (dot(&w, &w), IBig::ONE)
}

/// Squared distance of a point and the interior of an edge.
pub fn to_edge(p: &IntVec, [a, b]: &Edge) -> Option<Frac> {
    let (u, w) = (sub(b, a), sub(p, a));
    let (along, len2, off) = (dot(&u, &w), dot(&u, &u), cross(&u, &w));
    (along > IBig::ZERO && along < len2).then(|| (dot(&off, &off), len2))
}

/// Squared distance of a point and a face above or below which it lies; `n` must not be zero.
pub fn to_face(p: &IntVec, corners: &[IntVec], n: &IntVec) -> Option<Frac> {
    let mut sides = corners.iter().zip(corners.iter().cycle().skip(1));
    let over = sides.all(|(a, b)| dot(&cross(n, &sub(b, a)), &sub(p, a)) >= IBig::ZERO);
    let height = dot(n, &sub(p, &corners[0]));
    over.then(|| (&height * &height, dot(n, n)))
}

/// Squared distance of two edges whose lines are closest within both.
pub fn edge_edge([a, b]: &Edge, [c, d]: &Edge) -> Option<Frac> {
    let (u, v, w) = (sub(b, a), sub(d, c), sub(c, a));
    let n = cross(&u, &v);
    let (n2, s, t) = (dot(&n, &n), dot(&cross(&w, &v), &n), dot(&cross(&w, &u), &n));
    let inside = |x: &IBig| *x >= IBig::ZERO && *x <= n2;
    let height = dot(&w, &n);
    (n2 > IBig::ZERO && inside(&s) && inside(&t)).then(|| (&height * &height, n2))
}

/// Returns the squared distance of `p` from the nearest feature of `body`.
fn nearest(p: &IntVec, body: &Placed) -> Frac {
    let corner = body.points.iter().map(|v| to_corner(p, v));
    let edge = body.edges.iter().filter_map(|e| to_edge(p, e));
    let face = body.faces.iter().filter_map(|(c, n)| to_face(p, c, n));
    corner.chain(edge).chain(face).reduce(less).expect("a body has points")
}

/// Returns the least squared distance over all pairs of features: the distance of surfaces that do
/// not pass through each other.
pub(crate) fn least(a: &Placed, b: &Placed) -> Frac {
    let from_a = a.points.iter().map(|p| nearest(p, b));
    let from_b = b.points.iter().map(|p| nearest(p, a));
    let edges = a
        .edges
        .iter()
        .flat_map(|e| b.edges.iter().filter_map(move |f| edge_edge(e, f)));
    from_a
        .chain(from_b)
        .chain(edges)
        .reduce(less)
        .expect("a body has points")
}

/// Returns the normals of all facets that the difference of two bodies may have.
pub(crate) fn facet_normals<'a>(a: &'a Placed, b: &'a Placed) -> impl Iterator<Item = IntVec> + 'a {
    let normals = a.faces.iter().chain(&b.faces).map(|f| f.1.clone());
    let crosses = a.edges.iter().flat_map(|e| {
        b.edges
            .iter()
            .map(move |f| cross(&sub(&e[1], &e[0]), &sub(&f[1], &f[0])))
    });
    normals.chain(crosses).filter(|n| n.iter().any(|x| !x.is_zero()))
}

/// Returns the largest gap over all facet directions, or the first positive gap, as (gap, |n|^2).
fn widest_gap(a: &Placed, b: &Placed) -> Frac {
    let mut best: Option<Frac> = None;
    for n in facet_normals(a, b) {
        let ((a_min, a_max), (b_min, b_max), n2) = (a.extent(&n), b.extent(&n), dot(&n, &n));
        let gap = (b_min - a_max).max(a_min - b_max); // along n and along -n
        if gap > IBig::ZERO {
            return (gap, n2);
        }
        // Neither gap is positive: the larger gap has the smaller square.
        if best.as_ref().is_none_or(|(g, m)| &gap * &gap * m < g * g * &n2) {
            best = Some((gap, n2));
        }
    }
    best.expect("one of the bodies is solid")
}

/// Returns contact state and signed distance of two bodies at two poses.
pub fn solve(a: Body, pose_a: &Pose, b: Body, pose_b: &Pose) -> Exact {
    let (a, b, den) = place_two(a, pose_a, b, pose_b);
    let (gap, n2) = widest_gap(&a, &b);
    let state = ContactState::of_sign(gap.cmp(&IBig::ZERO));
    let (num, below) = if state == ContactState::Separated {
        least(&a, &b)
    } else {
        (&gap * &gap, n2)
    };
    Exact::new(state, RBig::from_parts_signed(num, below * &den * &den))
}

/// Returns the distance of a point of the world from a solid at a pose, correctly rounded; zero
/// inside and on the surface.
pub fn distance_to_body(point: Point, body: Body, pose: &Pose) -> f64 {
    solve(
        Body {
            points: &[point],
            faces: &[],
        },
        &Pose::IDENTITY,
        body,
        pose,
    )
    .distance
    .max(0.0)
}

#[cfg(test)]
#[path = "exact_tests.rs"]
mod tests;
