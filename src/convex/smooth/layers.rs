//! Solver after solver until the bounds of a pair agree.

use super::bent::{RunEnd, SolverRun};
use super::best::{BranchSet, ProvenBounds};
use super::frozen::{self, Around, Frozen, SolveGoal};
use super::posed::{PosedCores, askew, unit};
use super::warm;
use crate::base::num::scalar::{Scalar, Vec3, dot};
use crate::base::tolerance::AGREE_CURVED;
use crate::body::shape::Support;
use crate::pair::outcome::Solver;

/// End of the solvers of one arithmetic.
#[derive(PartialEq)]
pub(super) enum Ended {
    /// The bounds agree.
    Closed,
    Open,
    /// An overlap is proven.
    Deep,
}

/// Runs solver after solver until the bounds agree. `deep` proves an overlap: of cores that seem to
/// overlap, or whose difference contains the origin between four points.
#[inline(always)]
pub(super) fn separate<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    start: Option<(Vec3<T>, BranchSet)>,
    best: &mut ProvenBounds<T>,
    solver: &mut Solver,
    mut deep: impl FnMut(&ProvenBounds<T>, Option<Around<T>>) -> bool,
) -> Ended {
    let (mut start, mut closed) = (start, None);
    loop {
        if let Some((n, set)) = start {
            let end = warm::track(posed, n, &set, best);
            if end == Err(RunEnd::Closed) {
                return Ended::Closed;
            }
            // A lower bound goes with its own direction; a start is about of length one.
            let is_proven = best.lower > T::from(f64::NEG_INFINITY);
            let n = unit(&n).filter(|_| !is_proven).unwrap_or(best.n);
            if end == Err(RunEnd::Inside) && closed.is_none() && deep(&ProvenBounds { n, set, ..*best }, None) {
                return Ended::Deep;
            }
        }
        if let Some(closed) = closed {
            *best = closed;
            return Ended::Closed;
        }
        let ended = search(posed, start.is_some(), best, solver, &mut deep);
        if ended != Ended::Closed || best.is_opposite(posed) {
            return ended;
        }
        // Bounds that agree leave the direction open to the root of the tolerance.
        (start, closed) = (Some((best.n, best.set)), Some(*best));
    }
}

/// Runs the solvers behind the first one of a warm query.
#[inline(never)]
pub(super) fn search<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    is_warm: bool,
    best: &mut ProvenBounds<T>,
    solver: &mut Solver,
    mut deep: impl FnMut(&ProvenBounds<T>, Option<Around<T>>) -> bool,
) -> Ended {
    if is_warm {
        if let Some(ended) = bend(posed, best.n, best, &mut deep) {
            return ended;
        }
        *solver = Solver::Restart;
    }
    let axis = [T::from(1.0), T::from(0.0), T::from(0.0)];
    let n = unit(&posed.frame.translation).unwrap_or(axis);
    match frozen::solve(posed, n, SolveGoal::Approach, best) {
        Frozen::Closed => return Ended::Closed,
        Frozen::Inside(corners) if deep(best, Some(corners)) => return Ended::Deep,
        _ => {}
    }
    if let Some(ended) = bend(posed, toward_witness(posed, best), best, &mut deep) {
        return ended;
    }
    *solver = Solver::Fallback;
    match frozen::solve(posed, toward_witness(posed, best), SolveGoal::Close, best) {
        Frozen::Closed => Ended::Closed,
        Frozen::Inside(corners) if deep(best, Some(corners)) => Ended::Deep,
        _ => Ended::Open,
    }
}

/// Runs the main solver from a direction and the best pieces; returns `None` if the bounds stay
/// open.
fn bend<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    n: Vec3<T>,
    best: &mut ProvenBounds<T>,
    deep: &mut impl FnMut(&ProvenBounds<T>, Option<Around<T>>) -> bool,
) -> Option<Ended> {
    let (set, is_deep) = (best.set, false);
    let mut run = SolverRun {
        posed,
        best,
        deep: is_deep,
    };
    match run.run(n, &set) {
        RunEnd::Closed => Some(Ended::Closed),
        RunEnd::Inside if deep(best, None) => Some(Ended::Deep),
        _ => None,
    }
}

/// Returns the direction between the nearest points known; if the points coincide, a direction off
/// the symmetries that put them there.
fn toward_witness<A: Support, B: Support, T: Scalar>(posed: &PosedCores<A, B, T>, best: &ProvenBounds<T>) -> Vec3<T> {
    let w = posed.piece([0; 2], best.on_a, best.on_b).w;
    let least = T::from(AGREE_CURVED * posed.size);
    unit(&w)
        .filter(|_| dot(&w, &w) > least * least)
        .unwrap_or_else(|| askew(&best.n))
}
