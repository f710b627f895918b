//! Memory of large tables: lists that use little more than they need, and prefetching for loops.

use alloc::vec::Vec;

/// Appends an item. The list grows by an eighth and does not double, because tables of bodies are
/// most of the memory.
pub(super) fn push<T>(list: &mut Vec<T>, item: T) {
    if list.len() == list.capacity() {
        list.reserve_exact(list.len() / 8 + 16);
    }
    list.push(item);
}

/// Releases memory of a list that was far longer in an earlier step.
pub(super) fn trim<T>(list: &mut Vec<T>) {
    if list.capacity() > 8 * list.len() + 1024 {
        list.shrink_to(2 * list.len());
    }
}

/// Tables of up to this many items stay in near caches from step to step and need no prefetching.
const NEAR: usize = 1 << 14;

/// Reads all values, from a table of `count` items. A loop that searches and decides waits for its
/// reads one after another; without a branch between them, the values arrive together.
#[inline(always)]
pub(super) fn read_ahead(count: usize, values: impl Iterator<Item = u32>) {
    if count > NEAR {
        core::hint::black_box(values.fold(0, u32::wrapping_add));
    }
}
