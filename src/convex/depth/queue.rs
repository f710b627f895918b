//! Priority queue of triangles by lower bound, the least first.

use alloc::vec::Vec;

/// A triangle with its bound at the time of insertion.
#[derive(Clone, Copy, Debug)]
pub(super) struct QueuedTriangle {
    pub(super) bound: f64,
    pub(super) triangle: u32,
}

impl QueuedTriangle {
    /// Orders by bound; equal bounds by triangle number.
    fn is_before(&self, o: &Self) -> bool {
        self.bound < o.bound || (self.bound == o.bound && self.triangle < o.triangle)
    }
}

/// Binary heap of triangles, the least bound at the root.
#[derive(Clone, Debug, Default)]
pub(super) struct Queue {
    entries: Vec<QueuedTriangle>,
}

impl Queue {
    pub(super) fn reserve(&mut self, entries: usize) {
        self.entries.reserve(entries);
    }

    /// Returns the allocated bytes on the heap.
    pub(super) fn heap_bytes(&self) -> usize {
        self.entries.capacity() * size_of::<QueuedTriangle>()
    }

    pub(super) fn clear(&mut self) {
        self.entries.clear();
    }

    pub(super) fn first(&self) -> Option<QueuedTriangle> {
        self.entries.first().copied()
    }

    pub(super) fn push(&mut self, entry: QueuedTriangle) {
        self.entries.push(entry);
        let list = &mut self.entries;
        let mut k = list.len() - 1;
        while k > 0 && list[k].is_before(&list[(k - 1) / 2]) {
            list.swap(k, (k - 1) / 2);
            k = (k - 1) / 2;
        }
    }

    /// Removes the first entry.
    pub(super) fn pop(&mut self) {
        if self.entries.is_empty() {
            return;
        }
        self.entries.swap_remove(0);
        let list = &mut self.entries;
        let mut k = 0;
        loop {
            let children = 2 * k + 1..(2 * k + 3).min(list.len());
            let least = children.reduce(|l, r| if list[r].is_before(&list[l]) { r } else { l });
            match least {
                Some(c) if list[c].is_before(&list[k]) => {
                    list.swap(k, c);
                    k = c;
                }
                _ => return,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_leave_in_order() {
        let mut queue = Queue::default();
        for k in 0..500u32 {
            let bound = f64::from(k * 7919 % 101);
            queue.push(QueuedTriangle { bound, triangle: k });
            if k % 3 == 0 {
                queue.pop();
            }
        }
        let mut last: Option<QueuedTriangle> = None;
        let mut count = 0;
        while let Some(e) = queue.first() {
            assert!(last.is_none_or(|l| l.is_before(&e)));
            (last, count) = (Some(e), count + 1);
            queue.pop();
        }
        assert_eq!(count, 500 - 167);
    }
}
