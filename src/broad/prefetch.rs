//! Reading ahead: what a loop is going to need from all over memory.

/// So many items are read ahead at once.
pub(super) const AHEAD: usize = 32;

/// Tables of so many items stay in near caches from step to step and need not be read ahead.
const NEAR: usize = 1 << 14;

/// Reads all values, which lie in a table of `count` items. A loop that searches and decides waits for its reads one
/// after the other; asked for without a branch between, they arrive together.
#[inline(always)]
pub(super) fn read_ahead(count: usize, values: impl Iterator<Item = u32>) {
    if count > NEAR {
        core::hint::black_box(values.fold(0, u32::wrapping_add));
    }
}
