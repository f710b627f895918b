//! Depth of an overlap.
//!
//! From the best direction known, the main solver descends to the nearest local minimum of the
//! depth. Balls inside both cores that touch the surfaces at the deepest points prove a global
//! minimum if the balls are larger than the depth: if A contains a ball of radius `rA` about `cA`
//! and B a ball of radius `rB` about `cB`, the depth is at least `rA + rB - |cB - cA|`. Otherwise a
//! surface around the origin gives an interval.

use super::bent::Run;
use super::best::{Best, Set};
use super::frozen::Around;
use super::posed::Posed;
use super::surface;
use crate::shape::Support;
use crate::tolerance::{CERTIFICATE, DEPTH_GOAL, UNIT};

/// Bounds of the depth of cores that overlap or seem to.
pub(super) struct Deep {
    pub(super) best: Best<f64>,
    /// Whether four points of the difference are proven to contain the origin.
    pub(super) inside: bool,
    /// Whether a surface was grown.
    pub(super) grown: bool,
}

/// Searches the depth from a direction and branches; by a surface only from `corners` that contain
/// the origin.
pub(super) fn deepen<A: Support, B: Support>(
    posed: &Posed<A, B, f64>,
    known: &Best<f64>,
    corners: Option<Around<f64>>,
) -> Deep {
    let mut best = Best {
        upper: f64::INFINITY,
        ..*known
    };
    local(posed, known.n, &known.set, &mut best);
    let mut deep = Deep {
        best,
        inside: corners.is_some_and(|c| c.points().len() == 4),
        grown: false,
    };
    let is_done = best.closes(posed) || is_deep_enough(posed, &best);
    let Some(corners) = corners.filter(|_| !is_done) else {
        return deep;
    };
    deep.grown = true;
    let best = &mut deep.best;
    let Some(found) = surface::deepen(posed, corners.points(), best) else {
        return deep;
    };
    deep.inside = true;
    let mut set = Set::default();
    found.of.into_iter().for_each(|of| set.add(of));
    local(posed, found.n, &set, best);
    if best.upper > -found.least {
        (best.upper, best.set) = (-found.least, set);
    }
    deep
}

/// Returns whether an overlap is proven, and the depth to the accuracy of a surface.
pub(super) fn is_deep_enough<A: Support, B: Support>(posed: &Posed<A, B, f64>, best: &Best<f64>) -> bool {
    let goal = DEPTH_GOAL * posed.size;
    best.upper < -(CERTIFICATE + posed.noise) * UNIT * posed.size && best.upper - best.lower <= goal
}

/// Runs the main solver for the depth from one direction.
pub(super) fn local<A: Support, B: Support>(posed: &Posed<A, B, f64>, n: [f64; 3], set: &Set, best: &mut Best<f64>) {
    let deep = true;
    Run { posed, best, deep }.run(n, set);
}
