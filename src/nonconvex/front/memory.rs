//! The state between queries, for all kinds of leaves, and the decision whether to keep a front.
//!
//! The decision compares the work of queries that kept a front with the work of a search without
//! one ([`FrontWorth`]). If bodies touch at several points, or long bodies rotate fast, so many
//! directions fail from frame to frame that a front costs more than a new search. Such a front is
//! dropped. The next front is tried after some searches, about twice as many each time.

use alloc::vec::Vec;
use nalgebra::{Matrix3, Vector3};

use crate::base::num::Counter;
use crate::base::num::each::Each;
use crate::base::num::scalar::sqrt;
use crate::nonconvex::front::{EntryId, Front, NodePair};
use crate::nonconvex::query::box_gaps::{WIDTH, along};
use crate::nonconvex::query::frame::{TreeFrame, TreeMoves};
use crate::nonconvex::query::search::TreeWork;
use crate::nonconvex::query::search::{GapProof, Judge, TreeSearch};

/// Largest motion for which a front is worthwhile, about 2.4° of rotation.
///
/// A motion is the rotation, in radians for small angles, plus the translation as a fraction of L.
/// At 2° per frame, a front and a new search cost about the same.
const NEAR: f64 = 1.0 / 24.0;

/// Motion from which the search does not start from the last closest pair, about 5° of rotation.
///
/// Beyond it, this pair is a bad start that costs up to five times as many bounds.
const JUMP: f64 = 1.0 / 12.0;

/// A front is built again if it has grown by this factor, because splits are never undone.
///
/// Building a front costs thousands of bounds, and a long front costs a test per entry. For rocks
/// of 20,000 triangles at 0.5° per frame, a query takes 313 bounds with 2, 284 with 3 and 274 with
/// 5.
const GROWTH: usize = 3;

/// A new pair is searched if the last pairs are farther apart than this multiple of their distance.
///
/// That is the distance of the last answer. The new pair is found before the front is proven again,
/// because with too large a distance the front would be split in vain. Bodies that slide on each
/// other leave a pair every few frames.
const STALE: f64 = 4.0;

/// Largest number of entries of a front that is never dropped or built again because of its work.
///
/// A longer front is dropped if the directions of more than half its entries fail. Plates in flush
/// contact have about 30 entries, and only double precision proves half of them.
const FEW_ENTRIES: usize = 64;

/// The front, the last closest pairs, and buffers.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FrontMemory {
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) front: Front,
    /// The pairs of items that the next query measures first: closest pairs of the last answers.
    #[cfg_attr(feature = "serde", serde(skip))]
    last: [Option<NodePair>; 2],
    /// The last distance, in A's stored units.
    #[cfg_attr(feature = "serde", serde(skip))]
    distance: f64,
    #[cfg_attr(feature = "serde", serde(skip))]
    pose: Option<(Matrix3<f64>, Vector3<f64>)>,
    /// How far points have moved in the frames of their bodies since the last answer.
    ///
    /// In A's stored units.
    #[cfg_attr(feature = "serde", serde(skip))]
    bent: f64,
    /// The path sums of both bodies up to which the front has followed.
    #[cfg_attr(feature = "serde", serde(skip))]
    taken: [u64; 2],
    #[cfg_attr(feature = "serde", serde(skip))]
    worth: FrontWorth,
    #[cfg_attr(feature = "serde", serde(skip))]
    stack: Vec<NodePair>,
    #[cfg_attr(feature = "serde", serde(skip))]
    failed: Vec<EntryId>,
    pub(crate) work: TreeWork,
}

impl FrontMemory {
    /// Returns an empty memory for two bodies.
    pub(crate) fn of_bodies(moves: &TreeMoves) -> Self {
        Self {
            taken: moves.totals(),
            ..Self::default()
        }
    }

    /// Reduces every claim of the front by how far points have moved since the last call.
    pub(crate) fn follow(&mut self, moves: &TreeMoves) {
        match moves.since(self.taken) {
            Some(length) => {
                self.front.follow(moves);
                self.bent += length;
            }
            None => {
                self.front.clear();
                self.bent = f64::INFINITY;
            }
        }
        self.taken = moves.totals();
    }

    pub(crate) fn memory_usage(&self) -> usize {
        self.front.memory_usage()
            + self.stack.capacity() * size_of::<NodePair>()
            + self.failed.capacity() * size_of::<EntryId>()
    }

    /// Finds the closest pair of items, from the front if there is one.
    pub(crate) fn closest<J: Judge>(&mut self, search: &mut TreeSearch<J>) {
        let motion = self.motion(search.frame);
        self.pose = Some((search.frame.rotation, search.frame.translation));
        self.bent = 0.0;
        if motion < JUMP {
            for pair in self.last.into_iter().flatten() {
                search.measure(pair);
            }
        }
        if !search.is_over() {
            if motion < NEAR && !self.front.is_empty() {
                // After contact, the old directions predict nothing. So the search starts from a
                // new pair.
                if search.level() > STALE * self.distance + search.frame.tie {
                    search.seed();
                }
                self.renew(search);
            } else {
                self.begin(search, motion);
            }
        }
        if search.is_over() {
            self.front.clear();
        } else if motion < NEAR && self.is_cut_due() {
            self.cut(search);
        }
        self.conclude(search);
    }

    /// Returns whether any pair of items is within the distance of the search.
    ///
    /// Unless the roots are proven farther apart, the pairs of the last answers are tested first.
    pub(crate) fn is_within<J: Judge>(&mut self, search: &mut TreeSearch<J>) -> bool {
        search.start(&mut self.stack, None);
        if !self.stack.is_empty() {
            for pair in self.last.into_iter().flatten() {
                if !search.is_over() {
                    search.measure(pair);
                }
            }
            search.descend(&mut self.stack, None::<&mut Front>);
        }
        self.work += search.work;
        self.work.settled.count(search.judge.settled());
        let is_within = search.is_over();
        if let Some(best) = search.best.as_ref().filter(|_| is_within) {
            self.remember(best.pair);
        }
        is_within
    }

    fn conclude<J: Judge>(&mut self, search: &TreeSearch<J>) {
        self.work += search.work;
        self.work.settled.count(search.judge.settled());
        let Some(best) = &search.best else { return };
        self.distance = best.distance;
        match search.directions[0] {
            // Of several pairs that are equally close, this is the one whose direction proves the
            // others.
            Some((pair, _)) if pair != best.pair => self.last = [Some(pair), Some(best.pair)],
            _ => self.remember(best.pair),
        }
    }

    fn remember(&mut self, pair: NodePair) {
        if self.last[0] != Some(pair) {
            self.last = [Some(pair), self.last[0]];
        }
    }

    /// Returns the motion since the last query.
    ///
    /// It is the sum of the rotation, as a norm of the difference of the matrices, and the
    /// translation and displacement of points as fractions of L.
    fn motion(&self, frame: &TreeFrame) -> f64 {
        self.pose.as_ref().map_or(f64::INFINITY, |(r, t)| {
            let turn = sqrt(0.5 * (frame.rotation - r).norm_squared());
            turn + (sqrt((frame.translation - t).norm_squared()) + self.bent) / frame.size
        })
    }

    /// Returns whether to build a front: there is none and fronts are worthwhile, or it is too
    /// long.
    fn is_cut_due(&mut self) -> bool {
        if self.front.is_empty() {
            self.worth.is_due()
        } else {
            self.front.len() > (GROWTH * self.front.cut).max(FEW_ENTRIES)
        }
    }

    /// Searches without a front.
    fn begin<J: Judge>(&mut self, search: &mut TreeSearch<J>, motion: f64) {
        let before = FrontWorth::work(&search.work);
        self.front.clear();
        // The descent to the only item of a body meets a close pair as soon as the seed does.
        if !(motion < JUMP || search.a.is_alone() || search.b.is_alone()) {
            search.seed();
        }
        if !search.is_over() {
            search.start(&mut self.stack, None);
            search.descend(&mut self.stack, None::<&mut Front>);
        }
        if !search.is_over() {
            self.worth.searched(FrontWorth::work(&search.work) - before);
        }
    }

    /// Proves the front again, or searches without it if too many directions fail.
    ///
    /// Drops a front that took more work than a search.
    fn renew<J: Judge>(&mut self, search: &mut TreeSearch<J>) {
        self.test(search);
        let (failed, len) = (self.failed.len(), self.front.len());
        if len > FEW_ENTRIES && (2 * failed > len || self.worth.is_dearer(failed as u64)) {
            self.worth.lost();
            return self.begin(search, 0.0);
        }
        self.repair(search);
        if search.is_over() {
            return;
        }
        if len > FEW_ENTRIES && self.worth.is_dearer(FrontWorth::work(&search.work)) || self.front.is_full() {
            self.worth.lost();
            self.front.clear();
        } else {
            self.worth.paid();
        }
    }

    /// Collects the entries that are not proven at this pose.
    fn test<J: Judge>(&mut self, search: &mut TreeSearch<J>) {
        self.front.meet(&search.frame.single);
        self.failed.clear();
        let (failed, level) = (&mut self.failed, search.frame.single_up(search.level()));
        self.front.test(&search.frame.single, level, |place| failed.push(place));
        if self.front.has_moved() {
            self.hold_by_boxes(search, level);
        }
        search.work.entries += self.front.len() as u64;
        search.work.failed += self.failed.len() as u64;
    }

    /// Proves failed entries from the current boxes, and leaves from their items, along their
    /// directions.
    ///
    /// This is for bodies that bend: their claims lose the path lengths of all points, in every
    /// direction.
    fn hold_by_boxes<J: Judge>(&mut self, search: &mut TreeSearch<J>, level: f32) {
        let (single, trees, front) = (&search.frame.single, [search.a, search.b], &mut self.front);
        let mut left = 0;
        for first in (0..self.failed.len()).step_by(WIDTH) {
            let batch: [EntryId; WIDTH] = core::array::from_fn(|k| self.failed[(first + k).min(self.failed.len() - 1)]);
            let count = WIDTH.min(self.failed.len() - first);
            let normals = batch.each(|at| front.normal(single, at));
            let pairs = batch.each(|at| front.pair(at));
            let found = along(single, trees, &pairs, &normals);
            search.work.bounds += count as u64;
            for k in 0..count {
                let proven = found.gap[k] - single.error;
                if proven >= level {
                    let proof = GapProof {
                        normal: found.normal[k],
                        gap: proven,
                    };
                    front.set(single, trees, batch[k], proof);
                } else if let Some(proof) = search.by_items(pairs[k], normals[k]) {
                    front.set(single, trees, batch[k], proof);
                } else {
                    self.failed[left] = batch[k];
                    left += 1;
                }
            }
        }
        self.failed.truncate(left);
    }

    /// Finds new directions for the failed entries, or splits them.
    fn repair<J: Judge>(&mut self, search: &mut TreeSearch<J>) {
        self.stack.clear();
        for batch in self.failed.rchunks(8) {
            if search.is_over() {
                return;
            }
            let mut pairs = [[0; 2]; 8];
            (0..batch.len()).for_each(|k| pairs[k] = self.front.pair(batch[k]));
            let found = search.bound(&pairs[..batch.len()]);
            for k in (0..batch.len()).rev() {
                let (at, pair) = (batch[k], pairs[k]);
                match search.settle(pair, found.gap[k], found.normal[k]) {
                    Some(proof) => {
                        self.front.set(&search.frame.single, [search.a, search.b], at, proof);
                    }
                    None => {
                        self.front.remove(at);
                        self.stack.push(pair);
                    }
                }
            }
        }
        search.descend(&mut self.stack, Some(&mut self.front));
    }

    /// Builds a new front from the roots, with the known distance.
    fn cut<J: Judge>(&mut self, search: &mut TreeSearch<J>) {
        search.work.cuts += 1;
        self.front.clear();
        self.front.meet(&search.frame.single);
        search.start(&mut self.stack, Some(&mut self.front));
        search.descend(&mut self.stack, Some(&mut self.front));
        self.front.cut = self.front.len();
        if self.front.is_full() {
            self.worth.overflowed();
        }
        if search.is_over() || self.front.is_full() {
            self.front.clear();
        }
    }
}

/// Costs in units of one bound of a pair of boxes, roughly, from profiles of tumbling gears.
///
/// In the time of one bound, 16 entries of a front are tested. A pair of leaves takes 4 bounds, and
/// a pair of triangles 8.
const ENTRY_WORK: u64 = 16;
const LEAF_WORK: u64 = 4;
const MEASURE_WORK: u64 = 8;

/// Largest number of searches between a front that was dropped and the next one.
const LONGEST_WAIT: u32 = 63;

/// Records whether fronts were worthwhile lately.
#[derive(Clone, Copy, Debug, Default)]
struct FrontWorth {
    /// The work of the last search without a front; zero before the first.
    search: u64,
    /// Number of searches until a front is tried.
    left: u32,
    /// Number of searches between the last front and this one.
    wait: u32,
}

impl FrontWorth {
    /// Returns the work of a query, in bounds of boxes.
    fn work(done: &TreeWork) -> u64 {
        done.bounds + done.entries / ENTRY_WORK + LEAF_WORK * done.leaves + MEASURE_WORK * done.measured
    }

    /// Returns whether the next search must build a front.
    fn is_due(&mut self) -> bool {
        let is_due = self.left == 0;
        self.left = self.left.saturating_sub(1);
        is_due
    }

    /// Records the work of a search without a front.
    fn searched(&mut self, work: u64) {
        self.search = work;
    }

    /// Returns whether work with a front exceeds the work of a search.
    fn is_dearer(&self, work: u64) -> bool {
        self.search > 0 && work > self.search
    }

    /// Records that a front was worthwhile: the next one is tried at once.
    fn paid(&mut self) {
        self.wait = 0;
    }

    /// Records that a front was not worthwhile.
    fn lost(&mut self) {
        self.wait = (2 * self.wait + 1).min(LONGEST_WAIT);
        self.left = self.wait;
    }

    /// Records that a front was too long before it was complete: the next one is tried much later.
    fn overflowed(&mut self) {
        self.wait = LONGEST_WAIT;
        self.left = self.wait;
    }
}
