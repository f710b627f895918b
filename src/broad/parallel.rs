//! Feature `parallel`: work in halves. Without the feature, and with one thread, one after the other.

/// How many threads there are, and how little is not worth waking one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Threads {
    most: usize,
    least: usize,
}

impl Threads {
    /// Everything in the caller's thread.
    pub(super) const ONE: Self = Self { most: 1, least: 1 };

    /// Those of the pool for a structure that uses them from so many bodies on: each is woken for no less than a sixteenth of
    /// that.
    pub(super) fn from(bodies: usize) -> Self {
        #[cfg(feature = "parallel")]
        return Self {
            most: rayon::current_num_threads().max(1),
            least: (bodies / 16).max(1),
        };
        #[cfg(not(feature = "parallel"))]
        return Self {
            least: bodies,
            ..Self::ONE
        };
    }

    /// How many share work on so many things.
    pub(super) fn sharing(self, things: usize) -> usize {
        self.most.min(things / self.least).max(1)
    }
}

/// Both, side by side if there are threads to spare. A thread outside the pool does the first itself: handing both over, it
/// would sleep while two others are woken, often on one core.
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

/// Whether `items` ascend by `key`, no two equal.
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
