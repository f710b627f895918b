//! The ladder after a walk that the certificate refuses: each solver finer and slower than the
//! last.

use nalgebra::Vector3;

use crate::minimum::gjk::{Minimum, solve};
use crate::minimum::witnesses::{features, witnesses};
use crate::num::double_double::DoubleDouble;
use crate::num::scalar::Scalar;
use crate::pair::answer::{is_proven, round_outward, set_overlapping, set_undecided, unit};
use crate::pair::outcome::{Class, Outcome, Solver};
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;
use crate::solve::certified_walk;
use crate::tolerance::CERTIFICATE;
use crate::walk::seed;

/// Runs restart, f64 solver, double-double and exact arithmetic until one proves the outcome.
#[cold]
pub(crate) fn refine(posed: &PosedPair, warm: bool, outcome: &mut Outcome) {
    if warm && posed.same_scale() {
        outcome.work.restarts += 1;
        outcome.features = seed::cold(posed, &mut outcome.work);
        outcome.solver = Solver::Restart;
        if certified_walk(posed, outcome) {
            return;
        }
    }
    outcome.work.fallbacks += 1;
    outcome.solver = Solver::Fallback;
    write_minimum(posed, &solve(posed, &Transform::of(posed), outcome.features), outcome);
    if !is_proven(posed, outcome) {
        refine_in_double_double(posed, outcome);
    }
}

/// Runs the f64 solver alone, without a check of the bounds.
#[cold]
pub(crate) fn gjk_unchecked(posed: &PosedPair, outcome: &mut Outcome) {
    outcome.work.fallbacks += 1;
    outcome.solver = Solver::Fallback;
    write_minimum(posed, &solve(posed, &Transform::of(posed), outcome.features), outcome);
}

/// Runs the double-double solver and, if the outcome is not proven, the last step of the ladder.
fn refine_in_double_double(posed: &PosedPair, outcome: &mut Outcome) {
    outcome.work.double_doubles += 1;
    outcome.solver = Solver::DoubleDouble;
    match Transform::<DoubleDouble>::new(posed.a, posed.b, posed.pose) {
        Some(frame) => write_minimum(posed, &solve(posed, &frame, outcome.features), outcome),
        None => set_undecided(posed, outcome),
    }
    if !is_proven(posed, outcome) {
        decide(posed, outcome);
    }
}

/// Resolves by exact arithmetic a pair that no floating-point arithmetic decides.
#[cfg(feature = "exact")]
fn decide(posed: &PosedPair, outcome: &mut Outcome) {
    outcome.work.exacts += 1;
    crate::exact::resolve_exactly(posed, outcome);
}

/// Classifies the pair without exact arithmetic: narrow bounds that straddle zero count as
/// touching.
#[cfg(not(feature = "exact"))]
fn decide(posed: &PosedPair, outcome: &mut Outcome) {
    outcome.class = match outcome.class {
        Class::Overlapping => Class::Overlapping,
        _ if crate::pair::answer::is_narrow(posed, outcome) => Class::Touching,
        _ => Class::Undecided,
    };
}

/// Sharpens the distance of a separated pair to one unit in the last place: by double-double if the
/// bounds are close enough, else by exact arithmetic.
#[cfg(feature = "exact")]
pub(crate) fn sharpen(posed: &PosedPair, outcome: &mut Outcome) {
    if outcome.class != Class::Separated || outcome.solver == Solver::Exact {
        return;
    }
    outcome.work.double_doubles += 1;
    outcome.solver = Solver::DoubleDouble;
    if let Some(frame) = Transform::<DoubleDouble>::new(posed.a, posed.b, posed.pose) {
        let minimum = solve(posed, &frame, outcome.features);
        if let Minimum::Outside { simplex, lower, .. } = &minimum {
            let distance = simplex.witness_distance();
            let gap = (distance - *lower).value().abs()
                + 2.0 * CERTIFICATE * DoubleDouble::UNIT * posed.error_scale::<DoubleDouble>().total();
            let d = distance.value();
            // Rounding takes half a unit; the remaining gap must not take the second half.
            if gap <= 0.25 * (d - d.next_down()) {
                write_minimum(posed, &minimum, outcome);
                (outcome.distance, outcome.lower, outcome.upper) = (d, d.next_down(), d.next_up());
                return;
            }
        }
    }
    decide(posed, outcome);
}

/// Writes the proven bounds, the features and the witnesses of a solve.
fn write_minimum<T: Scalar>(posed: &PosedPair, minimum: &Minimum<T>, outcome: &mut Outcome) {
    let term = CERTIFICATE * T::UNIT * posed.error_scale::<T>().total();
    let (Minimum::Inside { simplex } | Minimum::Outside { simplex, .. }) = minimum;
    outcome.features = features(posed, simplex);
    (outcome.point_on_a, outcome.point_on_b) = witnesses(posed, simplex);
    match minimum {
        Minimum::Inside { .. } => set_overlapping(outcome),
        Minimum::Outside {
            simplex,
            lower,
            direction: d,
        } => {
            let distance = simplex.witness_distance();
            outcome.lower = round_outward(*lower, -term);
            outcome.upper = round_outward(distance, term);
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
