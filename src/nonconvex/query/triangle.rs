//! The distance of two triangles, by closed formulas, with the closest features.
//!
//! Two disjoint triangles are closest at two edges, or at a vertex and a point inside the other
//! triangle. In the second case, the triangle of the vertex lies beyond the plane through the
//! vertex that is parallel to the other triangle. So the vertex is the one nearest to the plane of
//! the other triangle. If several vertices are equally near, an edge between them is parallel to
//! this plane. If one end of this edge projects into the other triangle and the other end does not,
//! an edge pair is equally close. The result is a proposal. The caller proves it along its own
//! directions.
//!
//! The points lie in their triangles by construction: on an edge, or at non-negative weights of the
//! three vertices. Without this, a point could lie outside a triangle whose vertices are nearly
//! collinear, because its normal consists of rounding errors. So the distance of the points is an
//! upper bound for any normals. If a normal consists of rounding errors, an edge pair may be
//! proposed although the foot of a vertex is closer, by at most the thickness of the triangle.

use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::dot;
use nalgebra::Vector3;
use wide::f64x4;

use crate::base::tolerance::SAME_PLACE;

/// A feature of a triangle.
///
/// Edge k leads from vertex k to the next vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TriangleSpot {
    Vertex(u8),
    Edge(u8),
    Inside,
}

/// The closest points found, with their squared distance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closest {
    pub(crate) square: f64,
    pub(crate) on_p: Vector3<f64>,
    pub(crate) on_q: Vector3<f64>,
    pub(crate) spots: [TriangleSpot; 2],
    /// Whether an edge of one triangle passes through the other, up to rounding.
    pub(crate) pierces: bool,
}

pub(crate) type Triangle = [Vector3<f64>; 3];

/// Returns the normal of a triangle; its length is twice the area.
#[inline(always)]
pub(crate) fn normal([a, b, c]: &Triangle) -> Vector3<f64> {
    (b - a).cross(&(c - a))
}

/// Returns the closest points of two triangles.
pub(crate) fn closest(p: &Triangle, q: &Triangle) -> Closest {
    let mut best = Closest {
        square: f64::INFINITY,
        on_p: p[0],
        on_q: q[0],
        spots: [TriangleSpot::Vertex(0); 2],
        pierces: false,
    };
    edges(p, q, &mut best);
    let (of_p, of_q) = (normal(p), normal(q));
    let over_q = p.each(|x| of_q.dot(&(x - q[0])));
    let over_p = q.each(|x| of_p.dot(&(x - p[0])));
    // A vertex in the plane touches and does not pierce.
    let one_side = |h: &[f64; 3]| h.iter().all(|x| *x >= 0.0) || h.iter().all(|x| *x <= 0.0);
    match (one_side(&over_q), one_side(&over_p)) {
        (false, false) => pierce([p, q], [&of_p, &of_q], [&over_p, &over_q], &mut best),
        (above_q, above_p) => {
            if above_q {
                foot(p, &over_q, q, &of_q, false, &mut best);
            }
            if above_p {
                foot(q, &over_p, p, &of_p, true, &mut best);
            }
        }
    }
    best
}

/// Returns the squared distance of a point from a triangle, and the nearest feature.
pub(crate) fn nearest(point: &Vector3<f64>, y: &Triangle) -> (f64, TriangleSpot) {
    let best = closest_to(point, y);
    (best.square, best.spots[1])
}

/// Returns the squared distance of a point from a triangle, and the nearest point.
pub(crate) fn foot_of(point: &Vector3<f64>, y: &Triangle) -> (f64, Vector3<f64>) {
    let best = closest_to(point, y);
    (best.square, best.on_q)
}

/// Returns the squared distance of a point from a triangle, the nearest point and its feature.
pub(crate) fn nearest_point(point: &Vector3<f64>, y: &Triangle) -> (f64, Vector3<f64>, TriangleSpot) {
    let best = closest_to(point, y);
    (best.square, best.on_q, best.spots[1])
}

/// Returns the closest points of a point and a triangle.
fn closest_to(point: &Vector3<f64>, y: &Triangle) -> Closest {
    let mut best = Closest {
        square: f64::INFINITY,
        on_p: *point,
        on_q: y[0],
        spots: [TriangleSpot::Vertex(0); 2],
        pierces: false,
    };
    TriangleSides::new(y).closest_to(point, &Vector3::zeros(), 0, &mut best);
    let n = normal(y);
    if let Some((square, at)) = foot_inside(point, n.dot(&(point - y[0])), y, &n, best.square) {
        (best.square, best.on_q, best.spots[1]) = (square, at, TriangleSpot::Inside);
    }
    best
}

/// Updates the closest points with the nine pairs of edges.
#[inline(always)]
fn edges(p: &Triangle, q: &Triangle, best: &mut Closest) {
    let sides = TriangleSides::new(q);
    for i in 0..3 {
        sides.closest_to(&p[i], &(p[[1, 2, 0][i]] - p[i]), i, best);
    }
}

/// The three edges of a triangle, in the lanes of registers.
struct TriangleSides<'a> {
    corners: &'a Triangle,
    from: [f64x4; 3],
    along: [f64x4; 3],
    square: f64x4,
}

impl<'a> TriangleSides<'a> {
    #[inline(always)]
    fn new(corners: &'a Triangle) -> Self {
        let [a, b, c] = corners;
        let lanes = |k: usize| f64x4::new([a[k], b[k], c[k], c[k]]);
        let next = |k: usize| f64x4::new([b[k], c[k], a[k], a[k]]);
        let from = [lanes(0), lanes(1), lanes(2)];
        let along = [next(0) - from[0], next(1) - from[1], next(2) - from[2]];
        Self {
            corners,
            from,
            along,
            square: dot(&along, &along),
        }
    }

    /// Updates the closest points with one edge, the `i`-th of another triangle, and the three
    /// edges.
    #[inline(always)]
    fn closest_to(&self, from: &Vector3<f64>, along: &Vector3<f64>, i: usize, best: &mut Closest) {
        let (zero, one) = (f64x4::splat(0.0), f64x4::splat(1.0));
        let (v, vv) = (&self.along, self.square);
        let u = [f64x4::splat(along.x), f64x4::splat(along.y), f64x4::splat(along.z)];
        let uu = f64x4::splat(along.norm_squared());
        // If an edge has no length, its products are zero.
        let least = f64x4::splat(f64::MIN_POSITIVE);
        let w = [
            f64x4::splat(from.x) - self.from[0],
            f64x4::splat(from.y) - self.from[1],
            f64x4::splat(from.z) - self.from[2],
        ];
        let (uv, uw, vw) = (dot(&u, v), dot(&u, &w), dot(v, &w));
        let below = uu * vv - uv * uv;
        let slanted = (uv * vw - uw * vv) / below.fast_max(least);
        let s = below.simd_gt(zero).select(slanted, zero).fast_max(zero).fast_min(one);
        let free = (uv * s + vw) / vv.fast_max(least);
        let t = free.fast_max(zero).fast_min(one);
        let again = ((uv * t - uw) / uu.fast_max(least)).fast_max(zero).fast_min(one);
        let s = t.simd_eq(free).select(s, again);
        let between = [
            w[0] + u[0] * s - v[0] * t,
            w[1] + u[1] * s - v[1] * t,
            w[2] + u[2] * s - v[2] * t,
        ];
        let (squares, s, t) = (dot(&between, &between).to_array(), s.to_array(), t.to_array());
        for j in 0..3 {
            if squares[j] < best.square {
                best.square = squares[j];
                best.on_p = from + along * s[j];
                best.on_q = self.corners[j] + (self.corners[[1, 2, 0][j]] - self.corners[j]) * t[j];
                best.spots = [spot(i, s[j]), spot(j, t[j])];
            }
        }
    }
}

fn spot(edge: usize, s: f64) -> TriangleSpot {
    if s <= 0.0 {
        TriangleSpot::Vertex(edge as u8)
    } else if s >= 1.0 {
        TriangleSpot::Vertex((edge as u8 + 1) % 3)
    } else {
        TriangleSpot::Edge(edge as u8)
    }
}

/// Updates the closest points with the foot of the vertex of `x` nearest to the plane of `y`.
///
/// The foot counts if it lies in `y` and is closer than the best so far.
#[inline(always)]
fn foot(x: &Triangle, heights: &[f64; 3], y: &Triangle, n: &Vector3<f64>, swapped: bool, best: &mut Closest) {
    let mut k = 0;
    for i in 1..3 {
        if heights[i].abs() < heights[k].abs() {
            k = i;
        }
    }
    let Some((square, at)) = foot_inside(&x[k], heights[k], y, n, best.square) else {
        return;
    };
    best.square = square;
    let corner = TriangleSpot::Vertex(k as u8);
    if swapped {
        (best.on_p, best.on_q, best.spots) = (at, x[k], [TriangleSpot::Inside, corner]);
    } else {
        (best.on_p, best.on_q, best.spots) = (x[k], at, [corner, TriangleSpot::Inside]);
    }
}

/// Returns the squared distance of a point from its foot on a triangle, and the foot.
///
/// The height of the point is `height` divided by the length of the normal `n`. Returns `None` if
/// the foot is outside the triangle or no closer than `nearest`, a squared distance.
#[inline(always)]
fn foot_inside(
    point: &Vector3<f64>,
    height: f64,
    y: &Triangle,
    n: &Vector3<f64>,
    nearest: f64,
) -> Option<(f64, Vector3<f64>)> {
    let square = n.norm_squared();
    if !(height * height < nearest * square) {
        return None;
    }
    let inside = combined(y, weights(point, y, n)?);
    let at = point - n * (height / square);
    if is_same_place(&at, &inside, point, y) {
        return Some((height * height / square, at));
    }
    let square = (point - inside).norm_squared();
    (square < nearest).then_some((square, inside))
}

/// Returns the barycentric weights of the projection of a point into a triangle, up to a factor.
///
/// Returns `None` if the point projects outside the triangle.
#[inline(always)]
fn weights(point: &Vector3<f64>, y: &Triangle, n: &Vector3<f64>) -> Option<[f64; 3]> {
    let mut all = [0.0; 3];
    for i in 0..3 {
        let (from, to) = (&y[i], &y[(i + 1) % 3]);
        let weight = n.dot(&(to - from).cross(&(point - from)));
        // Written so that NaN returns `None`.
        if !(weight >= 0.0) {
            return None;
        }
        all[(i + 2) % 3] = weight;
    }
    Some(all)
}

/// Returns the point of a triangle at non-negative weights.
///
/// It lies inside the triangle or on an edge for any such weights. It is NaN if all weights are
/// zero.
#[inline(always)]
fn combined([a, b, c]: &Triangle, [u, v, w]: [f64; 3]) -> Vector3<f64> {
    let sum = u + v + w;
    a + (b - a) * (v / sum) + (c - a) * (w / sum)
}

/// Returns whether a foot or crossing `at` equals the point `inside` of a triangle up to rounding.
///
/// The rounding is that of the differences from which both were computed ([`SAME_PLACE`]).
#[inline(always)]
fn is_same_place(at: &Vector3<f64>, inside: &Vector3<f64>, from: &Vector3<f64>, [a, b, c]: &Triangle) -> bool {
    let size = (from - a).norm_squared() + (b - a).norm_squared() + (c - a).norm_squared();
    (at - inside).norm_squared() <= SAME_PLACE * SAME_PLACE * size
}

/// Sets the closest points to a point where an edge of one triangle passes through the other.
///
/// Changes nothing if no edge does. `over_q` are the heights of the vertices of `p` above the plane
/// of `q`, and `over_p` the heights of `q` above the plane of `p`.
fn pierce(
    [p, q]: [&Triangle; 2],
    [of_p, of_q]: [&Vector3<f64>; 2],
    [over_p, over_q]: [&[f64; 3]; 2],
    best: &mut Closest,
) {
    let found = crossing(p, over_q, q, of_q).map(|(at, edge)| (at, [TriangleSpot::Edge(edge), TriangleSpot::Inside]));
    let other =
        || crossing(q, over_p, p, of_p).map(|(at, edge)| (at, [TriangleSpot::Inside, TriangleSpot::Edge(edge)]));
    if let Some((at, spots)) = found.or_else(other) {
        *best = Closest {
            square: 0.0,
            on_p: at,
            on_q: at,
            spots,
            pierces: true,
        };
    }
}

/// Returns the point at which an edge of `x` passes through `y`, and the index of the edge.
///
/// `heights` are the heights of the vertices of `x`.
fn crossing(x: &Triangle, heights: &[f64; 3], y: &Triangle, n: &Vector3<f64>) -> Option<(Vector3<f64>, u8)> {
    (0..3).find_map(|i| {
        let j = (i + 1) % 3;
        let (h, k) = (heights[i], heights[j]);
        let apart = (h >= 0.0) != (k >= 0.0) && h != k;
        let at = x[i] + (x[j] - x[i]) * (h / (h - k));
        let is_inside = || weights(&at, y, n).is_some_and(|w| is_same_place(&at, &combined(y, w), &x[i], y));
        (apart && is_inside()).then_some((at, i as u8))
    })
}

/// Returns whether two triangles certainly cross if each vertex has a position error of `error`.
///
/// They cross if an edge of one has its ends on different sides of the other and passes inside its
/// three edges. Every sign must exceed its error.
///
/// Take a determinant of three differences of length at most `s`, of points with an error of
/// `error`. Its error from the points is `6 error s^2` to first order, and its rounding error is
/// `14 UNIT s^3`. `error` is more than `64 UNIT s`.
pub(crate) fn certainly_cross(p: &Triangle, q: &Triangle, error: f64) -> bool {
    let s = p.iter().chain(q).fold(0.0, |m: f64, x| m.larger((x - p[0]).amax()));
    // Differences between any two of the six vertices are at most twice the largest difference from
    // one vertex, and at most 1.8 times their largest coordinate.
    let doubt = 8.0 * error * (4.0 * s) * (4.0 * s);
    let volume =
        |a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>, d: &Vector3<f64>| (b - a).cross(&(c - a)).dot(&(d - a));
    let through = |x: &Triangle, y: &Triangle| {
        (0..3).any(|i| {
            let (from, to) = (&x[i], &x[(i + 1) % 3]);
            let (h, k) = (volume(&y[0], &y[1], &y[2], from), volume(&y[0], &y[1], &y[2], to));
            if !(h.smaller(k) < -doubt && h.larger(k) > doubt) {
                return false;
            }
            let turns = [0, 1, 2].each(|j| volume(from, to, &y[j], &y[(j + 1) % 3]));
            turns.iter().all(|v| *v > doubt) || turns.iter().all(|v| *v < -doubt)
        })
    };
    through(p, q) || through(q, p)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    fn clamp(x: f64) -> f64 {
        // Edges without length give NaN, which becomes zero.
        if x > 0.0 { x.min(1.0) } else { 0.0 }
    }

    fn triangle(mut corner: impl FnMut() -> f64) -> Triangle {
        [(); 3].map(|()| Vector3::new(corner(), corner(), corner()))
    }

    /// Returns the squared distance of two segments, by the six cases in which two are closest.
    fn of_segments([p, q]: [Vector3<f64>; 2], [r, s]: [Vector3<f64>; 2]) -> f64 {
        let to_segment = |x: &Vector3<f64>, [a, b]: [Vector3<f64>; 2]| {
            let along = b - a;
            let t = clamp(along.dot(&(x - a)) / along.norm_squared());
            (a + along * t - x).norm_squared()
        };
        let ends = to_segment(&p, [r, s]).min(to_segment(&q, [r, s]));
        let ends = ends.min(to_segment(&r, [p, q])).min(to_segment(&s, [p, q]));
        let (u, v, w) = (q - p, s - r, r - p);
        let n = u.cross(&v);
        let (t, at) = (
            w.cross(&v).dot(&n) / n.norm_squared(),
            w.cross(&u).dot(&n) / n.norm_squared(),
        );
        let inside = (0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&at);
        if inside {
            ends.min((w + v * at - u * t).norm_squared())
        } else {
            ends
        }
    }

    /// Returns the squared distance by brute force.
    ///
    /// It tests all pairs of edges, all vertices above the other triangle, and all edges through
    /// it.
    fn brute(p: &Triangle, q: &Triangle) -> f64 {
        let edge = |x: &Triangle, k: usize| [x[k], x[(k + 1) % 3]];
        let mut least = f64::INFINITY;
        for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
            least = least.min(of_segments(edge(p, i), edge(q, j)));
        }
        for (x, y) in [(p, q), (q, p)] {
            let n = normal(y);
            let height = |v: &Vector3<f64>| n.dot(&(v - y[0]));
            for v in x.iter().filter(|v| weights(v, y, &n).is_some()) {
                least = least.min(height(v) * height(v) / n.norm_squared());
            }
            for k in 0..3 {
                let [from, to] = edge(x, k);
                let (h, l) = (height(&from), height(&to));
                if h * l < 0.0 && weights(&(from + (to - from) * (h / (h - l))), y, &n).is_some() {
                    least = 0.0;
                }
            }
        }
        least
    }

    fn check(p: &Triangle, q: &Triangle) {
        let found = closest(p, q);
        let size = p.iter().chain(q).fold(0.0, |m: f64, x| m.max(x.norm()));
        let (least, slack) = (brute(p, q), 1e-12 * size * size);
        assert!(
            (found.square - least).abs() <= slack,
            "{p:?} {q:?}: {found:?}, not {least}"
        );
        assert!(((found.on_q - found.on_p).norm_squared() - found.square).abs() <= slack);
        for (point, of) in [(&found.on_p, p), (&found.on_q, q)] {
            assert!(nearest(point, of).0 <= slack, "{point} is off {of:?}");
            assert!((foot_of(point, of).1 - point).norm_squared() <= slack);
        }
        assert!(!found.pierces || least <= slack);
    }

    #[test]
    fn closest_points_are_those_of_all_pairs_of_features() {
        let mut rng = Rng::new(1);
        for _ in 0..20_000 {
            let p = triangle(|| rng.range(-1.0, 1.0));
            let q = triangle(|| rng.range(-1.0, 1.0)).map(|x| x + Vector3::new(0.7, 0.0, 0.0));
            check(&p, &q);
        }
    }

    #[test]
    fn ties_on_a_lattice_have_the_distance_of_all_pairs_of_features() {
        let mut rng = Rng::new(2);
        let mut tested = 0;
        while tested < 20_000 {
            let [p, q] = [(); 2].map(|()| triangle(|| rng.below(3) as f64));
            if normal(&p) != Vector3::zeros() && normal(&q) != Vector3::zeros() {
                check(&p, &q);
                tested += 1;
            }
        }
    }

    #[test]
    fn what_certainly_crosses_is_at_distance_zero() {
        let mut rng = Rng::new(3);
        let mut crossed = 0;
        for _ in 0..20_000 {
            let [p, q] = [(); 2].map(|()| triangle(|| rng.range(-1.0, 1.0)));
            if certainly_cross(&p, &q, 1e-13) {
                crossed += 1;
                assert_eq!(closest(&p, &q).square, 0.0);
            }
        }
        assert!(crossed > 1_000, "{crossed}");
    }
}
