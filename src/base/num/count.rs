//! Counters of work and of ticks. A counter saturates, as a file may hold the largest number.

/// A counter that lives longer than one query.
pub(crate) trait Counter {
    /// Adds to the counter; the largest number stays what it is.
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

/// Implements the sum of a type whose fields are all counters: a list that lacks a field does not
/// compile.
macro_rules! sum_of_counters {
    ($counts:ident { $($field:ident),+ $(,)? }) => {
        impl core::ops::AddAssign for $counts {
            /// Adds all counts. Sums saturate.
            fn add_assign(&mut self, o: Self) {
                use $crate::base::num::count::Counter;
                let Self { $($field),+ } = self;
                $($field.count(o.$field);)+
            }
        }
    };
}
pub(crate) use sum_of_counters;
