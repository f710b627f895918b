//! A small hash table of links: open addressing, linear probing, deletion by backward shift (Knuth,
//! section 6.4).

use crate::broad::change::PairKey;
use crate::broad::pairs::{NOWHERE, Slot};
use alloc::vec::Vec;

/// A hash of the two bodies, and the slot of their pair; the slot decides whether the link belongs
/// to a given pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    hash: u32,
    pub(super) slot: u32,
}

/// A vacant place; no pair has this slot.
const VACANT: Link = Link {
    hash: 0,
    slot: NOWHERE.id.slot,
};

impl Link {
    #[inline(always)]
    pub(super) fn new(key: PairKey, slot: u32) -> Self {
        let hash = hash(key);
        Self { hash, slot }
    }

    #[inline(always)]
    fn is_vacant(&self) -> bool {
        self.slot == VACANT.slot
    }
}

/// Returns the high half of a product with 2^64 over the golden ratio (Knuth, section 6.4).
#[inline(always)]
fn hash(key: PairKey) -> u32 {
    (key.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32) as u32
}

/// The links of some consecutive lower bodies.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    /// Table of links, at most 3/8 full: runs are short, and deletion walks over a run.
    pub(super) places: Vec<Link>,
    pub(super) live: usize,
}

impl Block {
    /// Returns the home place of a hash.
    #[inline(always)]
    fn home(&self, hash: u32) -> usize {
        ((u64::from(hash) * self.places.len() as u64) >> 32) as usize
    }

    #[inline(always)]
    fn next(&self, place: usize) -> usize {
        if place + 1 < self.places.len() { place + 1 } else { 0 }
    }

    /// Returns the content of the home place, for prefetching.
    #[inline(always)]
    pub(super) fn at_home(&self, key: PairKey) -> Option<u32> {
        self.places.get(self.home(hash(key))).map(|link| link.slot)
    }

    pub(super) fn find(&self, key: PairKey, slots: &[Slot]) -> Option<usize> {
        let hash = hash(key);
        let mut place = self.home(hash);
        loop {
            let link = self.places.get(place)?;
            if link.is_vacant() {
                return None;
            }
            if link.hash == hash && slots[link.slot as usize].key() == key {
                return Some(place);
            }
            place = self.next(place);
        }
    }

    /// Inserts a link; the pair must not be in the table.
    pub(super) fn insert(&mut self, link: Link) {
        if (self.live + 1) * 8 > self.places.len() * 3 {
            self.resize(7 * self.live / 2 + 4);
        }
        let mut place = self.home(link.hash);
        while !self.places[place].is_vacant() {
            place = self.next(place);
        }
        self.places[place] = link;
        self.live += 1;
    }

    pub(super) fn remove(&mut self, key: PairKey, slots: &[Slot]) -> Option<u32> {
        let mut hole = self.find(key, slots)?;
        let slot = self.places[hole].slot;
        let mut place = self.next(hole);
        while !self.places[place].is_vacant() {
            let home = self.home(self.places[place].hash);
            // The entry may fill the hole if the hole is not before its home in probing order.
            let fills = self.steps(home, place) >= self.steps(hole, place);
            let (here, there) = (self.places[hole], self.places[place]);
            self.places[hole] = if fills { there } else { here };
            hole = if fills { place } else { hole };
            place = self.next(place);
        }
        self.places[hole] = VACANT;
        self.live -= 1;
        if self.live * 10 + 16 < self.places.len() {
            self.resize(3 * self.live);
        }
        Some(slot)
    }

    /// Returns the number of probing steps from one place to another.
    #[inline(always)]
    fn steps(&self, from: usize, to: usize) -> usize {
        if from <= to {
            to - from
        } else {
            to + self.places.len() - from
        }
    }

    /// Rehashes the links into a table of this many places.
    #[cold]
    fn resize(&mut self, count: usize) {
        let old = core::mem::replace(&mut self.places, alloc::vec![VACANT; count]);
        self.live = 0;
        old.into_iter()
            .filter(|link| !link.is_vacant())
            .for_each(|link| self.insert(link));
    }
}
