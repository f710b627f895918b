//! Items by rank, for searches that take the best first.

use core::cmp::Ordering;

/// An item in a `BinaryHeap`: the item of least rank leaves first, among equal ranks that of least
/// key.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ranked<K, T = ()> {
    pub(crate) rank: f64,
    pub(crate) key: K,
    pub(crate) item: T,
}

impl<K: Ord, T> Ord for Ranked<K, T> {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_rank = other.rank.total_cmp(&self.rank);
        by_rank.then_with(|| other.key.cmp(&self.key))
    }
}

impl<K: Ord, T> PartialOrd for Ranked<K, T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<K: Ord, T> PartialEq for Ranked<K, T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<K: Ord, T> Eq for Ranked<K, T> {}
