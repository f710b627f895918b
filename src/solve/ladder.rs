//! What follows a walk that the certificate refuses: each layer finer and slower than the one before.

use nalgebra::Vector3;

use crate::minimum::gjk::{Minimum, solve};
use crate::minimum::witnesses::{features, witnesses};
use crate::num::double_double::DoubleDouble;
use crate::num::scalar::Scalar;
use crate::pair::answer::{give_up, is_proven, outward, overlapping, unit};
use crate::pair::outcome::{Class, Layer, Outcome};
use crate::pair::posed::Placed;
use crate::pair::transform::Frame;
use crate::solve::certified_walk;
use crate::tolerance::CERTIFICATE;
use crate::walk::seed;

/// Restart, fallback, double-double, exact: the first that proves its outcome.
#[cold]
pub(crate) fn refine(placed: &Placed, warm: bool, outcome: &mut Outcome) {
    if warm && placed.has_one_unit() {
        outcome.work.restarts += 1;
        outcome.features = seed::cold(placed, &mut outcome.work);
        outcome.layer = Layer::Restart;
        if certified_walk(placed, outcome) {
            return;
        }
    }
    outcome.work.fallbacks += 1;
    outcome.layer = Layer::Fallback;
    take(placed, &solve(placed, &Frame::of(placed), outcome.features), outcome);
    if !is_proven(placed, outcome) {
        doubled(placed, outcome);
    }
}

/// The f64 solver alone, its bounds not looked at.
#[cold]
pub(crate) fn unchecked(placed: &Placed, outcome: &mut Outcome) {
    outcome.work.fallbacks += 1;
    outcome.layer = Layer::Fallback;
    take(placed, &solve(placed, &Frame::of(placed), outcome.features), outcome);
}

/// The double-double layer and what follows it.
fn doubled(placed: &Placed, outcome: &mut Outcome) {
    outcome.work.double_doubles += 1;
    outcome.layer = Layer::DoubleDouble;
    match Frame::<DoubleDouble>::new(placed.a, placed.b, placed.pose) {
        Some(frame) => take(placed, &solve(placed, &frame, outcome.features), outcome),
        None => give_up(placed, outcome),
    }
    if !is_proven(placed, outcome) {
        last(placed, outcome);
    }
}

/// What no floating-point arithmetic decides.
#[cfg(feature = "exact")]
fn last(placed: &Placed, outcome: &mut Outcome) {
    outcome.work.exacts += 1;
    crate::exact::settle(placed, outcome);
}

/// Without the exact rung, bounds that are narrow and straddle zero are called touching.
#[cfg(not(feature = "exact"))]
fn last(placed: &Placed, outcome: &mut Outcome) {
    outcome.class = match outcome.class {
        Class::Overlapping => Class::Overlapping,
        _ if crate::pair::answer::is_narrow(placed, outcome) => Class::Touching,
        _ => Class::Undecided,
    };
}

/// The distance of a separated pair within one unit in the last place: by the double-double layer where its bounds
/// are that close, else by the exact rung.
#[cfg(feature = "exact")]
pub(crate) fn sharpen(placed: &Placed, outcome: &mut Outcome) {
    if outcome.class != Class::Separated || outcome.layer == Layer::Exact {
        return;
    }
    outcome.work.double_doubles += 1;
    outcome.layer = Layer::DoubleDouble;
    if let Some(frame) = Frame::<DoubleDouble>::new(placed.a, placed.b, placed.pose) {
        let minimum = solve(placed, &frame, outcome.features);
        if let Minimum::Outside { simplex, lower, .. } = &minimum {
            let distance = simplex.reach();
            let gap = (distance - *lower).value().abs()
                + 2.0 * CERTIFICATE * DoubleDouble::UNIT * placed.reach::<DoubleDouble>().whole();
            let d = distance.value();
            // Rounding takes half a unit; what is left open must not take the other half.
            if gap <= 0.25 * (d - d.next_down()) {
                take(placed, &minimum, outcome);
                (outcome.distance, outcome.lower, outcome.upper) = (d, d.next_down(), d.next_up());
                return;
            }
        }
    }
    last(placed, outcome);
}

/// Takes over what a solve proves, and its witnesses.
fn take<T: Scalar>(placed: &Placed, minimum: &Minimum<T>, outcome: &mut Outcome) {
    let term = CERTIFICATE * T::UNIT * placed.reach::<T>().whole();
    let (Minimum::Inside { simplex } | Minimum::Outside { simplex, .. }) = minimum;
    outcome.features = features(placed, simplex);
    (outcome.point_on_a, outcome.point_on_b) = witnesses(placed, simplex);
    match minimum {
        Minimum::Inside { .. } => overlapping(outcome),
        Minimum::Outside {
            simplex,
            lower,
            direction: d,
        } => {
            let distance = simplex.reach();
            outcome.lower = outward(*lower, -term);
            outcome.upper = outward(distance, term);
            outcome.class = if outcome.lower > 0.0 {
                Class::Separated
            } else {
                Class::Undecided
            };
            outcome.distance = distance.value().clamp(outcome.lower.max(0.0), outcome.upper.max(0.0));
            outcome.normal = unit(&Vector3::new(-d[0].value(), -d[1].value(), -d[2].value()));
        }
    }
}
