//! The naive oracle of meshes: all pairs of triangles, in `f64` by different formulas than the
//! crate's.

use crate::pose::{add, cross, dot, norm, scale, sub};
use crate::soups::Soup;
use crate::{Point, Pose};

/// A triangle.
pub type Triangle = [Point; 3];

/// Returns the point of a segment closest to a point.
fn on_segment(p: Point, a: Point, b: Point) -> Point {
    let u = sub(b, a);
    let s = dot(sub(p, a), u) / dot(u, u);
    add(a, scale(u, s.clamp(0.0, 1.0)))
}

/// Returns the distance of a point from a triangle: from its interior or from its sides.
fn point_triangle(p: Point, t: &Triangle) -> f64 {
    let n = cross(sub(t[1], t[0]), sub(t[2], t[0]));
    let over = (0..3).all(|i| dot(cross(sub(t[(i + 1) % 3], t[i]), sub(p, t[i])), n) >= 0.0);
    let sides = (0..3).map(|i| norm(sub(p, on_segment(p, t[i], t[(i + 1) % 3]))));
    let least = sides.fold(f64::INFINITY, f64::min);
    if over {
        least.min((dot(sub(p, t[0]), n) / norm(n)).abs())
    } else {
        least
    }
}

/// Returns the distance of two segments: from their ends or their interiors.
fn segments(a: Point, b: Point, c: Point, d: Point) -> f64 {
    let ends = [
        norm(sub(a, on_segment(a, c, d))),
        norm(sub(b, on_segment(b, c, d))),
        norm(sub(c, on_segment(c, a, b))),
        norm(sub(d, on_segment(d, a, b))),
    ];
    let least = ends.into_iter().fold(f64::INFINITY, f64::min);
    let (u, v, w) = (sub(b, a), sub(d, c), sub(c, a));
    let n = cross(u, v);
    let nn = dot(n, n);
    let (s, t) = (dot(cross(w, v), n) / nn, dot(cross(w, u), n) / nn);
    if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
        // Computed from the points: for nearly parallel segments, the height along an inaccurate
        // normal is too small.
        least.min(norm(sub(add(a, scale(u, s)), add(c, scale(v, t)))))
    } else {
        least
    }
}

/// Returns the point where a segment passes through a triangle (Möller and Trumbore 1997).
///
/// Returns it as a point of the segment and as a point of the triangle. They differ by rounding,
/// which is large if the segment is nearly in the plane of the triangle.
fn passes(a: Point, b: Point, t: &Triangle) -> Option<[Point; 2]> {
    let (e, f, d) = (sub(t[1], t[0]), sub(t[2], t[0]), sub(b, a));
    let h = cross(d, f);
    let det = dot(e, h);
    if det == 0.0 {
        return None;
    }
    let s = sub(a, t[0]);
    let u = dot(s, h) / det;
    let q = cross(s, e);
    let v = dot(d, q) / det;
    let at = dot(f, q) / det;
    let is_inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (0.0..=1.0).contains(&at);
    is_inside.then(|| [add(a, scale(d, at)), add(t[0], add(scale(e, u), scale(f, v)))])
}

/// Returns the distance of two triangles.
pub fn triangles(p: &Triangle, q: &Triangle) -> f64 {
    let side = |t: &Triangle, i: usize| (t[i], t[(i + 1) % 3]);
    let size = p.iter().chain(q).map(|x| norm(sub(*x, p[0]))).fold(0.0, f64::max);
    let mut best = f64::INFINITY;
    for i in 0..3 {
        let ((a, b), (c, d)) = (side(p, i), side(q, i));
        for [x, y] in passes(a, b, q).into_iter().chain(passes(c, d, p)) {
            let apart = norm(sub(x, y));
            if apart <= 1e-12 * size {
                return 0.0;
            }
            best = best.min(apart);
        }
    }
    let corners = p
        .iter()
        .map(|x| point_triangle(*x, q))
        .chain(q.iter().map(|x| point_triangle(*x, p)));
    let edges = (0..9).map(|k| {
        let ((a, b), (c, d)) = (side(p, k / 3), side(q, k % 3));
        segments(a, b, c, d)
    });
    corners.chain(edges).fold(best, f64::min)
}

/// Returns the least distance over all pairs of triangles, and its pair. Pairs whose bounding balls
/// are farther apart are skipped.
pub fn distance(a: &Soup, b: &Soup, a_from_b: &Pose) -> (f64, [usize; 2]) {
    let ball = |t: &Triangle| {
        let c = scale(add(add(t[0], t[1]), t[2]), 1.0 / 3.0);
        (c, t.iter().map(|x| norm(sub(*x, c))).fold(0.0, f64::max))
    };
    let balls = |all: &[Triangle]| all.iter().map(ball).collect::<Vec<_>>();
    let p: Vec<Triangle> = (0..a.triangles.len()).map(|t| a.corners(t)).collect();
    let q: Vec<Triangle> = (0..b.triangles.len())
        .map(|t| b.corners(t).map(|x| a_from_b.apply(x)))
        .collect();
    let (of_p, of_q) = (balls(&p), balls(&q));
    let mut best = (f64::INFINITY, [0, 0]);
    for (i, (c, r)) in of_p.iter().enumerate() {
        for (j, (d, s)) in of_q.iter().enumerate() {
            if norm(sub(*d, *c)) - r - s > best.0 * (1.0 + 1e-9) + 1e-12 {
                continue;
            }
            let found = triangles(&p[i], &q[j]);
            if found < best.0 {
                best = (found, [i, j]);
            }
        }
    }
    best
}

/// Returns the winding number about a point: the sum of solid angles (van Oosterom and Strackee
/// 1983) divided by 4π.
pub fn winding(soup: &Soup, p: Point) -> f64 {
    let angle = |t: [Point; 3]| {
        let [a, b, c] = t.map(|x| sub(x, p));
        let (x, y, z) = (norm(a), norm(b), norm(c));
        let above = dot(a, cross(b, c));
        let below = x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y;
        2.0 * above.atan2(below)
    };
    (0..soup.triangles.len()).map(|t| angle(soup.corners(t))).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact_meshes::square;
    use crate::rational::sqrt;
    use crate::rng::Rng;

    /// The triangles lie in one plane up to the rounding of a rotation, where quotients of volumes
    /// are noise.
    #[test]
    fn triangles_in_one_plane_are_as_far_apart_as_exact_arithmetic_says() {
        let mut rng = Rng::new(7);
        let (mut zeros, mut apart) = (0, 0);
        for k in 0..3_000 {
            let pose = Pose::new(rng.quat(), [0.3, -0.2, 0.7]);
            let mut corner = |off: f64| pose.apply([rng.range(-1.0, 1.0) + off, rng.range(-1.0, 1.0), 0.0]);
            let off = [0.0, 1.0, 2.5][k % 3];
            let [p, q] = [0.0, off].map(|off| [(); 3].map(|()| corner(off)));
            let area = |t: &Triangle| norm(cross(sub(t[1], t[0]), sub(t[2], t[0])));
            if area(&p) < 1e-3 || area(&q) < 1e-3 {
                continue;
            }
            let exact = sqrt(&square(&p, &q, &Pose::IDENTITY)).0;
            let found = triangles(&p, &q);
            assert!((found - exact).abs() < 1e-9, "{k} {found} {exact} {p:?} {q:?}");
            zeros += usize::from(exact < 1e-9);
            apart += usize::from(exact > 1e-9);
        }
        assert!(zeros > 500 && apart > 1_000, "{zeros} {apart}");
    }
}
