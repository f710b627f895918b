//! Prefetching: reads the scattered memory that a loop is going to need.

/// Tables of up to this many items stay in near caches from step to step and need no prefetching.
/// Not measured.
const NEAR: usize = 1 << 14;

/// Reads all values, which lie in a table of `count` items. A loop that searches and decides waits
/// for its reads one after another; requested without a branch between, the values arrive together.
#[inline(always)]
pub(super) fn read_ahead(count: usize, values: impl Iterator<Item = u32>) {
    if count > NEAR {
        core::hint::black_box(values.fold(0, u32::wrapping_add));
    }
}
