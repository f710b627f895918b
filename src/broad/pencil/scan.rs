//! The full sweep of one column: a window slides along the sorted entries, eight at a time.
//!
//! What is looked for is not overlap but *change* of overlap: old and new boxes stand side by side, and a pair is
//! touched only if exactly one of the two overlaps. So unchanged pairs, the great majority, cost a few lanes of a
//! comparison and no memory.
//!
//! With `d` the farthest any face of the column moved, an old box lies within its new box grown by `d`. So entries are
//! sorted by the lower bound of the new box alone, and an entry is compared with those that start before the end of its
//! own two boxes plus `d`. Bodies that come, leave or jump have one box only in the column; these few are left out of
//! the sweep and looked at one by one, as a repair does.

use super::column::{ARRIVING, Column, Part, index_of};
use crate::broad::aabb::{StoredBox, max};
use crate::broad::body::{Bodies, JUMPS, MIGRATES};
use crate::broad::bounds::{Bounds, largest};
use crate::broad::change::{Changes, overlap};
use alloc::vec::Vec;
use wide::{f32x4, f32x8};

/// Four units in the last place: more than one rounded sum of two bounds can err.
const SLACK: f32 = 4.0 * f32::EPSILON;

/// Entries compared at once.
const LANES: usize = 8;

/// The boxes of one column.
#[derive(Clone, Debug, Default)]
struct Lanes {
    /// Lower bound of the new box on the swept axis: what the column is sorted by. Padded by entries that meet nothing.
    start: Vec<f32>,
    /// The box that covers old and new box: its end on the swept axis, lower and upper bound on the two others.
    cover: [Vec<f32>; 5],
}

/// What one thread needs to sweep columns, and what it found.
#[derive(Clone, Debug, Default)]
pub(super) struct Worker {
    lanes: Lanes,
    pub(super) changes: Changes,
    /// Entries to look at one by one, and how far the start of an entry may lie behind its lower bound.
    pub(super) active: Vec<u64>,
    pub(super) reach: f32,
    /// What tuning goes by, if `counting`: entries inside the windows of a sample, the sample, and all entries.
    pub(super) counting: bool,
    pub(super) tests: u64,
    pub(super) sampled: u64,
    pub(super) swept: u64,
    /// Places that entries moved by to stay sorted.
    pub(super) swaps: u64,
}

impl Worker {
    /// Brings the column up to date and notes the changes it owns.
    pub(super) fn sweep(&mut self, index: usize, column: &mut Column, bodies: &Bodies) {
        let cell = bodies.grid.column(index);
        self.swaps += column.reorder(cell, &bodies.records, bodies.step);
        let moved = self.gather(cell, column, bodies);
        if moved {
            // Counted anew when tuning counts, in between dense stays dense.
            if column.dense && !self.counting {
                self.scan::<true>(column, cell, bodies);
            } else {
                column.dense = self.scan::<false>(column, cell, bodies);
            }
            for k in 0..self.active.len() {
                self.scan_one(column, self.active[k], cell, bodies, false);
            }
            if self.counting {
                self.count(column, bodies);
            }
        }
        if !self.active.is_empty() {
            column.settle(cell, &bodies.records);
        }
        column.settled = column.entries.len();
    }

    /// Copies the boxes of the column; lists entries of one box in `active` and leaves their lanes empty. True if
    /// anything moved.
    fn gather(&mut self, cell: [u16; 2], column: &mut Column, bodies: &Bodies) -> bool {
        let (n, step) = (column.entries.len(), bodies.step);
        self.active.clear();
        let Lanes {
            start,
            cover: [end, lo_u, hi_u, lo_v, hi_v],
        } = &mut self.lanes;
        for bounds in [&mut *end, lo_u, hi_u, lo_v, hi_v] {
            bounds.resize(n + LANES, 0.0);
        }
        start.resize(n + LANES, f32::INFINITY);
        start[n..].fill(f32::INFINITY);
        let (start, end) = (&mut start[..n], &mut end[..n]);
        let (lo_u, hi_u, lo_v, hi_v) = (&mut lo_u[..n], &mut hi_u[..n], &mut lo_v[..n], &mut hi_v[..n]);
        let absent = Bounds::from_box(&StoredBox::EMPTY);
        let (mut moved, mut farthest, mut longest) = (false, f32x4::ZERO, f32x4::ZERO);
        for (k, &e) in column.entries.iter().enumerate() {
            let record = &bodies.records[index_of(e)];
            moved |= record.moved(step);
            let (old, new) = (record.before(step), record.now());
            let (mut cover, mut from, mut by) = (old.united(&new), new.lo, old.displacement(&new));
            if (record.flags & (MIGRATES | JUMPS) != 0) | (e as u32 & ARRIVING != 0) {
                let part = Part::of(e as u32, record, cell);
                if part != Part::Both {
                    let only = if part == Part::Old { old } else { new };
                    longest = longest.fast_max(only.hi - only.lo);
                    (cover, from, by) = (absent, only.lo, f32x4::ZERO);
                    self.active.push(e);
                }
            }
            farthest = farthest.fast_max(by);
            longest = longest.fast_max(cover.hi - cover.lo);
            let ([_, u0, v0, _], [x1, u1, v1, _]) = (cover.lo.to_array(), cover.hi.to_array());
            (start[k], end[k]) = (from.to_array()[0], x1);
            (lo_u[k], hi_u[k], lo_v[k], hi_v[k]) = (u0, u1, v0, v1);
        }
        column.longest = longest.to_array()[0];
        self.reach = largest(farthest);
        moved
    }

    /// Compares every entry with those that start before it ends. True if that left more hits than entries to look at.
    ///
    /// `DENSE` is for columns where most hits are lasting pairs: what surely overlapped before and does so still is
    /// dropped at once. Elsewhere that costs more than it saves.
    fn scan<const DENSE: bool>(&mut self, column: &Column, cell: [u16; 2], bodies: &Bodies) -> bool {
        let n = column.entries.len();
        let padded = n + LANES;
        // Slices of one known length spare bounds checks.
        let Lanes {
            start,
            cover: [end, lo_u, hi_u, lo_v, hi_v],
        } = &self.lanes;
        let (start, end) = (&start[..padded], &end[..padded]);
        let (lo_u, hi_u, lo_v, hi_v) = (&lo_u[..padded], &hi_u[..padded], &lo_v[..padded], &hi_v[..padded]);
        // A little more, so that the rounding of the sum errs to the safe side.
        let d = self.reach * 1.000_01;
        let mut pending = [(0, 0, 0); PENDING];
        let mut waiting = 0;
        let mut looked_at = 0;
        for i in 0..n {
            let reach = end[i] + (d + end[i].abs() * SLACK);
            let [near, u0, u1, v0, v1] = [reach, lo_u[i], hi_u[i], lo_v[i], hi_v[i]].map(f32x8::splat);
            let mut j = i + 1;
            while j + LANES <= padded {
                let meets_u = eight(lo_u, j).simd_le(u1) & u0.simd_le(eight(hi_u, j));
                let meets_v = eight(lo_v, j).simd_le(v1) & v0.simd_le(eight(hi_v, j));
                let hits = eight(start, j).simd_le(near) & meets_u & meets_v;
                let mut hits = hits.to_bitmask();
                if DENSE {
                    hits &= !surely_same(&self.lanes, i, j, d);
                }
                // Written always, kept if there are any: no branch to mispredict.
                pending[waiting % PENDING] = (i as u32, j as u32, hits);
                waiting += usize::from(hits != 0);
                if waiting == PENDING {
                    looked_at += count_hits(&pending);
                    settle(&pending, column, cell, bodies, &mut self.changes);
                    waiting = 0;
                }
                if start[j + LANES - 1] > reach {
                    break;
                }
                j += LANES;
            }
        }
        settle(&pending[..waiting], column, cell, bodies, &mut self.changes);
        looked_at + count_hits(&pending[..waiting]) > n
    }

    /// Counts the entries inside the windows of a sample of the column.
    fn count(&mut self, column: &Column, bodies: &Bodies) {
        let n = column.entries.len();
        let start = &self.lanes.start[..n];
        for i in (0..n).step_by(4) {
            let end = bodies.records[index_of(column.entries[i])].now().to_box().hi[0];
            self.tests += start[i + 1..].partition_point(|s| *s <= end) as u64;
            self.sampled += 1;
        }
        self.swept += n as u64;
    }

    /// Bytes reserved.
    pub(super) fn bytes(&self) -> usize {
        let lanes = self.lanes.start.capacity() * 6 * 4;
        lanes + (self.changes.began.capacity() + self.changes.ended.capacity() + self.active.capacity()) * 8
    }
}

/// An entry, the first of eight others, and which of those it hit.
type Hits = (u32, u32, u32);

/// Hits put off until so many windows had some.
const PENDING: usize = 32;

fn count_hits(pending: &[Hits]) -> usize {
    pending.iter().map(|hits| hits.2.count_ones() as usize).sum()
}

/// Which of the eight entries from `j` on overlapped entry `i` before and do so still, for certain: those whose covers
/// would overlap even if both had shrunk by the farthest move.
#[inline(always)]
fn surely_same(lanes: &Lanes, i: usize, j: usize, d: f32) -> u32 {
    let Lanes {
        start,
        cover: [end, lo_u, hi_u, lo_v, hi_v],
    } = lanes;
    let size = [start[i], end[i], lo_u[i], hi_u[i], lo_v[i], hi_v[i]]
        .iter()
        .fold(0.0, |m, v| max(m, v.abs()));
    let shrink: f32 = 2.0 * d + SLACK * size;
    let inside = |lo: &[f32], hi: &[f32]| {
        let (first, last) = (f32x8::splat(lo[i] + shrink), f32x8::splat(hi[i] - shrink));
        eight(lo, j).simd_le(last) & first.simd_le(eight(hi, j))
    };
    (inside(start, end) & inside(lo_u, hi_u) & inside(lo_v, hi_v)).to_bitmask()
}

/// Finds out which of the hits are changes.
#[inline(never)]
fn settle(pending: &[Hits], column: &Column, cell: [u16; 2], bodies: &Bodies, changes: &mut Changes) {
    for &(i, j, hits) in pending {
        let first = column.entries[i as usize];
        let a = &bodies.records[index_of(first)];
        let mut open = hits;
        while open != 0 {
            let second = column.entries[(j + open.trailing_zeros()) as usize];
            open &= open - 1;
            let (was, is) = overlap(a, &bodies.records[index_of(second)], bodies.step);
            if was != is {
                decide(first as u32, second as u32, is, cell, bodies, changes);
            }
        }
    }
}

#[inline(always)]
fn eight(bounds: &[f32], from: usize) -> f32x8 {
    let mut out = [0.0; LANES];
    out.copy_from_slice(&bounds[from..from + LANES]);
    f32x8::from(out)
}

/// Reports a changed pair if the column owns it: a beginning by the new boxes, an end by the old ones.
pub(super) fn decide(a: u32, b: u32, began: bool, cell: [u16; 2], bodies: &Bodies, changes: &mut Changes) {
    let (i, j) = (a & !ARRIVING, b & !ARRIVING);
    let (first, second) = (&bodies.records[i as usize], &bodies.records[j as usize]);
    let (part_a, part_b) = (Part::of(a, first, cell), Part::of(b, second, cell));
    let (seen, owner) = if began {
        (
            part_a.has_new() & part_b.has_new(),
            bodies.grid.owner(&first.now(), &second.now()),
        )
    } else {
        let (old_a, old_b) = (first.before(bodies.step), second.before(bodies.step));
        (part_a.has_old() & part_b.has_old(), bodies.grid.owner(&old_a, &old_b))
    };
    if seen & (owner == cell) {
        changes.note(i, j, !began, began);
    }
}
