//! Local repair: if few boxes changed, only their entries move and only their windows are scanned.

use super::column::{ARRIVING, Column, EntryBoxes, entry, index_of, who};
use super::scan::{Worker, decide};
use crate::base::num::extremes::Bounded;
use crate::base::tolerance::{COLUMN_REACH, COLUMN_SEARCH};
use crate::broad::aabb::order_key;
use crate::broad::body::{Bodies, JUMPS, MIGRATES, Record};
use crate::broad::change::overlap;
use crate::broad::simd_box::{Bounds, largest};
use alloc::vec::Vec;

/// A column is swept completely if the number of its changed entries times this factor exceeds the
/// number of its entries.
const COLUMN_SHARE: usize = 6;

/// A column is swept completely if more than this number of bodies enter it, leave it or jump: each
/// shifts the entries behind it.
const MOST_PARTED: usize = 32;

/// A column is swept completely after all if the windows of its changed entries contain this many
/// times the number of its entries.
const MOST_SCANNED: u64 = 4;

/// A column number and the index of a body whose old or new box touches it.
pub(super) type Touch = (u32, u32);

/// Lists the columns of all bodies that moved, in ascending order.
pub(super) fn list_touched(bodies: &Bodies, touched: &mut Vec<Touch>) {
    touched.clear();
    for &index in &bodies.marks.moved {
        let record = &bodies.records[index as usize];
        let mut push = |cell: [u16; 2]| touched.push((bodies.grid.index(cell) as u32, index));
        let range = record.range();
        range.columns().for_each(&mut push);
        if record.flags() & MIGRATES != 0 {
            let old = record.range_before(bodies.step, &bodies.grid);
            old.columns().filter(|cell| !range.contains(*cell)).for_each(push);
        }
    }
    touched.sort_unstable();
}

impl Worker {
    /// Updates a column in which only the listed bodies changed.
    pub(super) fn repair(&mut self, column: &mut Column, touched: &[Touch], bodies: &Bodies) {
        let Some(&(index, _)) = touched.first() else { return };
        let cell = bodies.grid.column(index as usize);
        let parts = |touch: &&Touch| bodies.records[touch.1 as usize].flags() & (MIGRATES | JUMPS) != 0;
        let parted = touched.iter().filter(parts).count();
        if touched.len() * COLUMN_SHARE > column.entries.len() || parted > MOST_PARTED {
            for &(_, who) in touched {
                if roles(&bodies.records[who as usize], cell, bodies).1 {
                    column.arrive(who);
                }
            }
            return self.sweep(index as usize, column, bodies);
        }
        self.move_entries(column, touched, cell, bodies);
        column.settled = column.entries.len();
        let most = self.scanned + MOST_SCANNED * column.entries.len() as u64;
        for k in 0..self.active.len() {
            self.scan_one(column, self.active[k], cell, bodies);
            if self.scanned > most {
                // Changes found so far are found again and counted once.
                return self.sweep(index as usize, column, bodies);
            }
        }
        if parted > 0 {
            self.settle_active(column, cell, bodies);
        }
    }

    /// Cleans up as [`Column::settle`] does, for the few entries of one box. For a body with two
    /// entries, the old entry is listed last.
    fn settle_active(&self, column: &mut Column, cell: [u16; 2], bodies: &Bodies) {
        for &e in self.active.iter().rev() {
            let part = EntryBoxes::of(e as u32, &bodies.records[index_of(e)], cell);
            if part == EntryBoxes::Both {
                continue;
            }
            let Ok(place) = column.entries.binary_search(&e) else {
                debug_assert!(false, "a column lost the entry {e:#x}");
                continue;
            };
            if part == EntryBoxes::Old {
                column.entries.remove(place);
            } else {
                column.entries[place] &= !u64::from(ARRIVING);
            }
        }
        column.settled = column.entries.len();
    }

    /// Moves the entries of the touched bodies to their new positions and lists the entries in
    /// `active`.
    fn move_entries(&mut self, column: &mut Column, touched: &[Touch], cell: [u16; 2], bodies: &Bodies) {
        self.active.clear();
        self.reach = 0.0;
        for &(_, index) in touched {
            let record = &bodies.records[index as usize];
            let (stays, comes) = roles(record, cell, bodies);
            let (old, new) = (record.before(bodies.step), record.now());
            let (old_start, new_start) = (old.to_box().lo[0], new.to_box().lo[0]);
            if comes {
                let item = entry(new_start, who(index, ARRIVING));
                let place = column.entries.partition_point(|e| *e < item);
                column.entries.insert(place, item);
                column.longest = column.longest.at_least(length(&new));
                self.active.push(item);
            }
            if !stays {
                continue;
            }
            let mut item = entry(old_start, who(index, 0));
            if EntryBoxes::of(item as u32, record, cell) == EntryBoxes::Both {
                let moved = entry(new_start, who(index, 0));
                self.swaps += shift(&mut column.entries, item, moved);
                item = moved;
                column.longest = column.longest.at_least(length(&old.united(&new)));
                self.reach = self.reach.at_least(largest(old.displacement(&new)));
            }
            self.active.push(item);
        }
    }

    /// Records the changes between one entry and all entries that may meet its boxes. Every moved
    /// body is scanned in this way, so two such entries meet twice. Only the entry with the lower
    /// index reports the change.
    fn scan_one(&mut self, column: &Column, active: u64, cell: [u16; 2], bodies: &Bodies) {
        let who = active as u32;
        let record = &bodies.records[index_of(active)];
        let step = bodies.step;
        let cover = box_of(who, record, cell, step);
        let union = cover.to_box();
        let slack = COLUMN_SEARCH * union.lo[0].abs().at_least(union.hi[0].abs());
        let first = order_key(union.lo[0] - column.longest * COLUMN_REACH - slack);
        let last = order_key(union.hi[0] + self.reach * COLUMN_REACH + slack);
        let place = column.entries.partition_point(|e| ((e >> 32) as u32) < first);
        for &e in &column.entries[place..] {
            if (e >> 32) as u32 > last {
                break;
            }
            self.scanned += 1;
            let other = &bodies.records[index_of(e)];
            if index_of(e) == index_of(active) {
                continue; // itself, or the other entry of a body that jumps
            }
            // Most entries of the window are separated on another axis, both before and now.
            let near = cover.overlaps(&other.now()) || (other.moved(step) && cover.overlaps(&other.before(step)));
            if !near {
                continue;
            }
            let (was, is) = overlap(record, other, step);
            if was == is {
                continue;
            }
            let twice = other.moved(step) && index_of(e) < index_of(active);
            if !twice {
                decide(who, e as u32, is, cell, bodies, &mut self.changes);
            }
        }
    }
}

/// Returns whether the body has an entry in the column from the last step, and whether the body
/// needs a new entry.
fn roles(record: &Record, cell: [u16; 2], bodies: &Bodies) -> (bool, bool) {
    let flags = record.flags();
    let in_new = record.range().contains(cell);
    let in_old = flags & MIGRATES != 0 && record.range_before(bodies.step, &bodies.grid).contains(cell);
    let stays = if flags & MIGRATES == 0 { in_new } else { in_old };
    (stays, in_new && (flags & JUMPS != 0 || !stays))
}

/// Returns the box that an entry represents: the cover of old and new box, or one of the two.
fn box_of(who: u32, record: &Record, cell: [u16; 2], step: u32) -> Bounds {
    match EntryBoxes::of(who, record, cell) {
        EntryBoxes::Both => record.before(step).united(&record.now()),
        EntryBoxes::Old => record.before(step),
        EntryBoxes::New => record.now(),
    }
}

/// Returns the length on the swept axis.
fn length(bounds: &Bounds) -> f32 {
    let stored = bounds.to_box();
    stored.hi[0] - stored.lo[0]
}

/// Replaces an entry by another and keeps the order. Returns by how many positions the entry moved.
fn shift(entries: &mut [u64], from: u64, to: u64) -> u64 {
    let Ok(place) = entries.binary_search(&from) else {
        debug_assert!(false, "a column lost the entry {from:#x}");
        return 0;
    };
    let mut target = place;
    while target + 1 < entries.len() && entries[target + 1] < to {
        entries[target] = entries[target + 1];
        target += 1;
    }
    while target > 0 && entries[target - 1] > to {
        entries[target] = entries[target - 1];
        target -= 1;
    }
    entries[target] = to;
    place.abs_diff(target) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shifting_keeps_the_order() {
        let sorted: Vec<u64> = (0..40).map(|k| k * 10).collect();
        for from in 0..40 {
            for to in 0..41 {
                let mut entries = sorted.clone();
                let mut expected = sorted.clone();
                shift(&mut entries, from * 10, to * 10 + 5);
                expected[from as usize] = to * 10 + 5;
                expected.sort_unstable();
                assert_eq!(entries, expected);
            }
        }
    }
}
