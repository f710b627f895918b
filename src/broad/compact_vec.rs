//! Lists that take little more memory than they need.

use alloc::vec::Vec;

/// Appends; grows by an eighth, not by doubling, since tables of bodies are most of the memory.
pub(super) fn push<T>(list: &mut Vec<T>, item: T) {
    if list.len() == list.capacity() {
        list.reserve_exact(list.len() / 8 + 16);
    }
    list.push(item);
}

/// Gives back memory of a list that once was far longer than it was this step.
pub(super) fn trim<T>(list: &mut Vec<T>) {
    if list.capacity() > 8 * list.len() + 1024 {
        list.shrink_to(2 * list.len());
    }
}
