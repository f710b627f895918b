//! Due pairs by ids, ticks and bounds: each pair sleeps until the proof of its separation ends.
//!
//! A [`Schedule`] knows ids, integer ticks and bounds, but no shapes. A pair that is proven
//! separated, or proven to stay in contact, sleeps for the whole ticks of the proven time
//! ([`ticks`], rounded down). If the velocity or the pose of a body changes from outside, all pairs
//! of this body wake. Due pairs are returned in the order of ticks and ids, independent of the
//! order of calls.
//!
//! ```
//! use lin_canny::schedule::{Schedule, ticks};
//!
//! let mut schedule = Schedule::new();
//! schedule.insert(3, 7);
//! schedule.insert(3, 9);
//! let dt = 1.0 / 60.0;
//! let mut looks = 0;
//! for tick in 0..60 {
//!     schedule.advance(tick);
//!     while let Some(due) = schedule.due() {
//!         looks += 1;
//!         // Here a query: 3 and 7 are proven free for a quarter of a second,
//!         // 3 and 9 overlap.
//!         if due.pair == (3, 7) { schedule.sleep(&due, ticks(0.25, dt)) }
//!     }
//! }
//! assert_eq!(looks, 4 + 60);
//! ```
//!
//! # Rules
//!
//! 1. If a query at tick k proves a pair separated until the time of tick k + m, tick k + m
//!    included, the pair sleeps until tick k + m + 1.
//! 2. A pair that is due and not put to sleep is due again at the next tick. So pairs in contact
//!    stay due.
//! 3. A result counts only if neither body was disturbed, and the pair was not removed, since the
//!    pair was due. For this, [`Due`] carries the number of disturbances and insertions before it.
//! 4. Ticks are integers, so no wake-up is lost to the rounding of a clock. No tick follows the
//!    tick `u64::MAX`: a pair that would be due after it sleeps until a body is disturbed.
//!
//! # When not to use a schedule
//!
//! If velocities are unknown or change at every tick, a displacement budget
//! ([`scene`](crate::scene)) lets pairs sleep longer. Without a broad phase, n bodies have
//! `n (n - 1) / 2` pairs, and a heap of all pairs is about ten times slower than boxes. A scene
//! applies these rules to the pairs of its boxes without a heap: see [`Scene::advance`].
//!
//! [`Scene::advance`]: crate::scene::Scene::advance
//!
//! # Source
//!
//! Lin 1993, section 5.1 (the heap of wake-up times). Departures:
//!
//! 1. Bounds come from the caller and are proven over all points. The thesis uses only the speed of
//!    the closest points, and a spinning rod can exceed this speed by any factor.
//! 2. There is no minimum time between queries: a pair in contact is queried in every tick, a
//!    separated pair according to its bound.
//! 3. Disturbances are numbered, so that no outdated wake-up or result counts.

use alloc::collections::{BTreeMap, BTreeSet, BinaryHeap};
use core::cmp::Reverse;

use crate::base::tolerance::TICK;

/// Number of heap entries, above four per pair, at which the heap is rebuilt without outdated
/// entries.
const SPARE: usize = 64;

/// Pairs of bodies by id, and the tick at which each pair is due.
#[derive(Clone, Debug, Default)]
pub struct Schedule {
    now: u64,
    /// The number of disturbances and insertions so far: an epoch is one of these numbers.
    epoch: u64,
    pairs: BTreeMap<(u32, u32), DuePair>,
    /// All pairs once more, the higher id first.
    turned: BTreeSet<(u32, u32)>,
    /// The epoch of the last disturbance of each body.
    ///
    /// If a body is removed and inserted again, its pairs are younger than any result about the
    /// body before, so the epoch of a removed body may be dropped.
    disturbed: BTreeMap<u32, u64>,
    /// Entries that agree with `pairs`, and outdated ones.
    heap: BinaryHeap<Reverse<(u64, u32, u32)>>,
}

/// A pair of the schedule.
#[derive(Clone, Copy, Debug)]
struct DuePair {
    /// The tick at which the pair is due; `None` if it would be due after the last tick.
    tick: Option<u64>,
    /// The epoch in which the pair was inserted.
    arrived: u64,
}

/// A pair to query now.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Due {
    /// The ids, the lower id first.
    pub pair: (u32, u32),
    /// The tick at which the pair became due: now, or earlier if ticks were skipped.
    pub since: u64,
    /// The epoch in which the pair was found due.
    epoch: u64,
}

impl Schedule {
    /// Returns a schedule without pairs at tick zero.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a pair, due now.
    ///
    /// Returns false, and changes nothing, if the pair exists already or both ids are equal.
    pub fn insert(&mut self, a: u32, b: u32) -> bool {
        let pair = ordered(a, b);
        if a == b || self.pairs.contains_key(&pair) {
            return false;
        }
        self.epoch += 1;
        let arrived = self.epoch;
        self.pairs.insert(pair, DuePair { tick: None, arrived });
        self.turned.insert((pair.1, pair.0));
        self.wake_at(pair.0, pair.1, Some(self.now));
        true
    }

    /// Removes a pair. Returns false if the pair did not exist.
    pub fn remove(&mut self, a: u32, b: u32) -> bool {
        let pair = ordered(a, b);
        self.turned.remove(&(pair.1, pair.0));
        self.pairs.remove(&pair).is_some()
    }

    /// Removes a body and all its pairs.
    pub fn remove_body(&mut self, body: u32) {
        for (a, b) in self.of(body) {
            self.remove(a, b);
        }
        self.disturbed.remove(&body);
    }

    /// Returns the number of pairs.
    #[must_use]
    pub fn len(&self) -> usize {
        self.pairs.len()
    }

    /// Returns whether there is no pair.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Returns the current tick.
    #[must_use]
    pub fn now(&self) -> u64 {
        self.now
    }

    /// Advances to a later tick. A tick before the current tick changes nothing.
    pub fn advance(&mut self, tick: u64) {
        self.now = self.now.max(tick);
    }

    /// Reports that the velocity or the pose of a body was changed from outside: all its pairs are
    /// due now.
    pub fn disturb(&mut self, body: u32) {
        self.epoch += 1;
        self.disturbed.insert(body, self.epoch);
        for (a, b) in self.of(body) {
            let entry = self.pairs.get(&(a, b));
            if entry.is_some_and(|entry| entry.tick.is_none_or(|tick| tick > self.now)) {
                self.wake_at(a, b, Some(self.now));
            }
        }
    }

    /// Returns the next due pair, if any.
    ///
    /// The pair is due again at the next tick, unless you put it to [`sleep`](Self::sleep).
    pub fn due(&mut self) -> Option<Due> {
        while let Some(&Reverse((since, a, b))) = self.heap.peek() {
            if since > self.now {
                return None;
            }
            self.heap.pop();
            if self.pairs.get(&(a, b)).is_some_and(|entry| entry.tick == Some(since)) {
                self.wake_at(a, b, self.now.checked_add(1));
                return Some(Due {
                    pair: (a, b),
                    since,
                    epoch: self.epoch,
                });
            }
        }
        None
    }

    /// Lets a pair sleep for a number of whole ticks after the current tick.
    ///
    /// The pair is due at the tick after these. Changes nothing if a body of the pair was disturbed
    /// since the pair was due, or if the pair was removed, even if it was inserted again.
    pub fn sleep(&mut self, due: &Due, ticks: u64) {
        if ticks > 0 && self.is_valid(due) {
            let next = self.now.checked_add(ticks).and_then(|last| last.checked_add(1));
            self.wake_at(due.pair.0, due.pair.1, next);
        }
    }

    /// Returns the next tick at which a pair is due, if any.
    #[must_use]
    pub fn next(&self) -> Option<u64> {
        let ticks = self.pairs.values().filter_map(|entry| entry.tick);
        ticks.min().map(|tick| tick.max(self.now))
    }

    fn wake_at(&mut self, a: u32, b: u32, tick: Option<u64>) {
        let Some(entry) = self.pairs.get_mut(&(a, b)) else {
            return;
        };
        entry.tick = tick;
        self.heap.extend(tick.map(|tick| Reverse((tick, a, b))));
        if self.heap.len() > 4 * self.pairs.len() + SPARE {
            let entries = self.pairs.iter();
            self.heap = entries
                .filter_map(|(&(a, b), entry)| Some(Reverse((entry.tick?, a, b))))
                .collect();
        }
    }

    /// Returns whether a result for a pair that was due is about the pair as it is now.
    fn is_valid(&self, due: &Due) -> bool {
        let (a, b) = due.pair;
        let is_old = |body: u32| self.disturbed.get(&body).is_none_or(|epoch| *epoch <= due.epoch);
        self.pairs
            .get(&due.pair)
            .is_some_and(|entry| entry.arrived <= due.epoch)
            && is_old(a)
            && is_old(b)
    }

    /// Returns the pairs of a body, in the order of ids.
    fn of(&self, body: u32) -> alloc::vec::Vec<(u32, u32)> {
        let lower = self.turned.range((body, 0)..=(body, u32::MAX)).map(|&(b, a)| (a, b));
        let higher = self.pairs.range((body, 0)..=(body, u32::MAX)).map(|(&pair, _)| pair);
        lower.chain(higher).collect()
    }
}

/// Returns the number of whole ticks in a span of time; 0 if the span or the tick is not a positive
/// number.
///
/// The result is rounded down by more than the rounding of the quotient.
#[must_use]
pub fn ticks(span: f64, tick: f64) -> u64 {
    let whole = span / tick * (1.0 - TICK);
    // The cast saturates, and returns zero for NaN and negative numbers.
    if tick > 0.0 { whole as u64 } else { 0 }
}

fn ordered(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::rng::Rng;
    use std::collections::BTreeMap;
    use std::vec::Vec;

    /// A list of pairs without a heap, which finds due pairs by testing all.
    #[derive(Default)]
    struct Plain {
        wake: BTreeMap<(u32, u32), u64>,
    }

    impl Plain {
        fn due(&self, now: u64) -> Vec<(u32, u32)> {
            let mut due: Vec<_> = self
                .wake
                .iter()
                .filter(|(_, w)| **w <= now)
                .map(|(&p, &w)| (w, p))
                .collect();
            due.sort_unstable();
            due.into_iter().map(|(_, p)| p).collect()
        }
    }

    #[test]
    fn a_schedule_is_a_list_of_wake_ups() {
        for seed in 0..200 {
            let mut rng = Rng::new(seed);
            let (mut schedule, mut plain) = (Schedule::new(), Plain::default());
            let mut slept = 0;
            for now in 0..120 {
                schedule.advance(now);
                for _ in 0..rng.below(4) {
                    let (a, b) = (rng.below(8) as u32, rng.below(8) as u32);
                    let pair = ordered(a, b);
                    match rng.below(5) {
                        0 => {
                            let gone = plain.wake.remove(&pair).is_some();
                            assert_eq!(schedule.remove(a, b), gone);
                        }
                        1 => {
                            schedule.disturb(a);
                            for (p, w) in &mut plain.wake {
                                if p.0 == a || p.1 == a {
                                    *w = (*w).min(now);
                                }
                            }
                        }
                        _ => {
                            let new = a != b && !plain.wake.contains_key(&pair);
                            assert_eq!(schedule.insert(a, b), new);
                            if new {
                                plain.wake.insert(pair, now);
                            }
                        }
                    }
                }
                let expected = plain.due(now);
                let mut found = Vec::new();
                while let Some(due) = schedule.due() {
                    found.push(due.pair);
                    plain.wake.insert(due.pair, now + 1);
                    if rng.chance(0.7) {
                        let ticks = rng.below(20) as u64;
                        // A result that comes too late does not count.
                        if rng.chance(0.1) {
                            schedule.disturb(due.pair.0);
                            for (p, w) in &mut plain.wake {
                                if (p.0 == due.pair.0 || p.1 == due.pair.0) && *w > now {
                                    *w = now;
                                }
                            }
                            schedule.sleep(&due, ticks);
                            break;
                        }
                        schedule.sleep(&due, ticks);
                        plain.wake.insert(due.pair, now + ticks + 1);
                        slept += 1;
                    }
                }
                assert_eq!(found[..], expected[..found.len()], "seed {seed} tick {now}");
                assert!(schedule.heap.len() <= 4 * schedule.len() + SPARE + 1);
            }
            assert!(slept > 10);
        }
    }

    #[test]
    fn ticks_round_down() {
        assert_eq!(ticks(1.0, 0.25), 3);
        assert_eq!(ticks(1.0 + 1e-9, 0.25), 4);
        assert_eq!(ticks(f64::INFINITY, 0.25), u64::MAX);
        for nothing in [
            ticks(f64::NAN, 1.0),
            ticks(-1.0, 1.0),
            ticks(1.0, 0.0),
            ticks(1.0, -1.0),
            ticks(1.0, f64::NAN),
        ] {
            assert_eq!(nothing, 0);
        }
        let mut schedule = Schedule::new();
        schedule.insert(1, 2);
        let due = schedule.due().expect("a pair is due at once");
        schedule.sleep(&due, u64::MAX);
        schedule.advance(u64::MAX - 1);
        assert!(schedule.due().is_none());
    }
}
