//! The Lin-Canny core: from a pair of features to the closest pair, with proof.
//!
//! 1. **Walk** ([`walk`]): from the cached pair, or from the support vertices along the line of centres ([`seed`]).
//! 2. **Certify**: witnesses against supporting planes. Agreement within `64 UNIT L` is an answer; its bounds are
//!    widened by the error term and reported.
//! 3. Where they do not agree: both supports along the same direction are proven afresh; a walk from a cached pair is
//!    started again from the support vertices; then comes the minimum-norm solver in f64, the same in double-double,
//!    and the exact rung ([`fallback`], `exact`). Each is judged by bounds of its own.
//!
//! The class is never guessed: separated needs a positive lower bound, overlapping a tetrahedron of the Minkowski
//! difference around the origin. Bounds that straddle zero send the pair to the next finer arithmetic.

pub(crate) mod ladder;
#[cfg(test)]
mod mutation;
pub(crate) mod out_of_range;

use crate::pair::certificate;
use crate::pair::outcome::{Accuracy, Class, Outcome};
use crate::pair::posed::PosedPair;
use crate::tolerance::{AGREE, CERTIFICATE, UNIT};
use crate::walk;

/// Walks from the features of `outcome` and takes the certificate; on refusal, it says how far it got.
#[inline(always)]
pub(crate) fn certified_walk(posed: &PosedPair, outcome: &mut Outcome) -> bool {
    outcome.work.certificates += 1;
    let ended = walk::walk::<true>(posed, outcome);
    #[cfg(test)]
    let ended = mutation::falsify(posed, outcome, ended);
    // Comparisons are written so that NaN refuses.
    ended && (agrees(posed, outcome) || supports_agree(posed, outcome)) && proves_apart(posed, outcome)
}

/// Whether witnesses and supporting planes agree. Planes further apart than the witnesses are no agreement either: one of
/// the two is wrong then.
#[inline(always)]
fn agrees(posed: &PosedPair, outcome: &Outcome) -> bool {
    (outcome.distance - outcome.lower).abs() <= AGREE * posed.size()
}

/// The same with both supports looked for along the normal.
#[cold]
fn supports_agree(posed: &PosedPair, outcome: &mut Outcome) -> bool {
    let (a, b) = outcome.features.vertices_of(posed.a, posed.b);
    outcome.lower = certificate::supports(posed, &outcome.normal, a, b);
    agrees(posed, outcome)
}

/// Takes the error terms and refuses what they leave open.
#[inline(always)]
fn proves_apart(posed: &PosedPair, outcome: &mut Outcome) -> bool {
    let term = CERTIFICATE * UNIT * posed.size();
    outcome.lower -= term;
    outcome.upper = outcome.distance + term;
    outcome.class = Class::Separated;
    outcome.lower > 0.0
}

/// Answers from the features of `outcome`; `warm` if that is a cached one.
#[inline(always)]
pub(crate) fn solve(level: Accuracy, posed: &PosedPair, warm: bool, outcome: &mut Outcome) {
    if level == Accuracy::Walk {
        outcome.class = Class::Separated;
        if !(posed.same_scale() && walk::walk::<false>(posed, outcome)) {
            ladder::unchecked(posed, outcome);
        }
        return;
    }
    if !(posed.same_scale() && certified_walk(posed, outcome)) {
        ladder::refine(posed, warm, outcome);
    }
    #[cfg(feature = "exact")]
    if level == Accuracy::Exact {
        ladder::sharpen(posed, outcome);
    }
}
