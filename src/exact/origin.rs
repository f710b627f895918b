//! Inside or on the boundary: where exactly the origin lies in a convex set that holds it.

use alloc::vec::Vec;

use dashu_int::IBig;

use crate::exact::integer::{Big3, cross, dot, is_zero, neg};
use crate::exact::simplex::{ExactPoint, Nearest, nearest, sign};

/// Where the origin lies in a convex set that holds it.
pub(super) enum Origin {
    Interior,
    /// The set lies on the side of the origin that this does not point to: `n . w <= 0` for all of it.
    Boundary(Big3),
}

/// A convex set by its extreme points.
pub(super) struct Set<'a> {
    /// A point greatest along a direction.
    pub(super) highest: &'a dyn Fn(&Big3) -> ExactPoint,
    /// Of the edges that leave a corner and span the set seen from there: one that rises along a direction if one does, or else one that is
    /// level if one is, or else any. `None` where there is no edge.
    pub(super) rising: &'a dyn Fn(&ExactPoint, &Big3) -> Option<ExactPoint>,
}

/// Locates the origin, which `at` holds in the relative interior of its corners.
pub(super) fn locate(set: &Set, at: &Nearest) -> Origin {
    let w = |k: usize| &at.kept[k].w;
    match at.kept.len() {
        1 => at_vertex(&|n| (set.rising)(&at.kept[0], n)),
        // The two corners are opposite, so either is the line through both.
        2 => on_line(set.highest, w(1)),
        // With the origin inside their triangle, no two corners are parallel.
        3 => on_plane(set.highest, cross(w(0), w(1))),
        _ => Origin::Interior,
    }
}

/// Whether the set stays on one side of `n` and the origin.
fn supports(highest: &dyn Fn(&Big3) -> ExactPoint, n: &Big3) -> Result<(), ExactPoint> {
    let top = highest(n);
    if sign(&dot(n, &top.w)) <= 0 { Ok(()) } else { Err(top) }
}

/// The set holds a neighbourhood of the origin in the plane across `n`: only `n` and `-n` can support it.
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

/// The set holds a neighbourhood of the origin on the line along `d`: a normal is across it, so the search is in the
/// plane of `e` and `f`. The directions that no point found so far rules out are those from `start`, turning left, to
/// `end`; `start` is tried and moved until it supports or nothing is left.
fn on_line(highest: &dyn Fn(&Big3) -> ExactPoint, d: &Big3) -> Origin {
    let axis = (0..3)
        .find(|&k| d[(k + 1) % 3] != IBig::ZERO || d[(k + 2) % 3] != IBig::ZERO)
        .unwrap_or(0);
    let mut unit = [IBig::ZERO, IBig::ZERO, IBig::ZERO];
    unit[axis] = IBig::ONE;
    let e = cross(d, &unit);
    let f = cross(d, &e);
    let space = |n: &[IBig; 2]| [0, 1, 2].map(|k| &n[0] * &e[k] + &n[1] * &f[k]);
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

/// The origin is a corner of the set: a normal must not rise along any of its edges, so the question is where the
/// origin lies in the hull of the edge directions.
///
/// An edge that rises is as good as the highest: with each the nearest point of those found comes nearer to the origin, and where none
/// rises, the set stays on one side.
fn at_vertex(rising: &dyn Fn(&Big3) -> Option<ExactPoint>) -> Origin {
    let mut normal = [IBig::ONE, IBig::ZERO, IBig::ZERO];
    let mut corners = Vec::new();
    while let Some(next) = rising(&normal) {
        if !corners.is_empty() && sign(&dot(&normal, &next.w)) <= 0 {
            break;
        }
        corners.push(next);
        // One to four corners always have a nearest point.
        let Some(at) = nearest(&corners) else { break };
        if is_zero(&at.direction) {
            // No edge is zero, so the origin is not a corner of their hull and this goes no deeper.
            let highest = |n: &Big3| rising(n).unwrap_or_else(|| at.kept[0].clone());
            let edges = Set {
                highest: &highest,
                rising: &|_, _| None,
            };
            return locate(&edges, &at);
        }
        (normal, corners) = (neg(&at.direction), at.kept);
    }
    Origin::Boundary(normal)
}
