//! Depth of an overlap.
//!
//! From the best direction known, the main solver descends to the nearest local minimum of the
//! depth. Balls inside both cores that touch the surfaces at the deepest points prove a global
//! minimum if the balls are larger than the depth: if A contains a ball of radius `rA` about `cA`
//! and B a ball of radius `rB` about `cB`, the depth is at least `rA + rB - |cB - cA|`. Cylinders
//! and cones about parallel axes have the depth of two polygons (`parallel`). Otherwise a surface
//! around the origin gives an interval.

use alloc::vec::Vec;

use super::bent::SolverRun;
use super::best::{BranchSet, ProvenBounds};
use super::frozen::{self, Around, Frozen, SolveGoal};
use super::parallel;
use super::posed::{DifferencePoint, PosedCores, unit};
use super::surface;
use crate::base::num::scalar::{Vec3, cross, neg, sub};
use crate::base::tolerance::{CERTIFICATE, DEPTH_GOAL, UNIT};
use crate::body::shape::Support;
use crate::pair::outcome::Until;

/// Bounds of the depth of cores that overlap or seem to.
pub(super) struct Deep {
    pub(super) best: ProvenBounds<f64>,
    /// Whether four points of the difference are proven to contain the origin.
    pub(super) inside: bool,
    /// Whether a surface was grown.
    pub(super) grown: bool,
}

/// Searches the depth from a direction and branches; by a surface only from `corners` that contain
/// the origin, and only if a local depth will not do.
pub(super) fn deepen<A: Support, B: Support>(
    posed: &PosedCores<A, B, f64>,
    known: &ProvenBounds<f64>,
    corners: Option<Around<f64>>,
    until: Until,
) -> Deep {
    let mut best = ProvenBounds {
        upper: f64::INFINITY,
        ..*known
    };
    local(posed, known.n, &known.set, &mut best);
    let is_known = best.closes(posed) || (until == Until::LocalDepth && is_enough(posed, &best, until));
    if !is_known {
        parallel::prove(posed, &mut best);
    }
    let mut deep = Deep {
        best,
        inside: corners.is_some_and(|c| c.points().len() == 4),
        grown: false,
    };
    let is_local = until == Until::LocalDepth && deep.inside && best.lower < 0.0;
    let is_done = is_local || is_enough(posed, &best, until);
    if until == Until::LocalDepth && !is_done && corners.is_none() && best.lower < 0.0 {
        prove_overlap(posed, &mut deep);
    }
    let Some(corners) = corners.filter(|_| !is_done) else {
        return deep;
    };
    deep.grown = true;
    let best = &mut deep.best;
    let Some(found) = surface::deepen(posed, corners.points(), best) else {
        from_faces(posed, corners.points(), best);
        return deep;
    };
    deep.inside = true;
    let mut set = BranchSet::default();
    found.of.into_iter().for_each(|of| set.add(of));
    local(posed, found.n, &set, best);
    if best.upper > -found.least {
        (best.upper, best.set) = (-found.least, set);
    }
    deep
}

/// Searches four points of the difference about the origin, for a local depth that no balls prove
/// to be one of an overlap: that of two rims or edges.
fn prove_overlap<A: Support, B: Support>(posed: &PosedCores<A, B, f64>, deep: &mut Deep) {
    let mut apart = ProvenBounds::new();
    if let Frozen::Inside(corners) = frozen::solve(posed, deep.best.n, SolveGoal::Approach, &mut apart) {
        deep.inside = corners.points().len() == 4;
    }
    deep.best.evaluations += apart.evaluations;
}

/// Searches the depth from the normals of flat faces and of the triangles between the corners.
///
/// No surface is certain if the origin is on the boundary of the difference but for rounding. Then
/// it lies in the hull of corners that all lie on the supporting plane through the origin: a flat
/// face of a core that bears contains branches of such corners, and if there is none, three corners
/// are close to the plane.
fn from_faces<A: Support, B: Support>(
    posed: &PosedCores<A, B, f64>,
    corners: &[DifferencePoint<f64>],
    best: &mut ProvenBounds<f64>,
) {
    let mut prove = |n: Vec3<f64>, of: [u32; 2]| {
        let toward = posed.toward(n);
        best.prove(&toward, &posed.support(&toward, of));
    };
    for piece in corners {
        let of = piece.of;
        posed.a.flat_faces(of[0], &mut |n| prove(n, of));
        posed
            .b
            .flat_faces(of[1], &mut |m| prove(neg(&posed.frame.vector(&m)), of));
    }
    let mut starts = Vec::from([best.n]);
    for k in 0..corners.len() {
        let [p, q, r] = [1, 2, 3].map(|by| corners[(k + by) % corners.len()].w);
        let n = unit(&cross(&sub(&q, &p), &sub(&r, &p)));
        starts.extend(n.iter().flat_map(|n| [*n, neg(n)]));
    }
    for n in starts {
        local(posed, n, &BranchSet::default(), best);
    }
}

/// Returns whether the bounds agree, or an overlap is proven and its depth to the accuracy of a
/// surface, or from above if a local depth will do.
pub(super) fn is_enough<A: Support, B: Support>(
    posed: &PosedCores<A, B, f64>,
    best: &ProvenBounds<f64>,
    until: Until,
) -> bool {
    let is_overlap = best.upper < -(CERTIFICATE + posed.noise) * UNIT * posed.size;
    let is_near = until == Until::LocalDepth || best.upper - best.lower <= DEPTH_GOAL * posed.size;
    best.closes(posed) || (is_overlap && is_near)
}

/// Runs the main solver for the depth from one direction.
pub(super) fn local<A: Support, B: Support>(
    posed: &PosedCores<A, B, f64>,
    n: [f64; 3],
    set: &BranchSet,
    best: &mut ProvenBounds<f64>,
) {
    let deep = true;
    SolverRun { posed, best, deep }.run(n, set);
}
