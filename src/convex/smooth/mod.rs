//! Curved cores: signed distance with proven bounds, tracked.
//!
//! One solver for all pairs: GJK whose direction step knows the curvature (`bent`, on the model of
//! `model`). Before it, the parts of the last answer are proved again (`warm`); behind it stand GJK
//! on fixed support points (`frozen`), then both in double-double (`ladder`, the order of all).
//! Overlaps and their witnesses are the work of `depth` and `surface`. A core is a support map with
//! branches and second derivatives ([`Support`](crate::shape::Support)); there is no table of pairs
//! of kinds.
//!
//! For any unit direction the height of the difference is a lower bound of the signed distance, the
//! distance of any two points an upper bound; both are taken at every step, with the error terms of
//! [`CERTIFICATE`](crate::tolerance::CERTIFICATE).
//!
//! Sources: Gilbert, Johnson and Keerthi 1988; Newton's method on the dual as in Lin 1993, chapter
//! 4, and Montaut et al. 2022 for the acceleration of GJK. Departures:
//! 1. The step uses the second derivative of the support function, so it is quadratic on smooth
//!    cores and that of GJK on flat ones.
//! 2. Kinks (edges, sides of cylinders, flat faces) are up to three branches with weights, as a
//!    face of a simplex.
//! 3. Every answer carries both bounds, whatever the solver.

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
use crate::body::shape::{Core, match_core, order_of};
use crate::pair::outcome::{DepthMode, Outcome};

/// Returns the place of a kind in the order in which a pair is solved.
fn rank(core: &Core) -> u32 {
    match_core!(core, _ => 0, core => order_of(core))
}

/// Returns the closest points of two cores, at least one of them curved.
///
/// The cores are solved in the order of kinds, so that A-B and B-A are one problem, and matched
/// once. All further code knows both kinds; slow paths alone see [`Any`](cores::Any). A local depth
/// is the height of a direction that is highest in its neighbourhood, of cores that are proven to
/// overlap.
#[inline]
pub(crate) fn closest(a: &Core, b: &Core, pose: &RelativePose, until: DepthMode, memory: &mut WarmStart) -> Outcome {
    if rank(a) <= rank(b) {
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
        (Core::Polyhedron(x), Core::Superquadric(y)) => closest_of(&hull(x), y, &setting, memory),
        (Core::Ellipsoid(x), Core::Superquadric(y)) => closest_of(x, y, &setting, memory),
        (Core::Cylinder(x), Core::Superquadric(y)) => closest_of(x, y, &setting, memory),
        (Core::Cone(x), Core::Superquadric(y)) => closest_of(x, y, &setting, memory),
        (Core::Superquadric(x), Core::Superquadric(y)) => closest_of(x, y, &setting, memory),
        _ => ladder::extreme(a, b, &setting, memory),
    }
}
