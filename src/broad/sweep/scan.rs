//! The full sweep of a column: a window slides along the sorted entries, eight at a time.
//!
//! The sweep searches not for overlap but for *change* of overlap, which the new boxes alone show.
//! Let the separation of two boxes be the largest, over both sides of all axes, of the lower bound
//! of one box minus the upper bound of the other. It is at most zero if and only if the boxes
//! overlap. If no face of box i moved farther than `d_i`, the separation changed by at most
//! `d_i + d_j`. So only pairs whose separation is this close to zero may have changed: few, for any
//! number of overlaps. Unchanged pairs cost a few SIMD lanes of arithmetic and no memory.
//!
//! ```text
//!    box i   [-----------]                    start_i, end_i on the swept axis
//!    box j            [-------]               start_j <= end_i + farthest move: compared
//!    box k                        [-----]     start_k  > end_i + farthest move: the window ends
//! ```
//!
//! Entries are sorted by the lower bound of the new box. An entry is compared with the entries that
//! start before the sum of its end and the farthest move. Bodies that enter, leave or jump have
//! entries of one box. For such an entry, overlap itself is a change, so it is compared with every
//! box that is no farther away than that box has moved. Columns without such entries do not pay for
//! this.

use super::column::{ARRIVING, Column, Entry, EntryBoxes, index_of};
use super::tune::StepCounts;
use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use crate::base::tolerance::{COLUMN_MOVE, COLUMN_SUM};
use crate::broad::aabb::StoredBox;
use crate::broad::body::{Bodies, JUMPS, MIGRATES, Record};
use crate::broad::change::{Changes, overlap};
use alloc::vec::Vec;
use wide::f32x4;

/// Number of windows with hits to collect before the hits are tested.
const PENDING: usize = 32;

/// Number of entries copied at once.
const FOUR: usize = 4;

/// Number of entries compared at once: SIMD lanes.
const LANES: usize = 8;

/// The new boxes of a column, by axis, and their moves (structure of arrays). Padded by entries
/// that are apart from all boxes.
#[derive(Clone, Debug, Default)]
struct BoxColumns {
    /// Lower bounds on the swept axis: the sort order of the column.
    start: Vec<f32>,
    end: Vec<f32>,
    lo_u: Vec<f32>,
    hi_u: Vec<f32>,
    lo_v: Vec<f32>,
    hi_v: Vec<f32>,
    /// The farthest move of any face of the box in this step, rounded up; 0 for an entry of one
    /// box; NaN, for which every comparison is false, in the padding.
    moved: Vec<f32>,
    /// Least separation that is distinguished: 0 for an entry of one box, for which every depth of
    /// an overlap is a change; no limit for the others. Filled only if there are entries of one
    /// box.
    floor: Vec<f32>,
}

impl BoxColumns {
    /// Makes room for `n` entries and the padding; the content must be overwritten.
    fn make_room(&mut self, n: usize) {
        let Self {
            start,
            end,
            lo_u,
            hi_u,
            lo_v,
            hi_v,
            moved,
            floor,
        } = self;
        for bounds in [start, end, lo_u, hi_u, lo_v, hi_v, moved, floor] {
            bounds.resize(n + LANES, 0.0);
        }
    }

    /// Writes the only box of an entry.
    fn put_alone(&mut self, k: usize, only: &StoredBox) {
        (
            [self.start[k], self.lo_u[k], self.lo_v[k]],
            [self.end[k], self.hi_u[k], self.hi_v[k]],
        ) = (only.lo, only.hi);
        self.moved[k] = 0.0;
    }

    /// Fills the floors of a column in which the entries at the indices `alone` have one box.
    fn lay_floors(&mut self, alone: &[u32]) {
        self.floor.fill(f32::NEG_INFINITY);
        alone.iter().for_each(|k| self.floor[*k as usize] = 0.0);
    }

    /// Writes the padding after the entries.
    fn pad(&mut self, n: usize) {
        self.start[n..].fill(f32::INFINITY);
        self.moved[n..].fill(f32::NAN);
    }

    /// Copies four boxes to the indices from `k` on. Returns the moves of their faces, and the
    /// lengths on the swept axis of the covers of old and new boxes, or a little more.
    #[inline(always)]
    fn copy(&mut self, k: usize, records: &[&Record; FOUR], step: u32) -> (f32x4, f32x4) {
        let by = records.each(|record| record.before(step).displacement(&record.now()));
        let [start, lo_u, lo_v, _] = f32x4::transpose(records.each(|record| record.now().lo));
        let [end, hi_u, hi_v, _] = f32x4::transpose(records.each(|record| record.now().hi));
        let [by_x, by_u, by_v, _] = f32x4::transpose(by);
        let moved = by_x.fast_max(by_u).fast_max(by_v) * f32x4::splat(COLUMN_MOVE);
        let put = |boxes: &mut Vec<f32>, four: f32x4| boxes[k..k + FOUR].copy_from_slice(&four.to_array());
        put(&mut self.start, start);
        put(&mut self.end, end);
        put(&mut self.lo_u, lo_u);
        put(&mut self.hi_u, hi_u);
        put(&mut self.lo_v, lo_v);
        put(&mut self.hi_v, hi_v);
        put(&mut self.moved, moved);
        (moved, end - start + by_x + by_x)
    }
}

/// Scratch memory and results of one thread that sweeps columns.
#[derive(Clone, Debug, Default)]
#[repr(align(128))] // as `Marks` are
pub(super) struct Worker {
    boxes: BoxColumns,
    /// Hits of the sweep that are not yet tested.
    pending: Vec<Hits>,
    pub(super) changes: Changes,
    /// Indices of entries with one box.
    alone: Vec<u32>,
    /// Entries to scan one by one, in a repair.
    pub(super) active: Vec<u64>,
    /// Upper bound of how far the start of an entry lies behind its lower bound.
    pub(super) reach: f32,
    /// Number of entries compared with the entries of windows; a sweep counts whole blocks.
    pub(super) scanned: u64,
    /// Whether to count for tuning.
    pub(super) counting: bool,
    pub(super) counts: StepCounts,
    /// Positions that entries moved by to stay sorted.
    pub(super) swaps: u64,
}

impl Worker {
    /// Updates a column and records the changes that the column owns.
    pub(super) fn sweep(&mut self, index: usize, column: &mut Column, bodies: &Bodies) {
        let cell = bodies.grid.column(index);
        self.swaps += column.reorder(cell, &bodies.records, bodies.step);
        let moved = self.gather(cell, column, bodies);
        if moved {
            if self.alone.is_empty() {
                self.scan::<false>(column, cell, bodies);
            } else {
                self.boxes.lay_floors(&self.alone);
                self.scan::<true>(column, cell, bodies);
            }
            self.counts.entries += column.entries.len() as u64;
            if self.counting {
                self.count(column, bodies);
            }
        }
        if !self.alone.is_empty() {
            column.settle(cell, &bodies.records);
        }
        column.settled = column.entries.len();
    }

    /// Copies the boxes of the column and lists entries of one box in `alone`. Returns true if any
    /// box moved.
    fn gather(&mut self, cell: [u16; 2], column: &mut Column, bodies: &Bodies) -> bool {
        let n = column.entries.len();
        self.alone.clear();
        self.boxes.make_room(n);
        let (mut farthest, mut longest) = (f32x4::ZERO, f32x4::ZERO);
        for (k, entries) in column.entries.chunks(FOUR).enumerate() {
            // The last four may be fewer; the lanes behind the end are padding, which is written
            // last.
            let four: [Entry; FOUR] = core::array::from_fn(|i| entries[i.min(entries.len() - 1)]);
            let records = four.each(|e| &bodies.records[index_of(e)]);
            let (mut moved, mut length) = self.boxes.copy(FOUR * k, &records, bodies.step);
            let flags = records.iter().fold(0, |flags, record| flags | record.flags());
            let arriving = four.iter().fold(0, |all, e| all | *e as u32) & ARRIVING;
            if (flags & (MIGRATES | JUMPS) != 0) | (arriving != 0) {
                for i in 0..FOUR {
                    if let Some(only) = only_box(four[i], records[i], cell, bodies.step) {
                        moved.as_mut_array()[i] = 0.0;
                        length.as_mut_array()[i] = only.hi[0] - only.lo[0];
                        self.boxes.put_alone(FOUR * k + i, &only);
                        self.alone.extend((i < entries.len()).then_some((FOUR * k + i) as u32));
                    }
                }
            }
            farthest = farthest.fast_max(moved);
            longest = longest.fast_max(length);
        }
        self.boxes.pad(n);
        let most = |v: f32x4| v.to_array().into_iter().fold(0.0, f32::at_least);
        (column.longest, self.reach) = (most(longest), most(farthest));
        self.reach > 0.0 || !self.alone.is_empty()
    }

    /// Compares every entry with the entries that start before its end.
    fn scan<const ALONE: bool>(&mut self, column: &Column, cell: [u16; 2], bodies: &Bodies) {
        let n = column.entries.len();
        let padded = n + LANES;
        // Slices of one known length avoid bounds checks.
        let BoxColumns {
            start,
            end,
            lo_u,
            hi_u,
            lo_v,
            hi_v,
            moved,
            floor,
        } = &self.boxes;
        let (start, end, moved, floor) = (&start[..padded], &end[..padded], &moved[..padded], &floor[..padded]);
        let (lo_u, hi_u, lo_v, hi_v) = (&lo_u[..padded], &hi_u[..padded], &lo_v[..padded], &hi_v[..padded]);
        // Room for the windows of one more entry, so that no window has to wait until another is
        // tested.
        self.pending.resize(PENDING + padded / LANES + 1, (0, 0, 0));
        let pending = &mut self.pending[..];
        let (mut waiting, mut scanned) = (0, 0);
        // A little more, so that the rounding of the sum errs to the safe side; no bound is farther
        // from zero than these are together.
        let farthest = start[0].abs() + start[n - 1].abs() + column.longest;
        let beyond = 2.0 * self.reach + farthest * COLUMN_SUM;
        for i in 0..n {
            let reach = end[i] + beyond;
            let [x0, x1] = [start[i], end[i]].each(f32x4::splat);
            let [u0, u1, v0, v1] = [lo_u[i], hi_u[i], lo_v[i], hi_v[i]].each(f32x4::splat);
            let [by, least] = [moved[i], floor[i]].each(f32x4::splat);
            let hits_of_four = |j: usize| {
                let apart_x = (four(start, j) - x1).fast_max(x0 - four(end, j));
                let apart_u = (four(lo_u, j) - u1).fast_max(u0 - four(hi_u, j));
                let apart_v = (four(lo_v, j) - v1).fast_max(v0 - four(hi_v, j));
                let mut apart = apart_x.fast_max(apart_u).fast_max(apart_v);
                if ALONE {
                    apart = apart.fast_max(least.fast_max(four(floor, j)));
                }
                apart.abs().simd_le(by + four(moved, j)).to_bitmask()
            };
            let mut j = i + 1;
            while j + LANES <= padded {
                scanned += LANES;
                let hits = hits_of_four(j) | hits_of_four(j + FOUR) << FOUR;
                // Always written, kept only if there are hits: no branch to mispredict.
                pending[waiting] = (i as u32, j as u32, hits);
                waiting += usize::from(hits != 0);
                if start[j + LANES - 1] > reach {
                    break;
                }
                j += LANES;
            }
            if waiting >= PENDING {
                settle(&mut pending[..waiting], column, cell, bodies, &mut self.changes);
                waiting = 0;
            }
        }
        settle(&mut pending[..waiting], column, cell, bodies, &mut self.changes);
        self.scanned += scanned as u64;
        self.counts.compared += scanned as u64;
    }

    /// Counts the entries inside the windows of a sample of the column.
    fn count(&mut self, column: &Column, bodies: &Bodies) {
        let n = column.entries.len();
        let start = &self.boxes.start[..n];
        for i in (0..n).step_by(4) {
            let end = bodies.records[index_of(column.entries[i])].now().to_box().hi[0];
            self.counts.tests += start[i + 1..].partition_point(|s| *s <= end) as u64;
            self.counts.sampled += 1;
        }
        self.counts.columns += 1;
    }

    /// Returns the bytes reserved.
    pub(super) fn bytes(&self) -> usize {
        let boxes = self.boxes.start.capacity() * 8 * 4 + self.pending.capacity() * size_of::<Hits>();
        boxes
            + (self.changes.began.capacity() + self.changes.ended.capacity() + self.active.capacity()) * 8
            + self.alone.capacity() * 4
    }
}

/// Returns the box of an entry that represents only one box.
fn only_box(e: Entry, record: &Record, cell: [u16; 2], step: u32) -> Option<StoredBox> {
    match EntryBoxes::of(e as u32, record, cell) {
        EntryBoxes::Both => None,
        EntryBoxes::Old => Some(record.before(step).to_box()),
        EntryBoxes::New => Some(record.now().to_box()),
    }
}

/// An entry, the first of eight entries compared with the entry, and a mask of the hits among the
/// eight.
type Hits = (u32, u32, u32);

/// Tests which of the hits are changes: in each round the first hit of every window, then of the
/// windows with more hits. Results are always written and counted only if valid, since no branch
/// predicts the outcome.
#[inline(never)]
fn settle(pending: &mut [Hits], column: &Column, cell: [u16; 2], bodies: &Bodies, changes: &mut Changes) {
    let mut found = [(0, 0, false); PENDING];
    for pending in pending.chunks_mut(PENDING) {
        let mut open = pending.len();
        while open > 0 {
            let (mut left, mut changed) = (0, 0);
            for k in 0..open {
                let (i, j, hits) = pending[k];
                let first = column.entries[i as usize];
                let second = column.entries[(j + hits.trailing_zeros()) as usize];
                let [a, b] = [first, second].each(|e| &bodies.records[index_of(e)]);
                let (was, is) = overlap(a, b, bodies.step);
                found[changed] = (first as u32, second as u32, is);
                changed += usize::from(was != is);
                let others = hits & (hits - 1);
                pending[left] = (i, j, others);
                left += usize::from(others != 0);
            }
            for &(a, b, is) in &found[..changed] {
                decide(a, b, is, cell, bodies, changes);
            }
            open = left;
        }
    }
}

#[inline(always)]
fn four(bounds: &[f32], from: usize) -> f32x4 {
    let mut out = [0.0; FOUR];
    out.copy_from_slice(&bounds[from..from + FOUR]);
    f32x4::from(out)
}

/// Reports a changed pair if the column owns the pair: a beginning by the new boxes, an end by the
/// old boxes.
pub(super) fn decide(a: u32, b: u32, began: bool, cell: [u16; 2], bodies: &Bodies, changes: &mut Changes) {
    let (i, j) = (a >> 1, b >> 1);
    let (first, second) = (&bodies.records[i as usize], &bodies.records[j as usize]);
    let (part_a, part_b) = (EntryBoxes::of(a, first, cell), EntryBoxes::of(b, second, cell));
    // Computed without a branch, since the outcome is unpredictable.
    let seen = part_a.has(began) & part_b.has(began);
    let [box_a, box_b] = [first, second].each(|record| record.at(began, bodies.step));
    let owner = bodies.grid.owner(box_a, box_b);
    if seen & (owner == cell) {
        changes.note(i, j, !began, began);
    }
}
