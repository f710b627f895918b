//! Which vertex pairs are points of a large surface.

use alloc::vec::Vec;

/// No vertices have such numbers.
const VACANT: [u32; 2] = [u32::MAX; 2];

/// A hash table from which nothing is taken out: open addressing, linear probing (Knuth, section 6.4).
#[derive(Clone, Debug, Default)]
pub(super) struct Names {
    /// At most half of them are taken.
    places: Vec<[u32; 2]>,
    count: usize,
}

impl Names {
    /// Bytes on the heap.
    pub(super) fn heap_bytes(&self) -> usize {
        self.places.capacity() * size_of::<[u32; 2]>()
    }

    pub(super) fn clear(&mut self) {
        self.places.clear();
        self.count = 0;
    }

    /// How many names were put in, repeats included.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    pub(super) fn contains(&self, name: [u32; 2]) -> bool {
        !self.places.is_empty() && self.places[self.place(name)] == name
    }

    pub(super) fn insert(&mut self, name: [u32; 2]) {
        self.count += 1;
        if 2 * self.count > self.places.len() {
            let larger = alloc::vec![VACANT; 4 * self.count];
            let old = core::mem::replace(&mut self.places, larger);
            for name in old.into_iter().filter(|&name| name != VACANT) {
                let place = self.place(name);
                self.places[place] = name;
            }
        }
        let place = self.place(name);
        self.places[place] = name;
    }

    /// Where a name is, or else where it would be put. The table is not empty.
    fn place(&self, [a, b]: [u32; 2]) -> usize {
        // The high half of a product with 2^64 over the golden ratio.
        let hash = (u64::from(a) << 32 | u64::from(b)).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32;
        let mut place = ((hash * self.places.len() as u64) >> 32) as usize;
        while self.places[place] != VACANT && self.places[place] != [a, b] {
            place = if place + 1 < self.places.len() { place + 1 } else { 0 };
        }
        place
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::collections::BTreeSet;
    use lab::rng::Rng;

    #[test]
    fn names_are_a_set() {
        let mut rng = Rng::new(5);
        let (mut names, mut set) = (Names::default(), BTreeSet::new());
        for _ in 0..3 {
            names.clear();
            set.clear();
            let mut known = 0;
            for _ in 0..4000 {
                let name = [rng.below(60) as u32, rng.below(60) as u32];
                known += usize::from(set.contains(&name));
                assert_eq!(names.contains(name), set.contains(&name));
                names.insert(name);
                set.insert(name);
            }
            assert!(set.iter().all(|&name| names.contains(name)));
            assert!(known > 1000 && set.len() > 1000, "{known}");
        }
    }
}
