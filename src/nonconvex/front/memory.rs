//! The state between queries, for every kind of leaves, and whether a front pays: the work of the
//! queries that kept one beside the work of a search without ([`FrontWorth`]).
//!
//! Bodies held in several places, and long parts that turn fast, lose so many directions from frame
//! to frame that a front costs more than a search anew. Such a front is dropped, and after some
//! searches, twice as many each time, another one is tried.

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

/// Motions up to this, as the norm of the difference of rotations and as a part of L, are worth a
/// front: some 2.4 degrees. At 2 degrees a frame a front and a new search cost about the same.
const NEAR: f64 = 1.0 / 24.0;

/// Motions beyond this begin anew: above some 5 degrees the pair that was closest is a bad start,
/// which costs up to five times the bounds.
const JUMP: f64 = 1.0 / 12.0;

/// A front is cut anew if it has grown to so many times its length: splits are never undone. A cut
/// costs thousands of bounds, a long front a test for each entry. Rocks of 20k triangles at 0.5
/// degrees a frame: 313, 284 and 274 bounds a query with 2, 3 and 5.
const GROWTH: usize = 3;

/// If the pairs that were closest are farther apart than so many times the last distance, a new
/// pair is looked for before the front is proven again: with a distance that is too large a front
/// is split in vain. Bodies that slide on each other leave a pair every few frames.
const STALE: f64 = 4.0;

/// Fronts of more entries than this are given up if the directions of over half of them fail.
/// Plates in flush contact have some 30 entries, half of which only double precision can prove.
/// Fronts of no more are never cut.
const FEW_ENTRIES: usize = 64;

/// Front, last pairs and buffers.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FrontMemory {
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) front: Front,
    /// The two closest pairs of items of the last answers.
    #[cfg_attr(feature = "serde", serde(skip))]
    last: [Option<NodePair>; 2],
    /// The last distance, in A's stored units.
    #[cfg_attr(feature = "serde", serde(skip))]
    distance: f64,
    #[cfg_attr(feature = "serde", serde(skip))]
    pose: Option<(Matrix3<f64>, Vector3<f64>)>,
    /// How far points of the bodies have moved in their own frames since the last answer, in A's
    /// stored units.
    #[cfg_attr(feature = "serde", serde(skip))]
    bent: f64,
    /// The sums of all such moves that the front has taken.
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

    /// Takes from every claim of the front how far points have moved since it was last taken.
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

    /// Finds the closest pair of items, by the front if there is one.
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
                // After contact the old directions predict nothing: start anew.
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

    /// Returns whether any pair of items is within the distance that the search asks for. Unless
    /// the roots are far apart, the pairs that decided last are tried first.
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
            // Of pairs that are equally close, the one whose direction proves the others.
            Some((pair, _)) if pair != best.pair => self.last = [Some(pair), Some(best.pair)],
            _ => self.remember(best.pair),
        }
    }

    fn remember(&mut self, pair: NodePair) {
        if self.last[0] != Some(pair) {
            self.last = [Some(pair), self.last[0]];
        }
    }

    /// Returns how far the pose is from that of the last query: the norm of the difference of
    /// rotations, the shift as a part of L, and so the moves of points in the bodies' frames.
    fn motion(&self, frame: &TreeFrame) -> f64 {
        self.pose.as_ref().map_or(f64::INFINITY, |(r, t)| {
            let turn = sqrt(0.5 * (frame.rotation - r).norm_squared());
            turn + (sqrt((frame.translation - t).norm_squared()) + self.bent) / frame.size
        })
    }

    /// Returns whether a front is worth its cut: there is none and fronts pay, or it has grown too
    /// long.
    fn is_cut_due(&mut self) -> bool {
        if self.front.is_empty() {
            self.worth.is_due()
        } else {
            self.front.len() > (GROWTH * self.front.cut).max(FEW_ENTRIES)
        }
    }

    /// A search without a front.
    fn begin<J: Judge>(&mut self, search: &mut TreeSearch<J>, motion: f64) {
        let before = FrontWorth::work(&search.work);
        self.front.clear();
        if !(motion < JUMP) {
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

    /// Proves the front again, or searches anew if too many directions fail; drops a front that
    /// took more work than a search.
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

    /// Finds the entries that their directions do not prove.
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

    /// Proves entries that failed by the boxes as they are, and leaves by their items, along the
    /// direction that they have: for bodies that bend, whose claims lose the paths of all points,
    /// in whatever direction.
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

    /// Gives the entries that failed new directions, or splits them.
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

    /// Cuts a new front, with the distance known.
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

/// Entries of a front that are tested in the time of one bound of boxes; and how many such bounds a
/// pair of leaves and a pair of triangles take: by profiles of tumbling gears, roughly.
const ENTRY_WORK: u64 = 16;
const LEAF_WORK: u64 = 4;
const MEASURE_WORK: u64 = 8;

/// Most searches between a front that did not pay and the next one that is tried. Not measured.
const LONGEST_WAIT: u32 = 63;

/// What fronts have been worth lately.
#[derive(Clone, Copy, Debug, Default)]
struct FrontWorth {
    /// The work of the last search without a front; zero before the first.
    search: u64,
    /// Searches to go before a front is tried.
    left: u32,
    /// Searches between the last front and this one.
    wait: u32,
}

impl FrontWorth {
    /// Returns the work of a query, in bounds of boxes.
    fn work(done: &TreeWork) -> u64 {
        done.bounds + done.entries / ENTRY_WORK + LEAF_WORK * done.leaves + MEASURE_WORK * done.measured
    }

    /// Returns whether the search to come is to keep a front.
    fn is_due(&mut self) -> bool {
        let is_due = self.left == 0;
        self.left = self.left.saturating_sub(1);
        is_due
    }

    /// Takes the work of a search without a front.
    fn searched(&mut self, work: u64) {
        self.search = work;
    }

    /// Returns whether work with a front is more than a search takes.
    fn is_dearer(&self, work: u64) -> bool {
        self.search > 0 && work > self.search
    }

    /// A front paid: the next one is tried at once.
    fn paid(&mut self) {
        self.wait = 0;
    }

    /// A front did not pay.
    fn lost(&mut self) {
        self.wait = (2 * self.wait + 1).min(LONGEST_WAIT);
        self.left = self.wait;
    }

    /// A front grew too long before it was whole: the next one is far off.
    fn overflowed(&mut self) {
        self.wait = LONGEST_WAIT;
        self.left = self.wait;
    }
}
