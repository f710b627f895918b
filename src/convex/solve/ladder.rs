//! The ladder after a walk that the certificate refuses: each solver finer and slower than the
//! last.

use nalgebra::Vector3;

use crate::base::num::double_double::DoubleDouble;
use crate::base::num::extremes::Bounded;
use crate::base::num::scalar::Scalar;
use crate::base::tolerance::CERTIFICATE;
use crate::convex::minimum::gjk::{Minimum, solve};
use crate::convex::minimum::start::{about_witnesses, vertex_of};
use crate::convex::minimum::witnesses::{features, witnesses};
use crate::convex::solve::certified_walk;
#[cfg(feature = "exact")]
use crate::convex::solve::closed_form::closed_form;
use crate::convex::walk::seed;
use crate::pair::answer::{is_proven, round_outward, set_overlapping, set_undecided, unit};
use crate::pair::draft::Draft;
use crate::pair::outcome::{Class, Solver};
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;

/// Runs restart, f64 solver, double-double and exact arithmetic until one proves the outcome.
/// Bodies that touch up to the rounding of f64 go to double-double at once.
#[cold]
pub(crate) fn refine(posed: &PosedPair, warm: bool, draft: &mut Draft) {
    if warm && posed.same_scale() && draft.class != Class::Touching {
        draft.work.restarts += 1;
        draft.features = seed::cold(posed, &mut draft.work);
        draft.solver = Solver::Restart;
        if certified_walk(posed, draft) {
            return;
        }
    }
    if draft.class != Class::Touching {
        gjk_unchecked(posed, draft);
    }
    if !is_proven(posed, draft) {
        refine_in_double_double(posed, draft);
    }
}

/// Runs the f64 solver alone, without a check of the bounds.
#[cold]
pub(crate) fn gjk_unchecked(posed: &PosedPair, draft: &mut Draft) {
    draft.work.fallbacks += 1;
    draft.solver = Solver::Fallback;
    let frame = Transform::of(posed);
    let start = vertex_of(posed, &frame, draft.features);
    write_minimum(posed, &solve(posed, &frame, start), draft);
}

/// Runs the double-double solver and, if the outcome is not proven, the last step of the ladder.
fn refine_in_double_double(posed: &PosedPair, draft: &mut Draft) {
    let coarse = *draft;
    draft.work.double_doubles += 1;
    draft.solver = Solver::DoubleDouble;
    match Transform::<DoubleDouble>::new(posed.a, posed.b, posed.pose) {
        Some(frame) => {
            let start = about_witnesses(posed, &frame, draft);
            write_minimum(posed, &solve(posed, &frame, start), draft);
        }
        None => set_undecided(posed, draft),
    }
    if !is_proven(posed, draft) {
        decide(posed, draft);
    } else if draft.class == Class::Overlapping && coarse.class == Class::Touching {
        // Closest features, witnesses and direction in f64 hold for the overlap too; a combination
        // of four points names no feature.
        (draft.features, draft.normal) = (coarse.features, coarse.normal);
        (draft.point_on_a, draft.point_on_b) = (coarse.point_on_a, coarse.point_on_b);
    }
}

/// Resolves by exact arithmetic a pair that no floating-point arithmetic decides.
#[cfg(feature = "exact")]
fn decide(posed: &PosedPair, draft: &mut Draft) {
    draft.work.exacts += 1;
    crate::convex::exact::resolve_exactly(posed, draft);
}

/// Classifies the pair without exact arithmetic: narrow bounds that straddle zero count as
/// touching.
#[cfg(not(feature = "exact"))]
fn decide(posed: &PosedPair, draft: &mut Draft) {
    draft.class = match draft.class {
        Class::Overlapping => Class::Overlapping,
        _ if crate::pair::answer::is_narrow(posed, draft) => Class::Touching,
        _ => Class::Undecided,
    };
}

/// Sharpens the distance of a separated pair to one unit in the last place: by double-double if the
/// bounds are close enough, else by exact arithmetic.
#[cfg(feature = "exact")]
pub(crate) fn sharpen(posed: &PosedPair, draft: &mut Draft) {
    if draft.class != Class::Separated || draft.solver == Solver::Exact {
        return;
    }
    draft.work.double_doubles += 1;
    draft.solver = Solver::DoubleDouble;
    if let Some(form) = closed_form(posed, draft) {
        let d = form.distance.value();
        if form.error <= 0.25 * (d - d.next_down()) {
            draft.normal = unit(&form.normal);
            (draft.distance, draft.lower, draft.upper) = (d, d.next_down(), d.next_up());
            return;
        }
    }
    if let Some(frame) = Transform::<DoubleDouble>::new(posed.a, posed.b, posed.pose) {
        let minimum = solve(posed, &frame, about_witnesses(posed, &frame, draft));
        if let Minimum::Outside { simplex, lower, .. } = &minimum {
            let distance = simplex.witness_distance();
            let gap = (distance - *lower).value().abs()
                + 2.0 * CERTIFICATE * DoubleDouble::UNIT * posed.error_scale::<DoubleDouble>().total();
            let d = distance.value();
            // Rounding takes half a unit; the remaining gap must not take the second half.
            if gap <= 0.25 * (d - d.next_down()) {
                write_minimum(posed, &minimum, draft);
                (draft.distance, draft.lower, draft.upper) = (d, d.next_down(), d.next_up());
                return;
            }
        }
    }
    decide(posed, draft);
}

/// Writes the bounds of a solve. Each is rounded by itself: if they cross, the lower bound is
/// lowered, as the upper bound is the distance of two points. A lower bound that is NaN stays so,
/// and proves nothing.
fn write_bounds(draft: &mut Draft, lower: f64, upper: f64) {
    (draft.lower, draft.upper) = (if lower > upper { upper } else { lower }, upper);
}

/// Writes the proven bounds, the features and the witnesses of a solve.
fn write_minimum<T: Scalar>(posed: &PosedPair, minimum: &Minimum<T>, draft: &mut Draft) {
    let term = CERTIFICATE * T::UNIT * posed.error_scale::<T>().total();
    let (Minimum::Inside { simplex } | Minimum::Outside { simplex, .. }) = minimum;
    draft.features = features(posed, simplex);
    (draft.point_on_a, draft.point_on_b) = witnesses(posed, simplex);
    match minimum {
        Minimum::Inside { .. } => set_overlapping(draft),
        Minimum::Outside {
            simplex,
            lower,
            direction: d,
        } => {
            let distance = simplex.witness_distance();
            write_bounds(draft, round_outward(*lower, -term), round_outward(distance, term));
            draft.class = if draft.lower > 0.0 {
                Class::Separated
            } else {
                Class::Undecided
            };
            let (low, high) = (draft.lower.at_least(0.0), draft.upper.at_least(0.0));
            draft.distance = distance.value().clamped(low, high);
            draft.normal = unit(&Vector3::new(-d[0].value(), -d[1].value(), -d[2].value()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::pose::RelativePose;
    use crate::body::polyhedron::FeaturePair;
    use crate::body::polyhedron::solids::cuboid;

    /// Two bounds that are rounded apart may cross by a last bit: no clamp panics of that.
    #[test]
    fn bounds_that_cross_are_written_in_order() {
        let cube = cuboid(Vector3::repeat(0.5)).unwrap();
        let pose = RelativePose::from_isometry(&nalgebra::Isometry3::translation(3.0, 0.0, 0.0)).unwrap();
        let posed = PosedPair::new(&cube, &cube, &pose).ok().unwrap();
        let frame = Transform::of(&posed);
        let mut draft = Draft::starting_at(FeaturePair::FIRST);
        let start = vertex_of(&posed, &frame, draft.features);
        let Minimum::Outside {
            simplex,
            lower,
            direction,
        } = solve(&posed, &frame, start)
        else {
            panic!("the cubes are apart");
        };
        let beyond = lower * (1.0 + 1e-9);
        let crossed = Minimum::Outside {
            simplex,
            lower: beyond,
            direction,
        };
        write_minimum(&posed, &crossed, &mut draft);
        assert!(
            draft.lower <= draft.distance && draft.distance <= draft.upper,
            "{draft:?}"
        );
    }
}
