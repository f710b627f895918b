//! What the trackers of all pairs with a surface keep, and the course of a query.

use alloc::collections::BinaryHeap;

use super::closest::{Meeting, Meets};
use super::front::{NetEntry, NetFront};
use super::gap::Trees;
use super::outcome::SurfaceWork;
use super::search::{NetGoal, NetSearch, OpenNodePair, Pace};
use super::side::NetSide;
use crate::base::num::fingerprint::Fingerprint;

/// Splits of nodes that one query may make by default. Two bicubic patches in general position need
/// some hundred, surfaces that are level along a curve any number: see `FIRST_LOOK` in `search.rs`.
pub(super) const SPLITS: usize = 20_000;

/// Splits that a query may be allowed: two nodes each of 448 numbers at most are counted in 32
/// bits.
const MOST_SPLITS: usize = 1 << 22;

/// A front is cut anew if it has grown to so many times its length. Not measured.
const GROWTH: usize = 4;

/// Regions tried in one search. Not measured.
const TRIES: usize = 5;

/// After so many pairs split the search is taken to be stuck at a local minimum, as where bodies
/// cross: then two points are looked for below every 32nd pair, wherever its middle is. A search
/// for points costs as much as some six splits.
const IMPATIENT: usize = 128;

/// The front of the last answer, the last witnesses, and counters.
#[derive(Clone, Debug)]
pub(super) struct SurfaceMemory {
    fingerprints: [Fingerprint; 2],
    budget: usize,
    pub(super) front: NetFront,
    /// Patches and parameters of the last witnesses.
    last: Option<([u32; 2], [f64; 4])>,
    /// How far the region of the last search reached.
    way: Option<f64>,
    heap: BinaryHeap<OpenNodePair>,
    pub(super) work: SurfaceWork,
}

impl Default for SurfaceMemory {
    fn default() -> Self {
        Self {
            fingerprints: [Fingerprint::default(); 2],
            budget: SPLITS,
            front: NetFront::default(),
            last: None,
            way: None,
            heap: BinaryHeap::new(),
            work: SurfaceWork::default(),
        }
    }
}

impl SurfaceMemory {
    /// Sets the number of splits that a query may make.
    pub(super) fn allow(&mut self, splits: usize) {
        self.budget = splits.min(MOST_SPLITS);
    }

    /// Forgets everything but the budget.
    pub(super) fn reset(&mut self) {
        let budget = self.budget;
        *self = Self {
            budget,
            ..Self::default()
        };
    }

    /// Begins a query of two bodies: returns whether the state is theirs; if not, or if it
    /// `is_full`, forgets it.
    pub(super) fn recognises(&mut self, fingerprints: [Fingerprint; 2], is_full: bool) -> bool {
        let is_known = self.fingerprints == fingerprints && !is_full;
        if !is_known {
            let work = self.work;
            self.reset();
            (self.fingerprints, self.work) = (fingerprints, work);
        }
        self.work.queries += 1;
        is_known
    }

    /// Returns the front of these bodies, empty for others.
    pub(super) fn entries(&self, fingerprints: [Fingerprint; 2]) -> &[NetEntry] {
        if self.fingerprints == fingerprints {
            &self.front.entries
        } else {
            &[]
        }
    }

    pub(super) fn heap_bytes(&self) -> usize {
        self.front.entries.capacity() * size_of::<NetEntry>() + self.heap.capacity() * size_of::<OpenNodePair>()
    }

    /// Returns a lower bound of the distance and the closest points; `None` if no points were
    /// found.
    pub(super) fn search<B: NetSide, M: Meets>(
        &mut self,
        trees: &mut Trees<'_, B>,
        points: &mut M,
        goal: NetGoal,
    ) -> Option<(f64, Meeting)> {
        let mut search = NetSearch {
            trees,
            points,
            goal,
            budget: self.budget,
            pace: Pace::new(self.budget),
            heap: &mut self.heap,
            front: &mut self.front,
            best: None,
            upper: f64::INFINITY,
            hint: None,
            region: None,
            way: &mut self.way,
            patience: IMPATIENT,
            tries: TRIES,
            least: f64::INFINITY,
            work: &mut self.work,
        };
        let (patches, at) = self.last.unwrap_or(([0, 0], [0.5; 4]));
        search.offer(patches, at);
        search.best.as_ref()?;
        let entries = search.front.entries.len();
        let is_new = entries == 0 || entries > GROWTH * search.front.cut;
        if is_new {
            search.start();
        } else {
            search.renew();
        }
        let lower = search.run();
        let best = search.best;
        if is_new {
            self.front.cut = self.front.entries.len();
        }
        self.work.gaps += trees.counts.gaps;
        self.work.caps += trees.counts.caps;
        self.work.bowls += trees.counts.bowls;
        let best = best?;
        self.last = Some((best.patches, best.at));
        Some((lower, best))
    }
}
