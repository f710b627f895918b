//! The arithmetic: scalars of the solvers, double-double, packed vectors, exact signs, and
//! fingerprints of numbers.
//!
//! This file holds names of axes, counters and ranked items. Counters saturate, because a file may
//! contain the largest number. Ranked items serve searches that take the best item first.

pub(crate) mod double_double;
pub(crate) mod each;
pub(crate) mod extremes;
pub(crate) mod fingerprint;
pub(crate) mod packed;
pub(crate) mod scalar;
pub(crate) mod sign;
pub(crate) mod sort;

use core::cmp::Ordering;

/// Returns the name of an axis in the text of an error: x, y or z.
pub(crate) const fn axis_name(axis: usize) -> char {
    match axis {
        0 => 'x',
        1 => 'y',
        _ => 'z',
    }
}

/// A counter that outlives one query.
pub(crate) trait Counter {
    /// Adds to the counter; the sum saturates at the largest number.
    fn count(&mut self, by: Self);
}

impl Counter for u32 {
    #[inline(always)]
    fn count(&mut self, by: Self) {
        *self = self.saturating_add(by);
    }
}

impl Counter for u64 {
    #[inline(always)]
    fn count(&mut self, by: Self) {
        *self = self.saturating_add(by);
    }
}

impl<const N: usize> Counter for [u64; N] {
    #[inline(always)]
    fn count(&mut self, by: Self) {
        for (mine, theirs) in self.iter_mut().zip(by) {
            mine.count(theirs);
        }
    }
}

/// Implements the sum of a type whose fields are all counters; a list without one of the fields
/// does not compile.
macro_rules! sum_of_counters {
    ($counts:ident { $($field:ident),+ $(,)? }) => {
        impl core::ops::AddAssign for $counts {
            /// Adds all counts. Sums saturate.
            fn add_assign(&mut self, o: Self) {
                use $crate::base::num::Counter;
                let Self { $($field),+ } = self;
                $($field.count(o.$field);)+
            }
        }
    };
}
pub(crate) use sum_of_counters;

/// An item in a `BinaryHeap`: the item of least rank leaves first; among equal ranks, the item of
/// least key.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ranked<K, T = ()> {
    pub(crate) rank: f64,
    pub(crate) key: K,
    pub(crate) item: T,
}

impl<K: Ord, T> Ord for Ranked<K, T> {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_rank = other.rank.total_cmp(&self.rank);
        by_rank.then_with(|| other.key.cmp(&self.key))
    }
}

impl<K: Ord, T> PartialOrd for Ranked<K, T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<K: Ord, T> PartialEq for Ranked<K, T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<K: Ord, T> Eq for Ranked<K, T> {}
