//! Counts that add themselves.

use std::collections::BTreeMap;

/// Returns whether the slowest families of tests run whole: `.ci/nightly` sets `LIN_CANNY_WHOLE`.
#[must_use]
pub fn is_whole() -> bool {
    std::env::var_os("LIN_CANNY_WHOLE").is_some()
}

/// Returns a count, or a tenth of it unless the tests run [whole](is_whole).
#[must_use]
pub fn tenth(count: usize) -> usize {
    if is_whole() { count } else { count.div_ceil(10) }
}

/// A count, or a set of counts; [`tally!`](crate::tally!) defines one.
pub trait Tally {
    /// Adds the counts of another run. Of two numbers that are the largest of their runs, keeps the larger.
    fn add(&mut self, other: &Self);
}

macro_rules! counts {
    ($($type:ty),*) => {$(
        impl Tally for $type {
            fn add(&mut self, other: &Self) {
                *self += other;
            }
        }
    )*};
}

counts!(u32, u64, usize);

/// The largest of a run.
impl Tally for f64 {
    fn add(&mut self, other: &Self) {
        *self = self.max(*other);
    }
}

/// The largest of a run, and its number.
impl Tally for (u128, u64) {
    fn add(&mut self, other: &Self) {
        *self = (*self).max(*other);
    }
}

impl<T: Tally, const N: usize> Tally for [T; N] {
    fn add(&mut self, other: &Self) {
        self.iter_mut().zip(other).for_each(|(sum, n)| sum.add(n));
    }
}

impl<K: Ord + Copy, T: Tally + Default> Tally for BTreeMap<K, T> {
    fn add(&mut self, other: &Self) {
        other.iter().for_each(|(key, n)| self.entry(*key).or_default().add(n));
    }
}

/// Defines a struct of counts as a [`Tally`](crate::tally::Tally): a field is added by its type.
#[macro_export]
macro_rules! tally {
    ($(#[$meta:meta])* $vis:vis struct $name:ident { $($(#[$doc:meta])* $seen:vis $field:ident: $type:ty,)* }) => {
        $(#[$meta])*
        $vis struct $name {
            $($(#[$doc])* $seen $field: $type,)*
        }

        impl $crate::tally::Tally for $name {
            fn add(&mut self, other: &Self) {
                $($crate::tally::Tally::add(&mut self.$field, &other.$field);)*
            }
        }
    };
}
