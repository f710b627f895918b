//! A stable sort whose code is compiled once.
//!
//! A sort of the standard library is 2,300 lines of LLVM for each type and order. They were 8 % of
//! what this crate gives to the compiler. Here few items are sorted by insertion, and of more
//! items their numbers are sorted, by one function for all types. It is for lists that are short,
//! or are sorted once: the order of many items is called through a pointer, and their numbers take
//! memory.

use alloc::vec::Vec;
use core::cmp::Ordering;

/// Most items that are sorted by insertion, as the standard library does.
const FEW: usize = 20;

/// Sorts items; equal ones keep their order.
pub(crate) fn sort<T>(items: &mut [T], mut order: impl FnMut(&T, &T) -> Ordering) {
    if items.len() > FEW {
        let mut places = sorted_numbers(items.len(), &mut |i, j| order(&items[i], &items[j]));
        arrange(items, &mut places);
        return;
    }
    for k in 1..items.len() {
        let mut at = k;
        while at > 0 && order(&items[at - 1], &items[at]) == Ordering::Greater {
            items.swap(at - 1, at);
            at -= 1;
        }
    }
}

/// Sorts items by a key; those with equal keys keep their order.
pub(crate) fn sort_by_key<T, K: Ord>(items: &mut [T], mut key: impl FnMut(&T) -> K) {
    sort(items, |x, y| key(x).cmp(&key(y)));
}

#[inline(never)]
fn sorted_numbers(count: usize, order: &mut dyn FnMut(usize, usize) -> Ordering) -> Vec<usize> {
    let mut all: Vec<usize> = (0..count).collect();
    all.sort_by(|&i, &j| order(i, j));
    all
}

/// Moves the item `places[k]` to place k, for each k. The places are lost.
pub(crate) fn arrange<T>(items: &mut [T], places: &mut [usize]) {
    for start in 0..places.len() {
        // Round the cycle: the item of its start is carried along to its end.
        let mut at = start;
        while places[at] != DONE {
            let from = core::mem::replace(&mut places[at], DONE);
            if from != start {
                items.swap(at, from);
            }
            at = from;
        }
    }
}

/// The index of an item that has been moved.
const DONE: usize = usize::MAX;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    /// As the stable sort of the standard library, with few and with many equal keys.
    #[test]
    fn items_are_sorted_as_by_the_standard_library() {
        let mut rng = Rng::new(1);
        for round in 0..400 {
            let count = rng.below(if round % 2 == 0 { 25 } else { 300 });
            let keys = 1 + rng.below(60);
            let items: Vec<(usize, usize)> = (0..count).map(|k| (rng.below(keys), k)).collect();
            let (mut ours, mut theirs) = (items.clone(), items);
            sort_by_key(&mut ours, |item| item.0);
            theirs.sort_by_key(|item| item.0);
            assert_eq!(ours, theirs);
        }
    }
}
