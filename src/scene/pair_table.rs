//! Tables of pairs: one table for each level of detail, so that a pair uses memory only for the
//! enabled queries.
//!
//! ```text
//!              headers    trackers   answers
//! row 0        | a, b |   | .... |   | .... |
//! row 1        | a, b |   | .... |   | .... |     PairTable: three parallel lists
//! row n - 1    | a, b |   | .... |   | .... |     rows[slot of the pair] = (table, row)
//! ```
//!
//! The three lists of a table are parallel: a pair has the same row number in all three. Lists have
//! no gaps: the last pair moves to a row that becomes free. Pairs of two polyhedra have separate
//! tables: with one table of engines for all kinds, a step of 1,000 hulls took 1.06 to 1.27 times
//! as long (`race scene`, AMD EPYC, 2026-11-26).

use alloc::boxed::Box;
use alloc::vec::Vec;

use super::answers::{StoredAnswer, StoredContact};
use super::pair_engine::PairEngine;
use super::queries::{Detail, GroupPair, NEVER, PairPlan};
use crate::broad::PairId;
use crate::convex::contact::Manifold;
use crate::convex::tracker::Tracker;
#[cfg(feature = "meshes")]
use crate::nonconvex::contact::ContactGroup;
use crate::pair::outcome::{DepthMode, Distance, Outcome};
use crate::pair_tracker::geometry::Geometry;
use crate::pair_tracker::{Engine, TrackedPair};

/// The header of a pair, which is read before a query.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct PairHeader {
    /// Indices of the bodies, `a < b`.
    pub(super) a: u32,
    pub(super) b: u32,
    /// Id of the pair in the broad phase.
    pub(super) pair: PairId,
    pub(super) groups: GroupPair,
    pub(super) state: PairFlags,
    /// Sum of the odometers at which the pair is tested again; for a pair that sleeps, the number
    /// of the tick.
    pub(super) wake: f64,
}

/// Predicates of a pair at the last test.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct PairFlags {
    /// Whether the pair was tested since its plan last changed; if not, the other flags are older.
    pub(super) known: bool,
    pub(super) overlaps: bool,
    pub(super) within: bool,
    /// Whether the distance is within the range of the query, so that the table contains a result.
    pub(super) measured: bool,
    /// Whether the pair is proven separated until a tick.
    pub(super) sleeps: bool,
}

/// Pairs that store one kind of result.
#[derive(Clone, Debug)]
pub(super) struct PairTable<T, A> {
    pub(super) headers: Vec<PairHeader>,
    pub(super) trackers: Vec<T>,
    pub(super) answers: Vec<A>,
}

impl<T, A> Default for PairTable<T, A> {
    fn default() -> Self {
        Self {
            headers: Vec::new(),
            trackers: Vec::new(),
            answers: Vec::new(),
        }
    }
}

impl<T: PairEngine, A: StoredAnswer> PairTable<T, A> {
    fn push(&mut self, header: PairHeader, tracker: T) -> u32 {
        self.headers.push(header);
        self.trackers.push(tracker);
        self.answers.push(A::blank());
        (self.headers.len() - 1) as u32
    }

    /// Frees a row and moves the last pair of the table there. Returns the removed pair and the
    /// slot of the moved pair, if any.
    fn remove(&mut self, row: u32) -> (PairHeader, T, Option<u32>) {
        let i = row as usize;
        let header = self.headers.swap_remove(i);
        let tracker = self.trackers.swap_remove(i);
        self.answers.swap_remove(i);
        (header, tracker, self.headers.get(i).map(|moved| moved.pair.slot))
    }

    /// Returns the pair of a row for queries.
    fn view(&self, row: u32) -> Option<PairView<'_>> {
        let row = row as usize;
        let (header, answer, tracker) = (self.headers.get(row)?, &self.answers[row], &self.trackers[row]);
        Some(PairView {
            header,
            pieces: tracker.pieces(),
            distance: answer.distance().filter(|_| header.state.measured),
            outcome: answer.outcome().filter(|_| header.state.measured),
            manifold: answer.contacts().filter(|_| header.state.measured),
            #[cfg(feature = "meshes")]
            contacts: tracker.contacts().filter(|_| header.state.measured),
        })
    }

    fn is_parallel(&self) -> bool {
        [self.trackers.len(), self.answers.len()] == [self.headers.len(); 2]
    }

    fn bytes(&self) -> usize {
        let surfaces: usize = self.trackers.iter().map(T::memory_usage).sum();
        let manifolds = self.answers.iter().filter(|a| a.contacts().is_some()).count();
        self.headers.capacity() * size_of::<PairHeader>()
            + manifolds * size_of::<Manifold>()
            + self.trackers.capacity() * size_of::<T>()
            + self.answers.capacity() * size_of::<A>()
            + surfaces
    }

    /// Releases memory if most of the capacity is unused.
    fn trim(&mut self) {
        if self.headers.capacity() > 4 * self.headers.len() + 64 {
            self.headers.shrink_to(2 * self.headers.len());
            self.trackers.shrink_to(2 * self.trackers.len());
            self.answers.shrink_to(2 * self.answers.len());
        }
    }
}

/// Location of the pair of a slot. The four upper bits are the table. Below them is whether the
/// event of its boxes was sent, and the lower half is the row. There are fewer pairs than 2^32 at
/// once, so every row number fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct TableRow(u64);

const TABLE: u32 = 60;
const BOX_EVENT_SENT: u64 = 1 << 59;

/// Number of the first table of pairs that are not of two polyhedra.
const MIXED: u32 = 4;

impl TableRow {
    /// Entry of a pair with only the query `boxes`, and of a slot without a pair.
    const NONE: Self = Self(15 << TABLE);

    fn of(table: u32, row: u32) -> Self {
        Self(u64::from(table) << TABLE | u64::from(row))
    }

    fn table(self) -> u32 {
        (self.0 >> TABLE) as u32
    }

    fn row(self) -> u32 {
        self.0 as u32
    }

    fn is_box_event_sent(self) -> bool {
        self.0 & BOX_EVENT_SENT != 0
    }
}

/// State of a pair that moves from one table to another.
#[derive(Debug, Default)]
pub(super) struct PairState {
    pub(super) state: PairFlags,
    /// `None` for a pair that was in no table.
    pub(super) tracker: Option<TrackedPair>,
    /// Whether the event that the boxes met was sent.
    pub(super) box_event_sent: bool,
}

/// Read-only view of a pair for queries.
pub(super) struct PairView<'a> {
    pub(super) header: &'a PairHeader,
    pub(super) pieces: [u32; 2],
    pub(super) distance: Option<Distance>,
    pub(super) outcome: Option<&'a Outcome>,
    pub(super) manifold: Option<&'a Manifold>,
    #[cfg(feature = "meshes")]
    pub(super) contacts: Option<&'a [ContactGroup]>,
}

/// The tables of the pairs of one type of tracker, one for each level of detail that is stored.
#[derive(Clone, Debug)]
pub(super) struct DetailTables<T> {
    pub(super) predicates: PairTable<T, ()>,
    pub(super) distances: PairTable<T, Distance>,
    pub(super) features: PairTable<T, Outcome>,
    pub(super) contacts: PairTable<T, StoredContact>,
}

impl<T> Default for DetailTables<T> {
    fn default() -> Self {
        Self {
            predicates: PairTable::default(),
            distances: PairTable::default(),
            features: PairTable::default(),
            contacts: PairTable::default(),
        }
    }
}

impl<T: PairEngine> DetailTables<T> {
    /// Inserts a pair; returns the number of its table and the row.
    fn push(&mut self, plan: &PairPlan, header: PairHeader, mut tracker: T) -> Option<(u32, u32)> {
        if plan.until == DepthMode::None {
            tracker.free_memory();
        }
        if plan.detail != Detail::Manifold {
            tracker.drop_contacts();
        }
        Some(match plan.detail {
            Detail::Nothing | Detail::Boxes => return None,
            Detail::Predicates => (0, self.predicates.push(header, tracker)),
            Detail::Distance => (1, self.distances.push(header, tracker)),
            Detail::Features => (2, self.features.push(header, tracker)),
            Detail::Manifold => (3, self.contacts.push(header, tracker)),
        })
    }

    fn remove(&mut self, table: u32, row: u32) -> Option<(PairHeader, T, Option<u32>)> {
        match table {
            0 => Some(self.predicates.remove(row)),
            1 => Some(self.distances.remove(row)),
            2 => Some(self.features.remove(row)),
            3 => Some(self.contacts.remove(row)),
            _ => None,
        }
    }

    fn get(&self, table: u32, row: u32) -> Option<PairView<'_>> {
        match table {
            0 => self.predicates.view(row),
            1 => self.distances.view(row),
            2 => self.features.view(row),
            3 => self.contacts.view(row),
            _ => None,
        }
    }

    fn tracker(&self, table: u32, row: u32) -> Option<&T> {
        let trackers = [
            &self.predicates.trackers,
            &self.distances.trackers,
            &self.features.trackers,
            &self.contacts.trackers,
        ];
        trackers.get(table as usize)?.get(row as usize)
    }

    /// Returns the headers of the four tables.
    fn headers(&self) -> [&[PairHeader]; 4] {
        [
            &self.predicates.headers,
            &self.distances.headers,
            &self.features.headers,
            &self.contacts.headers,
        ]
    }

    /// Returns whether the lists of all tables are equally long.
    fn is_parallel(&self) -> bool {
        self.predicates.is_parallel()
            && self.distances.is_parallel()
            && self.features.is_parallel()
            && self.contacts.is_parallel()
    }

    fn trim(&mut self) {
        self.predicates.trim();
        self.distances.trim();
        self.features.trim();
        self.contacts.trim();
    }

    fn bytes(&self) -> usize {
        self.predicates.bytes() + self.distances.bytes() + self.features.bytes() + self.contacts.bytes()
    }
}

/// All tables, and the row of each slot.
#[derive(Clone, Debug, Default)]
pub(super) struct PairTables {
    /// Pairs of two polyhedra.
    pub(super) polyhedra: DetailTables<Tracker>,
    /// All other pairs.
    pub(super) mixed: DetailTables<Box<TrackedPair>>,
    rows: Vec<TableRow>,
}

impl PairTables {
    /// Inserts a pair into the table of its level of detail, and keeps the state that is still
    /// needed. Pairs with only the query `boxes` are not stored. The pair is tested in this step in
    /// any case.
    pub(super) fn insert(&mut self, plan: &PairPlan, header: PairHeader, pair_state: PairState) {
        let slot = header.pair.slot as usize;
        let state = PairFlags {
            overlaps: plan.overlap && pair_state.state.overlaps,
            within: plan.within != NEVER && pair_state.state.within,
            ..PairFlags::default()
        };
        let header = PairHeader { state, ..header };
        let place = match pair_state.tracker {
            Some(TrackedPair {
                engine: Engine::Polyhedra(engine),
                ..
            }) => self.polyhedra.push(plan, header, engine.tracker),
            Some(tracker) => {
                let place = self.mixed.push(plan, header, Box::new(tracker));
                place.map(|(table, row)| (table + MIXED, row))
            }
            None => None,
        };
        let row = place.map_or(TableRow::NONE, |(table, row)| TableRow::of(table, row));
        if slot >= self.rows.len() {
            self.rows.resize(slot + 1, TableRow::NONE);
        }
        self.rows[slot] = TableRow(row.0 | if plan.boxes { BOX_EVENT_SENT } else { 0 });
    }

    /// Removes the pair of a slot from its table, if stored.
    pub(super) fn remove(&mut self, slot: u32) -> PairState {
        let Some(entry) = self.rows.get_mut(slot as usize) else {
            return PairState::default();
        };
        let freed = core::mem::replace(entry, TableRow::NONE);
        let removed = if freed.table() < MIXED {
            let removed = self.polyhedra.remove(freed.table(), freed.row());
            removed.map(|(header, tracker, moved)| (header, Engine::of_polyhedra(tracker).into(), moved))
        } else {
            let removed = self.mixed.remove(freed.table() - MIXED, freed.row());
            removed.map(|(header, tracker, moved)| (header, *tracker, moved))
        };
        let box_event_sent = freed.is_box_event_sent();
        let Some((header, tracker, moved)) = removed else {
            return PairState {
                box_event_sent,
                ..PairState::default()
            };
        };
        if let Some(moved) = moved {
            // The last pair of the table moved to this row; its box event flag stays.
            let entry = &mut self.rows[moved as usize];
            *entry = TableRow(freed.0 & !BOX_EVENT_SENT | entry.0 & BOX_EVENT_SENT);
        }
        PairState {
            state: header.state,
            tracker: Some(tracker),
            box_event_sent,
        }
    }

    /// Returns the pair of a slot, if stored in a table.
    pub(super) fn get(&self, slot: u32) -> Option<PairView<'_>> {
        let entry = self.rows.get(slot as usize)?;
        let (table, row) = (entry.table(), entry.row());
        if table < MIXED {
            self.polyhedra.get(table, row)
        } else {
            self.mixed.get(table - MIXED, row)
        }
    }

    /// Returns an engine that starts with the state of the pair of a slot, for the two bodies in
    /// the order of the pair or in the opposite order.
    pub(super) fn started(&self, slot: u32, [a, b]: [&Geometry; 2], is_in_order: bool) -> Option<Engine> {
        let entry = self.rows.get(slot as usize)?;
        let (table, row) = (entry.table(), entry.row());
        if table < MIXED {
            self.polyhedra.tracker(table, row)?.started(a, b, is_in_order)
        } else {
            self.mixed.tracker(table - MIXED, row)?.started(a, b, is_in_order)
        }
    }

    /// Iterates over the slots whose box event was sent.
    #[cfg(feature = "serde")]
    pub(super) fn slots_with_box_event(&self) -> impl Iterator<Item = u32> + '_ {
        let rows = self.rows.iter().zip(0u32..);
        rows.filter(|(row, _)| row.is_box_event_sent()).map(|(_, slot)| slot)
    }

    /// Returns the table of the pair of a slot by its level of detail, if the pair is stored, and
    /// whether its box event was sent.
    pub(super) fn place(&self, slot: u32) -> (Option<u32>, bool) {
        let entry = self.rows.get(slot as usize).copied().unwrap_or(TableRow::NONE);
        let table = (entry.table() != TableRow::NONE.table()).then_some(entry.table() % MIXED);
        (table, entry.is_box_event_sent())
    }

    /// Returns whether every pair of the tables is found by its slot, and every slot finds a pair.
    pub(super) fn is_consistent(&self) -> bool {
        let tables = self.polyhedra.headers().into_iter().chain(self.mixed.headers());
        let rows = (0u32..).zip(tables).flat_map(|(table, headers)| {
            let rows = headers.iter().zip(0u32..);
            rows.map(move |(header, row)| (header.pair.slot, TableRow::of(table, row)))
        });
        let is_found = |(slot, row): (u32, TableRow)| {
            let entry = self.rows.get(slot as usize);
            entry.is_some_and(|entry| entry.0 & !BOX_EVENT_SENT == row.0)
        };
        let stored = self.rows.iter().filter(|row| row.table() != TableRow::NONE.table());
        self.polyhedra.is_parallel()
            && self.mixed.is_parallel()
            && stored.count() == self.headers().count()
            && rows.into_iter().all(is_found)
    }

    /// Iterates over the pairs of all tables.
    pub(super) fn headers(&self) -> impl Iterator<Item = &PairHeader> {
        let all = self.polyhedra.headers().into_iter().chain(self.mixed.headers());
        all.flatten()
    }

    /// Rebuilds the rows of restored tables; returns `None` if two pairs have one slot. Slots are
    /// from the broad phase.
    #[cfg(feature = "serde")]
    pub(super) fn restored(
        polyhedra: DetailTables<Tracker>,
        mixed: DetailTables<Box<TrackedPair>>,
        box_event_sent: &[u32],
        slots: usize,
    ) -> Option<Self> {
        let mut rows = alloc::vec![TableRow::NONE; slots];
        let tables = polyhedra.headers().into_iter().chain(mixed.headers());
        for (table, headers) in (0u32..).zip(tables) {
            for (header, row) in headers.iter().zip(0u32..) {
                let entry = rows.get_mut(header.pair.slot as usize)?;
                if *entry != TableRow::NONE {
                    return None;
                }
                *entry = TableRow::of(table, row);
            }
        }
        for slot in box_event_sent {
            let entry = rows.get_mut(*slot as usize)?;
            *entry = TableRow(entry.0 | BOX_EVENT_SENT);
        }
        Some(Self { polyhedra, mixed, rows })
    }

    pub(super) fn trim(&mut self) {
        self.polyhedra.trim();
        self.mixed.trim();
    }

    pub(super) fn bytes(&self) -> usize {
        self.polyhedra.bytes() + self.mixed.bytes() + self.rows.capacity() * size_of::<TableRow>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_keep_table_number_and_flag_apart() {
        for table in [0, 3, 7] {
            for row in [0, 1, (1 << 28) - 1, 1 << 28, (1 << 29) + 5, u32::MAX] {
                for box_event_sent in [0, BOX_EVENT_SENT] {
                    let entry = TableRow(TableRow::of(table, row).0 | box_event_sent);
                    assert_eq!(
                        (entry.table(), entry.row(), entry.is_box_event_sent()),
                        (table, row, box_event_sent != 0)
                    );
                    assert_ne!(entry, TableRow::NONE);
                }
            }
        }
    }
}
