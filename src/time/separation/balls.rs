//! Balls around the pivots, which contain the shapes at every rotation.

use crate::time::separation::bernstein::ROUNDS;
use nalgebra::{Isometry3, Vector3};

use super::fixed_normal::cut;
use super::{PairMotion, Separation};
use crate::base::motion::{MotionModel, Remainder, length};
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::{magnitude, sqrt};
use crate::base::pose::Operand;
use crate::base::tolerance::{BALLS, PLANE, ROOT};

/// The time for which balls stay separated during a motion.
pub(crate) struct Apart {
    /// Duration for which the balls are separated; infinite if for ever.
    pub(crate) span: f64,
    /// The radii around the pivots, and their sum.
    pub(crate) radii: [f64; 2],
    pub(crate) reach: f64,
    /// The distance of the balls.
    pub(crate) gap: f64,
    /// Upper bound of the effect of rounding and of the constant drift of both motions on a
    /// distance.
    pub(crate) noise: f64,
}

/// Returns the radius around the pivot, and the pivot in the world minus the pose's translation.
#[inline(always)]
fn about<S: Separation + ?Sized>(
    pair: &S,
    of: Operand,
    flight: &PairMotion,
    (pose, model): (&Isometry3<f64>, &MotionModel),
) -> (f64, Vector3<f64>) {
    let (centre, radius) = pair.ball_during(of, flight);
    let arm = centre - model.pivot;
    let radius = radius
        + if arm == Vector3::zeros() {
            0.0
        } else {
            length(&arm) * (1.0 + PLANE)
        };
    let lever = if model.pivot.coords == Vector3::zeros() {
        Vector3::zeros()
    } else {
        pose.rotation * model.pivot.coords
    };
    (radius, lever)
}

pub(super) fn apart<S: Separation + ?Sized>(pair: &S, flight: &PairMotion) -> Apart {
    let (a, b) = (&flight.model_a, &flight.model_b);
    // On the motion's own clock, see [`PairMotion::on_own_clock`].
    let tick = magnitude(flight.span);
    let span = flight.span / tick;
    let (radius_a, lever_a) = about(pair, Operand::A, flight, (&flight.pose_a, a));
    let (radius_b, lever_b) = about(pair, Operand::B, flight, (&flight.pose_b, b));
    let offset = flight.pose_b.translation.vector - flight.pose_a.translation.vector;
    let (between, velocity) = (offset + (lever_b - lever_a), flight.velocity() * tick);
    let drift = (a.drift(radius_a) + b.drift(radius_b)).on_clock(tick);
    let reach = radius_a + radius_b;
    let size = reach + length(&offset) + 2.0 * (length(&a.pivot.coords) + length(&b.pivot.coords));
    let noise = PLANE * size + drift.0[0] + f64::MIN_POSITIVE;
    let near = reach + flight.required + noise;
    let distance = length(&between);
    if !(distance > near) {
        return Apart {
            span: 0.0,
            radii: [radius_a, radius_b],
            reach,
            gap: distance - near,
            noise,
        };
    }
    // Terms that grow faster than linearly may use half of the gap; this limits the time.
    let Remainder([_, d1, d2, d3]) = drift;
    let growth = Remainder([0.0, d1, d2 + length(&flight.acceleration()) * tick * tick, d3]);
    let ahead = if growth == Remainder::default() {
        span
    } else {
        until_as_far(&growth, 0.5 * (distance - near), span)
    };
    let radius = near + growth.at(ahead);
    let until = until_as_near(&between, &velocity, radius);
    Apart {
        span: if ahead < span { until.smaller(ahead) } else { until } * tick,
        radii: [radius_a, radius_b],
        reach,
        gap: distance - radius,
        noise,
    }
}

/// Returns the time before which a point with a constant velocity is farther than `radius` from the
/// origin.
///
/// Infinite if for ever.
fn until_as_near(from: &Vector3<f64>, velocity: &Vector3<f64>, radius: f64) -> f64 {
    // Products have degree four, so lengths and velocities are scaled to about one.
    let most = |v: &Vector3<f64>| v.x.abs().at_least(v.y.abs()).at_least(v.z.abs());
    let (unit, pace) = (magnitude(most(from).at_least(radius)), magnitude(most(velocity)));
    let (from, velocity, radius) = (from / unit, velocity / pace, radius / unit);
    let [above, approach, _, root] = flight_of_ball(&from, &velocity, radius);
    if !(above > 0.0) {
        0.0
    } else if approach <= 0.0 || root < 0.0 {
        f64::INFINITY
    } else {
        above / (approach + sqrt(root)) * (1.0 - ROOT) * unit / pace
    }
}

/// Returns the squared distance minus the squared radius, the approach, the squared velocity, and
/// the discriminant.
///
/// The squared distance is rounded down and the squared radius up, by more than rounding changes
/// any term.
#[inline(always)]
pub(crate) fn flight_of_ball(from: &Vector3<f64>, velocity: &Vector3<f64>, radius: f64) -> [f64; 4] {
    let square = from.norm_squared();
    let above = square - (radius * radius + BALLS * (square + radius * radius));
    let approach = -from.dot(velocity);
    let speed = velocity.norm_squared();
    [above, approach, speed, approach * approach - speed * above]
}

/// Returns the time during which no point of A, seen from B, moves by as much as `way`.
pub(super) fn held<S: Separation + ?Sized>(pair: &S, flight: &PairMotion, way: f64) -> f64 {
    let (timed, tick) = flight.on_own_clock();
    let (a, b) = (&timed.model_a, &timed.model_b);
    let (radius_a, _) = about(pair, Operand::A, flight, (&flight.pose_a, a));
    let (radius_b, _) = about(pair, Operand::B, flight, (&flight.pose_b, b));
    let Remainder([d0, d1, d2, d3]) = a.drift(radius_a) + b.drift(radius_b);
    let push = length(&(b.acceleration - a.acceleration));
    let pace = length(&(b.linear - a.linear)) + radius_a * length(&a.angular) + radius_b * length(&b.angular);
    let way = way * (1.0 - PLANE) - d0 - f64::MIN_POSITIVE;
    until_as_far(&Remainder([0.0, pace + d1, push + d2, d3]), way, timed.span) * tick
}

/// Returns a time, at most `span`, up to which a displacement that grows from zero is less than
/// `way`.
fn until_as_far(growth: &Remainder, way: f64, span: f64) -> f64 {
    // Comparisons are written so that NaN ends at zero.
    if !(way > 0.0) {
        return 0.0;
    }
    if growth.at(span) < way {
        return span;
    }
    // The first and the second term each reach `way` no earlier than this, and the cubic term is at
    // most `way` after some cuts. So all three together are at most three times `way`.
    let [_, first, second, _] = growth.0;
    let mut late = span.smaller(way / first).smaller(sqrt(2.0 * way / second));
    // Cuts by a quarter do not end at zero.
    while growth.at(late) > 3.0 * way && late > f64::MIN_POSITIVE {
        late *= cut(growth.at(late) / (3.0 * way));
    }
    // The displacement is convex, so it lies below its chords: a chord reaches `way` first.
    let most = growth.at(late);
    let mut early = 0.0;
    for _ in 0..ROUNDS {
        let gone = growth.at(early);
        let next = early + (late - early) * ((way - gone) / (most - gone));
        if !(next > early) {
            break;
        }
        early = next.smaller(late);
    }
    early * (1.0 - ROOT)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::rng::Rng;

    /// Compares the time with the displacement itself, for growths of every degree and size.
    #[test]
    fn nothing_is_held_too_long_or_given_up_too_early() {
        let mut rng = Rng::new(17);
        for case in 0..4000 {
            let term = |rng: &mut Rng, k: u32| {
                if case >> k & 1 == 1 {
                    rng.log_range(1e-60, 1e60)
                } else {
                    0.0
                }
            };
            let growth = Remainder([0.0, term(&mut rng, 0), term(&mut rng, 1), term(&mut rng, 2)]);
            let (way, span) = (rng.log_range(1e-30, 1e30), rng.log_range(1e-3, 1e3));
            let until = until_as_far(&growth, way, span);
            assert!(
                growth.at(until) <= way * (1.0 + 1e-14) && until <= span,
                "{growth:?} {way} {until}"
            );
            assert!(
                until == span || growth.at(1.2 * until) > way,
                "{growth:?} {way} {until} {span}"
            );
        }
        for bad in [f64::NAN, f64::INFINITY] {
            assert_eq!(until_as_far(&Remainder([0.0, bad, 1.0, 1.0]), 1.0, 1.0), 0.0);
            assert_eq!(until_as_far(&Remainder([0.0, 1.0, 1.0, bad]), 1.0, 1.0), 0.0);
        }
    }
}
