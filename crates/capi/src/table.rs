//! Handles: numbers that name a slot and a generation, so that a stale, foreign or invented handle
//! is an error and never a wild pointer.
//!
//! ```text
//!  63    56 55          24 23      0
//! |  kind  |  generation  |  slot   |
//! ```
//!
//! Slots are in chunks of doubling size that are never freed or moved, so a look-up takes no lock.
//! One call at a time owns a slot: its state holds the generation and a busy bit, and a call that
//! finds the busy bit of another returns `LC_BUSY`. Generations start at a number that depends on
//! the address of the table. So a handle of another copy of this library in the process is, with
//! all but certainty, rejected too.

use std::cell::UnsafeCell;
use std::sync::atomic::{AtomicPtr, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use crate::border::{error, lc_status};

/// Slots of the first chunk; chunk k holds `FIRST << k`.
const FIRST: usize = 64;
const CHUNKS: usize = 18;
/// Below 2^24.
const SLOTS: usize = FIRST * ((1 << CHUNKS) - 1);
const BUSY: u64 = 1;
const GENERATIONS: u64 = 0xffff_ffff;

struct Slot<T> {
    /// `generation << 1 | busy`; the generation is odd while the slot is in use.
    state: AtomicU64,
    value: UnsafeCell<Option<T>>,
}

struct Vacant {
    free: Vec<u32>,
    fresh: usize,
    /// The slots whose generations ran out.
    retired: usize,
}

/// The objects of one kind.
pub(crate) struct Table<T> {
    kind: u64,
    /// What messages call an object.
    name: &'static str,
    chunks: [AtomicPtr<Slot<T>>; CHUNKS],
    vacant: Mutex<Vacant>,
}

// SAFETY: a value is touched only by the one call that set the busy bit (`claim`), which orders it
// after the last such call by acquire and release of `state`; values are `Send`.
unsafe impl<T: Send> Sync for Table<T> {}

/// Why a handle cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cause {
    /// It is no handle of this kind, or its object was freed.
    Stale,
    /// Another call is using the object.
    Busy,
    /// There is no room for another one.
    Full,
}

/// The cause, and the name of the kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Fault {
    pub(crate) cause: Cause,
    pub(crate) name: &'static str,
}

/// The object of a handle, while a call uses it.
pub(crate) struct Claim<'t, T> {
    slot: &'t Slot<T>,
    idle: u64,
}

impl<T> Claim<'_, T> {
    #[inline(always)]
    pub(crate) fn get(&mut self) -> &mut T {
        // SAFETY: this claim set the busy bit of the slot, and nobody else touches the value until
        // `drop` clears the bit.
        let value = unsafe { &mut *self.slot.value.get() };
        // SAFETY: a slot of an odd generation holds a value.
        unsafe { value.as_mut().unwrap_unchecked() }
    }
}

impl<T> Drop for Claim<'_, T> {
    #[inline(always)]
    fn drop(&mut self) {
        self.slot.state.store(self.idle, Ordering::Release);
    }
}

/// Returns the chunk of a slot, and its index there.
#[inline(always)]
fn location(slot: usize) -> (usize, usize) {
    let chunk = (slot / FIRST + 1).ilog2() as usize;
    (chunk, slot - FIRST * ((1 << chunk) - 1))
}

impl<T> Table<T> {
    pub(crate) const fn new(kind: u64, name: &'static str) -> Self {
        let vacant = Vacant {
            free: Vec::new(),
            fresh: 0,
            retired: 0,
        };
        Self {
            kind,
            name,
            chunks: [const { AtomicPtr::new(std::ptr::null_mut()) }; CHUNKS],
            vacant: Mutex::new(vacant),
        }
    }

    /// Returns the generation of unused slots: even, and different for each copy of the table.
    fn first_generation(&self) -> u64 {
        (std::ptr::from_ref(self).addr() as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32 & !1
    }

    fn fault(&self, cause: Cause) -> Fault {
        Fault { cause, name: self.name }
    }

    #[inline(always)]
    fn slot(&self, handle: u64) -> Option<(&Slot<T>, u64)> {
        let (kind, generation) = (handle >> 56, handle >> 24 & GENERATIONS);
        let slot = (handle & 0xff_ffff) as usize;
        if kind != self.kind || slot >= SLOTS {
            return None;
        }
        let (chunk, index) = location(slot);
        let chunk = self.chunks[chunk].load(Ordering::Acquire);
        if chunk.is_null() {
            return None;
        }
        // SAFETY: a chunk that is not null holds `FIRST << chunk` slots for ever, and the index is
        // less.
        let slot = unsafe { chunk.add(index) };
        // SAFETY: as above; slots are only shared.
        Some((unsafe { &*slot }, generation))
    }

    /// Takes the object for one call.
    #[inline(always)]
    pub(crate) fn claim(&self, handle: u64) -> Result<Claim<'_, T>, Fault> {
        let (slot, generation) = self.slot(handle).ok_or_else(|| self.fault(Cause::Stale))?;
        let idle = generation << 1;
        if generation & 1 == 0 {
            return Err(self.fault(Cause::Stale));
        }
        match slot
            .state
            .compare_exchange(idle, idle | BUSY, Ordering::Acquire, Ordering::Relaxed)
        {
            Ok(_) => Ok(Claim { slot, idle }),
            Err(now) if now == idle | BUSY => Err(self.fault(Cause::Busy)),
            Err(_) => Err(self.fault(Cause::Stale)),
        }
    }

    /// Takes the object as [`claim`](Self::claim) does, and waits for another call.
    ///
    /// For tables whose calls use an object for a few instructions only.
    pub(crate) fn claim_soon(&self, handle: u64) -> Result<Claim<'_, T>, Fault> {
        for _ in 0..100 {
            match self.claim(handle) {
                Err(fault) if fault.cause == Cause::Busy => std::thread::yield_now(),
                other => return other,
            }
        }
        // A real-time thread yields to no thread of a lower priority, which the other one may be.
        loop {
            match self.claim(handle) {
                Err(fault) if fault.cause == Cause::Busy => std::thread::sleep(Duration::from_micros(50)),
                other => return other,
            }
        }
    }

    /// Stores an object, and returns its handle.
    pub(crate) fn insert(&self, value: T) -> Result<u64, Fault> {
        let mut vacant = self.vacant.lock().unwrap_or_else(PoisonError::into_inner);
        let k = match vacant.free.pop() {
            Some(k) => k as usize,
            None if vacant.fresh < SLOTS => vacant.fresh,
            None => return Err(self.fault(Cause::Full)),
        };
        let (chunk, index) = location(k);
        let mut slots = self.chunks[chunk].load(Ordering::Acquire);
        if slots.is_null() {
            let first = self.first_generation() << 1;
            let unused = || Slot {
                state: AtomicU64::new(first),
                value: UnsafeCell::new(None),
            };
            let new: Box<[Slot<T>]> = std::iter::repeat_with(unused).take(FIRST << chunk).collect();
            slots = Box::leak(new).as_mut_ptr();
            self.chunks[chunk].store(slots, Ordering::Release);
        }
        vacant.fresh = vacant.fresh.max(k + 1);
        drop(vacant);
        // A panic before the first object, such as in the call that makes it, is also printed.
        crate::border::set_hook();
        // SAFETY: as in `slot`.
        let slot = unsafe { slots.add(index) };
        // SAFETY: as in `slot`.
        let slot = unsafe { &*slot };
        let generation = ((slot.state.load(Ordering::Acquire) >> 1) + 1) & GENERATIONS;
        // SAFETY: the slot was vacant (its generation is even, and it is on no list now). So no
        // claim succeeds, and this call alone touches it until `state` is stored.
        unsafe { *slot.value.get() = Some(value) };
        slot.state.store(generation << 1, Ordering::Release);
        Ok(self.kind << 56 | generation << 24 | k as u64)
    }

    /// Returns the number of objects.
    pub(crate) fn live(&self) -> usize {
        let vacant = self.vacant.lock().unwrap_or_else(PoisonError::into_inner);
        vacant.fresh - vacant.free.len() - vacant.retired
    }

    /// Returns the object of a claim, whose handle is stale from now on.
    fn remove(&self, mut claim: Claim<'_, T>, handle: u64) -> T {
        // SAFETY: as in `Claim::get`.
        let value = unsafe { &mut *claim.slot.value.get() };
        // SAFETY: as in `Claim::get`.
        let value = unsafe { value.take().unwrap_unchecked() };
        let next = ((claim.idle >> 1) + 1) & GENERATIONS;
        claim.idle = next << 1;
        drop(claim);
        let mut vacant = self.vacant.lock().unwrap_or_else(PoisonError::into_inner);
        if next == self.first_generation() {
            // The generations of the slot ran out: no handle comes back.
            vacant.retired += 1;
        } else {
            vacant.free.push((handle & 0xff_ffff) as u32);
        }
        drop(vacant);
        value
    }

    /// Frees an object; zero is no error.
    pub(crate) fn free(&self, handle: u64) -> Result<(), lc_status> {
        if handle != 0 {
            drop(self.remove(self.claim(handle)?, handle));
        }
        Ok(())
    }

    /// Frees an object as [`free`](Self::free) does, and waits for another call.
    pub(crate) fn free_soon(&self, handle: u64) -> Result<(), lc_status> {
        if handle != 0 {
            drop(self.remove(self.claim_soon(handle)?, handle));
        }
        Ok(())
    }
}

/// An object that calls change.
pub(crate) trait Changing {
    /// Prepares the object after a call that panicked, or refuses.
    fn recover(&mut self) -> Result<(), lc_status>;
}

/// Returns the error of an object whose last call panicked.
pub(crate) fn lost(name: &str) -> lc_status {
    error(
        lc_status::LC_PANIC,
        &format_args!("the {name} cannot be used since a call of it panicked"),
    )
}

/// An object, and whether a call is using it. If it is in use when a call starts, the last call
/// panicked.
pub(crate) struct Watched<T> {
    value: T,
    is_used: bool,
}

impl<T: Changing> Table<Watched<T>> {
    pub(crate) fn add(&self, value: T) -> Result<u64, Fault> {
        self.insert(Watched { value, is_used: false })
    }

    /// Runs a call with an object.
    #[inline(always)]
    pub(crate) fn with<R>(
        &self,
        handle: u64,
        call: impl FnOnce(&mut T) -> Result<R, lc_status>,
    ) -> Result<R, lc_status> {
        let mut claim = self.claim(handle)?;
        let watched = claim.get();
        if std::mem::replace(&mut watched.is_used, true) {
            watched.value.recover()?;
        }
        let result = call(&mut watched.value);
        watched.is_used = false;
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cause<T>(claim: Result<Claim<'_, T>, Fault>) -> Option<Cause> {
        claim.err().map(|fault| fault.cause)
    }

    #[test]
    fn locations_are_dense() {
        let mut expected = (0, 0);
        for k in 0..100_000 {
            assert_eq!(location(k), expected);
            expected.1 += 1;
            if expected.1 == FIRST << expected.0 {
                expected = (expected.0 + 1, 0);
            }
        }
        assert_eq!(location(SLOTS - 1).0, CHUNKS - 1);
    }

    #[test]
    fn handles_of_freed_objects_are_stale() {
        static TABLE: Table<u32> = Table::new(7, "number");
        let mut old = Vec::new();
        for round in 0..1000_u32 {
            let h = TABLE.insert(round).unwrap();
            assert_eq!(cause(TABLE.claim(h ^ 1 << 56)), Some(Cause::Stale));
            let mut claim = TABLE.claim(h).unwrap();
            assert_eq!(*claim.get(), round);
            assert_eq!(cause(TABLE.claim(h)), Some(Cause::Busy));
            assert_eq!(TABLE.remove(claim, h), round);
            old.push(h);
        }
        assert!(old.iter().all(|&h| cause(TABLE.claim(h)) == Some(Cause::Stale)));
        assert_eq!(TABLE.vacant.lock().unwrap().fresh, 1);
    }

    #[test]
    fn a_slot_whose_generations_ran_out_is_neither_live_nor_used_again() {
        static TABLE: Table<u32> = Table::new(7, "number");
        let first = TABLE.insert(1).unwrap();
        TABLE.free(first).unwrap();
        // The last generation but one, which is that of an unused slot.
        let (slot, _) = TABLE.slot(first).unwrap();
        let last_unused = TABLE.first_generation().wrapping_sub(2) & GENERATIONS;
        slot.state.store(last_unused << 1, Ordering::Release);
        let last = TABLE.insert(2).unwrap();
        assert_eq!((last & 0xff_ffff, TABLE.live()), (first & 0xff_ffff, 1));
        TABLE.free(last).unwrap();
        assert_eq!(TABLE.live(), 0);
        for h in [first, last] {
            assert_eq!(cause(TABLE.claim(h)), Some(Cause::Stale));
        }
        let next = TABLE.insert(3).unwrap();
        assert_eq!((next & 0xff_ffff, TABLE.live()), ((first & 0xff_ffff) + 1, 1));
    }

    #[test]
    fn random_handles_are_stale() {
        static TABLE: Table<u32> = Table::new(7, "number");
        let live: Vec<u64> = (0..200).map(|k| TABLE.insert(k).unwrap()).collect();
        let mut x = 1_u64;
        for _ in 0..if cfg!(miri) { 300 } else { 100_000 } {
            x = x.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            for h in [x, x >> 8 | 7 << 56, live[x as usize % 200] ^ 1 << (x >> 58)] {
                assert!(live.contains(&h) || cause(TABLE.claim(h)) == Some(Cause::Stale));
            }
        }
    }

    #[test]
    fn two_tables_refuse_the_handles_of_each_other() {
        static ONE: Table<u32> = Table::new(7, "number");
        static TWO: Table<u32> = Table::new(7, "number");
        let (one, two) = (ONE.insert(1).unwrap(), TWO.insert(2).unwrap());
        assert_eq!(cause(ONE.claim(two)), Some(Cause::Stale));
        assert_eq!(cause(TWO.claim(one)), Some(Cause::Stale));
    }

    #[test]
    fn threads_claim_one_at_a_time() {
        static TABLE: Table<[u64; 2]> = Table::new(7, "numbers");
        let h = TABLE.insert([0, 0]).unwrap();
        let count = |_| {
            let mut done = 0;
            for _ in 0..if cfg!(miri) { 100 } else { 50_000 } {
                if let Ok(mut claim) = TABLE.claim(h) {
                    let v = claim.get();
                    assert_eq!(v[0], v[1]);
                    v[0] += 1;
                    v[1] += 1;
                    done += 1;
                }
            }
            done
        };
        let done: u64 = std::thread::scope(|s| {
            let threads: Vec<_> = (0..4).map(|k| s.spawn(move || count(k))).collect();
            threads.into_iter().map(|t| t.join().unwrap()).sum()
        });
        let claim = TABLE.claim(h).unwrap();
        assert_eq!(TABLE.remove(claim, h), [done, done]);
    }
}
