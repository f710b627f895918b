//! Reading ahead: what a loop is going to need from all over memory.

/// So many items are read ahead at once.
pub(super) const AHEAD: usize = 32;

/// Reads all values. A loop that searches and decides waits for its reads one after the other; asked for without a branch
/// between, they arrive together.
#[inline(always)]
pub(super) fn read_ahead(values: impl Iterator<Item = u32>) {
    core::hint::black_box(values.fold(0, u32::wrapping_add));
}
