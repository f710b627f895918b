//! Links from two bodies to the slot of their pair: small hash tables, each for a few consecutive
//! lower bodies. A table has open addressing, linear probing, and deletion by backward shift
//! (Knuth, section 6.4).
//!
//! Changes come in ascending order. So a step visits the tables in order, stays in the nearest
//! caches, and can be distributed to threads.

use crate::broad::body::Bodies;
use crate::broad::change::{PairKey, pair_key};
use crate::broad::pairs::{AHEAD, NOWHERE, Pair, Slot, named};
use crate::broad::parallel::join;
use crate::broad::tables::read_ahead;
use alloc::vec::Vec;

/// Number of consecutive indices that share a block of links, as a power of two: few enough that a
/// block fits in the nearest cache.
const SHIFT: u32 = 6;

fn block_of(key: PairKey) -> usize {
    (key >> (32 + SHIFT)) as usize
}

fn key_of(pair: &Pair) -> PairKey {
    pair_key(pair.a.index, pair.b.index)
}

/// All links. Blocks after the block of the last pair may be missing.
#[derive(Clone, Debug, Default)]
pub(super) struct Links {
    blocks: Vec<Block>,
}

impl Links {
    /// Returns the slot of a pair.
    pub(super) fn find(&self, key: PairKey, slots: &[Slot]) -> Option<u32> {
        let block = self.blocks.get(block_of(key))?;
        let place = block.find(key, slots)?;
        Some(block.places[place].slot)
    }

    /// Links a pair, which must not be linked.
    pub(super) fn insert(&mut self, key: PairKey, slot: u32) {
        self.reach(key);
        self.blocks[block_of(key)].insert(Link::new(key, slot));
    }

    /// Unlinks a pair, if linked, and returns its slot.
    pub(super) fn remove(&mut self, key: PairKey, slots: &[Slot]) -> Option<u32> {
        self.blocks.get_mut(block_of(key))?.remove(key, slots)
    }

    /// Applies the changes of a step, both lists in ascending order; a pair that starts must not be
    /// linked. Writes to `gone` the pairs that ended, without generations; a pair that was not
    /// linked becomes `NOWHERE`.
    pub(super) fn update(
        &mut self,
        ended: &[PairKey],
        gone: &mut [Pair],
        began: &[Pair],
        slots: &[Slot],
        bodies: &Bodies,
        threads: usize,
    ) {
        if let Some(last) = began.last() {
            self.reach(key_of(last));
        }
        let part = LinkRange {
            blocks: &mut self.blocks,
            first: 0,
            ended,
            gone,
            began,
        };
        part.update(slots, bodies, threads);
    }

    fn reach(&mut self, key: PairKey) {
        if self.blocks.len() <= block_of(key) {
            self.blocks.resize_with(block_of(key) + 1, Block::default);
        }
    }

    /// Returns the number of links.
    pub(super) fn len(&self) -> usize {
        self.blocks.iter().map(|block| block.live).sum()
    }

    /// Returns the bytes reserved.
    pub(super) fn bytes(&self) -> usize {
        let links: usize = self.blocks.iter().map(|block| block.places.capacity()).sum();
        links * size_of::<Link>() + self.blocks.capacity() * size_of::<Block>()
    }
}

/// Consecutive blocks and the changes of pairs in these blocks.
struct LinkRange<'a> {
    blocks: &'a mut [Block],
    /// Number of the first block.
    first: usize,
    ended: &'a [PairKey],
    /// Pairs that ended, as long as `ended`.
    gone: &'a mut [Pair],
    began: &'a [Pair],
}

impl<'a> LinkRange<'a> {
    fn update(self, slots: &[Slot], bodies: &Bodies, threads: usize) {
        if threads > 1 && self.blocks.len() > 1 {
            let (low, high) = self.split();
            let fewer = threads / 2;
            join(
                || low.update(slots, bodies, fewer),
                || high.update(slots, bodies, threads - fewer),
            );
            return;
        }
        let Self { blocks, first, .. } = self;
        let mut began = self.began;
        for (keys, pairs) in self.ended.chunks(AHEAD).zip(self.gone.chunks_mut(AHEAD)) {
            let homes = keys
                .iter()
                .filter_map(|key| blocks.get(block_of(*key) - first)?.at_home(*key));
            read_ahead(slots.len(), homes);
            for (key, pair) in keys.iter().zip(pairs) {
                let slot = blocks
                    .get_mut(block_of(*key) - first)
                    .and_then(|block| block.remove(*key, slots));
                *pair = slot.map_or(NOWHERE, |slot| named(bodies, *key, slot, 0));
            }
            // New pairs follow close behind, while the tables are in the cache.
            let reached = keys.last().copied().unwrap_or(0);
            let count = began.iter().take_while(|pair| key_of(pair) < reached).count();
            insert_all(blocks, first, &began[..count], slots.len());
            began = &began[count..];
        }
        insert_all(blocks, first, began, slots.len());
    }

    /// Splits the part into two parts with about equally many changes.
    fn split(self) -> (Self, Self) {
        let middle = if self.ended.len() > self.began.len() {
            self.ended[self.ended.len() / 2]
        } else {
            self.began.get(self.began.len() / 2).map_or(0, key_of)
        };
        let border = block_of(middle)
            .saturating_sub(self.first)
            .clamp(1, self.blocks.len() - 1);
        let second = self.first + border;
        let (blocks, blocks_high) = self.blocks.split_at_mut(border);
        let at = self.ended.partition_point(|key| block_of(*key) < second);
        let (ended, ended_high) = self.ended.split_at(at);
        let (gone, gone_high) = self.gone.split_at_mut(at);
        let at = self.began.partition_point(|pair| block_of(key_of(pair)) < second);
        let (began, began_high) = self.began.split_at(at);
        let low = Self {
            blocks,
            first: self.first,
            ended,
            gone,
            began,
        };
        let high = Self {
            blocks: blocks_high,
            first: second,
            ended: ended_high,
            gone: gone_high,
            began: began_high,
        };
        (low, high)
    }
}

/// Links new pairs of a table with `count` pairs.
fn insert_all(blocks: &mut [Block], first: usize, began: &[Pair], count: usize) {
    let block_of = |pair: &Pair| block_of(key_of(pair)) - first;
    for pairs in began.chunks(AHEAD) {
        read_ahead(
            count,
            pairs
                .iter()
                .filter_map(|pair| blocks[block_of(pair)].at_home(key_of(pair))),
        );
        for pair in pairs {
            blocks[block_of(pair)].insert(Link::new(key_of(pair), pair.id.slot));
        }
    }
}

/// A hash of the two bodies, and the slot of their pair; the slot decides whether the link belongs
/// to a given pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    hash: u32,
    pub(super) slot: u32,
}

/// A vacant entry; no pair has this slot.
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
    /// Returns the home index of a hash.
    #[inline(always)]
    fn home(&self, hash: u32) -> usize {
        ((u64::from(hash) * self.places.len() as u64) >> 32) as usize
    }

    #[inline(always)]
    fn next(&self, place: usize) -> usize {
        if place + 1 < self.places.len() { place + 1 } else { 0 }
    }

    /// Returns the content at the home index, for prefetching.
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

    /// Returns the number of probing steps from one index to another.
    #[inline(always)]
    fn steps(&self, from: usize, to: usize) -> usize {
        if from <= to {
            to - from
        } else {
            to + self.places.len() - from
        }
    }

    /// Rehashes the links into a table of this size.
    #[cold]
    fn resize(&mut self, count: usize) {
        let old = core::mem::replace(&mut self.places, alloc::vec![VACANT; count]);
        self.live = 0;
        old.into_iter()
            .filter(|link| !link.is_vacant())
            .for_each(|link| self.insert(link));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;
    use alloc::collections::BTreeMap;
    use nalgebra::Point3;

    /// Uses pairs of few bodies, so that blocks are crowded and many of the pairs to end are not
    /// linked.
    fn steps_equal_a_map(lows: usize, threads: usize) {
        let bodies = Bodies::new(Point3::origin());
        let (mut links, mut slots, mut map) = (Links::default(), Vec::<Slot>::new(), BTreeMap::new());
        let (mut rng, mut found, mut absent) = (Rng::new(lows as u64), 0, 0);
        for step in 0..90 {
            let keys = |rng: &mut Rng| {
                let count = rng.below(300);
                let mut keys: Vec<PairKey> = (0..count)
                    .map(|_| pair_key(rng.below(lows) as u32, 1000 + rng.below(40) as u32))
                    .collect();
                keys.sort_unstable();
                keys.dedup();
                keys
            };
            let ended = keys(&mut rng);
            let mut began = keys(&mut rng);
            began.retain(|key| !map.contains_key(key) && ended.binary_search(key).is_err());
            let pairs: Vec<Pair> = (slots.len() as u32..)
                .zip(&began)
                .map(|(slot, key)| named(&bodies, *key, slot, 0))
                .collect();
            slots.extend(began.iter().map(|key| Slot {
                bodies: crate::broad::change::pair_of(*key).into(),
                generation: 0,
            }));
            let mut gone = alloc::vec![NOWHERE; ended.len()];
            links.update(&ended, &mut gone, &pairs, &slots, &bodies, threads);
            for (key, pair) in ended.iter().zip(&gone) {
                let slot = map.remove(key).unwrap_or(NOWHERE.id.slot);
                assert_eq!(pair.id.slot, slot, "step {step}, {key:x}");
                *(if slot == NOWHERE.id.slot {
                    &mut absent
                } else {
                    &mut found
                }) += 1;
            }
            map.extend(pairs.iter().map(|pair| (key_of(pair), pair.id.slot)));
            assert!(map.iter().all(|(key, slot)| links.find(*key, &slots) == Some(*slot)));
            assert!(ended.iter().all(|key| links.find(*key, &slots).is_none()));
        }
        assert!(found > 100 && absent > 200, "{found} {absent}");
        for (key, slot) in map {
            assert_eq!(links.remove(key, &slots), Some(slot));
        }
        assert!(
            links
                .blocks
                .iter()
                .all(|block| block.live == 0 && block.places.len() < 20)
        );
    }

    #[test]
    fn links_are_a_map_however_many_threads() {
        for lows in [1, 70, 900] {
            for threads in [1, 2, 3, 8] {
                steps_equal_a_map(lows, threads);
            }
        }
    }
}
