//! What two faces share where one has many corners: found by rays from a point inside, without a look at most of the corners.
//!
//! A ray leaves each face by an edge found by bisection; the nearer of the two is a border of what they share, and the end
//! of that edge, or where it crosses the other rim, is a corner. Four rays are shot crosswise, and then one out of the longest
//! side of what is known, as long as it gains much. So of two discs of `m` corners `log m` are looked at for each ray, and
//! not all corners of what they share are found: the area is within a small part of that of the best few points.

use super::clip::crossing;
use super::corners::{Corners, On};
use super::shadow::Shadow;

/// Rays after the first four.
const MORE: usize = 6;

/// A ray that adds less than this part of the area is the last.
const GAIN: f64 = 0.2;

type Place = [f64; 2];

fn minus(p: Place, q: Place) -> Place {
    [p[0] - q[0], p[1] - q[1]]
}

fn turn(u: Place, v: Place) -> f64 {
    u[0] * v[1] - u[1] * v[0]
}

fn dot(u: Place, v: Place) -> f64 {
    u[0] * v[0] + u[1] * v[1]
}

fn place(corner: [f64; 3]) -> Place {
    [corner[0], corner[1]]
}

impl Shadow<'_> {
    /// A point inside the face.
    fn middle(&self) -> Place {
        let [p, q, r] = [0, self.count / 3, 2 * self.count / 3].map(|k| self.corner(k));
        [0, 1].map(|k| (p[k] + q[k] + r[k]) / 3.0)
    }

    /// Where the ray from `from`, inside the face, leaves it: by which edge, and after how many times `way`.
    fn exit(&self, from: Place, way: Place) -> (f64, usize) {
        let seen = |k: usize| minus(place(self.corner(k)), from);
        let first = seen(0);
        let ahead = turn(first, way) >= 0.0;
        // Whether, counter-clockwise from the first corner, another comes before the ray.
        let before = |v: Place| {
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
        let (p, q) = (seen(low), seen(self.next(low)));
        let (right, left) = (turn(way, p), turn(way, q));
        let s = if left > right {
            (-right / (left - right)).clamp(0.0, 1.0)
        } else {
            0.5
        };
        let x = [p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])];
        (dot(x, way) / dot(way, way), low)
    }

    /// Whether a place is in the face, seen from one that is; NaN is in.
    fn holds(&self, middle: Place, at: Place) -> bool {
        !(self.exit(middle, minus(at, middle)).0 < 1.0)
    }
}

/// A point well inside both faces: the hint, or one from the witnesses, which are at zero, towards the middles.
fn inside(a: &Shadow, b: &Shadow, hint: Option<Place>) -> Option<Place> {
    let (of_a, of_b) = (a.middle(), b.middle());
    let both = |p: &Place| a.holds(of_a, *p) && b.holds(of_b, *p);
    if let Some(hint) = hint.filter(both) {
        return Some(hint);
    }
    let long = |u: Place| dot(u, u);
    let between = {
        let (la, lb) = (crate::scalar::sqrt(long(of_a)), crate::scalar::sqrt(long(of_b)));
        let least = la.min(lb);
        // Both directions with the same weight.
        [0, 1].map(|k| (of_a[k] / la + of_b[k] / lb) * 0.5 * least)
    };
    let mut part = 1.0;
    for _ in 0..8 {
        let ways = [of_a, of_b, between].map(|w| [w[0] * part, w[1] * part]);
        if let Some(p) = ways.into_iter().find(both) {
            return Some(p);
        }
        part *= 0.5;
    }
    None
}

/// Corners of what two faces share.
pub(super) fn clip(a: &Shadow, b: &Shadow, hint: Option<Place>, corners: &mut Corners) {
    let Some(centre) = inside(a, b, hint) else { return };
    let first = corners.all().len();
    for way in [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]] {
        shoot(a, b, centre, way, corners);
    }
    for _ in 0..MORE {
        if corners.all().len() < first + 3 || !widen(a, b, first, corners) {
            return;
        }
    }
}

/// One ray more, out of the middle of the longest side of the corners found; whether it gained much.
fn widen(a: &Shadow, b: &Shadow, first: usize, corners: &mut Corners) -> bool {
    let found = &mut corners.all_mut()[first..];
    let count = found.len();
    let middle = {
        let sum = found.iter().fold([0.0; 2], |s, c| [s[0] + c.at[0], s[1] + c.at[1]]);
        [sum[0] / count as f64, sum[1] / count as f64]
    };
    // Counter-clockwise from the first.
    let start = minus(found[0].at, middle);
    let half = |p: Place| turn(start, p) < 0.0 || turn(start, p) == 0.0 && dot(start, p) < 0.0;
    found[1..].sort_unstable_by(|c, d| {
        let (u, v) = (minus(c.at, middle), minus(d.at, middle));
        half(u).cmp(&half(v)).then(turn(v, u).total_cmp(&turn(u, v)))
    });
    let side = |k: usize| (found[k].at, found[(k + 1) % count].at);
    let long = |k: usize| {
        let (p, q) = side(k);
        dot(minus(q, p), minus(q, p))
    };
    let area: f64 = (0..count)
        .map(|k| turn(minus(side(k).0, middle), minus(side(k).1, middle)))
        .sum();
    let longest = (1..count).fold(0, |best, k| if long(k) > long(best) { k } else { best });
    let (p, q) = side(longest);
    let u = minus(q, p);
    let from = [(p[0] + q[0]) * 0.5, (p[1] + q[1]) * 0.5];
    shoot(a, b, from, [u[1], -u[0]], corners);
    let Some(new) = corners.all()[first..].get(count) else {
        return false;
    };
    turn(u, minus(new.at, p)) < -GAIN * area
}

/// The corner at the left end of the border that a ray from inside hits.
fn shoot(a: &Shadow, b: &Shadow, from: Place, way: Place, corners: &mut Corners) {
    let ((far_a, i), (far_b, j)) = (a.exit(from, way), b.exit(from, way));
    if far_a <= far_b {
        let end = a.next(i);
        let at = place(a.corner(end));
        match crossed(a, i, b, j, from, at) {
            None => corners.push(
                at,
                [a.corner(end)[2], b.height_on_face(at)],
                [On::corner(end), On::WHOLE],
            ),
            Some(j) => crossing(a, b, i, j, corners),
        }
    } else {
        let end = b.next(j);
        let at = place(b.corner(end));
        match crossed(b, j, a, i, from, at) {
            None => corners.push(
                at,
                [a.height_on_face(at), b.corner(end)[2]],
                [On::WHOLE, On::corner(end)],
            ),
            Some(i) => crossing(a, b, i, j, corners),
        }
    }
}

/// The edge of the outer face's rim that crosses edge `k` of the inner one between the ray, which leaves the outer face by
/// `start`, and the end of the edge; `None` where that end is in the outer face.
fn crossed(inner: &Shadow, k: usize, outer: &Shadow, start: usize, from: Place, end: Place) -> Option<usize> {
    let (far, last) = outer.exit(from, minus(end, from));
    if !(far < 1.0) {
        return None;
    }
    let p = place(inner.corner(k));
    let u = minus(end, p);
    let m = outer.count;
    // Corners of the outer rim from the ray on are outside the edge, then inside.
    let crossed = |k: usize| turn(u, minus(place(outer.corner((start + k) % m)), p)) >= 0.0;
    let (mut low, mut high) = (0, (last + m - start) % m + 1);
    while high - low > 1 {
        let middle = (low + high) / 2;
        if crossed(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    Some((start + low) % m)
}
