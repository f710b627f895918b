//! From two bodies to the slot of their pair: links in ascending order, cut into blocks by the lower body.
//!
//! Changes come in the same order, so a step walks the blocks once and in order, and blocks can be dealt out to threads.
//! A block is brought up to date by moving what lies between its changes, so it costs as much as it is long, and a body
//! with very many pairs, all as the lower of the two, makes its block long.

use crate::broad::ahead::read_ahead;
use crate::broad::body::Bodies;
use crate::broad::change::{PairKey, pair_key};
use crate::broad::pairs::{NOWHERE, Pair, named};
use crate::broad::parallel::join;
use alloc::vec::Vec;

/// Two bodies, the lower index first, and the slot of their pair.
#[derive(Clone, Copy, Debug, Default)]
struct Link {
    low: u32,
    high: u32,
    slot: u32,
}

impl Link {
    #[inline(always)]
    fn key(&self) -> PairKey {
        u64::from(self.low) << 32 | u64::from(self.high)
    }
}

/// So many consecutive indices share a block, as a power of two: few enough that a block lies in the nearest cache.
const SHIFT: u32 = 6;

fn block_of(key: PairKey) -> usize {
    (key >> (32 + SHIFT)) as usize
}

fn key_of(pair: &Pair) -> PairKey {
    pair_key(pair.a.index, pair.b.index)
}

/// The links of some consecutive lower bodies, ascending.
#[derive(Clone, Debug, Default)]
struct Block(Vec<Link>);

/// All links. Blocks behind the last pair's may be missing.
#[derive(Clone, Debug, Default)]
pub(super) struct Links {
    blocks: Vec<Block>,
}

impl Links {
    /// Links of pairs that are told in ascending order.
    pub(super) fn of(pairs: &[(PairKey, u32)]) -> Self {
        let mut out = Self::default();
        for &(key, slot) in pairs {
            out.reach(key);
            out.blocks[block_of(key)].0.push(link(key, slot));
        }
        out
    }

    /// The slot of a pair.
    pub(super) fn find(&self, key: PairKey) -> Option<u32> {
        let Block(links) = self.blocks.get(block_of(key))?;
        let at = links.binary_search_by_key(&key, Link::key).ok()?;
        Some(links[at].slot)
    }

    /// Takes over a step's changes, both in ascending order; no pair that begins may be linked. Names in `gone` the pairs
    /// that ended, without generations; those that were not linked are `NOWHERE`.
    pub(super) fn update(
        &mut self,
        ended: &[PairKey],
        gone: &mut [Pair],
        began: &[Pair],
        bodies: &Bodies,
        threads: usize,
    ) {
        if let Some(last) = began.last() {
            self.reach(key_of(last));
        }
        let part = Part {
            blocks: &mut self.blocks,
            first: 0,
            ended,
            gone,
            began,
        };
        part.update(bodies, threads);
    }

    fn reach(&mut self, key: PairKey) {
        if self.blocks.len() <= block_of(key) {
            self.blocks.resize_with(block_of(key) + 1, Block::default);
        }
    }

    /// Bytes reserved.
    pub(super) fn bytes(&self) -> usize {
        let links: usize = self.blocks.iter().map(|block| block.0.capacity()).sum();
        links * size_of::<Link>() + self.blocks.capacity() * size_of::<Block>()
    }
}

fn link(key: PairKey, slot: u32) -> Link {
    let (low, high) = crate::broad::change::pair_of(key);
    Link { low, high, slot }
}

/// Consecutive blocks and the changes that concern them.
struct Part<'a> {
    blocks: &'a mut [Block],
    /// Number of the first block.
    first: usize,
    ended: &'a [PairKey],
    /// As long as `ended`.
    gone: &'a mut [Pair],
    began: &'a [Pair],
}

impl<'a> Part<'a> {
    fn update(self, bodies: &Bodies, threads: usize) {
        if threads > 1 && self.blocks.len() > 1 {
            let (low, high) = self.split();
            let fewer = threads / 2;
            join(|| low.update(bodies, fewer), || high.update(bodies, threads - fewer));
            return;
        }
        let Self {
            blocks,
            first,
            mut ended,
            mut gone,
            mut began,
        } = self;
        loop {
            let next = [ended.first().copied(), began.first().map(key_of)];
            let Some(next) = next.into_iter().flatten().min() else {
                return;
            };
            let number = block_of(next);
            let (ended_here, ended_later) = cut(ended, |key| block_of(*key) == number);
            let (began_here, began_later) = cut(began, |pair| block_of(key_of(pair)) == number);
            let (gone_here, gone_later) = gone.split_at_mut(ended_here.len());
            match blocks.get_mut(number - first) {
                Some(block) => {
                    let lines = block.0.iter().step_by(64 / size_of::<Link>());
                    read_ahead(lines.map(|link| link.slot));
                    block.end(ended_here, gone_here, bodies);
                    block.begin(began_here);
                }
                None => gone_here.fill(NOWHERE),
            }
            (ended, began, gone) = (ended_later, began_later, gone_later);
        }
    }

    /// Two parts of about equally many changes.
    fn split(self) -> (Self, Self) {
        let middle = if self.ended.len() > self.began.len() {
            self.ended[self.ended.len() / 2]
        } else {
            self.began.get(self.began.len() / 2).map_or(0, key_of)
        };
        let border = block_of(middle).saturating_sub(self.first).clamp(1, self.blocks.len() - 1);
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

/// Splits behind the leading items that fit.
fn cut<T>(items: &[T], fits: impl Fn(&T) -> bool) -> (&[T], &[T]) {
    let count = items.iter().take_while(|item| fits(item)).count();
    items.split_at(count)
}

impl Block {
    /// Unlinks pairs and names them. Everything between two of them moves once.
    fn end(&mut self, ended: &[PairKey], gone: &mut [Pair], bodies: &Bodies) {
        let links = &mut self.0;
        let (mut read, mut write) = (0, 0);
        for (key, pair) in ended.iter().zip(gone) {
            let at = read + links[read..].partition_point(|link| link.key() < *key);
            let Some(link) = links.get(at).filter(|link| link.key() == *key) else {
                *pair = NOWHERE;
                continue;
            };
            *pair = named(bodies, *key, link.slot, 0);
            links.copy_within(read..at, write);
            write += at - read;
            read = at + 1;
        }
        links.copy_within(read.., write);
        links.truncate(links.len() - (read - write));
        if links.capacity() > 4 * links.len() + 64 {
            links.shrink_to(2 * links.len());
        }
    }

    /// Links pairs, from the back, so that everything between two of them moves once.
    fn begin(&mut self, began: &[Pair]) {
        let links = &mut self.0;
        let mut read = links.len();
        let mut write = read + began.len();
        if write > links.capacity() {
            links.reserve_exact(began.len() + read / 8 + 4);
        }
        links.resize(write, Link::default());
        for pair in began.iter().rev() {
            let key = key_of(pair);
            let at = links[..read].partition_point(|link| link.key() < key);
            write -= read - at;
            links.copy_within(at..read, write);
            write -= 1;
            links[write] = link(key, pair.id.slot);
            read = at;
        }
    }
}
