//! What two features of few corners share, seen along the normal: the corners of a polygon, the ends of a segment, or a point.
//!
//! A corner is a corner of one feature inside the other, or a crossing of two edges. Both kinds are found from two tables of
//! signs, in which A and B play the same part; corners on the border within rounding belong to both.

use wide::f64x4;

use super::corners::{Corners, On};
use super::shadow::Shadow;
use crate::polyhedron::topology::LARGE;

/// For each edge of one shadow, which corners of the other lie outside it, a bit each.
struct Sides {
    outside: [u32; LARGE],
    /// Outside any edge beyond rounding.
    beyond: u32,
}

impl Sides {
    #[inline(always)]
    fn new(of: &Shadow, corners: &Shadow, noise: f64) -> Self {
        let mut sides = Self {
            outside: [0; LARGE],
            beyond: 0,
        };
        let four = |list: &[f64; LARGE], k: usize| f64x4::new([list[k], list[k + 1], list[k + 2], list[k + 3]]);
        for j in 0..of.count {
            let next = of.next(j);
            let u = [of.x[next] - of.x[j], of.y[next] - of.y[j]];
            let (ux, uy, px, py) = (
                f64x4::splat(u[0]),
                f64x4::splat(u[1]),
                f64x4::splat(of.x[j]),
                f64x4::splat(of.y[j]),
            );
            let margin = f64x4::splat(-noise * (u[0].abs() + u[1].abs()));
            for k in (0..corners.count).step_by(4) {
                let side = ux * (four(&corners.y, k) - py) - uy * (four(&corners.x, k) - px);
                sides.outside[j] |= side.simd_lt(f64x4::ZERO).to_bitmask() << k;
                sides.beyond |= side.simd_lt(margin).to_bitmask() << k;
            }
        }
        sides
    }

    /// Whether the ends of edge `k` of the other shadow are on both sides of the line of edge `j`.
    #[inline(always)]
    fn parts(&self, j: usize, k: usize, next: usize) -> bool {
        (self.outside[j] >> k ^ self.outside[j] >> next) & 1 == 1
    }
}

/// The corners of what two features share, `noise` the rounding of a place.
#[inline(always)]
pub(super) fn clip(a: &Shadow, b: &Shadow, noise: f64, corners: &mut Corners) {
    let all = |s: &Shadow| (1u32 << s.count) - 1;
    let of_b = Sides::new(b, a, noise);
    // An edge has no inside; its two sides would be a line.
    let inside_b = if b.is_edge() { 0 } else { all(a) & !of_b.beyond };
    for i in (0..a.count).filter(|i| inside_b >> i & 1 == 1) {
        let at = [a.x[i], a.y[i]];
        corners.push(at, [a.height[i], b.height_on_face(at)], [On::corner(i), On::WHOLE]);
    }
    let of_a = Sides::new(a, b, noise);
    let inside_a = if a.is_edge() { 0 } else { all(b) & !of_a.beyond };
    for j in (0..b.count).filter(|j| inside_a >> j & 1 == 1) {
        let at = [b.x[j], b.y[j]];
        corners.push(at, [a.height_on_face(at), b.height[j]], [On::WHOLE, On::corner(j)]);
    }
    let edges = |s: &Shadow| if s.is_edge() { 1 } else { s.count };
    for j in 0..edges(b) {
        let outside = of_b.outside[j] & all(a);
        if outside == 0 || outside == all(a) {
            continue;
        }
        for i in 0..edges(a) {
            if of_b.parts(j, i, a.next(i)) && of_a.parts(i, j, b.next(j)) {
                crossing(a, b, i, j, corners);
            }
        }
    }
}

/// Edge `i` of A's shadow and edge `j` of B's, the line of which parts the ends of the other.
pub(super) fn crossing(a: &Shadow, b: &Shadow, i: usize, j: usize, corners: &mut Corners) {
    let (p, q) = (a.corner(i), a.corner(a.next(i)));
    let (r, s) = (b.corner(j), b.corner(b.next(j)));
    let side = |x: &[f64; 3]| (s[0] - r[0]) * (x[1] - r[1]) - (s[1] - r[1]) * (x[0] - r[0]);
    let (from, to) = (side(&p), side(&q));
    // One of the two is negative and the other is not; a place that rounding hides is the middle.
    let t = from / (from - to);
    let t = if (0.0..=1.0).contains(&t) { t } else { 0.5 };
    let at = [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])];
    let heights = [p[2] + t * (q[2] - p[2]), b.height_on_edge(j, at)];
    corners.push(at, heights, [On::edge(i), On::edge(j)]);
}

/// The ends of what two nearly parallel edges share, each end across from its foot on the other edge. Nothing for edges that
/// are not: then they cross at the witnesses.
pub(super) fn beside(a: &Shadow, b: &Shadow, sine: f64, corners: &mut Corners) {
    let direction = |s: &Shadow| [s.x[1] - s.x[0], s.y[1] - s.y[0]];
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
                    corners.push(at, [of.height[k], foot], [On::corner(k), On::WHOLE]);
                } else {
                    corners.push(at, [foot, of.height[k]], [On::WHOLE, On::corner(k)]);
                }
            }
        }
    }
}
