//! The overlapping pairs, in slots that stay the same from the start of a pair to its end, and the
//! check of these slots.

mod links;
#[cfg(feature = "serde")]
mod state;

use crate::base::num::each::Each;
use crate::broad::body::Bodies;
use crate::broad::change::{Changes, PairKey, pair_key, pair_of};
use crate::broad::pairs::links::Links;
#[cfg(feature = "serde")]
pub(crate) use crate::broad::pairs::state::PairsState;
use crate::broad::parallel::{Threads, join};
use crate::broad::tables::read_ahead;
use crate::broad::tables::trim;
use crate::broad::{BodyId, BroadPhaseError};
use alloc::string::String;
use alloc::vec::Vec;
use alloc::{format, vec};

/// Number of items prefetched at once.
pub(super) const AHEAD: usize = 32;

/// Id of a pair, constant from its start to its end. `slot` is small and dense, so a caller can
/// keep state for a pair, such as a tracker, in a vector at this index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PairId {
    /// Index in tables. It is reused in the step after the end of the pair was reported, at the
    /// earliest.
    pub slot: u32,
    /// Distinguishes the pairs that use the slot one after another.
    pub generation: u32,
}

impl core::fmt::Display for PairId {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "pair {} (generation {})", self.slot, self.generation)
    }
}

/// Two bodies whose boxes overlap, `a.index < b.index`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Pair {
    /// Id of the pair.
    pub id: PairId,
    /// The body with the lower index.
    pub a: BodyId,
    /// The body with the higher index.
    pub b: BodyId,
}

/// Changes of the last step, each list in ascending order of the two body indices. The order
/// depends only on boxes and ids, not on the structure, its tuning, its history or the number of
/// threads.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Events<'a> {
    /// Pairs that ended because the boxes separated, a body was removed, or the groups no longer
    /// allow the pair.
    pub ended: &'a [Pair],
    /// Pairs that started.
    pub began: &'a [Pair],
    /// [`BroadPhaseError::TooManyPairs`] if there was no slot for some pairs. These rejected pairs
    /// did not start; all other pairs are unaffected. Each rejected pair is tried again when its
    /// boxes have separated and overlap again, or after [`regroup`](super::SweepAndPrune::regroup).
    pub refused: Option<BroadPhaseError>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Slot {
    /// The two body indices, the lower first; `VACANT` if the slot holds no pair.
    bodies: [u32; 2],
    generation: u32,
}

const VACANT: [u32; 2] = [u32::MAX; 2];

impl Slot {
    #[inline(always)]
    fn key(&self) -> PairKey {
        let [low, high] = self.bodies;
        u64::from(low) << 32 | u64::from(high)
    }
}

/// Largest number of pairs at once: slot numbers have 32 bits, and slot number plus one is stored.
const MOST_PAIRS: usize = u32::MAX as usize;

/// Largest number of slots of a table; less in tests.
#[derive(Clone, Copy, Debug)]
pub(super) struct Most(pub(super) usize);

impl Default for Most {
    fn default() -> Self {
        Self(MOST_PAIRS)
    }
}

/// Slots, and links from two bodies to their slot. Used by events and look-ups only.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairSlots {
    slots: Vec<Slot>,
    free: Vec<u32>,
    /// Slots of pairs that ended in the last step; free from the next step on.
    resting: Vec<u32>,
    links: Links,
    live: usize,
    ended: Vec<Pair>,
    began: Vec<Pair>,
    /// The first pair of the step that found no slot, and the number of such pairs.
    refused: Option<(PairKey, usize)>,
    pub(super) most: Most,
}

impl PairSlots {
    pub(crate) fn len(&self) -> usize {
        self.live
    }

    pub(crate) fn events(&self, bodies: &Bodies) -> Events<'_> {
        let refused = self.refused.map(|(key, refused)| {
            let (a, b) = pair_of(key);
            let [a, b] = [a, b].each(|i| bodies.id(i));
            BroadPhaseError::TooManyPairs { a, b, refused }
        });
        Events {
            ended: &self.ended,
            began: &self.began,
            refused,
        }
    }

    /// Iterates over the pairs in the order of their slots.
    pub(crate) fn iter<'a>(&'a self, bodies: &'a Bodies) -> impl Iterator<Item = Pair> + 'a {
        let occupied = self.slots.iter().enumerate().filter(|(_, slot)| slot.bodies != VACANT);
        occupied.map(|(i, slot)| named(bodies, slot.key(), i as u32, slot.generation))
    }

    pub(crate) fn get(&self, a: u32, b: u32) -> Option<PairId> {
        let slot = self.links.find(pair_key(a, b), &self.slots)?;
        Some(PairId {
            slot,
            generation: self.slots[slot as usize].generation,
        })
    }

    /// Returns the two body indices of a pair that has not ended.
    pub(crate) fn members(&self, id: PairId) -> Option<(u32, u32)> {
        let slot = self.slots.get(id.slot as usize)?;
        let same = slot.generation == id.generation && slot.bodies != VACANT;
        same.then(|| pair_of(slot.key()))
    }

    /// Applies the sorted changes of a step that options and filter allow. Slots and filter are
    /// processed in sequence, since this work touches little memory; look-ups and moves are
    /// distributed to threads.
    pub(crate) fn apply(
        &mut self,
        changes: &Changes,
        bodies: &Bodies,
        filter: &mut dyn FnMut(BodyId, BodyId) -> bool,
        threads: Threads,
    ) {
        self.free.append(&mut self.resting);
        self.refused = None;
        for (events, keys) in [(&mut self.began, &changes.began), (&mut self.ended, &changes.ended)] {
            trim(events);
            events.clear();
            events.resize(keys.len(), NOWHERE);
        }
        let share = threads.sharing(changes.began.len());
        propose(&changes.began, &mut self.began, bodies, share);
        self.admit(filter);
        self.links.update(
            &changes.ended,
            &mut self.ended,
            &self.began,
            &self.slots,
            bodies,
            threads.sharing(changes.ended.len() + self.began.len()),
        );
        self.vacate();
    }

    /// Assigns slots to the proposed pairs that the filter accepts, and drops the rejected pairs.
    fn admit(&mut self, filter: &mut dyn FnMut(BodyId, BodyId) -> bool) {
        let mut began = core::mem::take(&mut self.began);
        let mut read = 0;
        began.retain_mut(|pair| {
            if read == 0 {
                let next = self.free.iter().rev().take(AHEAD);
                read_ahead(self.slots.len(), next.map(|slot| self.slots[*slot as usize].generation));
                read = AHEAD;
            }
            read -= 1;
            if *pair == NOWHERE || !filter(pair.a, pair.b) {
                return false;
            }
            let id = self.occupy(pair_key(pair.a.index, pair.b.index));
            pair.id = id.unwrap_or(pair.id);
            id.is_some()
        });
        self.began = began;
    }

    /// Returns a slot for a pair without a slot, if there is room.
    fn occupy(&mut self, key: PairKey) -> Option<PairId> {
        let slot = match self.free.pop() {
            Some(slot) => slot,
            None if self.slots.len() >= self.most.0 => {
                let (_, count) = self.refused.get_or_insert((key, 0));
                *count += 1;
                return None;
            }
            None => {
                self.slots.push(Slot {
                    bodies: VACANT,
                    generation: 0,
                });
                (self.slots.len() - 1) as u32
            }
        };
        let occupied = &mut self.slots[slot as usize];
        occupied.bodies = pair_of(key).into();
        self.live += 1;
        Some(PairId {
            slot,
            generation: occupied.generation,
        })
    }

    /// Empties the slots of the ended pairs and completes their ids. Drops pairs that never
    /// started.
    fn vacate(&mut self) {
        let mut ended = core::mem::take(&mut self.ended);
        ended.retain(|pair| pair.id.slot != NOWHERE.id.slot);
        for pairs in ended.chunks_mut(AHEAD) {
            read_ahead(
                self.slots.len(),
                pairs.iter().map(|pair| self.slots[pair.id.slot as usize].generation),
            );
            for pair in pairs {
                pair.id.generation = self.release(pair.id.slot);
            }
        }
        self.ended = ended;
    }

    /// Empties a slot; returns the generation of the pair that used the slot.
    fn release(&mut self, slot: u32) -> u32 {
        let vacated = &mut self.slots[slot as usize];
        let generation = vacated.generation;
        vacated.bodies = VACANT;
        vacated.generation = generation.wrapping_add(1);
        self.resting.push(slot);
        self.live -= 1;
        generation
    }

    /// Restores the order of events after some were added out of order.
    pub(crate) fn sort_events(&mut self) {
        let order = |p: &Pair| (p.a.index, p.b.index);
        self.ended.sort_unstable_by_key(order);
        self.began.sort_unstable_by_key(order);
    }

    /// Ends the pair if it is in the table.
    pub(crate) fn end(&mut self, key: PairKey, bodies: &Bodies) {
        if let Some(slot) = self.links.remove(key, &self.slots) {
            let generation = self.release(slot);
            self.ended.push(named(bodies, key, slot, generation));
        }
    }

    /// Starts the pair, unless it is in the table already or the table is full.
    pub(crate) fn begin(&mut self, key: PairKey, bodies: &Bodies) {
        if self.links.find(key, &self.slots).is_some() {
            return;
        }
        if let Some(id) = self.occupy(key) {
            self.links.insert(key, id.slot);
            self.began.push(named(bodies, key, id.slot, id.generation));
        }
    }

    /// Returns the bytes reserved for pairs and events.
    pub(crate) fn bytes(&self) -> usize {
        self.slots.capacity() * size_of::<Slot>()
            + (self.free.capacity() + self.resting.capacity()) * 4
            + self.links.bytes()
            + (self.ended.capacity() + self.began.capacity()) * size_of::<Pair>()
    }
}

/// Placeholder for no pair; no pair has this slot.
const NOWHERE: Pair = {
    let none = BodyId {
        index: u32::MAX,
        generation: 0,
    };
    let id = PairId {
        slot: u32::MAX,
        generation: 0,
    };
    Pair { id, a: none, b: none }
};

fn named(bodies: &Bodies, key: PairKey, slot: u32, generation: u32) -> Pair {
    let (a, b) = pair_of(key);
    Pair {
        id: PairId { slot, generation },
        a: bodies.id(a),
        b: bodies.id(b),
    }
}

/// Writes the ids of the bodies of all pairs that the options allow to start; `out` must contain
/// `NOWHERE` before.
fn propose(keys: &[PairKey], out: &mut [Pair], bodies: &Bodies, threads: usize) {
    if threads > 1 {
        let half = keys.len() / 2;
        let ((low, high), (out_low, out_high)) = (keys.split_at(half), out.split_at_mut(half));
        let fewer = threads / 2;
        join(
            || propose(low, out_low, bodies, fewer),
            || propose(high, out_high, bodies, threads - fewer),
        );
        return;
    }
    for (keys, pairs) in keys.chunks(AHEAD).zip(out.chunks_mut(AHEAD)) {
        bodies.read_ahead(keys.iter().map(|key| pair_of(*key).1));
        for (key, pair) in keys.iter().zip(pairs) {
            let (a, b) = pair_of(*key);
            if bodies.may_pair(a, b) {
                *pair = named(bodies, *key, NOWHERE.id.slot, 0);
            }
        }
    }
}

impl PairSlots {
    /// Returns the first contradiction between slots, links and the lists of vacant slots.
    pub(crate) fn check(&self) -> Result<(), String> {
        let mut vacant = vec![false; self.slots.len()];
        for &slot in self.free.iter().chain(&self.resting) {
            match vacant.get_mut(slot as usize) {
                Some(seen) if !*seen => *seen = true,
                _ => return Err(format!("slot {slot} is listed as vacant twice or is not there")),
            }
        }
        let mut live = 0;
        for (i, (slot, vacant)) in self.slots.iter().zip(&vacant).enumerate() {
            if (slot.bodies == VACANT) != *vacant {
                return Err(format!("slot {i} is listed as vacant: {vacant}"));
            }
            if *vacant {
                continue;
            }
            live += 1;
            if self.links.find(slot.key(), &self.slots) != Some(i as u32) {
                return Err(format!("the pair of slot {i} is not found under its name"));
            }
        }
        if live != self.live || live != self.links.len() {
            return Err(format!(
                "{live} pairs, {} counted, {} linked",
                self.live,
                self.links.len()
            ));
        }
        Ok(())
    }
}
