//! From the answer of two cores to that of the rounded shapes: bounds lose both radii, witnesses
//! move along the normal.

use crate::base::num::extremes::Bounded;
use crate::base::num::packed::PackedVec3;
use crate::base::pose::RelativePose;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::pair::outcome::{Class, Outcome};
use crate::pair::rounding;

/// Moves distance, bounds and witnesses of cores out by both radii; returns whether the bounds
/// leave the class open.
#[inline]
pub(super) fn shift(pose: &RelativePose, radii: [f64; 2], outcome: &mut Outcome) -> bool {
    outcome.distance = rounding::less(outcome.distance, radii);
    [outcome.lower, outcome.upper] = rounding::bounds([outcome.lower, outcome.upper], radii);
    let n = *outcome.normal;
    outcome.point_on_a += n * radii[0];
    if radii[1] > 0.0 {
        outcome.point_on_b -= pose.vector_in_b(PackedVec3::new(&n)).vector() * radii[1];
    }
    outcome.class = match outcome.class {
        _ if outcome.lower > 0.0 => Class::Separated,
        _ if outcome.upper < 0.0 => Class::Overlapping,
        Class::Undecided => Class::Undecided,
        _ => Class::Touching,
    };
    outcome.lower <= 0.0 && 0.0 <= outcome.upper
}

/// Moves the outcome of two polyhedra out by both radii. If the bounds leave the class open, exact
/// arithmetic decides the class.
#[inline]
pub(super) fn grow(
    cores: (&ConvexPolyhedron, &ConvexPolyhedron),
    pose: &RelativePose,
    radii: [f64; 2],
    outcome: &mut Outcome,
) {
    if shift(pose, radii, outcome) {
        settle(cores, pose, radii, outcome);
    }
}

#[cfg(feature = "exact")]
#[cold]
fn settle((a, b): (&ConvexPolyhedron, &ConvexPolyhedron), pose: &RelativePose, radii: [f64; 2], outcome: &mut Outcome) {
    use crate::pair::outcome::Solver;
    use core::cmp::Ordering;
    let hint = outcome.features.vertices_of(a, b);
    outcome.work.exacts += 1;
    outcome.solver = Solver::Exact;
    match crate::convex::exact::compare(a, b, pose, hint, &radii) {
        Ordering::Greater => {
            outcome.class = Class::Separated;
            outcome.lower = outcome.lower.at_least(0.0);
        }
        Ordering::Equal => {
            outcome.class = Class::Touching;
            (outcome.lower, outcome.upper) = (0.0, 0.0);
        }
        Ordering::Less => {
            outcome.class = Class::Overlapping;
            outcome.upper = outcome.upper.at_most(0.0);
        }
    }
    outcome.distance = outcome.distance.clamped(outcome.lower, outcome.upper);
}

#[cfg(not(feature = "exact"))]
fn settle(_: (&ConvexPolyhedron, &ConvexPolyhedron), _: &RelativePose, _: [f64; 2], _: &mut Outcome) {}
