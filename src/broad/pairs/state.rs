//! Feature `serde`: the table of pairs as text.

use super::{Links, MOST_PAIRS, PairSlots, Slot, VACANT};
use crate::broad::change::{PairKey, pair_of};
use alloc::vec::Vec;

/// The serialized slots; links are rebuilt.
#[derive(serde::Serialize, serde::Deserialize)]
pub(crate) struct PairsState {
    slots: Vec<Slot>,
    free: Vec<u32>,
    resting: Vec<u32>,
}

impl PairSlots {
    pub(crate) fn state(&self) -> PairsState {
        PairsState {
            slots: self.slots.clone(),
            free: self.free.clone(),
            resting: self.resting.clone(),
        }
    }
}

impl PairsState {
    /// Returns the restored table, if every slot names bodies below `bodies` and every vacant slot
    /// is listed once.
    pub(crate) fn restored(self, bodies: usize) -> Result<PairSlots, alloc::string::String> {
        let Self { slots, free, resting } = self;
        let mut vacant: Vec<u32> = free.iter().chain(&resting).copied().collect();
        vacant.sort_unstable();
        let empty = slots
            .iter()
            .enumerate()
            .filter(|(_, s)| s.bodies == VACANT)
            .map(|(i, _)| i as u32);
        let named = |key: &PairKey| {
            let (a, b) = pair_of(*key);
            a < b && (b as usize) < bodies
        };
        let occupied = slots.iter().enumerate().filter(|(_, s)| s.bodies != VACANT);
        let mut pairs: Vec<(PairKey, u32)> = occupied.map(|(i, s)| (s.key(), i as u32)).collect();
        pairs.sort_unstable();
        let sound = pairs.iter().all(|(key, _)| named(key)) && pairs.is_sorted_by(|a, b| a.0 < b.0);
        if slots.len() > MOST_PAIRS || !empty.eq(vacant) || !sound {
            return Err("the pairs of the broad phase contradict each other".into());
        }
        let mut links = Links::default();
        pairs.iter().for_each(|(key, slot)| links.insert(*key, *slot));
        Ok(PairSlots {
            live: pairs.len(),
            links,
            slots,
            free,
            resting,
            ..PairSlots::default()
        })
    }
}
