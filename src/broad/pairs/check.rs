//! Consistency of slots and links.

use super::{PairSlots, VACANT};
use alloc::format;
use alloc::string::String;
use alloc::vec;

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
