//! Queries about the boxes of the last step.

use super::PencilSweep;
use super::column::{Column, index_of};
use crate::base::num::extremes::Bounded;
use crate::base::tolerance::COLUMN_SEARCH;
use crate::broad::aabb::{StoredBox, order_key};
use crate::broad::body::{Bodies, Record};
use crate::broad::bounds::Bounds;

/// Visits every body once whose box overlaps `asked`; `place` returns the box of a record by which
/// the columns are sorted.
pub(super) fn overlapping(
    bodies: &Bodies,
    columns: &[Column],
    asked: &Bounds,
    place: impl Fn(&Record) -> Bounds,
    mut visit: impl FnMut(u32),
) {
    let StoredBox {
        lo: [start, ..],
        hi: [end, ..],
    } = asked.to_box();
    for cell in bodies.grid.range(asked).columns() {
        let Some(column) = columns.get(bodies.grid.index(cell)) else {
            continue;
        };
        let slack = COLUMN_SEARCH * start.abs().at_least(column.longest);
        let first = order_key(start - column.longest - slack);
        let last = order_key(end);
        let from = column.entries.partition_point(|e| ((e >> 32) as u32) < first);
        for &e in column.entries[from..].iter().take_while(|e| (*e >> 32) as u32 <= last) {
            let stored = place(&bodies.records[index_of(e)]);
            if stored.overlaps(asked) && bodies.grid.owner(&stored, asked) == cell {
                visit(index_of(e) as u32);
            }
        }
    }
    for &index in &bodies.unbounded {
        if place(&bodies.records[index as usize]).overlaps(asked) {
            visit(index);
        }
    }
}

impl PencilSweep {
    /// Iterates over the columns that hold a body, for pictures and statistics: lower corner and
    /// upper corner on the two axes that are not swept, and the number of listed bodies.
    pub fn pencils(&self) -> impl Iterator<Item = Pencil> + '_ {
        let grid = &self.state.bodies.grid;
        let held = self
            .columns
            .iter()
            .enumerate()
            .filter(|(_, column)| !column.entries.is_empty());
        held.map(move |(i, column)| {
            let cell = grid.column(i);
            let lo = core::array::from_fn(|k| grid.corner()[k] + f32::from(cell[k]) * grid.width);
            Pencil {
                swept_axis: grid.axis,
                lo,
                hi: lo.map(|v| v + grid.width),
                listed: column.entries.len(),
            }
        })
    }
}

/// A column of [`PencilSweep`]. Columns at the border of the grid also hold all bodies beyond the
/// border.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Pencil {
    /// The axis of the column: 0, 1, 2 for x, y, z. The two remaining axes follow in cyclic order.
    pub swept_axis: usize,
    /// Lower corner on the two remaining axes, relative to the origin of the structure.
    pub lo: [f32; 2],
    /// Upper corner on the two remaining axes.
    pub hi: [f32; 2],
    /// Number of bodies listed.
    pub listed: usize,
}
