//! The state of a pair of meshes, and the queries.

use alloc::boxed::Box;

use crate::base::num::count::Counter;
use crate::base::pose::RelativePose;
use crate::composite::front::memory::FrontMemory;
use crate::composite::front::{FrontFault, audit};
use crate::composite::meet::state::{PosedTrees, TreeAnswer, TreeState};
use crate::composite::meet::triangle::TriangleSpot;
use crate::composite::mesh::Mesh;
use crate::composite::mesh::own::SelfState;
use crate::composite::mesh::pair::{TriangleJudge, spots};
use crate::composite::work::MeshWork;
use crate::pair::spot::Answer;

/// The front of the last answer for one pair of meshes, from which the next query starts, and
/// counters.
///
/// Owns no mesh. State changes time, never an answer: a tracker that comes from another
/// pair, or is out of date, is allowed. Saving a tracker (feature `serde`) keeps its counters
/// alone.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct MeshTracker {
    pub(super) state: TreeState,
    /// Of A against itself.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) own: Option<Box<SelfState>>,
}

impl MeshTracker {
    /// Returns the work of all queries so far.
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
        self.state.kept.front.len() + self.own.as_ref().map_or(0, |own| own.front.len())
    }

    /// Returns the front that is kept: pairs of nodes of A's and B's trees that are proven farther
    /// apart than the distance.
    pub(crate) fn front(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.state.kept.front.pairs()
    }

    /// Checks the front that is kept against all vertices, at the pose of the last
    /// [`closest`](Self::closest), and what is claimed of A against itself: for debugging, in time
    /// that is entries times triangles.
    ///
    /// # Errors
    ///
    /// The first claim that is false, or a pair that is not covered.
    pub(crate) fn audit(&self, a: &Mesh, b: &Mesh, a_from_b: &RelativePose) -> Result<(), FrontFault> {
        if let Some(own) = &self.own {
            own.audit(a)?;
        }
        match PosedTrees::new(a, b, a_from_b) {
            Some(posed) if !self.state.kept.front.is_empty() => audit(&self.state.kept.front, a, b, &posed.frame),
            _ => Ok(()),
        }
    }

    /// Adds to the claim of an entry.
    #[cfg(test)]
    pub(in crate::composite) fn spoil(&mut self, entry: usize, by: f32) {
        let front = &mut self.state.kept.front;
        front.corrupt(front.place(entry % front.len()), by);
    }

    /// Loses an entry.
    #[cfg(test)]
    pub(in crate::composite) fn drop_entry(&mut self, entry: usize) {
        let front = &mut self.state.kept.front;
        front.remove(front.place(entry % front.len()));
    }

    /// Returns the bytes kept on the heap.
    #[must_use]
    pub(crate) fn heap_bytes(&self) -> usize {
        let own = self.own.as_ref();
        self.state.kept.heap_bytes() + own.map_or(0, |own| size_of::<SelfState>() + own.front.heap_bytes())
    }

    /// Returns the closest points with bounds of the distance, as told at `PairTracker::closest`.
    /// Bodies in contact end the search early: surfaces at the first pair in contact, solids after
    /// 128 of them if inner points of both are found.
    pub(crate) fn closest(&mut self, a: &Mesh, b: &Mesh, a_from_b: &RelativePose) -> Answer {
        if PosedTrees::is_turned(a, b, a_from_b) {
            return self.closest(b, a, &a_from_b.swapped()).swapped(a_from_b);
        }
        self.state.recognise(a, b);
        self.state.kept.work.queries.count(1);
        let answer = match PosedTrees::new(a, b, a_from_b) {
            Some(posed) => self.state.closest(&posed, TriangleJudge::new(&posed, None)),
            None => PosedTrees::far(a, b, a_from_b),
        };
        answered(a, b, &answer)
    }

    /// Returns whether the bodies are at most `d` apart, as told at `PairTracker::within`. Exact
    /// with the feature `exact`; without it ties count as within. False for a negative `d` and for
    /// NaN.
    pub(crate) fn within(&mut self, a: &Mesh, b: &Mesh, a_from_b: &RelativePose, d: f64) -> bool {
        if !(d >= 0.0) {
            return false;
        }
        if PosedTrees::is_turned(a, b, a_from_b) {
            return self.within(b, a, &a_from_b.swapped(), d);
        }
        self.state.recognise(a, b);
        self.state.kept.work.queries.count(1);
        match PosedTrees::new(a, b, a_from_b) {
            Some(posed) => {
                let judge = TriangleJudge::new(&posed, Some(d));
                self.state.within(&posed, judge, d / a.unit())
            }
            None => PosedTrees::far::<()>(a, b, a_from_b).lower <= d,
        }
    }

    /// Returns a lower bound of the distance in one pass over the front, without looking for the
    /// closest pair; zero if nothing better is known.
    pub(crate) fn lower_bound(&mut self, a: &Mesh, b: &Mesh, a_from_b: &RelativePose) -> f64 {
        if PosedTrees::is_turned(a, b, a_from_b) {
            return self.lower_bound(b, a, &a_from_b.swapped());
        }
        self.state.recognise(a, b);
        PosedTrees::new(a, b, a_from_b).map_or(0.0, |posed| self.state.lower_bound(&posed))
    }
}

fn answered(a: &Mesh, b: &Mesh, found: &TreeAnswer<[TriangleSpot; 2]>) -> Answer {
    let (pair, features) = found.of.unwrap_or(([0, 0], [TriangleSpot::Vertex(0); 2]));
    found.on(spots(a, b, pair, features))
}
