//! The full sweep of one column: a window slides along the sorted entries, eight at a time.
//!
//! What is tested is not overlap but *change* of overlap. With `U` the box that covers a body's old and new box, and
//! `d` the farthest any face of the column moved:
//!
//! 1. `U` of two bodies apart: they overlapped neither before nor after. Nothing to report.
//! 2. `U` of one shrunk by `2 d` still meets `U` of the other: they overlapped before and after. Nothing to report.
//! 3. Otherwise, which is rare under coherence, old and new boxes decide.
//!
//! So unchanged pairs, the great majority, cost a few lanes of a comparison and no memory.

use super::column::{ARRIVING, Column, Part, index_of};
use crate::broad::aabb::max;
use crate::broad::body::{Bodies, JUMPS, MIGRATES};
use crate::broad::bounds::largest;
use crate::broad::change::{Changes, overlap};
use alloc::vec::Vec;
use wide::{f32x4, f32x8};

/// Entries compared at once.
const LANES: usize = 8;

/// Four units in the last place: more than one rounded sum of two bounds can err.
const SLACK: f32 = 4.0 * f32::EPSILON;

/// The boxes of one column side by side, one vector for each bound, padded by `LANES` entries beyond every window.
#[derive(Clone, Debug, Default)]
struct Lanes {
    /// The bound the column is sorted by: at most `farthest` above the lower bound of `U`.
    start: Vec<f32>,
    /// Upper bound of `U` on the swept axis.
    end: Vec<f32>,
    /// The lesser upper bound of old and new box; minus infinity for an entry of one box only.
    sure_end: Vec<f32>,
    /// Bounds of `U` on the two other axes.
    lo: [Vec<f32>; 2],
    hi: [Vec<f32>; 2],
    who: Vec<u32>,
}

impl Lanes {
    fn resize(&mut self, n: usize) {
        let Self {
            start,
            end,
            sure_end,
            lo: [lo_u, lo_v],
            hi: [hi_u, hi_v],
            who,
        } = self;
        for bounds in [end, sure_end, lo_u, lo_v, hi_u, hi_v] {
            bounds.resize(n + LANES, 0.0);
        }
        who.resize(n + LANES, 0);
        start.resize(n + LANES, f32::INFINITY);
        start[n..].fill(f32::INFINITY);
    }
}

/// What one thread needs to sweep columns, and what it found.
#[derive(Clone, Debug, Default)]
pub(super) struct Worker {
    lanes: Lanes,
    pub(super) changes: Changes,
    /// Entries inside windows, and entries swept: what tuning goes by.
    pub(super) tests: u64,
    pub(super) swept: u64,
    /// Entries to look at in a repair, and how far the start of an entry may lie behind its lower bound.
    pub(super) active: Vec<u64>,
    pub(super) reach: f32,
}

/// What the gathering pass learned of a column.
struct Gathered {
    /// The farthest any face of an entry of both boxes moved.
    farthest: f32,
    longest: f32,
    moved: bool,
    parted: bool,
}

impl Worker {
    /// Bytes reserved.
    pub(super) fn bytes(&self) -> usize {
        let lanes = self.lanes.who.capacity() * 8 * 4;
        lanes + (self.changes.began.capacity() + self.changes.ended.capacity() + self.active.capacity()) * 8
    }

    /// Brings the column up to date and notes the changes it owns.
    pub(super) fn sweep(&mut self, index: usize, column: &mut Column, bodies: &Bodies) {
        let cell = bodies.grid.column(index);
        column.reorder(cell, &bodies.records, bodies.step);
        let gathered = self.gather(cell, column, bodies);
        column.longest = gathered.longest;
        if gathered.moved {
            self.scan(column.entries.len(), gathered.farthest, cell, bodies);
        }
        if gathered.parted {
            column.settle(cell, &bodies.records);
        }
        column.settled = column.entries.len();
    }

    fn gather(&mut self, cell: [u16; 2], column: &Column, bodies: &Bodies) -> Gathered {
        let n = column.entries.len();
        self.lanes.resize(n);
        let Lanes {
            start,
            end,
            sure_end,
            lo: [lo_u, lo_v],
            hi: [hi_u, hi_v],
            who,
        } = &mut self.lanes;
        let (start, end, sure_end) = (&mut start[..n], &mut end[..n], &mut sure_end[..n]);
        let (lo_u, lo_v, hi_u, hi_v) = (&mut lo_u[..n], &mut lo_v[..n], &mut hi_u[..n], &mut hi_v[..n]);
        let who = &mut who[..n];
        let step = bodies.step;
        let (mut moved, mut parted) = (false, false);
        let (mut farthest, mut longest) = (f32x4::ZERO, f32x4::ZERO);
        for (k, &e) in column.entries.iter().enumerate() {
            let record = &bodies.records[index_of(e)];
            let (old, new) = (record.old(step), record.new());
            moved |= record.moved(step);
            let mut union = old.united(&new);
            let mut from = new.lo;
            let mut least_end = old.hi.fast_min(new.hi).to_array()[0];
            let mut by = old.displacement(&new);
            if (record.flags & (MIGRATES | JUMPS) != 0) | (e as u32 & ARRIVING != 0) {
                let part = Part::of(e as u32, record, cell);
                if part != Part::Both {
                    union = if part == Part::Old { old } else { new };
                    (from, least_end, by) = (union.lo, f32::NEG_INFINITY, f32x4::ZERO);
                    parted = true;
                }
            }
            farthest = farthest.fast_max(by);
            longest = longest.fast_max(union.hi - union.lo);
            let ([_, u0, v0, _], [x1, u1, v1, _]) = (union.lo.to_array(), union.hi.to_array());
            start[k] = from.to_array()[0];
            (end[k], sure_end[k]) = (x1, least_end);
            [lo_u[k], lo_v[k], hi_u[k], hi_v[k]] = [u0, v0, u1, v1];
            who[k] = e as u32;
        }
        Gathered {
            farthest: largest(farthest),
            longest: longest.to_array()[0],
            moved,
            parted,
        }
    }

    /// Compares every entry with those that start before it ends.
    fn scan(&mut self, n: usize, farthest: f32, cell: [u16; 2], bodies: &Bodies) {
        let Lanes {
            start,
            end,
            lo: [lo_u, lo_v],
            hi: [hi_u, hi_v],
            ..
        } = &self.lanes;
        let padded = n + LANES;
        let (start, end) = (&start[..padded], &end[..padded]);
        let (lo_u, lo_v, hi_u, hi_v) = (&lo_u[..padded], &lo_v[..padded], &hi_u[..padded], &hi_v[..padded]);
        let mut tests = 0;
        // A little more than `farthest`, so that the rounding of sums and differences errs to the safe side.
        let d = farthest * 1.000_01;
        for i in 0..n {
            let reach = f32x8::splat(end[i] + d + end[i].abs() * SLACK);
            let [u0, u1, v0, v1] = [lo_u[i], hi_u[i], lo_v[i], hi_v[i]].map(f32x8::splat);
            let mut j = i + 1;
            while j + LANES <= padded {
                let near = eight(start, j).simd_le(reach);
                let overlaps_u = eight(lo_u, j).simd_le(u1) & u0.simd_le(eight(hi_u, j));
                let overlaps_v = eight(lo_v, j).simd_le(v1) & v0.simd_le(eight(hi_v, j));
                let hits = (near & overlaps_u & overlaps_v).to_bitmask();
                if hits != 0 {
                    let mut open = hits & !self.lanes.surely_same(i, j, d);
                    while open != 0 {
                        let k = j + open.trailing_zeros() as usize;
                        open &= open - 1;
                        decide(self.lanes.who[i], self.lanes.who[k], cell, bodies, &mut self.changes);
                    }
                }
                let inside = near.to_bitmask().trailing_ones();
                tests += u64::from(inside);
                if inside < LANES as u32 {
                    break;
                }
                j += LANES;
            }
        }
        self.tests += tests;
        self.swept += n as u64;
    }
}

impl Lanes {
    /// Which of the eight entries from `j` on overlapped entry `i` before and do so still, for certain.
    #[inline(always)]
    fn surely_same(&self, i: usize, j: usize, d: f32) -> u32 {
        let Self {
            start,
            end,
            sure_end,
            lo: [lo_u, lo_v],
            hi: [hi_u, hi_v],
            ..
        } = self;
        let largest = [start[i], end[i], lo_u[i], hi_u[i], lo_v[i], hi_v[i]]
            .iter()
            .fold(0.0, |m, v| max(m, v.abs()));
        let shrink: f32 = 2.0 * d + SLACK * largest;
        // `sure_end` of entry i tells whether it stands for both boxes; if not, nothing is sure.
        let from = if sure_end[i] > f32::NEG_INFINITY {
            start[i] + shrink
        } else {
            f32::INFINITY
        };
        let sure = f32x8::splat(from).simd_le(eight(sure_end, j))
            & eight(start, j).simd_le(f32x8::splat(end[i] - shrink))
            & eight(lo_u, j).simd_le(f32x8::splat(hi_u[i] - shrink))
            & f32x8::splat(lo_u[i] + shrink).simd_le(eight(hi_u, j))
            & eight(lo_v, j).simd_le(f32x8::splat(hi_v[i] - shrink))
            & f32x8::splat(lo_v[i] + shrink).simd_le(eight(hi_v, j));
        sure.to_bitmask()
    }
}

#[inline(always)]
fn eight(bounds: &[f32], from: usize) -> f32x8 {
    let mut out = [0.0; LANES];
    out.copy_from_slice(&bounds[from..from + LANES]);
    f32x8::from(out)
}

/// Old and new boxes decide, and the column reports what it owns: a beginning by the new boxes, an end by the old.
#[cold]
#[inline(never)]
pub(super) fn decide(a: u32, b: u32, cell: [u16; 2], bodies: &Bodies, changes: &mut Changes) {
    let (i, j) = (a & !ARRIVING, b & !ARRIVING);
    if i == j {
        return; // the two entries of a body that jumps
    }
    let (first, second) = (&bodies.records[i as usize], &bodies.records[j as usize]);
    let (was, is) = overlap(first, second, bodies.step);
    if was == is {
        return;
    }
    let (part_a, part_b) = (Part::of(a, first, cell), Part::of(b, second, cell));
    let (seen, owner) = if is {
        (
            part_a.has_new() && part_b.has_new(),
            bodies.grid.owner(&first.new(), &second.new()),
        )
    } else {
        let (old_a, old_b) = (first.old(bodies.step), second.old(bodies.step));
        (part_a.has_old() && part_b.has_old(), bodies.grid.owner(&old_a, &old_b))
    };
    if seen && owner == cell {
        changes.note(i, j, was, is);
    }
}
