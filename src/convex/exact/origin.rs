//! Exact location of the origin in a convex set that contains the origin: interior or boundary.
//!
//! ```text
//!   1 point kept:  vertex    any edge of the set may rule a normal out
//!   2 points:      line      a normal is perpendicular to d: search the plane of e and f
//!   3 points:      plane     only n and -n are possible normals
//!   4 points:      interior
//! ```

use crate::base::num::each::Each;
use alloc::vec::Vec;

use dashu_int::IBig;

use crate::convex::exact::integer::{Big3, cross, dot, is_zero, neg, sign};
use crate::convex::exact::simplex::{ExactPoint, NearestPoint, nearest};

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
    /// Returns an edge at a vertex, from the edges that span the set as seen from the vertex: an
    /// edge that rises along a direction if there is any, else a level edge if there is any, else
    /// an arbitrary edge. `None` if there is no edge.
    pub(super) rising: &'a dyn Fn(&ExactPoint, &Big3) -> Option<ExactPoint>,
}

/// Locates the origin, which must be `at`, in the relative interior of the kept points.
pub(super) fn locate(set: &PointSet, at: &NearestPoint) -> Origin {
    let w = |k: usize| &at.kept[k].w;
    match at.kept.len() {
        1 => at_vertex(&|n| (set.rising)(&at.kept[0], n)),
        // The two points are opposite, so either gives the line through both.
        2 => on_line(set.highest, w(1)),
        // With the origin inside the triangle, no two of its vertices are parallel.
        3 => on_plane(set.highest, cross(w(0), w(1))),
        _ => Origin::Interior,
    }
}

/// Returns whether no point of the set rises along `n`; if a point does, the support point.
fn supports(highest: &dyn Fn(&Big3) -> ExactPoint, n: &Big3) -> Result<(), ExactPoint> {
    let top = highest(n);
    if sign(&dot(n, &top.w)) <= 0 { Ok(()) } else { Err(top) }
}

/// Locates the origin in a set that contains a neighbourhood of the origin in the plane
/// perpendicular to `n`: only `n` and `-n` can be outward normals.
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

/// Locates the origin in a set that contains a neighbourhood of the origin on the line along `d`.
///
/// A normal is perpendicular to `d`, so the search is in the plane of `e` and `f`. The directions
/// not yet excluded by a support point are the ones from `start`, turning left, to `end`; `start`
/// is tried and moved until no point of the set rises along `start` or no direction is left.
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
        // Past the end, or turned right round: no direction is left.
        if turn < 0 || (turn == 0 && ahead < 0) {
            return Origin::Interior;
        }
    }
}

/// Locates the origin at a vertex of the set: a normal must not rise along any edge at the vertex,
/// so the question becomes the location of the origin in the hull of the edge directions.
///
/// Any rising edge serves as well as the steepest: with each edge the nearest point of the hull so
/// far comes strictly nearer to the origin, and if no edge rises, the set stays on one side.
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
            // No edge is zero, so the origin is no vertex of the edges' hull and the recursion ends
            // here.
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
