//! From a given box to a stored box: checked, grown by the margins of the body, and noted if
//! changed.

use super::record::{LOOSE, NOTED, Record, UNBOUNDED};
use super::{BodyDetail, Marks};
use crate::base::num::extremes::Bounded;
use crate::broad::aabb::{Aabb, BoxFault, FARTHEST, StoredBox};
use crate::broad::bounds::{Bounds, any_above};
use crate::broad::grid::Grid;
use nalgebra::Point3;
use wide::f32x4;

/// The input of placing a box, besides the record.
pub(super) struct PlaceContext<'a> {
    pub(super) origin: &'a Point3<f64>,
    pub(super) grid: &'a Grid,
    pub(super) details: &'a [BodyDetail],
    pub(super) step: u32,
}

impl PlaceContext<'_> {
    /// Stores a new box and notes changes. Returns the fault of the box, if any. `AXIS` must be the
    /// swept axis of the grid.
    #[inline(always)]
    pub(super) fn place<const AXIS: usize>(
        &self,
        record: &mut Record,
        index: u32,
        aabb: &Aabb,
        marks: &mut Marks,
    ) -> Result<(), BoxFault> {
        match Bounds::outward::<AXIS>(aabb, self.origin) {
            Some(bounds) => {
                self.store(record, index, bounds, marks);
                Ok(())
            }
            None => self.place_slowly(record, index, aabb, marks),
        }
    }

    /// Places faulty, unbounded and far boxes. The two paths must not join before the box is
    /// stored: the box of the fast path would then go through memory, written and read in
    /// pieces of different sizes, which costs as much as all the rest.
    #[inline(never)]
    fn place_slowly(&self, record: &mut Record, index: u32, aabb: &Aabb, marks: &mut Marks) -> Result<(), BoxFault> {
        let stored = checked(aabb, self.origin, self.grid, record.flags())?;
        self.store(record, index, Bounds::from_box(&stored), marks);
        Ok(())
    }

    /// Stores new bounds. The common case touches only the record.
    #[inline(always)]
    fn store(&self, record: &mut Record, index: u32, given: Bounds, marks: &mut Marks) {
        let present = record.now();
        let mut bounds = given;
        if record.flags() & LOOSE != 0 {
            if present.contains(&given) {
                return;
            }
            bounds = self.loosened(record, index, given);
        }
        let by = present.displacement(&bounds);
        if !any_above(by, f32x4::ZERO) {
            return;
        }
        record.touch(index, self.step, &mut marks.moved);
        record.set_new(&bounds);
        if record.flags() & UNBOUNDED != 0 {
            return;
        }
        let range = self.grid.range(&bounds);
        let far = any_above(by, self.grid.leap);
        if (range != record.range()) | far {
            record.set_range(range);
            if record.flags() & NOTED == 0 {
                record.raise(NOTED);
                marks.noted.push(index);
            }
        }
    }

    /// Returns the given box grown by the margins of the body.
    #[inline(never)]
    fn loosened(&self, record: &Record, index: u32, given: Bounds) -> Bounds {
        let Some(detail) = self.details.get(index as usize) else {
            return given;
        };
        let (given, present) = (given.to_box(), record.now().to_box());
        let mut stored = grown(&given, detail.margin);
        let steps = self.step.wrapping_sub(record.stamp()).max(1) as f32;
        let ahead = detail.lookahead / steps;
        if ahead > 0.0 {
            for k in 0..3 {
                let travel = 0.5 * (given.lo[k] - present.lo[k] + given.hi[k] - present.hi[k]) * ahead;
                stored.lo[k] = (stored.lo[k] + travel.at_most(0.0)).at_least(-FARTHEST);
                stored.hi[k] = (stored.hi[k] + travel.at_least(0.0)).at_most(FARTHEST);
            }
        }
        Bounds::from_box(&stored)
    }
}

/// Returns the stored form of a box, or the fault of the box.
pub(super) fn checked(aabb: &Aabb, origin: &Point3<f64>, grid: &Grid, flags: u32) -> Result<StoredBox, BoxFault> {
    let fault = if flags & UNBOUNDED == 0 {
        aabb.fault()
    } else {
        aabb.fault_unbounded()
    };
    match fault {
        Some(fault) => Err(fault),
        None => Ok(StoredBox::outward(aabb, origin).rotated(grid.axis)),
    }
}

pub(super) fn grown(stored: &StoredBox, margin: f32) -> StoredBox {
    let mut out = *stored;
    for k in 0..3 {
        out.lo[k] = (stored.lo[k] - margin).at_least(-FARTHEST);
        out.hi[k] = (stored.hi[k] + margin).at_most(FARTHEST);
    }
    out
}

/// Returns a fixed number in (0, 1] for each index, evenly spread.
pub(super) fn fraction(index: u32) -> f32 {
    (index.wrapping_mul(2_654_435_769) >> 8) as f32 / (1 << 24) as f32
}
