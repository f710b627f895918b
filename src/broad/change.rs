//! The changes that a step finds: pairs that started and pairs that ended, computed from old and
//! new boxes alone.
//!
//! No state of a pair is needed to find that the pair started or ended, and a pair that stays costs
//! no table look-up. `was` and `is` are the overlaps of the old and of the new boxes; a pair is
//! reported if they differ.

use super::body::{Bodies, Record};
use super::tables::trim;
use alloc::vec::Vec;

/// Two body indices in one number, the lower index in the upper half, so that numbers sort like
/// pairs.
pub(crate) type PairKey = u64;

#[inline(always)]
pub(crate) fn pair_key(a: u32, b: u32) -> PairKey {
    let (low, high) = if a < b { (a, b) } else { (b, a) };
    u64::from(low) << 32 | u64::from(high)
}

#[inline(always)]
pub(crate) fn pair_of(key: PairKey) -> (u32, u32) {
    ((key >> 32) as u32, key as u32)
}

/// Pairs whose overlap changed, before groups are tested.
#[derive(Clone, Debug, Default)]
pub(crate) struct Changes {
    pub(crate) began: Vec<PairKey>,
    pub(crate) ended: Vec<PairKey>,
}

impl Changes {
    pub(crate) fn clear(&mut self) {
        for keys in [&mut self.began, &mut self.ended] {
            trim(keys);
            keys.clear();
        }
    }

    /// Moves all changes of `other` here; `other` keeps memory for as many.
    pub(crate) fn append(&mut self, other: &mut Self) {
        for (all, part) in [(&mut self.began, &mut other.began), (&mut self.ended, &mut other.ended)] {
            trim(part);
            if all.is_empty() {
                core::mem::swap(all, part);
            } else {
                all.append(part);
            }
        }
    }

    /// Sorts the changes that one thread found, so that [`settle`](Self::settle) only has to merge.
    pub(crate) fn sort(&mut self) {
        self.began.sort_unstable();
        self.ended.sort_unstable();
    }

    /// Sorts the changes by the two indices, each pair once: one order for every structure, mode
    /// and thread count. The library's stable sort takes sorted runs as they are.
    pub(crate) fn settle(&mut self) {
        for keys in [&mut self.began, &mut self.ended] {
            keys.sort();
            keys.dedup();
        }
    }

    /// Records the pair if its overlap changed.
    #[inline(always)]
    pub(crate) fn note(&mut self, a: u32, b: u32, was: bool, is: bool) {
        if was != is {
            let list = if is { &mut self.began } else { &mut self.ended };
            list.push(pair_key(a, b));
        }
    }
}

/// Returns whether the pair overlapped in the last step, and whether the pair overlaps now.
#[inline(always)]
pub(crate) fn overlap(a: &Record, b: &Record, step: u32) -> (bool, bool) {
    (a.before(step).overlaps(&b.before(step)), a.now().overlaps(&b.now()))
}

/// Compares the unbounded bodies, which are in no column, with all moved bodies, or with every body
/// if the unbounded body itself moved. A pair of two moved bodies is recorded from the body with
/// the lower index.
pub(crate) fn note_unbounded(bodies: &Bodies, changes: &mut Changes) {
    let step = bodies.step;
    for &w in &bodies.unbounded {
        let wide = &bodies.records[w as usize];
        let mut compare = |other: u32| {
            let record = &bodies.records[other as usize];
            let twice = record.flags() & super::body::UNBOUNDED != 0 && record.moved(step) && other < w;
            if other != w && !twice {
                let (was, is) = overlap(wide, record, step);
                changes.note(w, other, was, is);
            }
        };
        if wide.moved(step) {
            (0..bodies.records.len() as u32).for_each(compare);
        } else {
            bodies.marks.moved.iter().for_each(|&other| compare(other));
        }
    }
}
