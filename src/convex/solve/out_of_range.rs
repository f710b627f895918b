//! Pairs outside the range of f64: bodies so far apart that only the separation counts, or two
//! points so close that squares of lengths underflow.
//!
//! The radii are below the rounding of the separation (or zero), so the vertices that face each
//! other are the closest features within every bound requested. Lengths are scaled before the
//! squares are taken.

use crate::base::num::extremes::Bounded;
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::{CERTIFICATE, UNIT};
use crate::body::polyhedron::{ConvexPolyhedron, FeaturePair};
use crate::pair::outcome::{ContactState, Outcome, Solver, Work};

/// Returns the outcome in the caller's units.
#[cold]
pub(crate) fn answer(a: &ConvexPolyhedron, b: &ConvexPolyhedron, pose: &RelativePose) -> Outcome {
    // In sixteenths, so that no intermediate result is infinite.
    let (rotation, translation) = (pose.rotation(), pose.translation_sixteenth());
    let t = translation + rotation * b.origin / 16.0 - a.origin / 16.0;
    let n = crate::pair::draft::unit(&t);
    let (va, vb) = (a.support_cold(&n), b.support_cold(&-rotation.tr_mul(&n)));
    let (point_on_a, point_on_b) = (a.to_user(&a.points[va.index()]), b.to_user(&b.points[vb.index()]));
    let between = translation + rotation * point_on_b.coords / 16.0 - point_on_a.coords / 16.0;
    let largest = between.amax();
    let distance = if largest > 0.0 {
        16.0 * (largest * (between / largest).norm())
    } else {
        0.0
    };
    let radii = a.radius * a.unit() + b.radius * b.unit();
    let offsets = a.origin.abs().sum() + b.origin.abs().sum();
    // Below the normal numbers rounding is absolute: the last term is 1024 times the least f64.
    let slack = CERTIFICATE * UNIT * (distance + radii + offsets) + 2.0 * radii + f64::from_bits(1024);
    let lower = (distance - slack).at_least(0.0);
    let state = if lower > 0.0 {
        ContactState::Separated
    } else {
        ContactState::Touching
    };
    let outcome = Outcome {
        state,
        distance,
        lower,
        upper: distance + slack,
        features: FeaturePair::vertices(Operand::A, va, vb),
        point_on_a,
        point_on_b,
        normal: n,
        solver: Solver::Far,
        work: Work::default(),
    };
    // Two points that f64 cannot distinguish, or bodies far from their origins.
    #[cfg(feature = "exact")]
    if state != ContactState::Separated || offsets > distance {
        return exactly(a, b, pose, outcome);
    }
    outcome
}

/// Replaces contact state and distance by the result of exact arithmetic. The depth of an overlap
/// is at most the sum of the radii. This bound is enough, because bodies that overlap here are so
/// far from their origins that they are smaller than the rounding of their positions.
#[cfg(feature = "exact")]
#[cold]
pub(crate) fn exactly(a: &ConvexPolyhedron, b: &ConvexPolyhedron, pose: &RelativePose, outcome: Outcome) -> Outcome {
    let hint = outcome.features.vertices_of(a, b).into();
    let Some((state, distance)) = crate::convex::exact::separation(a, b, pose, hint) else {
        return outcome;
    };
    let (lower, upper) = match state {
        ContactState::Separated => (distance.next_down().at_least(0.0), distance.next_up()),
        ContactState::Overlapping => ((-a.radius * a.unit() - b.radius * b.unit()).next_down(), 0.0),
        _ => (0.0, 0.0),
    };
    Outcome {
        state,
        distance,
        lower,
        upper,
        work: Work {
            exacts: outcome.work.exacts + 1,
            ..outcome.work
        },
        ..outcome
    }
}
