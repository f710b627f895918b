//! Whether a front pays: the work of the queries that kept one beside the work of a search without.
//!
//! Bodies held in several places, and long parts that turn fast, lose so many directions from frame
//! to frame that a front costs more than a search anew. Such a front is dropped, and after some
//! searches, twice as many each time, another one is tried.

use crate::composite::work::MeshWork;

/// Entries of a front that are tested in the time of one bound of boxes; and how many such bounds a
/// pair of leaves and a pair of triangles take: by profiles of tumbling gears, roughly.
const ENTRY_WORK: u64 = 16;
const LEAF_WORK: u64 = 4;
const MEASURE_WORK: u64 = 8;

/// Most searches between a front that did not pay and the next one that is tried. Not measured.
const LONGEST_WAIT: u32 = 63;

/// What fronts have been worth lately.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::composite) struct FrontWorth {
    /// The work of the last search without a front; zero before the first.
    search: u64,
    /// Searches to go before a front is tried.
    left: u32,
    /// Searches between the last front and this one.
    wait: u32,
}

impl FrontWorth {
    /// Returns the work of a query, in bounds of boxes.
    pub(in crate::composite) fn work(done: &MeshWork) -> u64 {
        done.bounds + done.entries / ENTRY_WORK + LEAF_WORK * done.leaves + MEASURE_WORK * done.measured
    }

    /// Returns whether the search to come is to keep a front.
    pub(in crate::composite) fn is_due(&mut self) -> bool {
        let is_due = self.left == 0;
        self.left = self.left.saturating_sub(1);
        is_due
    }

    /// Takes the work of a search without a front.
    pub(in crate::composite) fn searched(&mut self, work: u64) {
        self.search = work;
    }

    /// Returns whether work with a front is more than a search takes.
    pub(in crate::composite) fn is_dearer(&self, work: u64) -> bool {
        self.search > 0 && work > self.search
    }

    /// A front paid: the next one is tried at once.
    pub(in crate::composite) fn paid(&mut self) {
        self.wait = 0;
    }

    /// A front did not pay.
    pub(in crate::composite) fn lost(&mut self) {
        self.wait = (2 * self.wait + 1).min(LONGEST_WAIT);
        self.left = self.wait;
    }

    /// A front grew too long before it was whole: the next one is far off.
    pub(in crate::composite) fn overflowed(&mut self) {
        self.wait = LONGEST_WAIT;
        self.left = self.wait;
    }
}
