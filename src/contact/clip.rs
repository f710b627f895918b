//! What two features of few corners share, seen along the normal: the corners of a polygon, the ends of a segment, or a point.
//!
//! A corner is a corner of one feature inside the other, or a crossing of two edges. Both kinds are found from two tables of
//! signs, in which A and B play the same part; corners on the border within rounding belong to both.

use wide::f64x4;

use super::corners::{Corners, Location};
use super::shadow::ProjectedFeature;
use crate::tuning::polyhedron::LARGE;

/// For each edge of one shadow, which corners of the other lie outside it, a bit each.
struct Sides {
    outside: [u32; LARGE],
    /// Outside any edge, or past the last corner, beyond rounding.
    beyond: u32,
}

impl Sides {
    #[inline(always)]
    fn new(of: &ProjectedFeature, corners: &ProjectedFeature, noise: f64) -> Self {
        let mut sides = Self {
            outside: [0; LARGE],
            beyond: 0,
        };
        let fours = corners.count.div_ceil(4);
        let xs = || corners.x.as_chunks::<4>().0[..fours].iter();
        let ys = || corners.y.as_chunks::<4>().0[..fours].iter();
        for j in 0..of.count {
            let next = of.next(j);
            let u = [of.x[next] - of.x[j], of.y[next] - of.y[j]];
            let (ux, uy) = (f64x4::splat(u[0]), f64x4::splat(u[1]));
            let line = f64x4::splat(u[0] * of.y[j] - u[1] * of.x[j]);
            let margin = line - f64x4::splat(noise * (u[0].abs() + u[1].abs()));
            let (mut outside, mut beyond) = (0, 0);
            for (k, (x, y)) in xs().zip(ys()).enumerate() {
                let side = ux * f64x4::new(*y) - uy * f64x4::new(*x);
                outside |= side.simd_lt(line).to_bitmask() << (4 * k);
                beyond |= side.simd_lt(margin).to_bitmask() << (4 * k);
            }
            sides.outside[j] = outside;
            sides.beyond |= beyond;
        }
        let [[left, right], [low, high]] = of.span();
        let (left, right) = (f64x4::splat(left - noise), f64x4::splat(right + noise));
        let (low, high) = (f64x4::splat(low - noise), f64x4::splat(high + noise));
        for (k, (x, y)) in xs().zip(ys()).enumerate() {
            let (x, y) = (f64x4::new(*x), f64x4::new(*y));
            let past = x.simd_lt(left) | x.simd_gt(right) | y.simd_lt(low) | y.simd_gt(high);
            sides.beyond |= past.to_bitmask() << (4 * k);
        }
        sides
    }

    /// The edges of the other shadow whose ends are on both sides of the line of edge `j`, a bit each.
    #[inline(always)]
    fn parted(&self, j: usize, other: &ProjectedFeature) -> u32 {
        let here = self.outside[j] & all(other);
        // An edge has two corners and is one edge.
        if other.is_edge() {
            return (here ^ here >> 1) & 1;
        }
        let next = here >> 1 | (here & 1) << (other.count - 1);
        here ^ next
    }
}

/// A bit for each corner.
#[inline(always)]
fn all(s: &ProjectedFeature) -> u32 {
    (1 << s.count) - 1
}

/// The numbers of the bits set.
#[inline(always)]
fn each(mut bits: u32, mut f: impl FnMut(usize)) {
    while bits != 0 {
        f(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}

/// The corners of what two features share, `noise` the rounding of a place.
#[inline(always)]
pub(super) fn clip(a: &ProjectedFeature, b: &ProjectedFeature, noise: f64, corners: &mut Corners) {
    let of_b = Sides::new(b, a, noise);
    // An edge has no inside; its two sides would be a line.
    let inside_b = if b.is_edge() { 0 } else { all(a) & !of_b.beyond };
    each(inside_b, |i| {
        let at = [a.x[i], a.y[i]];
        corners.push(
            at,
            [a.corner(i)[2], b.height_on_face(at)],
            [Location::corner(i), Location::WHOLE],
        );
    });
    let of_a = Sides::new(a, b, noise);
    let inside_a = if a.is_edge() { 0 } else { all(b) & !of_a.beyond };
    each(inside_a, |j| {
        let at = [b.x[j], b.y[j]];
        corners.push(
            at,
            [a.height_on_face(at), b.corner(j)[2]],
            [Location::WHOLE, Location::corner(j)],
        );
    });
    let edges = if b.is_edge() { 1 } else { b.count };
    for j in 0..edges {
        each(of_b.parted(j, a), |i| {
            if of_a.parted(i, b) >> j & 1 == 1 {
                crossing(a, b, i, j, corners);
            }
        });
    }
}

/// Point2 and height of the end of an edge.
pub(super) type End = [f64; 3];

/// Where two edges cross: the place, how far along each it is, and the heights there.
pub(super) struct Crossing {
    pub(super) at: [f64; 2],
    pub(super) along: [f64; 2],
    pub(super) heights: [f64; 2],
}

/// Where an edge of A meets an edge of B, the line of which parts its ends.
#[inline(always)]
pub(super) fn meet([p, q]: &[End; 2], [r, s]: &[End; 2]) -> Crossing {
    let (u, v) = ([q[0] - p[0], q[1] - p[1]], [s[0] - r[0], s[1] - r[1]]);
    let side = |x: &End| v[0] * (x[1] - r[1]) - v[1] * (x[0] - r[0]);
    let (from, to) = (side(p), side(q));
    // One of the two is negative and the other is not; a place that rounding hides is the middle.
    let t = from / (from - to);
    let t = if (0.0..=1.0).contains(&t) { t } else { 0.5 };
    let at = [p[0] + t * u[0], p[1] + t * u[1]];
    let along = ((at[0] - r[0]) * v[0] + (at[1] - r[1]) * v[1]) / (v[0] * v[0] + v[1] * v[1]);
    let along = if along > 0.0 { along.min(1.0) } else { 0.0 };
    Crossing {
        at,
        along: [t, along],
        heights: [p[2] + t * (q[2] - p[2]), r[2] + along * (s[2] - r[2])],
    }
}

/// Whether two edges cross: each parts the ends of the other.
#[inline(always)]
pub(super) fn cross([p, q]: &[End; 2], [r, s]: &[End; 2]) -> bool {
    let left = |p: &End, q: &End, x: &End| (q[0] - p[0]) * (x[1] - p[1]) >= (q[1] - p[1]) * (x[0] - p[0]);
    left(r, s, p) != left(r, s, q) && left(p, q, r) != left(p, q, s)
}

/// Edge `i` of A's shadow and edge `j` of B's, the line of which parts the ends of the other.
#[inline(always)]
pub(super) fn crossing(a: &ProjectedFeature, b: &ProjectedFeature, i: usize, j: usize, corners: &mut Corners) -> bool {
    let Crossing { at, heights, .. } = meet(&a.ends(i), &b.ends(j));
    corners.push(at, heights, [Location::edge(i), Location::edge(j)])
}

/// The ends of what two nearly parallel edges share, each end across from its foot on the other edge. Nothing for edges that
/// are not: then they cross at the witnesses.
pub(super) fn beside(a: &ProjectedFeature, b: &ProjectedFeature, sine: f64, corners: &mut Corners) {
    let direction = |s: &ProjectedFeature| [s.x[1] - s.x[0], s.y[1] - s.y[0]];
    let (u, v) = (direction(a), direction(b));
    let squared = |d: [f64; 2]| d[0] * d[0] + d[1] * d[1];
    let turn = u[0] * v[1] - u[1] * v[0];
    if turn * turn > sine * sine * squared(u) * squared(v) {
        return;
    }
    for k in 0..2 {
        for (of, to, is_a) in [(a, b, true), (b, a, false)] {
            let at = [of.x[k], of.y[k]];
            let t = to.along(0, at);
            if t > 0.0 && t < 1.0 {
                let foot = to.height_on_edge(0, at);
                if is_a {
                    corners.push(at, [of.corner(k)[2], foot], [Location::corner(k), Location::WHOLE]);
                } else {
                    corners.push(at, [foot, of.corner(k)[2]], [Location::WHOLE, Location::corner(k)]);
                }
            }
        }
    }
}
