//! Minimum-norm search with exact signs, and location of the origin in a convex set that contains
//! it.
//!
//! The origin lies in the interior or on the boundary. The search depends on the number of points
//! that the nearest point needs:
//!
//! ```text
//!   1 point kept:  vertex    any edge of the set may rule a normal out
//!   2 points:      line      a normal is perpendicular to d: search the plane of e and f
//!   3 points:      plane     only n and -n are possible normals
//!   4 points:      interior
//! ```

use crate::base::num::each::Each;
use crate::body::polyhedron::VertexId;
use crate::convex::exact::integer::{Big3, cross, dot, is_zero, neg, sign, sub};
use alloc::vec;
use alloc::vec::Vec;
use dashu_base::Signed;
use dashu_int::IBig;

/// A point of the searched set: its two vertices and its position.
#[derive(Clone, Debug)]
pub(super) struct ExactPoint {
    pub(super) a: VertexId,
    pub(super) b: VertexId,
    pub(super) w: Big3,
}

/// The point of a simplex nearest to the origin.
#[derive(Clone, Debug)]
pub(super) struct NearestPoint {
    /// Simplex vertices whose hull contains the nearest point in its relative interior.
    pub(super) kept: Vec<ExactPoint>,
    /// Barycentric coordinates of the nearest point, positive, as numerators over `sum`.
    pub(super) weights: Vec<IBig>,
    pub(super) sum: IBig,
    /// A positive multiple of the nearest point; zero if the nearest point is the origin.
    pub(super) direction: Big3,
}

impl NearestPoint {
    /// Returns the squared distance from the origin as a fraction.
    pub(super) fn squared(&self) -> (IBig, IBig) {
        let w = |k: usize| &self.kept[k].w;
        match self.kept.len() {
            1 => (dot(w(0), w(0)), IBig::ONE),
            2 => {
                let d = sub(w(1), w(0));
                let area = cross(w(0), &d);
                (dot(&area, &area), dot(&d, &d))
            }
            _ => {
                let n = &self.direction;
                let height = dot(n, w(0));
                (&height * &height, dot(n, n))
            }
        }
    }
}

/// Returns barycentric coordinates, their sum, and the direction of the affine hull's nearest
/// point, if the point lies in the relative interior of the convex hull.
fn inside(s: &[&ExactPoint]) -> Option<(Vec<IBig>, IBig, Big3)> {
    let positive = |w: &[IBig]| w.iter().all(|x| x.is_positive() && !x.is_zero());
    match s {
        [p] => Some((vec![IBig::ONE], IBig::ONE, p.w.clone())),
        [p, q] => {
            let d = sub(&q.w, &p.w);
            let w = vec![dot(&q.w, &d), -dot(&p.w, &d)];
            positive(&w).then(|| {
                let n = [0, 1, 2].each(|k| &w[0] * &p.w[k] + &w[1] * &q.w[k]);
                (w, dot(&d, &d), n)
            })
        }
        [p, q, r] => {
            let n = cross(&sub(&q.w, &p.w), &sub(&r.w, &p.w));
            let w = vec![
                dot(&n, &cross(&q.w, &r.w)),
                dot(&n, &cross(&r.w, &p.w)),
                dot(&n, &cross(&p.w, &q.w)),
            ];
            positive(&w).then(|| {
                let (sum, height) = (dot(&n, &n), sign(&dot(&n, &p.w)));
                let n = match height {
                    0 => [IBig::ZERO, IBig::ZERO, IBig::ZERO],
                    1 => n,
                    _ => neg(&n),
                };
                (w, sum, n)
            })
        }
        [p, q, r, t] => {
            let det = |x: &ExactPoint, y: &ExactPoint, z: &ExactPoint| dot(&x.w, &cross(&y.w, &z.w));
            let mut w = vec![det(q, r, t), -det(p, r, t), det(p, q, t), -det(p, q, r)];
            let mut sum = &w[0] + &w[1] + &w[2] + &w[3];
            if sign(&sum) < 0 {
                sum = -sum;
                w.iter_mut().for_each(|x| *x = -&*x);
            }
            positive(&w).then_some((w, sum, [IBig::ZERO, IBig::ZERO, IBig::ZERO]))
        }
        _ => None,
    }
}

/// Returns the nearest point of the hull of one to four points.
///
/// The first subset that satisfies both conditions of the minimum-norm point is the answer. First,
/// the nearest point of its affine hull lies in its relative interior. Second, no other point is
/// closer to the origin than the plane through the nearest point.
pub(super) fn nearest(vertices: &[ExactPoint]) -> Option<NearestPoint> {
    let n = vertices.len();
    for size in 1..=n.min(4) {
        for mask in (1u32..1 << n).filter(|m| m.count_ones() as usize == size) {
            let chosen = |k: &usize| mask & 1 << k != 0;
            let subset: Vec<&ExactPoint> = (0..n).filter(chosen).map(|k| &vertices[k]).collect();
            let Some((weights, sum, direction)) = inside(&subset) else {
                continue;
            };
            let base = dot(&direction, &subset[0].w);
            let supports = is_zero(&direction) || (0..n).all(|k| chosen(&k) || dot(&direction, &vertices[k].w) >= base);
            if supports {
                let kept = subset.into_iter().cloned().collect();
                return Some(NearestPoint {
                    kept,
                    weights,
                    sum,
                    direction,
                });
            }
        }
    }
    None
}

/// Returns the point of a convex set nearest to the origin.
///
/// `lowest(n)` must return an extreme point that is least along `n`. The search terminates because
/// each round is strictly nearer and the number of simplices is finite.
pub(super) fn minimize(start: Vec<ExactPoint>, lowest: &dyn Fn(&Big3) -> ExactPoint) -> Option<NearestPoint> {
    let mut vertices = start;
    loop {
        let now = nearest(&vertices)?;
        if is_zero(&now.direction) {
            return Some(now);
        }
        let next = lowest(&now.direction);
        if dot(&now.direction, &next.w) >= dot(&now.direction, &now.kept[0].w) {
            return Some(now);
        }
        vertices = now.kept;
        vertices.push(next);
    }
}

/// Location of the origin in a convex set.
pub(super) enum Origin {
    Interior,
    /// Outward normal of a supporting plane through the origin: `n . w <= 0` for every point `w` of
    /// the set.
    Boundary(Big3),
}

/// A convex set given by its extreme points.
pub(super) struct PointSet<'a> {
    /// Returns a support point along a direction.
    pub(super) highest: &'a dyn Fn(&Big3) -> ExactPoint,
    /// Returns an edge at a vertex, from the edges that span the set as seen from the vertex.
    /// Prefers an edge that rises along a direction, then a level edge, then any edge. Returns
    /// `None` if there is no edge.
    pub(super) rising: &'a dyn Fn(&ExactPoint, &Big3) -> Option<ExactPoint>,
}

/// Locates the origin, which must be `at` and in the relative interior of its kept points.
pub(super) fn locate(set: &PointSet, at: &NearestPoint) -> Origin {
    let w = |k: usize| &at.kept[k].w;
    match at.kept.len() {
        1 => at_vertex(&|n| (set.rising)(&at.kept[0], n)),
        // The two points are on opposite sides of the origin, so either of them gives the line
        // through both.
        2 => on_line(set.highest, w(1)),
        // Because the origin is inside the triangle, no two of its vertices are parallel.
        3 => on_plane(set.highest, cross(w(0), w(1))),
        _ => Origin::Interior,
    }
}

/// Returns `Ok` if no point of the set rises along `n`, otherwise the support point.
fn supports(highest: &dyn Fn(&Big3) -> ExactPoint, n: &Big3) -> Result<(), ExactPoint> {
    let top = highest(n);
    if sign(&dot(n, &top.w)) <= 0 { Ok(()) } else { Err(top) }
}

/// Locates the origin in a set that contains a neighbourhood of it in the plane perpendicular to
/// `n`. Only `n` and `-n` can be outward normals.
fn on_plane(highest: &dyn Fn(&Big3) -> ExactPoint, n: Big3) -> Origin {
    let opposite = neg(&n);
    if supports(highest, &n).is_ok() {
        Origin::Boundary(n)
    } else if supports(highest, &opposite).is_ok() {
        Origin::Boundary(opposite)
    } else {
        Origin::Interior
    }
}

/// Locates the origin in a set that contains a neighbourhood of it on the line along `d`.
///
/// A normal is perpendicular to `d`, so the search is in the plane of `e` and `f`. The directions
/// that no support point has excluded yet are those from `start` counter-clockwise to `end`. If a
/// point of the set rises along `start`, `start` moves. The search ends if no point rises or no
/// direction is left.
///
/// ```text
///   start   f
///       \   |       top      A support point `top` excludes every n with n . top > 0.
///        \  |     .'         Not excluded: the directions from start, turning left, to end.
///         \ |  .'
///           o------- e
///            \
///             end
/// ```
fn on_line(highest: &dyn Fn(&Big3) -> ExactPoint, d: &Big3) -> Origin {
    let axis = (0..3)
        .find(|&k| d[(k + 1) % 3] != IBig::ZERO || d[(k + 2) % 3] != IBig::ZERO)
        .unwrap_or(0);
    let mut unit = [IBig::ZERO, IBig::ZERO, IBig::ZERO];
    unit[axis] = IBig::ONE;
    let e = cross(d, &unit);
    let f = cross(d, &e);
    let space = |n: &[IBig; 2]| [0, 1, 2].each(|k| &n[0] * &e[k] + &n[1] * &f[k]);
    let plane = |p: &Big3| [dot(&e, p), dot(&f, p)];
    let top = match supports(highest, &e) {
        Ok(()) => return Origin::Boundary(e),
        Err(top) => plane(&top.w),
    };
    let left = |p: &[IBig; 2]| [-&p[1], p[0].clone()];
    let mut start = left(&top);
    let end = [top[1].clone(), -&top[0]];
    loop {
        match supports(highest, &space(&start)) {
            Ok(()) => return Origin::Boundary(space(&start)),
            Err(top) => start = left(&plane(&top.w)),
        }
        let turn = sign(&(&start[0] * &end[1] - &start[1] * &end[0]));
        let ahead = sign(&(&start[0] * &end[0] + &start[1] * &end[1]));
        // Past the end, or at the direction opposite to it: no direction is left.
        if turn < 0 || (turn == 0 && ahead < 0) {
            return Origin::Interior;
        }
    }
}

/// Locates the origin at a vertex of the set.
///
/// A normal must not rise along any edge at the vertex, so the problem is to locate the origin in
/// the hull of the edge directions. Any rising edge is as good as the steepest. With each edge the
/// nearest point of the hull comes strictly nearer to the origin. If no edge rises, the set stays
/// on one side.
fn at_vertex(rising: &dyn Fn(&Big3) -> Option<ExactPoint>) -> Origin {
    let mut normal = [IBig::ONE, IBig::ZERO, IBig::ZERO];
    let mut vertices = Vec::new();
    while let Some(next) = rising(&normal) {
        if !vertices.is_empty() && sign(&dot(&normal, &next.w)) <= 0 {
            break;
        }
        vertices.push(next);
        // One to four points always have a nearest point.
        let Some(at) = nearest(&vertices) else { break };
        if is_zero(&at.direction) {
            // No edge has length zero, so the origin is not a vertex of the hull of the edges, and
            // the recursion ends here.
            let highest = |n: &Big3| rising(n).unwrap_or_else(|| at.kept[0].clone());
            let edges = PointSet {
                highest: &highest,
                rising: &|_, _| None,
            };
            return locate(&edges, &at);
        }
        (normal, vertices) = (neg(&at.direction), at.kept);
    }
    Origin::Boundary(normal)
}
