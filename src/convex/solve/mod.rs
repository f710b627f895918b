//! The Lin-Canny core: from a feature pair to the closest feature pair, with proof.
//!
//! 1. **Walk** ([`walk`]): starts at the cached pair, or at the support vertices along the line of
//!    centres ([`seed`]).
//! 2. **Certify** ([`certificate`]): compares the witness points with supporting planes. If they
//!    agree within `64 UNIT L`, the result is proven; the bounds are widened by the error term and
//!    reported.
//! 3. **Refine** ([`refine`]), if the bounds disagree: a ladder of solvers, each more precise and
//!    slower than the last. Both support vertices along the same direction are searched for and
//!    proven. If a vertex touches a face along an axis, integers prove it at once. A walk from a
//!    cached pair is restarted from the support vertices. Then the minimum-norm solver runs in f64,
//!    then in double-double, and then exact arithmetic (`exact`). Each solver is judged by its
//!    bounds.
//!
//! The contact state is never guessed. Separated requires a positive lower bound; overlapping
//! requires a tetrahedron of the Minkowski difference around the origin. If zero lies between the
//! bounds, the pair goes to the next more precise arithmetic.

#[cfg(feature = "exact")]
pub(crate) mod closed_form;
#[cfg(test)]
mod mutation;
pub(crate) mod out_of_range;

use crate::base::num::double_double::DoubleDouble;
use crate::base::num::extremes::Bounded;
use crate::base::num::scalar::Scalar;
use crate::base::tolerance::{AGREE, CERTIFICATE, UNIT};
use crate::convex::minimum::{self, Minimum, about_witnesses, features, vertex_of, witnesses};
#[cfg(feature = "exact")]
use crate::convex::solve::closed_form::closed_form;
use crate::convex::walk;
use crate::convex::walk::seed;
use crate::pair::certificate;
use crate::pair::draft::Draft;
use crate::pair::draft::{is_proven, round_outward, set_overlapping, set_undecided, unit};
use crate::pair::outcome::{Accuracy, ContactState, Solver};
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;
use nalgebra::Vector3;

/// Walks from the features of `draft` and tests the certificate. Returns whether the outcome is
/// proven; if not, `draft` contains the state at the failure.
#[inline(always)]
pub(crate) fn certified_walk(posed: &PosedPair, draft: &mut Draft) -> bool {
    draft.work.certificates += 1;
    let ended = walk::walk::<true>(posed, draft);
    #[cfg(test)]
    let ended = mutation::falsify(posed, draft, ended);
    // Comparisons are written so that NaN fails.
    ended && (bounds_agree(posed, draft) || supports_agree(posed, draft)) && proves_separated(posed, draft)
}

/// Returns whether witness points and supporting planes agree. Planes farther apart than the
/// witness points do not agree either: then one of the two is wrong.
#[inline(always)]
fn bounds_agree(posed: &PosedPair, draft: &Draft) -> bool {
    (draft.distance - draft.lower).abs() <= AGREE * posed.size()
}

/// Returns whether witness points and supporting planes agree after a search for both support
/// vertices along the normal.
#[cold]
fn supports_agree(posed: &PosedPair, draft: &mut Draft) -> bool {
    let (a, b) = draft.features.vertices_of(posed.a, posed.b);
    draft.lower = certificate::support_distance(posed, &draft.normal, a, b);
    bounds_agree(posed, draft)
}

/// Widens the bounds by the error terms and returns whether the lower bound remains positive; if
/// not, the bodies touch up to rounding.
#[inline(always)]
fn proves_separated(posed: &PosedPair, draft: &mut Draft) -> bool {
    let term = CERTIFICATE * UNIT * posed.size();
    draft.lower -= term;
    draft.upper = draft.distance + term;
    let is_apart = draft.lower > 0.0;
    draft.state = if is_apart {
        ContactState::Separated
    } else {
        ContactState::Touching
    };
    is_apart
}

/// Computes the outcome from the features of `draft`; `warm` means that they come from the cache.
/// If the walk fails, `overlap` runs first and returns whether the bodies are proven to overlap.
#[inline(always)]
pub(crate) fn solve(
    accuracy: Accuracy,
    posed: &PosedPair,
    warm: bool,
    draft: &mut Draft,
    overlap: impl FnOnce(&mut Draft) -> bool,
) {
    if accuracy == Accuracy::Walk {
        draft.state = ContactState::Separated;
        if !(posed.same_scale() && walk::walk::<false>(posed, draft)) {
            self::gjk_unchecked(posed, draft);
        }
        return;
    }
    let may_overlap = |draft: &mut Draft| draft.state != ContactState::Touching && overlap(draft);
    if !(posed.same_scale() && (certified_walk(posed, draft) || may_overlap(draft))) {
        self::refine(posed, warm, draft);
    }
    #[cfg(feature = "exact")]
    if accuracy == Accuracy::Exact {
        self::sharpen(posed, draft);
    }
}

/// Runs restart, f64 solver, double-double and exact arithmetic until one proves the outcome.
/// Bodies that touch up to the rounding of f64 go to double-double at once.
#[cold]
pub(crate) fn refine(posed: &PosedPair, warm: bool, draft: &mut Draft) {
    #[cfg(feature = "exact")]
    if crate::convex::exact::touches(posed, draft) {
        draft.work.exacts += 1;
        return;
    }
    if warm && posed.same_scale() && draft.state != ContactState::Touching {
        draft.work.restarts += 1;
        draft.features = seed::cold(posed, &mut draft.work);
        draft.solver = Solver::Restart;
        if certified_walk(posed, draft) {
            return;
        }
    }
    if draft.state != ContactState::Touching {
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
    draft.solver = Solver::Gjk;
    let frame = Transform::of(posed);
    let start = vertex_of(posed, &frame, draft.features);
    write_minimum(posed, &minimum::solve(posed, &frame, start), draft);
}

/// Runs the double-double solver and, if the outcome is not proven, the last stage of the ladder.
fn refine_in_double_double(posed: &PosedPair, draft: &mut Draft) {
    let coarse = *draft;
    draft.work.double_doubles += 1;
    draft.solver = Solver::DoubleDouble;
    match Transform::<DoubleDouble>::new(posed.a, posed.b, posed.pose) {
        Some(frame) => {
            let start = about_witnesses(posed, &frame, draft);
            write_minimum(posed, &minimum::solve(posed, &frame, start), draft);
        }
        None => set_undecided(posed, draft),
    }
    if !is_proven(posed, draft) {
        decide(posed, draft);
    } else if draft.state == ContactState::Overlapping && coarse.state == ContactState::Touching {
        // Closest features, witness points and direction in f64 hold for the overlap too. A
        // combination of four points has no feature.
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

/// Determines the contact state without exact arithmetic: narrow bounds with zero between them
/// count as touching.
#[cfg(not(feature = "exact"))]
fn decide(posed: &PosedPair, draft: &mut Draft) {
    draft.state = match draft.state {
        ContactState::Overlapping => ContactState::Overlapping,
        _ if crate::pair::draft::is_narrow(posed, draft) => ContactState::Touching,
        _ => ContactState::Undecided,
    };
}

/// Refines the distance of a separated pair to one unit in the last place: by double-double if the
/// bounds are close enough, otherwise by exact arithmetic.
#[cfg(feature = "exact")]
pub(crate) fn sharpen(posed: &PosedPair, draft: &mut Draft) {
    if draft.state != ContactState::Separated || draft.solver == Solver::Exact {
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
        let minimum = minimum::solve(posed, &frame, about_witnesses(posed, &frame, draft));
        if let Minimum::Outside { simplex, lower, .. } = &minimum {
            let distance = simplex.witness_distance();
            let gap = (distance - *lower).value().abs()
                + 2.0 * CERTIFICATE * DoubleDouble::UNIT * posed.error_scale::<DoubleDouble>().total();
            let d = distance.value();
            // Rounding takes half a unit; the remaining gap must not take the other half.
            if gap <= 0.25 * (d - d.next_down()) {
                write_minimum(posed, &minimum, draft);
                (draft.distance, draft.lower, draft.upper) = (d, d.next_down(), d.next_up());
                return;
            }
        }
    }
    decide(posed, draft);
}

/// Writes the bounds of a solve. Each is rounded separately. If they cross, the lower bound is
/// lowered, because the upper bound is the distance of two points. A lower bound that is NaN stays
/// NaN and proves nothing.
fn write_bounds(draft: &mut Draft, lower: f64, upper: f64) {
    (draft.lower, draft.upper) = (if lower > upper { upper } else { lower }, upper);
}

/// Writes the proven bounds, the features and the witnesses of a solve.
fn write_minimum<T: Scalar>(posed: &PosedPair, minimum: &Minimum<T>, draft: &mut Draft) {
    let term = CERTIFICATE * T::UNIT * posed.error_scale::<T>().total();
    let (Minimum::Inside { simplex } | Minimum::Outside { simplex, .. }) = minimum;
    draft.features = features(posed, simplex);
    [draft.point_on_a, draft.point_on_b] = witnesses(posed, simplex);
    match minimum {
        Minimum::Inside { .. } => set_overlapping(draft),
        Minimum::Outside {
            simplex,
            lower,
            direction: d,
        } => {
            let distance = simplex.witness_distance();
            write_bounds(draft, round_outward(*lower, -term), round_outward(distance, term));
            draft.state = if draft.lower > 0.0 {
                ContactState::Separated
            } else {
                ContactState::Undecided
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

    /// Two bounds that are rounded separately may cross in the last bit. No clamp may panic then.
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
        } = minimum::solve(&posed, &frame, start)
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
