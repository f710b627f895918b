//! Memory of large tables: lists that take little more than needed, and reads ahead of a loop.

use alloc::vec::Vec;

/// Appends an item; grows by an eighth, not by doubling, since tables of bodies are most of the
/// memory.
pub(super) fn push<T>(list: &mut Vec<T>, item: T) {
    if list.len() == list.capacity() {
        list.reserve_exact(list.len() / 8 + 16);
    }
    list.push(item);
}

/// Releases memory of a list that once was far longer than in this step.
pub(super) fn trim<T>(list: &mut Vec<T>) {
    if list.capacity() > 8 * list.len() + 1024 {
        list.shrink_to(2 * list.len());
    }
}

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
