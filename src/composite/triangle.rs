//! The distance of two triangles: a proposal by closed formulas, with the features it lies on.
//!
//! Two disjoint triangles are closest at two edges, or at a vertex and the inside of the other
//! triangle. In the second case the whole triangle of the vertex lies beyond the plane through it,
//! so it is the vertex nearest the other plane; of several that are equally near, an edge is
//! parallel to the plane, and if one of its ends lies over the triangle and the other does not,
//! an edge pair is as close. The caller judges the proposal along its own directions.

use nalgebra::Vector3;

/// A feature of a triangle by the number of its vertex, of its edge (from the vertex of that number
/// to the next), or the inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spot {
    Vertex(u8),
    Edge(u8),
    Inside,
}

/// The closest points found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closest {
    pub(super) square: f64,
    pub(super) on_p: Vector3<f64>,
    pub(super) on_q: Vector3<f64>,
    pub(super) spots: [Spot; 2],
    /// Whether an edge of one passes through the other, as far as rounding can tell.
    pub(super) pierces: bool,
}

pub(super) type Triangle = [Vector3<f64>; 3];

/// The normal of a triangle, with twice its area as length.
#[inline(always)]
pub(super) fn normal([a, b, c]: &Triangle) -> Vector3<f64> {
    (b - a).cross(&(c - a))
}

/// The closest points of two triangles.
pub(super) fn closest(p: &Triangle, q: &Triangle) -> Closest {
    let mut best = Closest {
        square: f64::INFINITY,
        on_p: p[0],
        on_q: q[0],
        spots: [Spot::Vertex(0); 2],
        pierces: false,
    };
    edges(p, q, &mut best);
    let (of_p, of_q) = (normal(p), normal(q));
    let over_q = p.map(|x| of_q.dot(&(x - q[0])));
    let over_p = q.map(|x| of_p.dot(&(x - p[0])));
    let one_side = |h: &[f64; 3]| h.iter().all(|x| *x > 0.0) || h.iter().all(|x| *x < 0.0);
    match (one_side(&over_q), one_side(&over_p)) {
        (false, false) => pierce((p, &of_p, &over_p), (q, &of_q, &over_q), &mut best),
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

/// The squared distance of a point from a triangle, and the nearest feature.
pub(super) fn nearest(point: &Vector3<f64>, y: &Triangle) -> (f64, Spot) {
    let mut best = Closest {
        square: f64::INFINITY,
        on_p: *point,
        on_q: y[0],
        spots: [Spot::Vertex(0); 2],
        pierces: false,
    };
    edges(&[*point; 3], y, &mut best);
    let n = normal(y);
    let (square, height) = (n.norm_squared(), n.dot(&(point - y[0])));
    if height * height < best.square * square && is_over(point, y, &n) {
        (height * height / square, Spot::Inside)
    } else {
        (best.square, best.spots[1])
    }
}

/// The squared distance of a point from a triangle, and the nearest point.
pub(super) fn foot_of(point: &Vector3<f64>, y: &Triangle) -> (f64, Vector3<f64>) {
    let (square, spot) = nearest(point, y);
    let foot = match spot {
        Spot::Vertex(k) => y[k as usize % 3],
        Spot::Edge(k) => {
            let (from, along) = (y[k as usize % 3], y[(k as usize + 1) % 3] - y[k as usize % 3]);
            from + along * clamp(along.dot(&(point - from)) / along.norm_squared())
        }
        Spot::Inside => {
            let n = normal(y);
            point - n * (n.dot(&(point - y[0])) / n.norm_squared())
        }
    };
    (square, foot)
}

/// The closest points of the nine pairs of edges.
#[inline(always)]
fn edges(p: &Triangle, q: &Triangle, best: &mut Closest) {
    let next = [1, 2, 0];
    let v = [0, 1, 2].map(|j| q[next[j]] - q[j]);
    let vv = v.map(|v| v.norm_squared());
    for i in 0..3 {
        let u = p[next[i]] - p[i];
        let uu = u.norm_squared();
        for j in 0..3 {
            let w = p[i] - q[j];
            let (uv, uw, vw) = (u.dot(&v[j]), u.dot(&w), v[j].dot(&w));
            let below = uu * vv[j] - uv * uv;
            let s = if below > 0.0 {
                clamp((uv * vw - uw * vv[j]) / below)
            } else {
                0.0
            };
            let free = (uv * s + vw) / vv[j];
            let t = clamp(free);
            let s = if t == free { s } else { clamp((uv * t - uw) / uu) };
            let between = w + u * s - v[j] * t;
            let square = between.norm_squared();
            if square < best.square {
                best.square = square;
                best.on_p = p[i] + u * s;
                best.on_q = q[j] + v[j] * t;
                best.spots = [spot(i, s), spot(j, t)];
            }
        }
    }
}

#[inline(always)]
fn clamp(x: f64) -> f64 {
    // NaN, of edges without length, becomes zero.
    if x > 0.0 { if x < 1.0 { x } else { 1.0 } } else { 0.0 }
}

fn spot(edge: usize, s: f64) -> Spot {
    if s <= 0.0 {
        Spot::Vertex(edge as u8)
    } else if s >= 1.0 {
        Spot::Vertex((edge as u8 + 1) % 3)
    } else {
        Spot::Edge(edge as u8)
    }
}

/// The foot of the vertex of `x` nearest the plane of `y`, if it is closer than the best so far
/// and lies in `y`.
#[inline(always)]
fn foot(x: &Triangle, heights: &[f64; 3], y: &Triangle, n: &Vector3<f64>, swapped: bool, best: &mut Closest) {
    let square = n.norm_squared();
    let mut k = 0;
    for i in 1..3 {
        if heights[i].abs() < heights[k].abs() {
            k = i;
        }
    }
    let height = heights[k];
    if !(height * height < best.square * square) || !is_over(&x[k], y, n) {
        return;
    }
    let at = x[k] - n * (height / square);
    best.square = height * height / square;
    let corner = Spot::Vertex(k as u8);
    if swapped {
        (best.on_p, best.on_q, best.spots) = (at, x[k], [Spot::Inside, corner]);
    } else {
        (best.on_p, best.on_q, best.spots) = (x[k], at, [corner, Spot::Inside]);
    }
}

/// Whether a point projects into a triangle.
#[inline(always)]
fn is_over(point: &Vector3<f64>, y: &Triangle, n: &Vector3<f64>) -> bool {
    (0..3).all(|i| {
        let (from, to) = (&y[i], &y[(i + 1) % 3]);
        n.dot(&(to - from).cross(&(point - from))) >= 0.0
    })
}

/// Looks for an edge of one triangle that passes through the other.
fn pierce(
    (p, of_p, over_p): (&Triangle, &Vector3<f64>, &[f64; 3]),
    (q, of_q, over_q): (&Triangle, &Vector3<f64>, &[f64; 3]),
    best: &mut Closest,
) {
    let found = crossing(p, over_q, q, of_q).map(|(at, edge)| (at, [Spot::Edge(edge), Spot::Inside]));
    let other = || crossing(q, over_p, p, of_p).map(|(at, edge)| (at, [Spot::Inside, Spot::Edge(edge)]));
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

/// The point at which an edge of `x`, whose vertices have these heights, passes through `y`.
fn crossing(x: &Triangle, heights: &[f64; 3], y: &Triangle, n: &Vector3<f64>) -> Option<(Vector3<f64>, u8)> {
    (0..3).find_map(|i| {
        let j = (i + 1) % 3;
        let (h, k) = (heights[i], heights[j]);
        let apart = (h >= 0.0) != (k >= 0.0) && h != k;
        let at = x[i] + (x[j] - x[i]) * (h / (h - k));
        (apart && is_over(&at, y, n)).then_some((at, i as u8))
    })
}

/// Whether two triangles certainly cross, each of whose vertices may be off its place by `error`:
/// an edge of one has its ends on different sides of the other and passes inside its three edges,
/// each sign beyond doubt.
///
/// A determinant of three differences up to `s` of points that are each off by `error` is off by
/// `6 error s^2` to first order, its rounding by `14 UNIT s^3`; `error` is more than `64 UNIT s`.
pub(super) fn certainly_cross(p: &Triangle, q: &Triangle, error: f64) -> bool {
    let s = p.iter().chain(q).fold(0.0, |m: f64, x| m.max((x - p[0]).amax()));
    // Differences between any two of the six are at most twice the largest from one of them, and
    // 1.8 times their largest coordinate.
    let doubt = 8.0 * error * (4.0 * s) * (4.0 * s);
    let volume =
        |a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>, d: &Vector3<f64>| (b - a).cross(&(c - a)).dot(&(d - a));
    let through = |x: &Triangle, y: &Triangle| {
        (0..3).any(|i| {
            let (from, to) = (&x[i], &x[(i + 1) % 3]);
            let (h, k) = (volume(&y[0], &y[1], &y[2], from), volume(&y[0], &y[1], &y[2], to));
            if !(h.min(k) < -doubt && h.max(k) > doubt) {
                return false;
            }
            let turns = [0, 1, 2].map(|j| volume(from, to, &y[j], &y[(j + 1) % 3]));
            turns.iter().all(|v| *v > doubt) || turns.iter().all(|v| *v < -doubt)
        })
    };
    through(p, q) || through(q, p)
}
