//! The state of a pair of bodies of convex parts, and the queries.

use alloc::collections::BTreeMap;

use super::pair::{NearParts, PartJudge};
use crate::base::num::Counter;
use crate::base::pose::RelativePose;
use crate::body::polyhedron::FeaturePair;
use crate::composite::front::NodePair;
use crate::composite::front::memory::FrontMemory;
use crate::composite::meet::state::{PosedTrees, Recognised, TreeAnswer, TreeState};
use crate::composite::parts::Parted;
use crate::composite::work::MeshWork;
use crate::pair::spot::{Answer, Spot};

/// Trackers of pairs of pieces that are kept for each entry of the front; more are forgotten. Not
/// measured.
const TRACKERS: usize = 4;

/// The front of the last answer for one pair of bodies of convex parts, and a
/// `ShapeTracker` for each pair of parts that came near.
///
/// Either body is a [`Composite`](crate::Composite) or a [`Mesh`](crate::Mesh); a
/// `MeshTracker` is faster for two meshes. A convex body against a mesh is a
/// composite of one piece, which is one leaf with its own support points.
///
/// Owns no body. State changes time, never an answer. Saving a tracker (feature `serde`)
/// keeps its counters alone.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct CompositeTracker {
    state: TreeState,
    #[cfg_attr(feature = "serde", serde(skip))]
    near: BTreeMap<NodePair, NearParts>,
}

impl CompositeTracker {
    /// Returns a tracker without a start.
    #[must_use]
    pub(crate) fn new() -> Self {
        Self::default()
    }

    /// Returns the work of all queries so far; `measured` counts queries of two parts.
    #[must_use]
    pub(crate) fn work(&self) -> MeshWork {
        self.state.kept.work
    }

    pub(in crate::composite) fn kept(&self) -> &FrontMemory {
        &self.state.kept
    }

    pub(in crate::composite) fn count_windings(&mut self, taken: u64) {
        self.state.kept.work.windings.count(taken);
    }

    /// Returns the number of entries of the front that is kept.
    #[must_use]
    pub(crate) fn front_len(&self) -> usize {
        self.state.kept.front.len()
    }

    /// Returns the bytes of the front on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.state.kept.heap_bytes()
    }

    /// Returns the closest points with bounds of the distance, as told at `PairTracker::closest`:
    /// half as wide again if pieces have poses of their own. Curved pieces add the width of their
    /// own bounds.
    pub(crate) fn closest<A: Parted, B: Parted>(&mut self, a: &A, b: &B, a_from_b: &RelativePose) -> Answer {
        if PosedTrees::is_turned(a, b, a_from_b) {
            return self.closest(b, a, &a_from_b.swapped()).swapped(a_from_b);
        }
        self.recognise(a, b);
        self.state.kept.work.queries.count(1);
        let answer = match PosedTrees::new(a, b, a_from_b) {
            Some(posed) => {
                let judge = PartJudge::new(&posed, None, &mut self.near);
                self.state.closest(&posed, judge)
            }
            None => PosedTrees::far(a, b, a_from_b),
        };
        self.forget_some();
        answered(a, b, &answer)
    }

    /// Returns whether the bodies are at most `d` apart: as exact as
    /// [`intersects`](Self::intersects), with the limits of
    /// `MeshTracker::within`. False for a negative `d` and NaN.
    pub(crate) fn within<A: Parted, B: Parted>(&mut self, a: &A, b: &B, a_from_b: &RelativePose, d: f64) -> bool {
        if !(d >= 0.0) {
            return false;
        }
        if PosedTrees::is_turned(a, b, a_from_b) {
            return self.within(b, a, &a_from_b.swapped(), d);
        }
        self.recognise(a, b);
        self.state.kept.work.queries.count(1);
        let Some(posed) = PosedTrees::new(a, b, a_from_b) else {
            return PosedTrees::far::<()>(a, b, a_from_b).lower <= d;
        };
        let judge = PartJudge::new(&posed, Some(d), &mut self.near);
        let is_within = self.state.within(&posed, judge, d / a.stored_unit());
        self.forget_some();
        is_within
    }

    /// Returns a lower bound of the distance in one pass over the front, without looking for the
    /// closest pair; zero if nothing better is known.
    pub(crate) fn lower_bound<A: Parted, B: Parted>(&mut self, a: &A, b: &B, a_from_b: &RelativePose) -> f64 {
        if PosedTrees::is_turned(a, b, a_from_b) {
            return self.lower_bound(b, a, &a_from_b.swapped());
        }
        self.recognise(a, b);
        PosedTrees::new(a, b, a_from_b).map_or(0.0, |posed| self.state.lower_bound(&posed))
    }

    fn recognise<A: Parted, B: Parted>(&mut self, a: &A, b: &B) {
        // The parts near each other are copies.
        if self.state.recognise(a, b) != Recognised::Same {
            self.near.clear();
        }
    }

    fn forget_some(&mut self) {
        if self.near.len() > TRACKERS * self.state.kept.front.len() + 64 {
            self.near.clear();
        }
    }
}

fn answered<A: Parted, B: Parted>(a: &A, b: &B, found: &TreeAnswer<FeaturePair>) -> Answer {
    let ([i, j], features) = found.of.unwrap_or(([0, 0], FeaturePair::FIRST));
    found.on([Spot::new(a.number(i), features.a), Spot::new(b.number(j), features.b)])
}
