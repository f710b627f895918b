//! The overlapping pairs in slots that stay put from a pair's beginning to its end.

use super::body::trim;
use super::change::{Changes, PairKey, pair_key};
use super::{Bodies, BodyId, BroadPhaseError};
use alloc::vec::Vec;

/// Names a pair from its beginning to its end. `slot` is small and dense: a caller can keep its own state of a pair,
/// say a tracker, in a vector at that place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PairId {
    /// Place in tables; reused no earlier than the step after the pair's end was reported.
    pub slot: u32,
    /// Tells apart the pairs that used the slot one after the other.
    pub generation: u32,
}

/// Two bodies whose boxes overlap, `a.index < b.index`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Pair {
    /// The pair's own name.
    pub id: PairId,
    /// The body with the lower index.
    pub a: BodyId,
    /// The body with the higher index.
    pub b: BodyId,
}

/// What the last step changed, each part in ascending order of the two body indices. The order depends on boxes and
/// ids alone: not on the structure, its tuning, its history or the number of threads.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Events<'a> {
    /// Pairs that ended: boxes parted, a body was removed, or groups no longer let them pair.
    pub ended: &'a [Pair],
    /// Pairs that began.
    pub began: &'a [Pair],
    /// [`BroadPhaseError::TooManyPairs`] where pairs found no place. They did not begin, and all others are as they would be
    /// without them; each is asked again when its boxes have parted and meet anew, or by
    /// [`regroup`](super::BroadPhase::regroup).
    pub refused: Option<BroadPhaseError>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Slot {
    /// `VACANT` in both halves when no pair lives here.
    key: PairKey,
    generation: u32,
}

const VACANT: PairKey = PairKey::MAX;

/// Most pairs at once: slot numbers have 32 bits, and one more than a slot's number is kept.
const MOST_PAIRS: usize = u32::MAX as usize;

/// How many slots a table may have; less in tests.
#[derive(Clone, Copy, Debug)]
pub(super) struct Most(pub(super) usize);

impl Default for Most {
    fn default() -> Self {
        Self(MOST_PAIRS)
    }
}

/// So many changes are read ahead.
const AHEAD: usize = 32;

/// Slots, and an index from two bodies to their slot: open addressing, linear probing, deletion by backward shift.
/// Touched by events and look-ups only.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairTable {
    slots: Vec<Slot>,
    free: Vec<u32>,
    /// Slots of pairs that ended in the last step; free from the next step on.
    resting: Vec<u32>,
    /// Slot number plus one; 0 is empty. The length is a power of two, at most 3/8 full: runs are short, which deletion walks.
    index: Vec<u32>,
    live: usize,
    ended: Vec<Pair>,
    began: Vec<Pair>,
    /// The first pair of the step that found no place, and how many did not.
    refused: Option<(PairKey, usize)>,
    pub(super) most: Most,
}

impl PairTable {
    pub(crate) fn len(&self) -> usize {
        self.live
    }

    pub(crate) fn events(&self, bodies: &Bodies) -> Events<'_> {
        let refused = self.refused.map(|(key, refused)| {
            let (a, b) = super::change::pair_of(key);
            let [a, b] = [a, b].map(|i| bodies.id(i));
            BroadPhaseError::TooManyPairs { a, b, refused }
        });
        Events {
            ended: &self.ended,
            began: &self.began,
            refused,
        }
    }

    /// Pairs in the order of their slots.
    pub(crate) fn iter<'a>(&'a self, bodies: &'a Bodies) -> impl Iterator<Item = Pair> + 'a {
        let occupied = self.slots.iter().enumerate().filter(|(_, slot)| slot.key != VACANT);
        occupied.map(|(i, slot)| named(bodies, i as u32, *slot))
    }

    pub(crate) fn get(&self, a: u32, b: u32) -> Option<PairId> {
        let slot = self.slot_at(self.find(pair_key(a, b))?)?;
        Some(PairId {
            slot,
            generation: self.slots[slot as usize].generation,
        })
    }

    /// The two body indices of a pair that has not ended.
    pub(crate) fn members(&self, id: PairId) -> Option<(u32, u32)> {
        let slot = self.slots.get(id.slot as usize)?;
        let same = slot.generation == id.generation && slot.key != VACANT;
        same.then(|| super::change::pair_of(slot.key))
    }

    /// Takes over the sorted changes of a step, those the options of the bodies allow.
    pub(crate) fn apply(&mut self, changes: &Changes, bodies: &Bodies, allowed: &mut dyn FnMut(u32, u32) -> bool) {
        self.free.append(&mut self.resting);
        self.refused = None;
        for events in [&mut self.ended, &mut self.began] {
            trim(events);
            events.clear();
        }
        for keys in changes.ended.chunks(AHEAD) {
            self.read_ahead(keys);
            for &key in keys {
                self.end(key, bodies);
            }
        }
        for keys in changes.began.chunks(AHEAD) {
            self.read_ahead(keys);
            for &key in keys {
                let (a, b) = super::change::pair_of(key);
                if allowed(a, b) {
                    self.begin(key, bodies);
                }
            }
        }
    }

    /// Reads what the next keys will need. These places are far apart in memory; asked for one after the other and
    /// without a branch between, they arrive together.
    fn read_ahead(&self, keys: &[PairKey]) {
        if self.index.is_empty() || self.slots.is_empty() {
            return;
        }
        let read = |key: &PairKey| {
            let slot = self.index[self.home(*key)].saturating_sub(1);
            self.slots[slot as usize].generation
        };
        core::hint::black_box(keys.iter().map(read).fold(0, u32::wrapping_add));
    }

    /// Restores the order of events after some were added out of order.
    pub(crate) fn sort_events(&mut self) {
        let order = |p: &Pair| (p.a.index, p.b.index);
        self.ended.sort_unstable_by_key(order);
        self.began.sort_unstable_by_key(order);
    }

    /// Ends the pair, if the table has it.
    pub(crate) fn end(&mut self, key: PairKey, bodies: &Bodies) {
        let Some(place) = self.find(key) else { return };
        let Some(slot) = self.slot_at(place) else { return };
        self.unlink(place);
        self.ended.push(named(bodies, slot, self.slots[slot as usize]));
        let vacated = &mut self.slots[slot as usize];
        vacated.key = VACANT;
        vacated.generation = vacated.generation.wrapping_add(1);
        self.resting.push(slot);
        self.live -= 1;
    }

    /// Begins the pair, unless the table has it or is full.
    pub(crate) fn begin(&mut self, key: PairKey, bodies: &Bodies) {
        if self.live * 8 >= self.index.len() * 3 {
            self.grow();
        }
        let mut place = self.home(key);
        while let Some(slot) = self.slot_at(place) {
            if self.slots[slot as usize].key == key {
                return;
            }
            place = self.next(place);
        }
        let slot = match self.free.pop() {
            Some(slot) => slot,
            None if self.slots.len() >= self.most.0 => {
                let (_, count) = self.refused.get_or_insert((key, 0));
                *count += 1;
                return;
            }
            None => {
                self.slots.push(Slot {
                    key: VACANT,
                    generation: 0,
                });
                (self.slots.len() - 1) as u32
            }
        };
        self.slots[slot as usize].key = key;
        self.index[place] = slot + 1;
        self.live += 1;
        self.began.push(named(bodies, slot, self.slots[slot as usize]));
    }

    /// Bytes reserved for pairs and events.
    pub(crate) fn bytes(&self) -> usize {
        self.slots.capacity() * size_of::<Slot>()
            + (self.free.capacity() + self.resting.capacity() + self.index.capacity()) * 4
            + (self.ended.capacity() + self.began.capacity()) * size_of::<Pair>()
    }

    /// Where a key belongs: the high bits of a product with 2^64 over the golden ratio (Knuth, section 6.4).
    #[inline]
    fn home(&self, key: PairKey) -> usize {
        let bits = self.index.len().trailing_zeros();
        let mixed = (key ^ (key >> 32)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        (mixed.checked_shr(64 - bits).unwrap_or(0)) as usize
    }

    #[inline]
    fn next(&self, place: usize) -> usize {
        (place + 1) & (self.index.len() - 1)
    }

    #[inline]
    fn slot_at(&self, place: usize) -> Option<u32> {
        self.index[place].checked_sub(1)
    }

    /// The place in the index of a key the table has.
    fn find(&self, key: PairKey) -> Option<usize> {
        if self.index.is_empty() {
            return None;
        }
        let mut place = self.home(key);
        while let Some(slot) = self.slot_at(place) {
            if self.slots[slot as usize].key == key {
                return Some(place);
            }
            place = self.next(place);
        }
        None
    }

    /// Empties a place and moves later entries of the run back, so that no search is cut short.
    fn unlink(&mut self, mut hole: usize) {
        let mask = self.index.len() - 1;
        let mut place = self.next(hole);
        while let Some(slot) = self.slot_at(place) {
            let home = self.home(self.slots[slot as usize].key);
            // The entry may fill the hole if the hole is not before its home in probing order.
            if (place.wrapping_sub(home) & mask) >= (place.wrapping_sub(hole) & mask) {
                self.index[hole] = self.index[place];
                hole = place;
            }
            place = self.next(place);
        }
        self.index[hole] = 0;
    }

    fn grow(&mut self) {
        let size = (self.index.len() * 2).max(16);
        self.reindex(size);
    }

    /// Builds the index anew with `size` places, a power of two.
    fn reindex(&mut self, size: usize) {
        self.index.clear();
        self.index.resize(size, 0);
        for slot in 0..self.slots.len() {
            let key = self.slots[slot].key;
            if key == VACANT {
                continue;
            }
            let mut place = self.home(key);
            while self.index[place] != 0 {
                place = self.next(place);
            }
            self.index[place] = slot as u32 + 1;
        }
    }
}

fn named(bodies: &Bodies, slot: u32, content: Slot) -> Pair {
    let (a, b) = super::change::pair_of(content.key);
    Pair {
        id: PairId {
            slot,
            generation: content.generation,
        },
        a: bodies.id(a),
        b: bodies.id(b),
    }
}

/// Feature `serde`: the slots as text; the index is made anew.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
pub(crate) struct PairsState {
    slots: Vec<Slot>,
    free: Vec<u32>,
    resting: Vec<u32>,
}

#[cfg(feature = "serde")]
impl PairTable {
    pub(crate) fn state(&self) -> PairsState {
        PairsState {
            slots: self.slots.clone(),
            free: self.free.clone(),
            resting: self.resting.clone(),
        }
    }
}

#[cfg(feature = "serde")]
impl PairsState {
    /// The table again, if every slot names bodies below `bodies` and every vacant slot is listed once.
    pub(crate) fn restored(self, bodies: usize) -> Result<PairTable, alloc::string::String> {
        let Self { slots, free, resting } = self;
        let mut vacant: Vec<u32> = free.iter().chain(&resting).copied().collect();
        vacant.sort_unstable();
        let empty = slots
            .iter()
            .enumerate()
            .filter(|(_, s)| s.key == VACANT)
            .map(|(i, _)| i as u32);
        let mut keys: Vec<PairKey> = slots.iter().map(|s| s.key).filter(|key| *key != VACANT).collect();
        keys.sort_unstable();
        let named = |key: &PairKey| {
            let (a, b) = super::change::pair_of(*key);
            a < b && (b as usize) < bodies
        };
        if slots.len() > MOST_PAIRS || !empty.eq(vacant) || !keys.iter().all(named) || !keys.is_sorted_by(|a, b| a < b)
        {
            return Err("the pairs of the broad phase contradict each other".into());
        }
        let mut table = PairTable {
            live: keys.len(),
            slots,
            free,
            resting,
            ..PairTable::default()
        };
        table.reindex((table.live * 8 / 3 + 1).next_power_of_two().max(16));
        Ok(table)
    }
}
