//! Balls about the pivots, which contain the shapes at every turn.

use nalgebra::{Isometry3, Vector3};

use super::{Flight, Separation};
use crate::motion::Course;
use crate::num::scalar::sqrt;
use crate::pose::Operand;
use crate::tolerance::{BALLS, PLANE, ROOT};

/// The time for which balls stay apart on a flight.
pub(crate) struct Apart {
    /// Time for which the balls are apart; infinite if for ever.
    pub(crate) span: f64,
    /// The radii about the pivots, and their sum.
    pub(crate) radii: [f64; 2],
    pub(crate) reach: f64,
    /// The distance of the balls.
    pub(crate) gap: f64,
    /// Upper bound of the effect of rounding and of the constant drift of both motions on a
    /// distance.
    pub(crate) noise: f64,
}

/// The radius about the pivot, and the pivot in the world less the pose's translation.
fn about<S: Separation + ?Sized>(pair: &S, of: Operand, pose: &Isometry3<f64>, course: &Course) -> (f64, Vector3<f64>) {
    let (centre, radius) = pair.ball(of);
    let arm = centre - course.pivot;
    let radius = radius
        + if arm == Vector3::zeros() {
            0.0
        } else {
            arm.norm() * (1.0 + PLANE)
        };
    let lever = if course.pivot.coords == Vector3::zeros() {
        Vector3::zeros()
    } else {
        pose.rotation * course.pivot.coords
    };
    (radius, lever)
}

pub(super) fn apart<S: Separation + ?Sized>(pair: &S, flight: &Flight) -> Apart {
    let (a, b, span) = (&flight.course_a, &flight.course_b, flight.span);
    let (radius_a, lever_a) = about(pair, Operand::A, &flight.pose_a, a);
    let (radius_b, lever_b) = about(pair, Operand::B, &flight.pose_b, b);
    let offset = flight.pose_b.translation.vector - flight.pose_a.translation.vector;
    let (between, velocity) = (offset + (lever_b - lever_a), b.linear - a.linear);
    let drift = a.drift(radius_a) + b.drift(radius_b);
    let reach = radius_a + radius_b;
    let size = reach + offset.norm() + 2.0 * (a.pivot.coords.norm() + b.pivot.coords.norm());
    let noise = PLANE * size + drift.0[0];
    let bent = 0.5 * (b.acceleration - a.acceleration).norm() * span * span;
    let radius = reach + flight.keep + PLANE * size + drift.at(span) + bent;
    // Both sides a little to the worse: more than what rounding takes of any term.
    let square = between.norm_squared();
    let above = square - (radius * radius + BALLS * (square + radius * radius));
    let approach = -between.dot(&velocity);
    let speed = velocity.norm_squared();
    let root = approach * approach - speed * above;
    let span = if !(above > 0.0) {
        0.0
    } else if approach <= 0.0 || root < 0.0 {
        f64::INFINITY
    } else {
        above / (approach + sqrt(root)) * (1.0 - ROOT)
    };
    Apart {
        span,
        radii: [radius_a, radius_b],
        reach,
        gap: sqrt(square) - radius,
        noise,
    }
}

/// Returns the time in which no point of A, seen from B, moves by as much as `way`.
pub(super) fn held<S: Separation + ?Sized>(pair: &S, flight: &Flight, way: f64) -> f64 {
    let (a, b) = (&flight.course_a, &flight.course_b);
    let (radius_a, _) = about(pair, Operand::A, &flight.pose_a, a);
    let (radius_b, _) = about(pair, Operand::B, &flight.pose_b, b);
    let drift = a.drift(radius_a) + b.drift(radius_b);
    let push = (b.acceleration - a.acceleration).norm();
    let pace = (b.linear - a.linear).norm() + radius_a * a.angular.norm() + radius_b * b.angular.norm();
    // Over the whole span, then over the rest: drifts and accelerations grow with the span for
    // which both are counted.
    let mut span = flight.span;
    for _ in 0..3 {
        let left = way * (1.0 - PLANE) - drift.at(span) - 0.5 * push * span * span;
        let held = if left <= 0.0 {
            0.0
        } else if pace * span <= left {
            return span;
        } else {
            left / pace * (1.0 - ROOT)
        };
        if held > 0.0 {
            return held;
        }
        span *= 0.25;
    }
    0.0
}
