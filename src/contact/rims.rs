//! What two faces share where one has many corners: found by rays from a point inside, without a look at most of the corners.
//!
//! A ray leaves each face by an edge found by bisection; the nearer of the two is a border of what they share, and the end
//! of that edge, or where it crosses the other rim, is a corner. Four rays are shot crosswise, some between them, and then some out of
//! the longest sides of what is known. So of two discs of `m` corners `log m` are looked at for each
//! ray, and not all corners of what they share are found: more than are wanted, spread over it.

use core::cmp::Ordering;

use super::MOST_POINTS;
use super::clip::crossing;
use super::corners::{Corners, Location};
use super::shadow::ProjectedFeature;
use crate::num::scalar::sqrt;
use crate::tuning::contact::NEAR;

/// Where the rays of the last frame left the faces of A and of B: the next ones leave nearby.
pub(super) type Rays = [[u32; 2]; 12];

/// A ray that has none before it.
pub(super) const NO_RAYS: Rays = [[u32::MAX; 2]; 12];

type Point2 = [f64; 2];

fn minus(p: Point2, q: Point2) -> Point2 {
    [p[0] - q[0], p[1] - q[1]]
}

fn turn(u: Point2, v: Point2) -> f64 {
    u[0] * v[1] - u[1] * v[0]
}

fn dot(u: Point2, v: Point2) -> f64 {
    u[0] * v[0] + u[1] * v[1]
}

impl ProjectedFeature<'_> {
    /// A point inside the face.
    pub(super) fn middle(&self) -> Point2 {
        let [p, q, r] = [0, self.count / 3, 2 * self.count / 3].map(|k| self.place(k));
        [0, 1].map(|k| (p[k] + q[k] + r[k]) / 3.0)
    }

    /// Whether the face is no wider than `noise`, so that rounding decides where rays leave it. Of a large one a triangle in it tells.
    fn is_sliver(&self, noise: f64) -> bool {
        let count = if self.is_large() { 3 } else { self.count };
        let seen = |k: usize| minus(self.place(k * self.count / count), self.place(0));
        let (mut area, mut reach) = (0.0, 0.0f64);
        for k in 2..count {
            let (p, q) = (seen(k - 1), seen(k));
            area += turn(p, q);
            reach = reach.max(dot(p, p)).max(dot(q, q));
        }
        // Written so that NaN is one.
        !self.is_edge() && !(area.abs() > noise * sqrt(reach))
    }

    /// Where the ray from `from`, inside the face, leaves it: by which edge, and after how many times `way`. A ray that leaves by
    /// the edge `hint` or one beside it is soon told.
    fn exit(&self, from: Point2, way: Point2, hint: usize) -> (f64, usize) {
        let seen = |k: usize| minus(self.place(k), from);
        let leave = |k: usize, p: Point2, q: Point2| {
            let (right, left) = (turn(way, p), turn(way, q));
            let s = if left > right {
                (-right / (left - right)).clamp(0.0, 1.0)
            } else {
                0.5
            };
            let x = [p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])];
            (dot(x, way) / dot(way, way), k)
        };
        // Right of the ray at one end, left of it at the other, and seen from inside.
        let hit = |p: Point2, q: Point2| {
            turn(way, p) <= 0.0 && turn(way, q) >= 0.0 && turn(p, q) > 0.0 && dot(way, q) + dot(way, p) > 0.0
        };
        let near = if hint < self.count { NEAR } else { 0 };
        let mut k = hint.min(self.count - 1);
        let mut p = seen(k);
        let forward = turn(way, p) <= 0.0;
        for _ in 0..near {
            let beside = if forward {
                self.next(k)
            } else if k == 0 {
                self.count - 1
            } else {
                k - 1
            };
            let q = seen(beside);
            if forward && hit(p, q) {
                return leave(k, p, q);
            }
            if !forward && hit(q, p) {
                return leave(beside, q, p);
            }
            (k, p) = (beside, q);
        }
        let k = self.bisect(from, way);
        leave(k, seen(k), seen(self.next(k)))
    }

    /// The edge by which a ray leaves.
    fn bisect(&self, from: Point2, way: Point2) -> usize {
        let seen = |k: usize| minus(self.place(k), from);
        let first = seen(0);
        let ahead = turn(first, way) >= 0.0;
        // Whether, counter-clockwise from the first corner, another comes before the ray.
        let before = |v: Point2| {
            let (half, short) = (turn(first, v) >= 0.0, turn(v, way) >= 0.0);
            if ahead { half && short } else { half || short }
        };
        let (mut low, mut high) = (0, self.count);
        while high - low > 1 {
            let middle = (low + high) / 2;
            if before(seen(middle)) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    /// Whether a place is in the face, seen from one that is; NaN is in.
    pub(super) fn holds(&self, middle: Point2, at: Point2) -> bool {
        !(self.exit(middle, minus(at, middle), usize::MAX).0 < 1.0)
    }
}

/// A point well inside both faces: the hint, or one from the witnesses, which are at zero: towards the middle of a face, or away
/// from both borders.
fn inside(a: &ProjectedFeature, b: &ProjectedFeature, hint: Option<Point2>) -> Option<Point2> {
    let (of_a, of_b) = (a.middle(), b.middle());
    let both = |p: &Point2| a.holds(of_a, *p) && b.holds(of_b, *p);
    if let Some(hint) = hint.filter(both) {
        return Some(hint);
    }
    if let Some(p) = [of_a, of_b].map(|w| [w[0] * 0.5, w[1] * 0.5]).into_iter().find(both) {
        return Some(p);
    }
    let inward = |s: &ProjectedFeature, middle: Point2| {
        let (_, k) = s.exit(middle, [-middle[0], -middle[1]], usize::MAX);
        let u = minus(s.place(s.next(k)), s.place(k));
        let length = sqrt(dot(u, u));
        [-u[1] / length, u[0] / length]
    };
    let (m, n) = (inward(a, of_a), inward(b, of_b));
    let reach = sqrt(dot(of_a, of_a).min(dot(of_b, of_b)));
    let between = [(m[0] + n[0]) * reach, (m[1] + n[1]) * reach];
    let mut part = 1.0;
    for _ in 0..12 {
        let ways = [between, of_a, of_b].map(|w| [w[0] * part, w[1] * part]);
        if let Some(p) = ways.into_iter().find(both) {
            return Some(p);
        }
        part *= 0.5;
    }
    None
}

/// Two faces, and how many rays were shot at them.
pub(super) struct Rims<'a> {
    a: &'a ProjectedFeature<'a>,
    b: &'a ProjectedFeature<'a>,
    rays: &'a mut Rays,
    count: usize,
}

/// Corners of what two faces share, enough to choose `most` from; none of slivers no wider than `noise`. `hint`: a place that may be in
/// the middle of it.
pub(super) fn clip(
    [a, b]: [&ProjectedFeature; 2],
    noise: f64,
    hint: Option<Point2>,
    most: usize,
    rays: &mut Rays,
    corners: &mut Corners,
) {
    if a.is_sliver(noise) || b.is_sliver(noise) {
        return;
    }
    let Some(mut centre) = inside(a, b, hint) else { return };
    let mut rims = Rims { a, b, rays, count: 0 };
    let first = corners.all().len();
    let mut half = [0.0; 2];
    for k in 0..2 {
        let mut ray = |way: f64| {
            let mut axis = [0.0; 2];
            axis[k] = way;
            rims.shoot(centre, axis, corners)
        };
        let (ahead, back) = (ray(1.0), ray(-1.0));
        half[k] = (ahead + back) * 0.5;
        centre[k] += (ahead - back) * 0.5;
    }
    // Between the axes a round or square outline is met before the sum of both; a long one beyond it, and then on both ends.
    for [x, y] in [half, [-half[0], half[1]]] {
        if rims.shoot(centre, [x, y], corners) > 1.0 {
            rims.shoot(centre, [-x, -y], corners);
        }
    }
    let mut tried = [[f64::NAN; 2]; MOST_POINTS / 2];
    for k in 0..most / 2 {
        if corners.all().len() < first + 3 {
            return;
        }
        tried[k] = rims.widen(first, &tried[..k], corners);
    }
}

impl Rims<'_> {
    /// One ray more, out of the middle of the longest side of the corners found that was not `tried` yet; which is told.
    fn widen(&mut self, first: usize, tried: &[Point2], corners: &mut Corners) -> Point2 {
        let found = &mut corners.all_mut()[first..];
        let count = found.len();
        let sum = found.iter().fold([0.0; 2], |s, c| [s[0] + c.at[0], s[1] + c.at[1]]);
        let middle = [sum[0] / count as f64, sum[1] / count as f64];
        // Counter-clockwise from the first.
        let start = minus(found[0].at, middle);
        let half = |p: Point2| turn(start, p) < 0.0 || turn(start, p) == 0.0 && dot(start, p) < 0.0;
        let order = |p: Point2, q: Point2| {
            let (u, v) = (minus(p, middle), minus(q, middle));
            half(u).cmp(&half(v)).then(turn(v, u).total_cmp(&turn(u, v)))
        };
        // By hand: to rounding this is no order, which the sorts of the library may end by a panic.
        for end in 2..count {
            let mut k = end;
            while k > 1 && order(found[k].at, found[k - 1].at) == Ordering::Less {
                found.swap(k, k - 1);
                k -= 1;
            }
        }
        let mut longest = (0.0, [f64::NAN; 2], [0.0; 2]);
        for k in 0..count {
            let (p, q) = (found[k].at, found[(k + 1) % count].at);
            let u = minus(q, p);
            let from = [(p[0] + q[0]) * 0.5, (p[1] + q[1]) * 0.5];
            if dot(u, u) > longest.0 && !tried.contains(&from) {
                longest = (dot(u, u), from, [u[1], -u[0]]);
            }
        }
        let (length, from, way) = longest;
        if length > 0.0 {
            self.shoot(from, way, corners);
        }
        from
    }

    /// The corner at the left end of the border that a ray from inside hits, and that at its right end where the border is one of a
    /// few; after how many times `way` the ray hits it is told.
    fn shoot(&mut self, from: Point2, way: Point2, corners: &mut Corners) -> f64 {
        let (a, b) = (self.a, self.b);
        let before = self.rays.get(self.count).copied().unwrap_or([u32::MAX; 2]);
        let ((far_a, i), (far_b, j)) = (
            a.exit(from, way, before[0] as usize),
            b.exit(from, way, before[1] as usize),
        );
        if let Some(ray) = self.rays.get_mut(self.count) {
            *ray = [i as u32, j as u32];
        }
        self.count += 1;
        if far_a <= far_b {
            for end in ends(a, i) {
                let at = a.place(end);
                match crossed((a, i, end), (b, j), from) {
                    None => corners.push(
                        at,
                        [a.corner(end)[2], b.height_on_face(at)],
                        [Location::corner(end), Location::WHOLE],
                    ),
                    Some(j) => crossing(a, b, i, j, corners),
                };
            }
        } else {
            for end in ends(b, j) {
                let at = b.place(end);
                match crossed((b, j, end), (a, i), from) {
                    None => corners.push(
                        at,
                        [a.height_on_face(at), b.corner(end)[2]],
                        [Location::WHOLE, Location::corner(end)],
                    ),
                    Some(i) => crossing(a, b, i, j, corners),
                };
            }
        }
        far_a.min(far_b)
    }
}

/// The ends of edge `k` that are worth a look.
fn ends(of: &ProjectedFeature, k: usize) -> impl Iterator<Item = usize> {
    let right = (!of.is_large()).then_some(k);
    core::iter::once(of.next(k)).chain(right)
}

/// The edge of the outer face's rim that crosses edge `k` of the inner one between the ray, which leaves the outer face by `start`,
/// and one end of the edge; `None` where that end is in the outer face.
fn crossed(
    (inner, k, end): (&ProjectedFeature, usize, usize),
    (outer, start): (&ProjectedFeature, usize),
    from: Point2,
) -> Option<usize> {
    let (far, last) = outer.exit(from, minus(inner.place(end), from), start);
    if !(far < 1.0) {
        return None;
    }
    let p = inner.place(k);
    let u = minus(inner.place(inner.next(k)), p);
    let m = outer.count;
    // Edge 0 leaves by the ray, the last one by the end; their corners are outside the inner edge, then inside.
    let left = end != k;
    let edge = |n: usize| if left { (start + n) % m } else { (start + m - n) % m };
    let inside = |n: usize| {
        let corner = if left { outer.next(edge(n)) } else { edge(n) };
        turn(u, minus(outer.place(corner), p)) >= 0.0
    };
    let (mut low, mut high) = (
        0,
        if left {
            (last + m - start) % m
        } else {
            (start + m - last) % m
        },
    );
    while low < high {
        let middle = (low + high) / 2;
        if inside(middle) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    Some(edge(low))
}
