//! Signed distance of curved cores, with proven bounds, tracked from query to query.
//!
//! A core is a support map with branches and second derivatives
//! ([`Support`](crate::shape::Support)). One solver handles all pairs of kinds; there is no table
//! of pairs. The solvers run in this order (`ladder`):
//! 1. `warm_start` proves the support sets of the last answer again.
//! 2. `newton_gjk`, the main solver, is GJK whose direction step uses the curvature by the local
//!    model in `model`.
//! 3. `gjk` is GJK on fixed support points.
//! 4. If the bounds still disagree, all of them run again in double-double.
//!
//! `depth` computes the depth and the witness points of an overlap; `polytope` bounds the depth if
//! no local method proves it.
//!
//! For any unit direction the support value of the difference is a lower bound of the signed
//! distance. The distance of any two points is an upper bound. Both are computed at every step,
//! with the error terms of `tolerance::CERTIFICATE`.
//!
//! Sources: Gilbert, Johnson and Keerthi 1988; Lin 1993, chapter 4, for Newton's method on the
//! dual; Montaut et al. 2022 for the acceleration of GJK. Departures:
//! 1. The step uses the second derivative of the support function. It converges quadratically on
//!    smooth cores, and equals the step of GJK on flat ones.
//! 2. A kink (an edge, the side of a cylinder, a flat face) is represented by up to three weighted
//!    branches, like a face of a simplex.
//! 3. Every solver returns both bounds.

mod best_bounds;
mod cores;
mod depth;
mod flat_round_faces;
mod gjk;
mod ladder;
mod model;
mod newton_gjk;
mod polytope;
mod posed;
mod warm_start;

use alloc::sync::Arc;

#[cfg(feature = "__proofs")]
pub(crate) use best_bounds::bounds_along;
use cores::PolyhedralCore;
pub(crate) use ladder::WarmStart;
use ladder::{SolverSetting, closest_of};

use crate::base::pose::RelativePose;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::body::shape::Core;
use crate::pair::outcome::{DepthMode, Outcome};

/// Returns the closest points of two cores, at least one of them curved.
///
/// The cores are solved in the order of their kinds, so that A-B and B-A are the same problem.
/// Their kinds are matched once: all further code knows both, and only slow paths see
/// [`Any`](cores::Any). A local depth is the support value of a locally best direction, of cores
/// that are proven to overlap.
#[inline]
pub(crate) fn closest(a: &Core, b: &Core, pose: &RelativePose, until: DepthMode, memory: &mut WarmStart) -> Outcome {
    if a.rank() <= b.rank() {
        return ordered(a, b, pose, until, memory);
    }
    let pose = pose.swapped();
    memory.swap(&pose);
    let mut outcome = ordered(b, a, &pose, until, memory);
    outcome.features = outcome.features.swapped();
    core::mem::swap(&mut outcome.point_on_a, &mut outcome.point_on_b);
    outcome.normal = crate::pair::draft::unit(&-pose.rotation().tr_mul(&outcome.normal));
    outcome
}

fn hull(body: &Arc<ConvexPolyhedron>) -> PolyhedralCore<'_> {
    PolyhedralCore { body, unit: 1.0 }
}

#[inline(always)]
fn ordered(a: &Core, b: &Core, pose: &RelativePose, until: DepthMode, memory: &mut WarmStart) -> Outcome {
    let setting = SolverSetting::new(a, b, pose, until);
    if !setting.is_plain() {
        return ladder::extreme(a, b, &setting, memory);
    }
    match (a, b) {
        (Core::Polyhedron(x), Core::Ellipsoid(y)) => closest_of(&hull(x), y, &setting, memory),
        (Core::Polyhedron(x), Core::Cylinder(y)) => closest_of(&hull(x), y, &setting, memory),
        (Core::Polyhedron(x), Core::Cone(y)) => closest_of(&hull(x), y, &setting, memory),
        (Core::Ellipsoid(x), Core::Ellipsoid(y)) => closest_of(x, y, &setting, memory),
        (Core::Ellipsoid(x), Core::Cylinder(y)) => closest_of(x, y, &setting, memory),
        (Core::Ellipsoid(x), Core::Cone(y)) => closest_of(x, y, &setting, memory),
        (Core::Cylinder(x), Core::Cylinder(y)) => closest_of(x, y, &setting, memory),
        (Core::Cylinder(x), Core::Cone(y)) => closest_of(x, y, &setting, memory),
        (Core::Cone(x), Core::Cone(y)) => closest_of(x, y, &setting, memory),
        _ => ladder::extreme(a, b, &setting, memory),
    }
}
