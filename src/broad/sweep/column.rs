//! A column: its bodies in the order of their lower bound on the swept axis.

use crate::base::num::extremes::Bounded;
use crate::broad::aabb::order_key;
use crate::broad::body::{Bodies, JUMPS, MIGRATES, Record, UNBOUNDED};
use crate::broad::tables::read_ahead;
use alloc::vec::Vec;

/// Marks an entry for the new box only: the body entered the column in this step. It is the lowest
/// bit, below the index, so entries stay in order when the bit is cleared. After the entries of old
/// boxes are removed, no two entries differ in this bit alone.
pub(super) const ARRIVING: u32 = 1;

/// The box or boxes of a body that an entry represents in its column in this step.
///
/// A body that stays in a column has one entry for both boxes. A body that leaves keeps an entry
/// for the old box until the column is done, so that the ends of its pairs are found. A body that
/// enters gets an entry for the new box. A body that jumps has two entries, so that the path
/// between costs nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EntryBoxes {
    Both,
    Old,
    New,
}

impl EntryBoxes {
    /// Returns whether the entry represents the new box, and whether it represents the old box.
    #[inline(always)]
    pub(super) fn has(self, new: bool) -> bool {
        self != if new { Self::Old } else { Self::New }
    }

    /// Returns the part that the entry of `who` has in the column.
    #[inline(always)]
    pub(super) fn of(who: u32, record: &Record, column: [u16; 2]) -> Self {
        if who & ARRIVING != 0 {
            Self::New
        } else if record.flags() & (MIGRATES | JUMPS) == 0 {
            Self::Both
        } else if record.flags() & JUMPS != 0 || !record.range().contains(column) {
            Self::Old
        } else {
            Self::Both
        }
    }
}

/// An entry: the sort key of the lower bound in the upper half, index and flag in the lower half.
/// Ties are broken by index.
pub(super) type Entry = u64;

/// Returns the lower half of an entry: index of a body, and `ARRIVING` or 0.
#[inline(always)]
pub(super) fn who(index: u32, arriving: u32) -> u32 {
    index << 1 | arriving
}

#[inline(always)]
pub(super) fn entry(lower: f32, who: u32) -> Entry {
    u64::from(order_key(lower)) << 32 | u64::from(who)
}

#[inline(always)]
pub(super) fn index_of(entry: Entry) -> usize {
    (entry as u32 >> 1) as usize
}

/// The entries of a column. Between steps they are sorted, there is one entry per body, no flag is
/// set, and the keys belong to the last boxes of the bodies.
#[derive(Clone, Debug, Default)]
pub(super) struct Column {
    pub(super) entries: Vec<Entry>,
    /// Entries before this index were in order after the last step; the rest arrived since.
    pub(super) settled: usize,
    /// Upper bound of the lengths of the boxes of the column on the swept axis.
    pub(super) longest: f32,
}

impl Column {
    /// Returns the only column of a grid with a single column, as the last step left the column.
    pub(super) fn of_all(bodies: &Bodies) -> Self {
        let listed = |r: &Record| r.flags() & UNBOUNDED == 0 && r.present_before(bodies.step);
        let mut out = Self::default();
        for (i, record) in bodies.records.iter().enumerate().filter(|(_, r)| listed(r)) {
            let old = record.before(bodies.step).to_box();
            out.entries.push(entry(old.lo[0], who(i as u32, 0)));
            out.longest = out.longest.at_least(old.hi[0] - old.lo[0]);
        }
        out.entries.sort_unstable();
        out.settled = out.entries.len();
        out
    }

    /// Appends the new box of a body, out of order: [`reorder`](Self::reorder) sorts the entry.
    pub(super) fn arrive(&mut self, index: u32) {
        self.entries.push(u64::from(who(index, ARRIVING)));
    }

    /// Gives every entry the key of its box of this step and restores the order: insertion sort for
    /// the entries that stayed, which are nearly in order, then one merge with the entries that
    /// came. Returns by how many positions entries moved.
    pub(super) fn reorder(&mut self, column: [u16; 2], records: &[Record], step: u32) -> u64 {
        read_ahead(
            records.len(),
            self.entries.iter().map(|e| records[index_of(*e)].flags()),
        );
        let settled = self.settled.min(self.entries.len());
        let (stayed, came) = self.entries.split_at_mut(settled);
        let key = |e: Entry| {
            let who = e as u32;
            let record = &records[index_of(e)];
            let lower = match EntryBoxes::of(who, record, column) {
                EntryBoxes::Old => record.before(step).to_box().lo[0],
                _ => record.now().to_box().lo[0],
            };
            entry(lower, who)
        };
        let swaps = insertion_sort(stayed, key);
        if !came.is_empty() {
            came.iter_mut().for_each(|e| *e = key(*e));
            came.sort_unstable();
            merge_tail(&mut self.entries, settled);
        }
        swaps
    }

    /// Cleans up after the step: removes entries of old boxes and clears the flags of new entries.
    pub(super) fn settle(&mut self, column: [u16; 2], records: &[Record]) {
        self.entries.retain_mut(|e| {
            let part = EntryBoxes::of(*e as u32, &records[index_of(*e)], column);
            *e &= !u64::from(ARRIVING);
            part.has(true)
        });
        self.settled = self.entries.len();
    }
}

/// Sorts `items` by `key(item)`, which also replaces each item, by insertion. Linear if nearly in
/// order; if not, the rest is left to the library's sort. Returns by how many positions items moved
/// before.
fn insertion_sort(items: &mut [Entry], key: impl Fn(Entry) -> Entry) -> u64 {
    let most = 8 * items.len() + 64;
    let mut budget = most;
    let mut previous = 0;
    for k in 0..items.len() {
        let item = key(items[k]);
        items[k] = item;
        if item >= previous {
            previous = item;
            continue;
        }
        let mut place = k;
        while place > 0 && items[place - 1] > item {
            items[place] = items[place - 1];
            place -= 1;
        }
        items[place] = item;
        budget = budget.saturating_sub(k - place);
        if budget == 0 {
            items[k + 1..].iter_mut().for_each(|e| *e = key(*e));
            items.sort_unstable();
            break;
        }
    }
    (most - budget) as u64
}

/// Merges two sorted runs, the second starting at `middle`, from the back.
fn merge_tail(items: &mut [Entry], middle: usize) {
    let tail: Vec<Entry> = items[middle..].to_vec();
    let (mut left, mut place) = (middle, items.len());
    for &item in tail.iter().rev() {
        while left > 0 && items[left - 1] > item {
            place -= 1;
            left -= 1;
            items[place] = items[left];
        }
        place -= 1;
        items[place] = item;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(n: u64, spread: u64) -> Vec<Entry> {
        (0..n)
            .map(|i| i * 10 + (i.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) % spread)
            .collect()
    }

    #[test]
    fn sorts_order_anything() {
        for spread in [1, 50, 1 << 20] {
            let mut items = noise(500, spread);
            let mut sorted = items.clone();
            sorted.sort_unstable();
            insertion_sort(&mut items, |e| e);
            assert_eq!(items, sorted);
        }
    }

    #[test]
    fn merge_is_a_sort_of_two_runs() {
        for middle in [0, 1, 37, 99, 100] {
            let mut items = noise(100, 1 << 20);
            items[..middle].sort_unstable();
            items[middle..].sort_unstable();
            let mut sorted = items.clone();
            sorted.sort_unstable();
            merge_tail(&mut items, middle);
            assert_eq!(items, sorted);
        }
    }
}
