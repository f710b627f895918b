//! The record of a body that a step reads, in one cache line.

use crate::base::num::each::Each;
use crate::broad::aabb::StoredBox;
use crate::broad::grid::{Grid, Range};
use crate::broad::simd_box::Bounds;
use alloc::vec::Vec;
use wide::f32x4;

/// Flag: the body is fixed.
pub(crate) const FIXED: u32 = 1;
/// Flag: the body is in the list of unbounded bodies, outside all columns.
pub(crate) const UNBOUNDED: u32 = 1 << 1;
/// Flag: the stored box is larger than the given box.
pub(super) const LOOSE: u32 = 1 << 2;
/// Flag: the body is listed among the bodies that may have changed columns.
pub(super) const NOTED: u32 = 1 << 3;
/// Flag: the body changes columns in this step, so its entry depends on the column.
pub(crate) const MIGRATES: u32 = 1 << 4;
/// Flag: the body jumps in this step: the old and the new box are two entries.
pub(crate) const JUMPS: u32 = 1 << 5;

/// The record of a body that a step reads, in one cache line: two boxes in SIMD registers, whose
/// spare lanes hold the remaining fields as bits.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Record {
    /// The box of the step being prepared; the spare lane of the lower corner holds the least
    /// column, the spare lane of the upper corner the greatest.
    new: Bounds,
    /// The box of the last step; stale, and equal to the new box by definition, unless the stamp is
    /// the current step. The spare lane of the lower corner holds the stamp: the step for which the
    /// box last changed; the spare lane of the upper corner holds the flags.
    old: Bounds,
}

impl Record {
    /// Returns a record with this box, in no column and absent from the last step.
    pub(super) fn new(bounds: &Bounds, stamp: u32, flags: u32) -> Self {
        let mut record = Self {
            new: *bounds,
            old: Bounds::from_box(&StoredBox::EMPTY),
        };
        record.set_range(Range::NONE);
        set_spare(&mut record.old.lo, stamp);
        set_spare(&mut record.old.hi, flags);
        record
    }

    pub(super) fn absent() -> Self {
        Self::new(&Bounds::from_box(&StoredBox::EMPTY), 0, 0)
    }

    /// Returns the box of the step being prepared.
    #[inline(always)]
    pub(crate) fn now(&self) -> Bounds {
        self.new
    }

    /// Returns the box of the last step.
    #[inline(always)]
    pub(crate) fn before(&self, step: u32) -> Bounds {
        *self.at(false, step)
    }

    /// Returns the box of the step being prepared, or of the last step.
    #[inline(always)]
    pub(crate) fn at(&self, new: bool, step: u32) -> &Bounds {
        if new | !self.moved(step) { &self.new } else { &self.old }
    }

    /// Returns the step for which the box last changed.
    #[inline(always)]
    pub(super) fn stamp(&self) -> u32 {
        spare(&self.old.lo)
    }

    pub(super) fn set_stamp(&mut self, stamp: u32) {
        set_spare(&mut self.old.lo, stamp);
    }

    #[inline(always)]
    pub(crate) fn flags(&self) -> u32 {
        spare(&self.old.hi)
    }

    #[inline(always)]
    pub(super) fn raise(&mut self, flags: u32) {
        let flags = self.flags() | flags;
        set_spare(&mut self.old.hi, flags);
    }

    #[inline(always)]
    pub(super) fn lower(&mut self, flags: u32) {
        let flags = self.flags() & !flags;
        set_spare(&mut self.old.hi, flags);
    }

    #[inline(always)]
    pub(crate) fn moved(&self, step: u32) -> bool {
        self.stamp() == step
    }

    /// Returns whether the body is present in the step being prepared.
    pub(crate) fn present(&self) -> bool {
        is_present(&self.new)
    }

    pub(crate) fn present_before(&self, step: u32) -> bool {
        is_present(&self.before(step))
    }

    /// Returns the columns of the new box.
    #[inline(always)]
    pub(crate) fn range(&self) -> Range {
        Range {
            least: Range::unpack(spare(&self.new.lo)),
            most: Range::unpack(spare(&self.new.hi)),
        }
    }

    /// Returns the columns of the old box.
    pub(crate) fn range_before(&self, step: u32, grid: &Grid) -> Range {
        if self.present_before(step) && self.flags() & UNBOUNDED == 0 {
            grid.range(&self.before(step))
        } else {
            Range::NONE
        }
    }

    #[inline(always)]
    pub(super) fn set_range(&mut self, range: Range) {
        set_spare(&mut self.new.lo, Range::pack(range.least));
        set_spare(&mut self.new.hi, Range::pack(range.most));
    }

    #[inline(always)]
    pub(super) fn set_new(&mut self, bounds: &Bounds) {
        replace(&mut self.new, bounds);
    }

    pub(super) fn set_old(&mut self, bounds: &Bounds) {
        replace(&mut self.old, bounds);
    }

    /// Rotates the coordinates of both boxes to another cyclic order.
    pub(super) fn rotate(&mut self, turn: usize) {
        let [new, old] = [self.new, self.old].each(|bounds| Bounds::from_box(&bounds.to_box().rotated(turn)));
        self.set_new(&new);
        self.set_old(&old);
    }

    /// Replaces the new box; the first change of a step keeps the box of the last step.
    #[inline(always)]
    pub(super) fn touch(&mut self, index: u32, step: u32, moved: &mut Vec<u32>) {
        if !self.moved(step) {
            replace(&mut self.old, &{ self.new });
            self.set_stamp(step);
            moved.push(index);
        }
    }
}

#[inline(always)]
fn is_present(bounds: &Bounds) -> bool {
    bounds.lo.as_array()[0] <= bounds.hi.as_array()[0]
}

#[inline(always)]
fn spare(lanes: &f32x4) -> u32 {
    lanes.as_array()[3].to_bits()
}

#[inline(always)]
fn set_spare(lanes: &mut f32x4, bits: u32) {
    lanes.as_mut_array()[3] = f32::from_bits(bits);
}

/// Replaces the box and keeps the spare bits.
#[inline(always)]
fn replace(kept: &mut Bounds, by: &Bounds) {
    let (lo, hi) = (spare(&kept.lo), spare(&kept.hi));
    *kept = *by;
    set_spare(&mut kept.lo, lo);
    set_spare(&mut kept.hi, hi);
}
