//! The Lin-Canny core: from a feature pair to the closest feature pair, with proof.
//!
//! 1. **Walk** ([`walk`]): from the cached pair, or from the support vertices along the line of
//!    centres ([`seed`](crate::convex::walk::seed)).
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

#[cfg(feature = "exact")]
pub(crate) mod closed_form;
pub(crate) mod ladder;
#[cfg(test)]
mod mutation;
pub(crate) mod out_of_range;

use crate::base::tolerance::{AGREE, CERTIFICATE, UNIT};
use crate::convex::walk;
use crate::pair::certificate;
use crate::pair::draft::Draft;
use crate::pair::outcome::{Accuracy, Class};
use crate::pair::posed::PosedPair;

/// Walks from the features of `outcome` and tests the certificate. Returns whether the answer is
/// proven; if not, `outcome` holds the state at the refusal.
#[inline(always)]
pub(crate) fn certified_walk(posed: &PosedPair, draft: &mut Draft) -> bool {
    draft.work.certificates += 1;
    let ended = walk::walk::<true>(posed, draft);
    #[cfg(test)]
    let ended = mutation::falsify(posed, draft, ended);
    // Comparisons are written so that NaN refuses.
    ended && (bounds_agree(posed, draft) || supports_agree(posed, draft)) && proves_separated(posed, draft)
}

/// Returns whether witnesses and supporting planes agree. Planes further apart than the witnesses
/// do not agree either: then one of the two is wrong.
#[inline(always)]
fn bounds_agree(posed: &PosedPair, draft: &Draft) -> bool {
    (draft.distance - draft.lower).abs() <= AGREE * posed.size()
}

/// Returns whether witnesses and supporting planes agree after a search for both supports along the
/// normal.
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
    draft.class = if is_apart { Class::Separated } else { Class::Touching };
    is_apart
}

/// Answers from the features of `outcome`; `warm` if the features come from the cache. `overlap` is
/// asked first if the walk is refused, and returns whether the bodies overlap, proven.
#[inline(always)]
pub(crate) fn solve(
    accuracy: Accuracy,
    posed: &PosedPair,
    warm: bool,
    draft: &mut Draft,
    overlap: impl FnOnce(&mut Draft) -> bool,
) {
    if accuracy == Accuracy::Walk {
        draft.class = Class::Separated;
        if !(posed.same_scale() && walk::walk::<false>(posed, draft)) {
            ladder::gjk_unchecked(posed, draft);
        }
        return;
    }
    let may_overlap = |draft: &mut Draft| draft.class != Class::Touching && overlap(draft);
    if !(posed.same_scale() && (certified_walk(posed, draft) || may_overlap(draft))) {
        ladder::refine(posed, warm, draft);
    }
    #[cfg(feature = "exact")]
    if accuracy == Accuracy::Exact {
        ladder::sharpen(posed, draft);
    }
}
