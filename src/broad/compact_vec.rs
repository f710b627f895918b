//! Lists that take little more memory than needed.

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
