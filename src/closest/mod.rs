//! The Lin-Canny core: from a pair of features to the closest pair, with proof.
//!
//! 1. **Walk** ([`walk`]): from the cached pair, or from the support vertices along the line of centres ([`seed`]).
//! 2. **Certify**: witnesses against supporting planes. Agreement within `32 UNIT L` is an answer; its bounds are
//!    widened by the error term and reported.
//! 3. Where they do not agree: both supports along the same direction are proven afresh; a walk from a cached pair is
//!    started again from the support vertices; then comes the minimum-norm solver in f64, the same in double-double,
//!    and the exact rung ([`fallback`], `exact`). Each is judged by bounds of its own.
//!
//! The class is never guessed: separated needs a positive lower bound, overlapping a tetrahedron of the Minkowski
//! difference around the origin. Bounds that straddle zero send the pair to the next finer arithmetic.

mod edge_edge;
#[cfg(feature = "exact")]
pub(crate) mod exact;
pub(crate) mod fallback;
mod fan;
pub(crate) mod far;
#[cfg(test)]
mod mutation;
pub(crate) mod outcome;
pub(crate) mod placed;
mod refine;
pub(crate) mod seed;
pub(crate) mod simplex;
mod slide;
pub(crate) mod state;
pub(crate) mod trace;
mod vertex_edge;
mod vertex_face;
mod vertex_vertex;
pub(crate) mod walk;

use crate::certificate;
use crate::polyhedron::FeaturePair;
use crate::tolerance::{AGREE, CERTIFICATE, UNIT};
use outcome::{Class, Layer, Level, Work};
use placed::Placed;
use state::Found;

/// An answer in stored units and frames.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Answer {
    pub(crate) class: Class,
    /// Witnesses, normal and distance.
    pub(crate) found: Found,
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    pub(crate) state: FeaturePair,
    pub(crate) layer: Layer,
    pub(crate) work: Work,
}

impl Answer {
    /// An answer that says nothing yet.
    #[inline]
    pub(crate) fn open(state: FeaturePair) -> Self {
        Self {
            class: Class::Undecided,
            found: Found::default(),
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            state,
            layer: Layer::Walk,
            work: Work::default(),
        }
    }
}

/// Walks from the state of `answer` and takes the certificate; on refusal, `answer` says how far it got.
#[inline(always)]
pub(crate) fn certified_walk(placed: &Placed, answer: &mut Answer) -> bool {
    answer.work.certificates += 1;
    let ended = walk::walk::<true>(placed, answer);
    #[cfg(test)]
    let ended = mutation::falsify(placed, answer, ended);
    // Comparisons are written so that NaN refuses.
    ended && (agrees(placed, answer) || supports_agree(placed, answer)) && proves_apart(placed, answer)
}

/// Whether witnesses and supporting planes agree. Planes further apart than the witnesses are no agreement either: one of
/// the two is wrong then.
#[inline(always)]
fn agrees(placed: &Placed, answer: &Answer) -> bool {
    (answer.found.distance - answer.found.lower).abs() <= AGREE * placed.size()
}

/// The same with both supports looked for along the normal.
#[cold]
fn supports_agree(placed: &Placed, answer: &mut Answer) -> bool {
    let (a, b) = answer.state.vertices_of(placed.a, placed.b);
    answer.found.lower = certificate::supports(placed, &answer.found.normal, a, b);
    agrees(placed, answer)
}

/// Takes the error terms and refuses what they leave open.
#[inline(always)]
fn proves_apart(placed: &Placed, answer: &mut Answer) -> bool {
    let term = CERTIFICATE * UNIT * placed.size();
    answer.lower = answer.found.lower - term;
    answer.upper = answer.found.distance + term;
    answer.class = Class::Separated;
    answer.lower > 0.0
}

/// Answers from the pair of `answer`; `warm` if that is a cached one.
#[inline(always)]
pub(crate) fn solve(level: Level, placed: &Placed, warm: bool, answer: &mut Answer) {
    if level == Level::Walk {
        answer.class = Class::Separated;
        if !(placed.has_one_unit() && walk::walk::<false>(placed, answer)) {
            refine::unchecked(placed, answer);
        }
        return;
    }
    if !(placed.has_one_unit() && certified_walk(placed, answer)) {
        refine::refine(placed, warm, answer);
    }
    #[cfg(feature = "exact")]
    if level == Level::Exact {
        refine::sharpen(placed, answer);
    }
}
