//! Invariants of every certified outcome, checked in debug builds.

use nalgebra::Vector3;

use crate::base::pose::RelativePose;
use crate::base::tolerance::{UNIT_LENGTH, WITNESS_CHECK};
use crate::body::polyhedron::ConvexPolyhedron;
use crate::pair::outcome::{ContactState, Outcome, Solver};

/// Returns a description of the first violated invariant, or `None` if the outcome is sound.
///
/// The invariants concern the bounds, the normal and the witnesses.
pub(crate) fn fault(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    pose: &RelativePose,
    o: &Outcome,
) -> Option<&'static str> {
    // NaN violates every comparison.
    if !(o.lower <= o.distance && o.distance <= o.upper) {
        return Some("the distance is not between its bounds");
    }
    if !(o.distance.is_finite() && o.upper.is_finite()) {
        return Some("the distance or its upper bound is not finite");
    }
    let classed = match o.state {
        // If the distance underflows, exact arithmetic may know more than a bound can express.
        ContactState::Separated => o.lower > 0.0 || o.lower == 0.0 && o.solver >= Solver::Exact,
        ContactState::Overlapping => o.upper <= 0.0,
        ContactState::Touching => o.lower <= 0.0 && o.upper >= 0.0,
        ContactState::Undecided => true,
    };
    if !classed {
        return Some("the bounds contradict the contact state");
    }
    if !((o.normal.norm() - 1.0).abs() <= UNIT_LENGTH) {
        return Some("the normal is not of unit length");
    }
    // Witnesses are unchecked if the bodies are too far apart or too near for squares.
    if o.solver == Solver::Far || witnesses_agree(a, b, pose, o) {
        None
    } else {
        Some("the witnesses contradict the bounds")
    }
}

/// Returns whether the witnesses, transformed in f64, are as far apart as the bounds require, also
/// along the normal.
///
/// The slack covers the rounding of witnesses in the caller's coordinates, possibly far from the
/// body.
fn witnesses_agree(a: &ConvexPolyhedron, b: &ConvexPolyhedron, pose: &RelativePose, o: &Outcome) -> bool {
    let (p, q) = (o.point_on_a.coords, o.point_on_b.coords);
    let between = pose.rotation() * q + pose.translation() - p;
    let apart = length(&between);
    let origins = length(&a.origin) + length(&b.origin);
    let size = a.radius * a.unit() + b.radius * b.unit() + length(&pose.translation()) + 2.0 * origins;
    let slack = WITNESS_CHECK * size;
    if o.state == ContactState::Undecided {
        return apart.is_finite();
    }
    let along = o.normal.dot(&between);
    match o.state {
        // The witness on B lies behind the witness on A by the depth.
        ContactState::Overlapping => {
            apart <= -o.lower + slack && apart >= -o.upper - slack && -along >= -o.upper - slack
        }
        ContactState::Separated => apart <= o.upper + slack && apart >= o.lower - slack && along >= o.lower - slack,
        _ => apart <= o.upper + slack,
    }
}

/// Returns the length of a vector whose squares may overflow or underflow.
fn length(v: &Vector3<f64>) -> f64 {
    let largest = v.amax();
    if largest > 0.0 {
        largest * crate::base::num::scalar::sqrt((v / largest).norm_squared())
    } else {
        largest
    }
}
