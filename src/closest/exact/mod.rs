//! The exact rung: class and distance over the rationals, for what no floating-point arithmetic decides.
//!
//! Both bodies are placed in the world, relative to A's origin, as integers over one denominator `D = |qa|^2 |qb|^2`
//! times a power of two, from the bits of vertices and poses. The minimum-norm search of `fallback` runs on them with
//! exact signs, from the features that floating point ended on, so it takes a step or two. Supports are filtered: only
//! vertices within the rounding of the highest are placed exactly.

mod depth;
mod integer;
mod origin;
mod simplex;

use alloc::vec;
use alloc::vec::Vec;

use dashu_base::UnsignedAbs;
use dashu_int::IBig;
use nalgebra::{Matrix3, Point3};

use super::outcome::{Class, Layer, Outcome};
use super::placed::Placed;
use super::refine;
use crate::polyhedron::ConvexPolyhedron;
use crate::pose::RelativePose;
use crate::tolerance::EXACT_FILTER;
pub(crate) use depth::deepest;
use integer::{Big3, direction, dot, fraction, integer, is_zero, lowest_bit, neg, root, sub};
use origin::{Origin, Set, locate};
use simplex::{Corner, Nearest, minimize};

/// One body turned, over the common denominator.
struct Turned<'a> {
    body: &'a ConvexPolyhedron,
    matrix: [Big3; 3],
    /// The same matrix in f64, transposed use only: world directions into the body.
    rounded: Matrix3<f64>,
}

/// Both bodies over `D 2^-e`.
struct Pair<'a> {
    a: Turned<'a>,
    b: Turned<'a>,
    /// B's place relative to A's.
    offset: Big3,
    denominator: IBig,
    exponent: i32,
}

/// `R(q) |q|^2` and `|q|^2` for the integer quaternion that is a multiple of `q`.
fn turn(q: &[f64; 4]) -> ([Big3; 3], IBig) {
    let e = lowest_bit(*q).unwrap_or(0);
    let [x, y, z, w] = q.map(|c| integer(c, e));
    let (xx, yy, zz, ww) = (&x * &x, &y * &y, &z * &z, &w * &w);
    let two = |x: IBig| x << 1;
    let rows = [
        [&ww + &xx - &yy - &zz, two(&x * &y - &w * &z), two(&x * &z + &w * &y)],
        [two(&x * &y + &w * &z), &ww - &xx + &yy - &zz, two(&y * &z - &w * &x)],
        [two(&x * &z - &w * &y), two(&y * &z + &w * &x), &ww - &xx - &yy + &zz],
    ];
    (rows, ww + xx + yy + zz)
}

impl<'a> Turned<'a> {
    fn new(body: &'a ConvexPolyhedron, q: &[f64; 4], rows: [Big3; 3], factor: &IBig) -> Self {
        let [x, y, z, w] = *q;
        let unit = nalgebra::UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, x, y, z));
        let matrix = rows.map(|row| row.map(|m| m * factor));
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

    fn given(&self, v: u32, exponent: i32) -> Big3 {
        let p = self.body.given(&self.body.points[v as usize]);
        [p.x, p.y, p.z].map(|c| integer(c, exponent))
    }

    /// Vertex `v`, turned.
    fn point(&self, v: u32, exponent: i32) -> Big3 {
        self.vector(&self.given(v, exponent))
    }

    /// The vertex greatest along `n`; the lowest number among exact equals.
    fn highest(&self, n: &Big3, hint: u32, exponent: i32) -> u32 {
        let local = self.rounded.tr_mul(&direction(n));
        let slack = EXACT_FILTER * local.abs().sum() * self.body.radius;
        let mut best: Option<(IBig, u32)> = None;
        self.body.extremes(&local, hint, slack, |v, _| {
            let height = dot(n, &self.point(v, exponent));
            if best
                .as_ref()
                .is_none_or(|(top, u)| height > *top || (height == *top && v < *u))
            {
                best = Some((height, v));
            }
        });
        best.map_or(hint, |(_, v)| v)
    }

    /// The edges that leave `v`, turned.
    fn edges(&self, v: u32, exponent: i32) -> Vec<Big3> {
        let from = self.point(v, exponent);
        let neighbours = self.body.topology.neighbours(v);
        neighbours.map(|w| sub(&self.point(w, exponent), &from)).collect()
    }
}

impl<'a> Pair<'a> {
    fn new(a: &'a ConvexPolyhedron, b: &'a ConvexPolyhedron, pose: &RelativePose) -> Self {
        let ((rows_a, na), (rows_b, nb)) = (turn(&pose.a.q), turn(&pose.b.q));
        let given = |body: &'a ConvexPolyhedron| body.points.iter().flat_map(|p| body.given(p).coords.data.0[0]);
        let translations = pose.a.t.into_iter().chain(pose.b.t);
        let exponent = lowest_bit(given(a).chain(given(b)).chain(translations)).unwrap_or(0);
        let denominator = &na * &nb;
        let offset =
            [0, 1, 2].map(|k| (integer(pose.b.t[k], exponent) - integer(pose.a.t[k], exponent)) * &denominator);
        Self {
            a: Turned::new(a, &pose.a.q, rows_a, &nb),
            b: Turned::new(b, &pose.b.q, rows_b, &na),
            offset,
            denominator,
            exponent,
        }
    }

    /// The point `a - b` of the difference.
    fn corner(&self, a: u32, b: u32) -> Corner {
        let (p, q) = (self.a.point(a, self.exponent), self.b.point(b, self.exponent));
        Corner {
            a,
            b,
            w: sub(&sub(&p, &q), &self.offset),
        }
    }

    /// The corner greatest along `n`.
    fn highest(&self, n: &Big3, hint: (u32, u32)) -> Corner {
        let a = self.a.highest(n, hint.0, self.exponent);
        let b = self.b.highest(&neg(n), hint.1, self.exponent);
        self.corner(a, b)
    }

    fn nearest(&self, hint: (u32, u32)) -> Option<Nearest> {
        minimize(vec![self.corner(hint.0, hint.1)], &|n| self.highest(&neg(n), hint))
    }

    /// Where the origin lies in the difference, which holds it at `at`.
    fn locate(&self, at: &Nearest, hint: (u32, u32)) -> Origin {
        let edges = |c: &Corner| {
            let mut edges = self.a.edges(c.a, self.exponent);
            edges.extend(self.b.edges(c.b, self.exponent).iter().map(neg));
            edges
        };
        locate(
            &Set {
                highest: &|n| self.highest(n, hint),
                edges: &edges,
            },
            at,
        )
    }
}

/// Settles class and distance exactly, from the vertices of the outcome's features.
pub(crate) fn settle(placed: &Placed, outcome: &mut Outcome) {
    let hint = outcome.features.vertices_of(placed.a, placed.b);
    let pair = Pair::new(placed.a, placed.b, placed.pose);
    // One to four corners always have a nearest point.
    let Some(at) = pair.nearest(hint) else {
        return refine::give_up(placed, outcome);
    };
    let (mut a, mut b) = ([0; 4], [0; 4]);
    for (k, c) in at.kept.iter().enumerate().take(4) {
        (a[k], b[k]) = (c.a, c.b);
    }
    outcome.layer = Layer::Exact;
    outcome.features = refine::state_of(placed, &a[..at.kept.len()], &b[..at.kept.len()]);
    (outcome.point_on_a, outcome.point_on_b) = witnesses(&pair, &at);
    let normal = |n: &Big3| refine::unit(&pair.a.rounded.tr_mul(&direction(n)));
    if !is_zero(&at.direction) {
        let d = distance(&pair, &at) / placed.a.unit();
        outcome.class = Class::Separated;
        outcome.distance = d;
        outcome.normal = normal(&neg(&at.direction));
        // Zero where f64 ends.
        (outcome.lower, outcome.upper) = (d.next_down().max(0.0), d.next_up());
        return;
    }
    match pair.locate(&at, hint) {
        // A - B lies below the normal, A behind and B in front: it points from A to B.
        Origin::Boundary(n) => {
            outcome.class = Class::Touching;
            outcome.distance = 0.0;
            outcome.normal = normal(&n);
            (outcome.lower, outcome.upper) = (0.0, 0.0);
        }
        Origin::Interior => refine::overlapping(outcome),
    }
}

/// The distance in the caller's units, correctly rounded.
fn distance(pair: &Pair, at: &Nearest) -> f64 {
    let (num, den) = at.squared();
    let den = den * &pair.denominator * &pair.denominator;
    root(&num.unsigned_abs(), &den.unsigned_abs(), pair.exponent)
}

/// Of two bodies of which it is known that they do not overlap: whether they are apart, and their distance in the
/// caller's units, correctly rounded (which may be zero).
pub(crate) fn separation(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    pose: &RelativePose,
    hint: (u32, u32),
) -> Option<(bool, f64)> {
    let pair = Pair::new(a, b, pose);
    let at = pair.nearest(hint)?;
    Some((!is_zero(&at.direction), distance(&pair, &at)))
}

/// The convex combinations of the corners' vertices in stored coordinates, rounded.
fn witnesses(pair: &Pair, at: &Nearest) -> (Point3<f64>, Point3<f64>) {
    let (mut on_a, mut on_b) = (Point3::origin(), Point3::origin());
    for (c, weight) in at.kept.iter().zip(&at.weights) {
        let s = fraction(weight, &at.sum);
        on_a += pair.a.body.points[c.a as usize] * s;
        on_b += pair.b.body.points[c.b as usize] * s;
    }
    (on_a, on_b)
}

/// Whether the closed bodies are at most `d` apart, exactly; `d` is not negative.
pub(crate) fn within(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    pose: &RelativePose,
    hint: (u32, u32),
    d: f64,
) -> bool {
    let pair = Pair::new(a, b, pose);
    let Some(at) = pair.nearest(hint) else { return true };
    if is_zero(&at.direction) || d == f64::INFINITY {
        return true;
    }
    let Some(e) = lowest_bit([d]) else { return false };
    // s^2 = num / (den D^2) 4^exponent against d^2 = m^2 4^e.
    let (num, den) = at.squared();
    let m = integer(d, e);
    let (mut left, mut right) = (num, den * &pair.denominator * &pair.denominator * &m * &m);
    let shift = 2 * (i64::from(pair.exponent) - i64::from(e));
    if shift >= 0 {
        left <<= shift as usize;
    } else {
        right <<= (-shift) as usize;
    }
    left <= right
}
