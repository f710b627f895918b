//! Feature `parallel`: work divided into halves. Without the feature, and with one thread, the
//! halves run one after the other.

/// The number of threads, and the least work that is worth waking a thread.
#[derive(Clone, Copy, Debug)]
pub(super) struct Threads {
    most: usize,
    least: usize,
}

impl Threads {
    /// All work in the caller's thread.
    pub(super) const ONE: Self = Self { most: 1, least: 1 };

    /// Returns the threads of the pool for a structure that uses threads from this number of
    /// bodies. Each thread gets at least a sixteenth of this number.
    pub(super) fn from(bodies: usize) -> Self {
        #[cfg(feature = "parallel")]
        let most = rayon::current_num_threads().max(1);
        #[cfg(not(feature = "parallel"))]
        let most = 1;
        Self {
            most,
            least: (bodies / 16).max(1),
        }
    }

    /// Returns how many threads share the given number of tasks.
    pub(super) fn sharing(self, things: usize) -> usize {
        self.most.min(things / self.least).max(1)
    }
}

/// Runs both closures, in parallel if threads are available. A thread outside the pool runs the
/// first closure itself. If it passed both to the pool, it would sleep while two pool threads wake
/// up, often on one core.
pub(super) fn join(a: impl FnOnce() + Send, b: impl FnOnce() + Send) {
    #[cfg(feature = "parallel")]
    if rayon::current_thread_index().is_some() {
        rayon::join(a, b);
    } else {
        rayon::in_place_scope(|scope| {
            scope.spawn(|_| b());
            a();
        });
    }
    #[cfg(not(feature = "parallel"))]
    {
        a();
        b();
    }
}

/// Returns whether `items` ascend strictly by `key`.
pub(super) fn ascends<T: Sync>(items: &[T], key: impl Fn(&T) -> u32 + Sync + Copy, threads: usize) -> bool {
    if threads > 1 && items.len() > 2 {
        // Halves share an item, so that every two neighbours are compared.
        let half = items.len() / 2;
        let (mut low, mut high) = (false, false);
        join(
            || low = ascends(&items[..=half], key, threads / 2),
            || high = ascends(&items[half..], key, threads - threads / 2),
        );
        return low && high;
    }
    items.is_sorted_by(|a, b| key(a) < key(b))
}

#[cfg(test)]
mod tests {
    use super::Threads;

    #[test]
    fn any_number_of_bodies_has_a_share() {
        for bodies in [0, 1, 15, 16, 1000, usize::MAX] {
            for things in [0, 1, 1000, usize::MAX] {
                assert!(Threads::from(bodies).sharing(things) >= 1);
            }
        }
    }
}
