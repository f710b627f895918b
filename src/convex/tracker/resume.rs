//! Depths from the last outcome: its deepest facet and its polytope.

use super::{Tracker, to_user_units};
use crate::body::polyhedron::FeaturePair;
use crate::convex::depth::{self, Memory, NearestFeature};
use crate::pair::draft::Draft;
use crate::pair::outcome::DepthMode;
use crate::pair::posed::PosedPair;

/// The result of resuming the last overlap.
pub(super) enum Resumed {
    /// The draft holds the proven depth.
    Proven,
    /// The bodies seem separated: these features are near the closest ones.
    Apart(FeaturePair),
    /// Nothing is known.
    Open,
}

impl Tracker {
    /// Computes the outcome from the deepest facet or the polytope of the last outcome.
    ///
    /// State of no further use is dropped. Bodies that have separated since get the start of a
    /// walk, independent of the costs of starts, because a replay does not record these costs.
    #[inline(never)]
    pub(super) fn resume(&mut self, posed: &PosedPair, until: DepthMode, draft: &mut Draft) -> Resumed {
        let first = *draft;
        let mut resumed = NearestFeature::Open(None);
        if until == DepthMode::Local
            && let Some(facet) = self.memory.facet_of(posed)
        {
            resumed = depth::local_depth(posed, facet, &mut self.memory, &mut self.overlap_proof, draft);
        }
        if let NearestFeature::Open(_) = resumed {
            resumed = depth::resume(posed, &mut self.memory, draft);
        }
        if resumed != NearestFeature::Proven {
            self.memory.clear();
            let (grown, visited) = (draft.work.points_added, draft.work.facets);
            *draft = first;
            (draft.work.points_added, draft.work.facets) = (grown, visited);
            return match resumed {
                NearestFeature::Apart(start) => Resumed::Apart(start),
                _ => Resumed::Open,
            };
        }
        self.totals.note(true, draft.solver, &draft.work);
        self.stay(draft.features);
        if !(posed.a.is_unscaled && posed.b.is_unscaled) {
            to_user_units(posed.a, posed.b, draft);
        }
        Resumed::Proven
    }
}

/// Computes an overlap from the features at which the certificate of a walk failed.
///
/// The depth is the least depth, even if a local depth is enough: the next queries start from its
/// facet.
#[cold]
#[inline(never)]
pub(super) fn enters_overlap(posed: &PosedPair, memory: &mut Memory, draft: &mut Draft) -> bool {
    let from = draft.features;
    if !from.is_of(posed.a, posed.b) {
        return false;
    }
    match depth::nearest_facet(posed, from, memory, draft) {
        NearestFeature::Proven => true,
        NearestFeature::Open(Some(facet)) => depth::depth_from(posed, facet, memory, draft),
        NearestFeature::Open(None) | NearestFeature::Apart(_) | NearestFeature::Touch => false,
    }
}
