//! The naive exact oracle of meshes: least distances over all pairs of triangles, over the
//! integers.
//!
//! Two triangles share a point if an edge of one passes through the other. Otherwise they are
//! closest at one of the fifteen pairs of a vertex and a face or of two edges, or at the ends of
//! these. Floating point selects the pairs that may be the closest, with a margin far above its
//! error.

use crate::brute::{self, Triangle};
use crate::exact::{Frac, edge_edge, less, to_corner, to_edge, to_face};
use crate::pose::norm;
use crate::rational::{self, IntVec, common, cross, dot, exact, placed, sub};
use crate::soups::Soup;
use crate::{Point, Pose};
use dashu_int::IBig;
use dashu_ratio::RBig;

/// A triangle over the integers.
type IntTriangle = [IntVec; 3];

/// Returns whether a segment passes through a triangle, if its ends are on different sides of it.
fn passes(p: &IntVec, q: &IntVec, t: &IntTriangle, n: &IntVec) -> bool {
    let (h, k) = (dot(n, &sub(p, &t[0])), dot(n, &sub(q, &t[0])));
    let differs = h > IBig::ZERO && k < IBig::ZERO || h < IBig::ZERO && k > IBig::ZERO;
    if !differs {
        return false;
    }
    let way = sub(q, p);
    let turns = [0, 1, 2].map(|i| dot(&cross(&sub(&t[i], p), &sub(&t[(i + 1) % 3], p)), &way));
    turns.iter().all(|x| *x >= IBig::ZERO) || turns.iter().all(|x| *x <= IBig::ZERO)
}

/// Returns the squared distance of two triangles, which may have no area.
fn squared(x: &IntTriangle, y: &IntTriangle) -> Frac {
    let sides = |t: &IntTriangle| [0, 1, 2].map(|i| [t[i].clone(), t[(i + 1) % 3].clone()]);
    let mut best = to_corner(&x[0], &y[0]);
    let mut offer = |s: Frac| best = less(best.clone(), s);
    for (p, q) in [(x, y), (y, x)] {
        let (edges, n) = (sides(q), cross(&sub(&q[1], &q[0]), &sub(&q[2], &q[0])));
        for i in 0..3 {
            if passes(&p[i], &p[(i + 1) % 3], q, &n) {
                return (IBig::ZERO, IBig::ONE);
            }
            if n.iter().any(|c| !c.is_zero()) {
                to_face(&p[i], q, &n).into_iter().for_each(&mut offer);
            }
            q.iter().for_each(|corner| offer(to_corner(&p[i], corner)));
            edges
                .iter()
                .filter_map(|edge| to_edge(&p[i], edge))
                .for_each(&mut offer);
        }
    }
    for (of_x, of_y) in sides(x).iter().flat_map(|e| sides(y).map(|f| (e.clone(), f))) {
        edge_edge(&of_x, &of_y).into_iter().for_each(&mut offer);
    }
    best
}

/// Returns the squared distance of two triangles, the second at a pose.
pub fn square(p: &Triangle, q: &Triangle, pose: &Pose) -> RBig {
    let (x, y, den) = common(&placed(p, &Pose::IDENTITY), &placed(q, pose));
    let (x, y) = (x.try_into().expect("three"), y.try_into().expect("three"));
    let (square, below) = squared(&x, &y);
    let den = IBig::from(den);
    RBig::from_parts_signed(square, below * &den * &den)
}

/// Returns a bounding ball of a triangle.
fn ball(t: &Triangle) -> (Point, f64) {
    let middle = [0, 1, 2].map(|k| (t[0][k] + t[1][k] + t[2][k]) / 3.0);
    let radius = t.iter().map(|x| norm(crate::pose::sub(*x, middle)));
    (middle, radius.fold(0.0, f64::max))
}

/// Returns the distance in floating point, also for triangles that are points.
fn estimate(p: &Triangle, q: &Triangle) -> f64 {
    let corners = p
        .iter()
        .flat_map(|x| q.iter().map(move |y| norm(crate::pose::sub(*x, *y))));
    corners.fold(brute::triangles(p, q), f64::min)
}

/// Returns the least of all squares, and its pair.
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
        // The floating-point result is wrong, which may happen for coplanar triangles or slivers.
        (reach, is_known) = (root, true);
    }
}

fn corners(soup: &Soup) -> Vec<Triangle> {
    (0..soup.triangles.len()).map(|t| soup.corners(t)).collect()
}

/// Returns the least squared distance of two meshes, and a pair of triangles that attains it.
pub fn apart(a: &Soup, b: &Soup, a_from_b: &Pose) -> (RBig, [usize; 2]) {
    let (p, q) = (corners(a), corners(b));
    let there: Vec<Triangle> = q.iter().map(|t| t.map(|x| a_from_b.apply(x))).collect();
    let square = |[i, j]: [usize; 2]| square(&p[i], &q[j], a_from_b);
    least(&p, &there, |_, _| true, square).expect("meshes have triangles")
}

/// Returns the least squared distance of two triangles of a mesh that share no vertex, and such a
/// pair.
pub fn itself(soup: &Soup) -> Option<(RBig, [usize; 2])> {
    let p = corners(soup);
    let square = |[i, j]: [usize; 2]| square(&p[i], &p[j], &Pose::IDENTITY);
    least(&p, &p, |i, j| i < j && !share(soup, i, j), square)
}

/// Returns all pairs of triangles of a mesh that share no vertex and are at most `d` apart, the
/// lower number first.
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
            // Floating point may report coplanar triangles as crossing.
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

    /// On a lattice and in general position, exact squares agree with different formulas in
    /// floating point.
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
