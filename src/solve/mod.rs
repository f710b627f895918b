//! The Lin-Canny core: from a feature pair to the closest feature pair, with proof.
//!
//! 1. **Walk** ([`walk`]): from the cached pair, or from the support vertices along the line of
//!    centres ([`seed`](crate::walk::seed)).
//! 2. **Certify** ([`certificate`]): witnesses against supporting planes. Agreement within
//!    `64 UNIT L` is an answer; the bounds are widened by the error term and reported.
//! 3. **Refine** ([`ladder`]), if the bounds disagree. Both supports along the same direction are
//!    searched for and proven; a walk from a cached pair is restarted from the support vertices;
//!    then come the minimum-norm solver in f64, in double-double, and exact arithmetic (`exact`).
//!    Each solver is judged by bounds of its own.
//!
//! The class is never guessed: separated requires a positive lower bound, overlapping a tetrahedron
//! of the Minkowski difference around the origin. If the bounds straddle zero, the pair goes to the
//! next finer arithmetic.

pub(crate) mod ladder;
#[cfg(test)]
mod mutation;
pub(crate) mod out_of_range;

use crate::pair::certificate;
use crate::pair::outcome::{Accuracy, Class, Outcome};
use crate::pair::posed::PosedPair;
use crate::tolerance::{AGREE, CERTIFICATE, UNIT};
use crate::walk;

/// Walks from the features of `outcome` and tests the certificate. Returns whether the answer is
/// proven; if not, `outcome` holds the state at the refusal.
#[inline(always)]
pub(crate) fn certified_walk(posed: &PosedPair, outcome: &mut Outcome) -> bool {
    outcome.work.certificates += 1;
    let ended = walk::walk::<true>(posed, outcome);
    #[cfg(test)]
    let ended = mutation::falsify(posed, outcome, ended);
    // Comparisons are written so that NaN refuses.
    ended && (bounds_agree(posed, outcome) || supports_agree(posed, outcome)) && proves_separated(posed, outcome)
}

/// Returns whether witnesses and supporting planes agree. Planes further apart than the witnesses
/// do not agree either: then one of the two is wrong.
#[inline(always)]
fn bounds_agree(posed: &PosedPair, outcome: &Outcome) -> bool {
    (outcome.distance - outcome.lower).abs() <= AGREE * posed.size()
}

/// Returns whether witnesses and supporting planes agree after a search for both supports along the
/// normal.
#[cold]
fn supports_agree(posed: &PosedPair, outcome: &mut Outcome) -> bool {
    let (a, b) = outcome.features.vertices_of(posed.a, posed.b);
    outcome.lower = certificate::support_distance(posed, &outcome.normal, a, b);
    bounds_agree(posed, outcome)
}

/// Widens the bounds by the error terms and returns whether the lower bound remains positive.
#[inline(always)]
fn proves_separated(posed: &PosedPair, outcome: &mut Outcome) -> bool {
    let term = CERTIFICATE * UNIT * posed.size();
    outcome.lower -= term;
    outcome.upper = outcome.distance + term;
    outcome.class = Class::Separated;
    outcome.lower > 0.0
}

/// Answers from the features of `outcome`; `warm` if the features come from the cache.
#[inline(always)]
pub(crate) fn solve(accuracy: Accuracy, posed: &PosedPair, warm: bool, outcome: &mut Outcome) {
    if accuracy == Accuracy::Walk {
        outcome.class = Class::Separated;
        if !(posed.same_scale() && walk::walk::<false>(posed, outcome)) {
            ladder::gjk_unchecked(posed, outcome);
        }
        return;
    }
    if !(posed.same_scale() && certified_walk(posed, outcome)) {
        ladder::refine(posed, warm, outcome);
    }
    #[cfg(feature = "exact")]
    if accuracy == Accuracy::Exact {
        ladder::sharpen(posed, outcome);
    }
}
