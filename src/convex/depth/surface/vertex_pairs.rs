//! Set of the vertex pairs whose points lie on a large surface.

use crate::body::polyhedron::VertexId;
use alloc::vec::Vec;

/// Marks a free slot: no vertices have such numbers.
const VACANT: [VertexId; 2] = [VertexId(u32::MAX); 2];

/// A hash table without removal: open addressing, linear probing (Knuth, section 6.4).
#[derive(Clone, Debug, Default)]
pub(super) struct VertexPairs {
    /// At most half of the slots are occupied.
    slots: Vec<[VertexId; 2]>,
    count: usize,
}

impl VertexPairs {
    /// Returns the allocated bytes on the heap.
    pub(super) fn heap_bytes(&self) -> usize {
        self.slots.capacity() * size_of::<[VertexId; 2]>()
    }

    pub(super) fn clear(&mut self) {
        self.slots.clear();
        self.count = 0;
    }

    /// Returns the number of insertions, repeats included.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    pub(super) fn contains(&self, pair: [VertexId; 2]) -> bool {
        !self.slots.is_empty() && self.slots[self.slot(pair)] == pair
    }

    pub(super) fn insert(&mut self, pair: [VertexId; 2]) {
        self.count += 1;
        if 2 * self.count > self.slots.len() {
            let larger = alloc::vec![VACANT; 4 * self.count];
            let old = core::mem::replace(&mut self.slots, larger);
            for pair in old.into_iter().filter(|&pair| pair != VACANT) {
                let slot = self.slot(pair);
                self.slots[slot] = pair;
            }
        }
        let slot = self.slot(pair);
        self.slots[slot] = pair;
    }

    /// Returns the slot of a pair, or the free slot for a new pair. The table must not be empty.
    fn slot(&self, [a, b]: [VertexId; 2]) -> usize {
        // High half of a product with 2^64 over the golden ratio.
        let hash = (u64::from(a.0) << 32 | u64::from(b.0)).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32;
        let mut slot = ((hash * self.slots.len() as u64) >> 32) as usize;
        while self.slots[slot] != VACANT && self.slots[slot] != [a, b] {
            slot = if slot + 1 < self.slots.len() { slot + 1 } else { 0 };
        }
        slot
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;
    use alloc::collections::BTreeSet;

    #[test]
    fn vertex_pairs_are_a_set() {
        let mut rng = Rng::new(5);
        let (mut pairs, mut set) = (VertexPairs::default(), BTreeSet::new());
        for _ in 0..3 {
            pairs.clear();
            set.clear();
            let mut known = 0;
            for _ in 0..4000 {
                let pair = [0; 2].map(|_| VertexId(rng.below(60) as u32));
                known += usize::from(set.contains(&pair));
                assert_eq!(pairs.contains(pair), set.contains(&pair));
                pairs.insert(pair);
                set.insert(pair);
            }
            assert!(set.iter().all(|&pair| pairs.contains(pair)));
            assert!(known > 1000 && set.len() > 1000, "{known}");
        }
    }
}
