//! Exact solver: contact state and distance in rational arithmetic.
//!
//! It decides the pairs that floating point cannot decide.
//! 1. From the bits of vertices and poses, both bodies are put into the world, relative to A's
//!    origin. Coordinates are integers over a common denominator `D = |qa|^2 |qb|^2` times a power
//!    of two.
//! 2. The minimum-norm search of `minimum` runs on these integers with exact signs. It starts from
//!    the last features found in floating point, so one or two steps are enough.
//! 3. Support vertices are found by hill climbing. Vertices are compared exactly only if f64 cannot
//!    prove a sign.

mod depth;
mod flush;
pub(crate) mod integer;
pub(crate) mod place;
mod simplex;

use alloc::vec;
use core::cmp::Ordering;

use dashu_base::UnsignedAbs;
use dashu_int::IBig;
use nalgebra::{Matrix3, Point3, Vector3};

use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use crate::base::num::sign::{edge_sign, is_level};
use crate::base::pose::RelativePose;
use crate::body::polyhedron::fans::Axis;
use crate::body::polyhedron::highest::{Upward, steeper};
use crate::body::polyhedron::{ConvexPolyhedron, VertexId, lowest_bit};
use crate::pair::draft::Draft;
use crate::pair::outcome::{ContactState, Solver};
use crate::pair::posed::PosedPair;
pub(crate) use depth::deepest;
pub(crate) use flush::touches;
use integer::{Big3, direction, dot, fraction, integer, is_zero, neg, root, sign, sub};
use simplex::{ExactPoint, NearestPoint, minimize};
use simplex::{Origin, PointSet, locate};

/// A body rotated exactly, over the common denominator.
struct RotatedBody<'a> {
    body: &'a ConvexPolyhedron,
    matrix: [Big3; 3],
    /// The matrix in f64. Only its transpose is used: it maps world directions to the body frame.
    rounded: Matrix3<f64>,
}

/// Both bodies over `D 2^-e`.
struct ScaledPair<'a> {
    a: RotatedBody<'a>,
    b: RotatedBody<'a>,
    /// Translation from A to B.
    offset: Big3,
    denominator: IBig,
    exponent: i32,
}

/// Returns `R(q) |q|^2` and `|q|^2` for the integer quaternion proportional to `q`.
fn turn(q: &[f64; 4]) -> ([Big3; 3], IBig) {
    let e = lowest_bit(*q).unwrap_or(0);
    let [x, y, z, w] = q.each(|c| integer(c, e));
    let (xx, yy, zz, ww) = (&x * &x, &y * &y, &z * &z, &w * &w);
    let two = |x: IBig| x << 1;
    let rows = [
        [&ww + &xx - &yy - &zz, two(&x * &y - &w * &z), two(&x * &z + &w * &y)],
        [two(&x * &y + &w * &z), &ww - &xx + &yy - &zz, two(&y * &z - &w * &x)],
        [two(&x * &z - &w * &y), two(&y * &z + &w * &x), &ww - &xx - &yy + &zz],
    ];
    (rows, ww + xx + yy + zz)
}

impl<'a> RotatedBody<'a> {
    fn new(body: &'a ConvexPolyhedron, q: &[f64; 4], rows: [Big3; 3], factor: &IBig) -> Self {
        let [x, y, z, w] = *q;
        let unit = nalgebra::UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, x, y, z));
        let matrix = rows.each(|row| row.each(|m| m * factor));
        Self {
            body,
            matrix,
            rounded: unit.to_rotation_matrix().into_inner(),
        }
    }

    fn vector(&self, v: &Big3) -> Big3 {
        [
            dot(&self.matrix[0], v),
            dot(&self.matrix[1], v),
            dot(&self.matrix[2], v),
        ]
    }

    fn to_user(&self, v: VertexId, exponent: i32) -> Big3 {
        let p = self.body.to_user(&self.body.points[v.index()]);
        [p.x, p.y, p.z].each(|c| integer(c, exponent))
    }

    /// Returns vertex `v`, rotated.
    fn point(&self, v: VertexId, exponent: i32) -> Big3 {
        self.vector(&self.to_user(v, exponent))
    }

    /// Returns the world direction `n` in the body frame.
    fn along(&self, n: &Big3, exponent: i32) -> Along<'_> {
        let m = &self.matrix;
        let n = [0, 1, 2].each(|k| &n[0] * &m[0][k] + &n[1] * &m[1][k] + &n[2] * &m[2][k]);
        Along {
            body: self,
            rounded: direction(&n),
            n,
            exponent,
        }
    }

    /// Returns the support vertex along `n`; among exact ties, the vertex of lowest index.
    fn support_exact(&self, n: &Big3, hint: VertexId, exponent: i32) -> VertexId {
        let (body, along) = (self.body, self.along(n, exponent));
        let start = body.support_climb(&along.rounded, body.start_vertex(&along.rounded, hint));
        body.support_exact(&along, start)
    }

    /// Returns an edge at `v`, rotated, with its end vertex. Prefers an edge that rises along `n`,
    /// then a level edge.
    fn rising(&self, n: &Big3, v: VertexId, exponent: i32) -> Option<(VertexId, Big3)> {
        let h = self.body.rising(&self.along(n, exponent), v)?;
        let to = self.body.topology.half_edge(h).to;
        Some((to, sub(&self.point(to, exponent), &self.point(v, exponent))))
    }
}

/// A direction in the frame of a body's vertices, exact and rounded.
struct Along<'a> {
    body: &'a RotatedBody<'a>,
    n: Big3,
    rounded: Vector3<f64>,
    exponent: i32,
}

impl Along<'_> {
    /// Returns the edge between two vertices, in stored units.
    fn rounded_edge(&self, p: VertexId, q: VertexId) -> Vector3<f64> {
        let points = &self.body.body.points;
        points[q.index()] - points[p.index()]
    }

    /// Returns an exact multiple of the edge between two vertices.
    fn edge(&self, p: VertexId, q: VertexId) -> Big3 {
        sub(
            &self.body.to_user(q, self.exponent),
            &self.body.to_user(p, self.exponent),
        )
    }
}

impl Upward for Along<'_> {
    fn rise(&self, p: VertexId, q: VertexId) -> i32 {
        let edge = self.rounded_edge(p, q);
        match edge_sign(&self.rounded, &edge) {
            // Rounding keeps zeros: coordinates that differ never round to a difference of zero.
            0 if is_level(&self.rounded.into(), &edge.into()) => 0,
            0 => sign(&dot(&self.n, &self.edge(p, q))),
            sign => sign,
        }
    }

    fn steeper(&self, m: &Axis, p: VertexId, q: VertexId, r: VertexId) -> i32 {
        let certain = steeper(
            &self.rounded,
            &m.rounded(),
            &self.rounded_edge(p, q),
            &self.rounded_edge(p, r),
        );
        certain.unwrap_or_else(|| {
            let lowest = lowest_bit(m.parts().iter().flatten().copied()).unwrap_or(0);
            let m = m
                .parts()
                .each(|parts| parts.each(|c| integer(c, lowest)).into_iter().sum::<IBig>());
            let (e, f) = (self.edge(p, q), self.edge(p, r));
            sign(&(dot(&self.n, &e) * dot(&m, &f) - dot(&self.n, &f) * dot(&m, &e)))
        })
    }
}

impl<'a> ScaledPair<'a> {
    fn new(a: &'a ConvexPolyhedron, b: &'a ConvexPolyhedron, pose: &RelativePose) -> Self {
        let ((rows_a, na), (rows_b, nb)) = (turn(&pose.a.q()), turn(&pose.b.q()));
        let translations = lowest_bit(pose.a.t().into_iter().chain(pose.b.t()));
        let lowest = [a.lowest_bit, b.lowest_bit, translations].into_iter().flatten().min();
        let exponent = lowest.unwrap_or(0);
        let denominator = &na * &nb;
        let offset =
            [0, 1, 2].each(|k| (integer(pose.b.t()[k], exponent) - integer(pose.a.t()[k], exponent)) * &denominator);
        Self {
            a: RotatedBody::new(a, &pose.a.q(), rows_a, &nb),
            b: RotatedBody::new(b, &pose.b.q(), rows_b, &na),
            offset,
            denominator,
            exponent,
        }
    }

    /// Returns the point `a - b` of A - B.
    fn corner(&self, a: VertexId, b: VertexId) -> ExactPoint {
        let (p, q) = (self.a.point(a, self.exponent), self.b.point(b, self.exponent));
        ExactPoint {
            a,
            b,
            w: sub(&sub(&p, &q), &self.offset),
        }
    }

    /// Returns the support point of A - B along `n`.
    fn support_exact(&self, n: &Big3, hint: [VertexId; 2]) -> ExactPoint {
        let a = self.a.support_exact(n, hint[0], self.exponent);
        let b = self.b.support_exact(&neg(n), hint[1], self.exponent);
        self.corner(a, b)
    }

    fn nearest(&self, hint: [VertexId; 2]) -> Option<NearestPoint> {
        minimize(vec![self.corner(hint[0], hint[1])], &|n| {
            self.support_exact(&neg(n), hint)
        })
    }

    /// Locates the origin in A - B; `at` must be the origin.
    fn locate(&self, at: &NearestPoint, hint: [VertexId; 2]) -> Origin {
        let rising = |c: &ExactPoint, n: &Big3| {
            let a = self
                .a
                .rising(n, c.a, self.exponent)
                .map(|(a, w)| ExactPoint { a, w, ..c.clone() });
            let b = self.b.rising(&neg(n), c.b, self.exponent);
            let b = b.map(|(b, w)| ExactPoint {
                b,
                w: neg(&w),
                ..c.clone()
            });
            let both = a.into_iter().chain(b);
            both.max_by(|c, d| dot(n, &c.w).cmp(&dot(n, &d.w)))
        };
        locate(
            &PointSet {
                highest: &|n| self.support_exact(n, hint),
                rising: &rising,
            },
            at,
        )
    }
}

/// Resolves contact state and distance exactly, from the vertices of the outcome's features.
pub(crate) fn resolve_exactly(posed: &PosedPair, draft: &mut Draft) {
    let hint = draft.features.vertices_of(posed.a, posed.b).into();
    let pair = ScaledPair::new(posed.a, posed.b, posed.pose);
    // One to four points always have a nearest point.
    let Some(at) = pair.nearest(hint) else {
        return crate::pair::draft::set_undecided(posed, draft);
    };
    let (mut a, mut b) = ([VertexId(0); 4], [VertexId(0); 4]);
    for (k, c) in at.kept.iter().enumerate().take(4) {
        (a[k], b[k]) = (c.a, c.b);
    }
    draft.solver = Solver::Exact;
    draft.features = crate::pair::draft::walk_state(posed, &a[..at.kept.len()], &b[..at.kept.len()]);
    (draft.point_on_a, draft.point_on_b) = witnesses(&pair, &at);
    let normal = |n: &Big3| crate::pair::draft::unit(&pair.a.rounded.tr_mul(&direction(n)));
    if !is_zero(&at.direction) {
        let d = distance(&pair, &at, posed.a.exponent);
        draft.state = ContactState::Separated;
        draft.distance = d;
        draft.normal = normal(&neg(&at.direction));
        // Zero if the distance underflows. A single rounding, even to a subnormal number, errs by
        // at most half a unit in the last place.
        (draft.lower, draft.upper) = (d.next_down().at_least(0.0), d.next_up());
        return;
    }
    match pair.locate(&at, hint) {
        // A - B lies below the plane: A is behind it and B in front, so the normal points from A to
        // B.
        Origin::Boundary(n) => {
            draft.state = ContactState::Touching;
            draft.distance = 0.0;
            draft.normal = normal(&n);
            (draft.lower, draft.upper) = (0.0, 0.0);
        }
        Origin::Interior => crate::pair::draft::set_overlapping(draft),
    }
}

/// Returns the distance in units of `2^unit` times the caller's unit. It is rounded at most twice,
/// and its error is less than one unit in the last place.
fn distance(pair: &ScaledPair, at: &NearestPoint, unit: i32) -> f64 {
    let (num, den) = at.squared();
    let den = den * &pair.denominator * &pair.denominator;
    root(&num.unsigned_abs(), &den.unsigned_abs(), pair.exponent - unit)
}

/// Returns the contact state, and the distance in the caller's unit to less than one unit in the
/// last place.
///
/// The distance is zero if the bodies touch or overlap. It may also be zero if the distance of
/// separated bodies underflows.
pub(crate) fn separation(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    pose: &RelativePose,
    hint: [VertexId; 2],
) -> Option<(ContactState, f64)> {
    let pair = ScaledPair::new(a, b, pose);
    let at = pair.nearest(hint)?;
    if !is_zero(&at.direction) {
        return Some((ContactState::Separated, distance(&pair, &at, 0)));
    }
    Some(match pair.locate(&at, hint) {
        Origin::Boundary(_) => (ContactState::Touching, 0.0),
        Origin::Interior => (ContactState::Overlapping, 0.0),
    })
}

/// Returns the witness points in stored coordinates: convex combinations of the simplex vertices,
/// rounded.
fn witnesses(pair: &ScaledPair, at: &NearestPoint) -> (Point3<f64>, Point3<f64>) {
    let (mut on_a, mut on_b) = (Point3::origin(), Point3::origin());
    for (c, weight) in at.kept.iter().zip(&at.weights) {
        let s = fraction(weight, &at.sum);
        on_a += pair.a.body.points[c.a.index()] * s;
        on_b += pair.b.body.points[c.b.index()] * s;
    }
    (on_a, on_b)
}

/// Returns whether the closed bodies are at most `d` apart, exactly; `d` must not be negative.
pub(crate) fn within(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    pose: &RelativePose,
    hint: [VertexId; 2],
    d: f64,
) -> bool {
    d == f64::INFINITY || compare(a, b, pose, hint, &[d]).is_le()
}

/// Compares the distance of the closed bodies with a sum of finite numbers, exactly. No number of
/// the sum may be negative.
pub(crate) fn compare(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    pose: &RelativePose,
    hint: [VertexId; 2],
    sum: &[f64],
) -> Ordering {
    let e = lowest_bit(sum.iter().copied());
    let pair = ScaledPair::new(a, b, pose);
    let nearest = pair.nearest(hint).filter(|at| !is_zero(&at.direction));
    let (at, e) = match (nearest, e) {
        (Some(at), Some(e)) => (at, e),
        (Some(_), None) => return Ordering::Greater,
        (None, Some(_)) => return Ordering::Less,
        (None, None) => return Ordering::Equal,
    };
    // Compares s^2 = num / (den D^2) 4^exponent with d^2 = m^2 4^e.
    let (num, den) = at.squared();
    let m = sum.iter().map(|&x| integer(x, e)).sum::<IBig>();
    let (mut left, mut right) = (num, den * &pair.denominator * &pair.denominator * &m * &m);
    let shift = 2 * (i64::from(pair.exponent) - i64::from(e));
    if shift >= 0 {
        left <<= shift as usize;
    } else {
        right <<= (-shift) as usize;
    }
    left.cmp(&right)
}
