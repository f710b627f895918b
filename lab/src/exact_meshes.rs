//! The naive exact oracle of meshes: least distances over all pairs of triangles, over the integers.
//!
//! Two triangles share a point if an edge of one passes through the other; else they are closest at one of the fifteen pairs of a
//! vertex and a face or of two edges, or where these end. Floating point chooses the pairs that may be the closest, by a margin
//! that is far more than its error.

use crate::brute::{self, Triangle};
use crate::pose::norm;
use crate::rational::{self, IntVec, common, cross, dot, exact, placed, sub};
use crate::soups::Soup;
use crate::{Point, Pose};
use dashu::integer::IBig;
use dashu::rational::RBig;

/// A square of a length as numerator and positive denominator.
type Square = (IBig, IBig);

fn less(a: Square, b: Square) -> Square {
    if &a.0 * &b.1 <= &b.0 * &a.1 { a } else { b }
}

/// A point and an edge, which may be a point.
fn to_edge(p: &IntVec, a: &IntVec, b: &IntVec) -> Square {
    let (u, w) = (sub(b, a), sub(p, a));
    let (along, length) = (dot(&u, &w), dot(&u, &u));
    if along <= IBig::ZERO {
        (dot(&w, &w), IBig::ONE)
    } else if along >= length {
        let w = sub(p, b);
        (dot(&w, &w), IBig::ONE)
    } else {
        let off = cross(&u, &w);
        (dot(&off, &off), length)
    }
}

fn normal([a, b, c]: &[IntVec; 3]) -> IntVec {
    cross(&sub(b, a), &sub(c, a))
}

/// A point over the inside of a triangle that has an area.
fn to_face(p: &IntVec, t: &[IntVec; 3], n: &IntVec) -> Option<Square> {
    let square = dot(n, n);
    let over = (0..3).all(|i| dot(&cross(n, &sub(&t[(i + 1) % 3], &t[i])), &sub(p, &t[i])) >= IBig::ZERO);
    (square > IBig::ZERO && over).then(|| {
        let height = dot(n, &sub(p, &t[0]));
        (&height * &height, square)
    })
}

/// Two edges whose lines are closest within both.
fn edges([a, b]: [&IntVec; 2], [c, d]: [&IntVec; 2]) -> Option<Square> {
    let (u, v, w) = (sub(b, a), sub(d, c), sub(c, a));
    let n = cross(&u, &v);
    let (square, s, t) = (dot(&n, &n), dot(&cross(&w, &v), &n), dot(&cross(&w, &u), &n));
    let inside = |x: &IBig| *x >= IBig::ZERO && *x <= square;
    let height = dot(&w, &n);
    (square > IBig::ZERO && inside(&s) && inside(&t)).then(|| (&height * &height, square))
}

/// Whether a segment whose ends lie on different sides of a triangle passes through it.
fn passes(p: &IntVec, q: &IntVec, t: &[IntVec; 3], n: &IntVec) -> bool {
    let (h, k) = (dot(n, &sub(p, &t[0])), dot(n, &sub(q, &t[0])));
    let differs = h > IBig::ZERO && k < IBig::ZERO || h < IBig::ZERO && k > IBig::ZERO;
    if !differs {
        return false;
    }
    let way = sub(q, p);
    let turns = [0, 1, 2].map(|i| dot(&cross(&sub(&t[i], p), &sub(&t[(i + 1) % 3], p)), &way));
    turns.iter().all(|x| *x >= IBig::ZERO) || turns.iter().all(|x| *x <= IBig::ZERO)
}

/// The squared distance of two triangles, which may have no area.
fn squared(x: &[IntVec; 3], y: &[IntVec; 3]) -> Square {
    let mut best: Option<Square> = None;
    let mut offer = |s: Square| best = Some(best.take().map_or(s.clone(), |b| less(b, s)));
    for (p, q) in [(x, y), (y, x)] {
        let n = normal(q);
        for i in 0..3 {
            if passes(&p[i], &p[(i + 1) % 3], q, &n) {
                return (IBig::ZERO, IBig::ONE);
            }
            to_face(&p[i], q, &n).into_iter().for_each(&mut offer);
            (0..3).for_each(|j| offer(to_edge(&p[i], &q[j], &q[(j + 1) % 3])));
        }
    }
    for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
        let found = edges([&x[i], &x[(i + 1) % 3]], [&y[j], &y[(j + 1) % 3]]);
        found.into_iter().for_each(&mut offer);
    }
    best.expect("triangles have corners")
}

/// The squared distance of two triangles, the second at a pose.
pub fn square(p: &Triangle, q: &Triangle, pose: &Pose) -> RBig {
    let (x, y, den) = common(&placed(p, &Pose::IDENTITY), &placed(q, pose));
    let (x, y) = (x.try_into().expect("three"), y.try_into().expect("three"));
    let (square, below) = squared(&x, &y);
    let den = IBig::from(den);
    RBig::from_parts_signed(square, below * &den * &den)
}

/// A ball about a triangle.
fn ball(t: &Triangle) -> (Point, f64) {
    let middle = [0, 1, 2].map(|k| (t[0][k] + t[1][k] + t[2][k]) / 3.0);
    let radius = t.iter().map(|x| norm(crate::pose::sub(*x, middle)));
    (middle, radius.fold(0.0, f64::max))
}

/// The distance in floating point, also of triangles that are points.
fn estimate(p: &Triangle, q: &Triangle) -> f64 {
    let corners = p
        .iter()
        .flat_map(|x| q.iter().map(move |y| norm(crate::pose::sub(*x, *y))));
    corners.fold(brute::triangles(p, q), f64::min)
}

/// The least of all squares, and its pair.
fn least(
    p: &[Triangle],
    q: &[Triangle],
    is_asked: impl Fn(usize, usize) -> bool,
    square: impl Fn([usize; 2]) -> RBig,
) -> Option<(RBig, [usize; 2])> {
    let balls = |all: &[Triangle]| all.iter().map(ball).collect::<Vec<_>>();
    let (of_p, of_q) = (balls(p), balls(q));
    let size = of_p.iter().chain(&of_q).fold(0.0, |m: f64, (c, r)| m.max(norm(*c) + r));
    let margin = 1e-9 * size;
    let (mut reach, mut is_known) = (f64::INFINITY, false);
    loop {
        let mut found = Vec::new();
        for (i, (c, r)) in of_p.iter().enumerate() {
            for (j, (d, s)) in of_q.iter().enumerate() {
                if norm(crate::pose::sub(*d, *c)) - r - s > reach + margin || !is_asked(i, j) {
                    continue;
                }
                let distance = estimate(&p[i], &q[j]);
                if !is_known {
                    reach = reach.min(distance);
                }
                found.push((distance, [i, j]));
            }
        }
        found.retain(|(distance, _)| *distance <= reach + margin);
        let best = least_of(found.into_iter().map(|f| f.1), &square)?;
        let root = rational::sqrt(&best.0).0;
        if is_known || root <= reach + margin {
            return Some(best);
        }
        // Floating point has gone wrong, as it may for triangles in one plane, or nearly segments.
        (reach, is_known) = (root, true);
    }
}

fn corners(soup: &Soup) -> Vec<Triangle> {
    (0..soup.triangles.len()).map(|t| soup.corners(t)).collect()
}

/// The least squared distance of two meshes, and two triangles that have it.
pub fn apart(a: &Soup, b: &Soup, a_from_b: &Pose) -> (RBig, [usize; 2]) {
    let (p, q) = (corners(a), corners(b));
    let there: Vec<Triangle> = q.iter().map(|t| t.map(|x| a_from_b.apply(x))).collect();
    let square = |[i, j]: [usize; 2]| square(&p[i], &q[j], a_from_b);
    least(&p, &there, |_, _| true, square).expect("meshes have triangles")
}

/// The least squared distance of two triangles of a mesh that share no vertex, and such two.
pub fn itself(soup: &Soup) -> Option<(RBig, [usize; 2])> {
    let p = corners(soup);
    let square = |[i, j]: [usize; 2]| square(&p[i], &p[j], &Pose::IDENTITY);
    least(&p, &p, |i, j| i < j && !share(soup, i, j), square)
}

/// All pairs of triangles of a mesh that share no vertex and are at most `d` apart, the lower number first.
pub fn pairs_within(soup: &Soup, d: f64) -> Vec<[usize; 2]> {
    let (p, most) = (corners(soup), exact(d));
    let most = &most * &most;
    let size = p.iter().map(ball).fold(0.0, |m: f64, (c, r)| m.max(norm(c) + r));
    let mut found = Vec::new();
    for i in 0..p.len() {
        for j in (i + 1..p.len()).filter(|&j| !share(soup, i, j)) {
            let ((c, r), (e, s)) = (ball(&p[i]), ball(&p[j]));
            if norm(crate::pose::sub(e, c)) - r - s > d + 1e-9 * size {
                continue;
            }
            // Floating point may take triangles in one plane for crossing ones.
            let distance = estimate(&p[i], &p[j]);
            if distance <= d + 1e-9 * size && square(&p[i], &p[j], &Pose::IDENTITY) <= most {
                found.push([i, j]);
            }
        }
    }
    found
}

fn share(soup: &Soup, i: usize, j: usize) -> bool {
    let (p, q) = (soup.triangles[i], soup.triangles[j]);
    p.iter().any(|v| q.contains(v))
}

fn least_of(
    candidates: impl Iterator<Item = [usize; 2]>,
    square: impl Fn([usize; 2]) -> RBig,
) -> Option<(RBig, [usize; 2])> {
    let mut best: Option<(RBig, [usize; 2])> = None;
    for pair in candidates {
        let found = square(pair);
        if found == RBig::ZERO {
            return Some((found, pair));
        }
        if best.as_ref().is_none_or(|b| found < b.0) {
            best = Some((found, pair));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rational::{rounded, sqrt};
    use crate::rng::Rng;

    /// On a lattice, and in general position, exact squares are those of floating point by other formulas.
    #[test]
    fn squares_are_those_of_floating_point() {
        let mut rng = Rng::new(5);
        let mut zeros = 0;
        for k in 0..4_000 {
            let mut coordinate = || match k % 2 {
                0 => rng.below(4) as f64,
                _ => rng.range(-1.0, 1.0),
            };
            let [p, q] = [(); 2].map(|()| [(); 3].map(|()| [coordinate(), coordinate(), coordinate()]));
            let area = |t: &Triangle| {
                norm(crate::pose::cross(
                    crate::pose::sub(t[1], t[0]),
                    crate::pose::sub(t[2], t[0]),
                ))
            };
            if area(&p) < 1e-3 || area(&q) < 1e-3 {
                continue;
            }
            let found = square(&p, &q, &Pose::IDENTITY);
            let (root, _) = sqrt(&found);
            assert!(
                (root - brute::triangles(&p, &q)).abs() < 1e-9,
                "{p:?} {q:?} {}",
                rounded(&found)
            );
            zeros += usize::from(found == RBig::ZERO);
        }
        assert!(zeros > 200, "{zeros}");
    }
}
