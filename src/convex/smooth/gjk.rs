//! Fallback of the main solver: GJK on fixed support points, without curvature (Gilbert, Johnson
//! and Keerthi 1988).
//!
//! On curved cores GJK converges slowly, but from any start. At steps 4, 8, 16 and so on the main
//! solver tries to finish from the simplex. GJK also proves overlaps, by four points of the
//! difference around the origin.

use super::best_bounds::{BranchSet, ProvenBounds};
use super::newton_gjk::{RunEnd, SolverRun};
use super::posed::{DifferencePoint, PosedCores, askew, tangents, unit};
use crate::base::num::each::Each;
use crate::base::num::scalar::{Scalar, Vec3, neg};
use crate::body::shape::Support;
use crate::convex::minimum::simplex::{Indexed, Simplex};
use crate::pair::transform::ErrorScale;

/// Largest number of support points of one solve.
const POINTS: usize = 96;

/// Steps before the first attempt of the main solver to finish. Each further attempt follows after
/// twice as many steps, because an attempt costs as much as many steps. A heuristic.
const ATTEMPT: usize = 4;

/// Largest number of support points of a first approach.
const APPROACH: usize = 6;

/// Goal of a solve.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum SolveGoal {
    /// A direction within about 60° of the normal: a start for the main solver.
    Approach,
    /// Bounds that agree.
    Close,
}

/// Points of the difference around the origin.
#[derive(Clone, Copy)]
pub(super) struct Around<T> {
    points: [DifferencePoint<T>; 6],
    len: usize,
}

impl<T: Scalar> Around<T> {
    /// Returns four points that are proven to contain the origin, or six points, up and down three
    /// axes, that are not proven to do so.
    pub(super) fn points(&self) -> &[DifferencePoint<T>] {
        &self.points[..self.len]
    }

    pub(super) fn map<U: Scalar>(&self, of: impl Fn(DifferencePoint<T>) -> DifferencePoint<U>) -> Around<U> {
        Around {
            points: self.points.each(of),
            len: self.len,
        }
    }

    /// Returns the support points up and down three axes, rotated away from the symmetries of the
    /// cores. Along an axis of symmetry many points are equally high, and the six might lie in one
    /// plane.
    fn six<A: Support, B: Support>(posed: &PosedCores<A, B, T>, n: Vec3<T>) -> Self {
        let n = askew(&n);
        let [d, e] = tangents(&n);
        let at = |n: Vec3<T>| posed.support(&posed.toward(n), [0; 2]);
        Self {
            points: [n, neg(&n), d, neg(&d), e, neg(&e)].each(at),
            len: 6,
        }
    }
}

/// End of a solve.
pub(super) enum Frozen<T> {
    Closed,
    Open,
    /// The difference contains the origin, or seems to contain it.
    Inside(Around<T>),
}

/// Runs GJK from a direction. The branches of the simplex become the branch set of `best`.
pub(super) fn solve<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    n: Vec3<T>,
    goal: SolveGoal,
    best: &mut ProvenBounds<T>,
) -> Frozen<T> {
    let reach = ErrorScale {
        size: posed.size,
        shared: 0.0,
    };
    let toward = posed.toward(n);
    let first = posed.support(&toward, [0; 2]);
    best.prove(&toward, &first);
    best.point(&first);
    let mut points = [first; POINTS];
    let corner = |k: usize, piece: &DifferencePoint<T>| Indexed {
        index: k,
        w: neg(&piece.w),
    };
    let mut simplex = Simplex::vertex(corner(0, &first));
    for k in 1..if goal == SolveGoal::Approach { APPROACH } else { POINTS } {
        let Some(n) = unit(&neg(&simplex.direction())) else {
            return inside(posed, n, best);
        };
        let toward = posed.toward(n);
        let piece = posed.support(&toward, points[k - 1].of);
        let height = best.prove(&toward, &piece);
        points[k] = piece;
        let gains = simplex.add(corner(k, &piece), reach);
        if simplex.len() == 4 {
            let mut held = [piece; 6];
            for (held, c) in held.iter_mut().zip(simplex.points()) {
                *held = points[c.index];
            }
            return Frozen::Inside(Around { points: held, len: 4 });
        }
        let mut kept = [piece; 4];
        for (kept, c) in kept.iter_mut().zip(simplex.points()) {
            *kept = points[c.index];
        }
        best.mixture(posed, &kept[..simplex.len().min(4)], simplex.weights());
        if best.closes(posed) {
            return Frozen::Closed;
        }
        let near = goal == SolveGoal::Approach && height + height > simplex.witness_distance();
        if near || !gains || goal == SolveGoal::Close && k >= ATTEMPT && k.is_power_of_two() {
            let mut set = BranchSet::default();
            simplex.points().iter().for_each(|c| set.add(points[c.index].of));
            if goal == SolveGoal::Approach {
                best.set = set;
                return Frozen::Open;
            }
            let n = unit(&neg(&simplex.direction())).unwrap_or(n);
            if (SolverRun {
                posed,
                best,
                deep: false,
            })
            .run(n, &set)
                == RunEnd::Closed
            {
                return Frozen::Closed;
            }
            if !gains {
                return inside(posed, n, best);
            }
        }
    }
    Frozen::Open
}

/// Ends a solve whose simplex touches the origin, so that no direction is left: other points
/// contain it.
fn inside<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    n: Vec3<T>,
    best: &ProvenBounds<T>,
) -> Frozen<T> {
    if best.lower < T::from(0.0) {
        Frozen::Inside(Around::six(posed, n))
    } else {
        Frozen::Open
    }
}
