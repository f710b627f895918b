//! What a step reads of a body, in one cache line.

use crate::broad::aabb::StoredBox;
use crate::broad::bounds::Bounds;
use crate::broad::grid::{Grid, Range};
use alloc::vec::Vec;
use wide::f32x4;

/// The body does not move by itself: it never pairs with another fixed one.
pub(crate) const FIXED: u32 = 1;
/// Kept in the list of unbounded bodies, outside all columns.
pub(crate) const UNBOUNDED: u32 = 1 << 1;
/// The stored box is larger than the given one.
pub(super) const LOOSE: u32 = 1 << 2;
/// Listed among those that may have changed columns.
pub(super) const NOTED: u32 = 1 << 3;
/// This step the body changes columns, so its part in a column depends on the column.
pub(crate) const MIGRATES: u32 = 1 << 4;
/// This step the body jumps: its old and its new box are listed as two entries.
pub(crate) const JUMPS: u32 = 1 << 5;

/// What a step reads of a body, in one cache line. Each box takes two vector registers whose spare lanes hold the rest.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Record {
    /// The box of the step being prepared, and its columns.
    pub(super) lo: [f32; 3],
    pub(super) least: u32,
    pub(super) hi: [f32; 3],
    pub(super) most: u32,
    /// The box of the last step; stale, and equal to the new one by definition, unless `stamp` is the current step.
    pub(super) old_lo: [f32; 3],
    /// The step for which the box last changed.
    pub(super) stamp: u32,
    pub(super) old_hi: [f32; 3],
    pub(crate) flags: u32,
}

impl Record {
    pub(super) fn absent() -> Self {
        let StoredBox { lo, hi } = StoredBox::EMPTY;
        let [least, most] = [Range::NONE.least, Range::NONE.most].map(Range::pack);
        Self {
            lo,
            least,
            hi,
            most,
            old_lo: lo,
            stamp: 0,
            old_hi: hi,
            flags: 0,
        }
    }

    /// The box of the step being prepared.
    #[inline(always)]
    pub(crate) fn now(&self) -> Bounds {
        Bounds {
            lo: lanes(self.lo, self.least),
            hi: lanes(self.hi, self.most),
        }
    }

    /// The box of the last step.
    #[inline(always)]
    pub(crate) fn before(&self, step: u32) -> Bounds {
        if self.stamp == step {
            Bounds {
                lo: lanes(self.old_lo, self.stamp),
                hi: lanes(self.old_hi, self.flags),
            }
        } else {
            self.now()
        }
    }

    #[inline(always)]
    pub(crate) fn moved(&self, step: u32) -> bool {
        self.stamp == step
    }

    /// Whether the body is there in the step being prepared, and whether it was in the last.
    pub(crate) fn present(&self) -> bool {
        self.lo[0] <= self.hi[0]
    }

    pub(crate) fn present_before(&self, step: u32) -> bool {
        if self.stamp == step {
            self.old_lo[0] <= self.old_hi[0]
        } else {
            self.present()
        }
    }

    /// Columns of the new box.
    #[inline(always)]
    pub(crate) fn range(&self) -> Range {
        Range {
            least: Range::unpack(self.least),
            most: Range::unpack(self.most),
        }
    }

    /// Columns of the old box.
    pub(crate) fn range_before(&self, step: u32, grid: &Grid) -> Range {
        if self.present_before(step) && self.flags & UNBOUNDED == 0 {
            grid.range(&self.before(step))
        } else {
            Range::NONE
        }
    }

    #[inline(always)]
    pub(super) fn set_range(&mut self, range: Range) {
        (self.least, self.most) = (Range::pack(range.least), Range::pack(range.most));
    }

    #[inline(always)]
    pub(super) fn set_new(&mut self, bounds: &Bounds) {
        let stored = bounds.to_box();
        (self.lo, self.hi) = (stored.lo, stored.hi);
    }
}

/// Four consecutive numbers of a record as one vector.
#[inline(always)]
fn lanes([a, b, c]: [f32; 3], rest: u32) -> f32x4 {
    f32x4::from([a, b, c, f32::from_bits(rest)])
}

/// The first change of a step keeps the box of the last one.
#[inline(always)]
pub(super) fn touch(record: &mut Record, index: u32, step: u32, moved: &mut Vec<u32>) {
    if record.stamp != step {
        record.stamp = step;
        (record.old_lo, record.old_hi) = (record.lo, record.hi);
        moved.push(index);
    }
}
