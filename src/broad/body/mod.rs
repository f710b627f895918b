//! The table of bodies: ids with generations, the stored boxes of this step and the last, and the
//! lists of moved bodies.
//!
//! A box that a caller sets, alone or in a batch, is checked, extended by the options of its body
//! and stored. If it changed, the body is listed.

mod record;
#[cfg(feature = "serde")]
mod state;

use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use crate::broad::aabb::{Aabb, BoxFault, FARTHEST, StoredBox};
pub(crate) use crate::broad::body::record::{FIXED, JUMPS, MIGRATES, Record, UNBOUNDED};
use crate::broad::body::record::{LOOSE, NOTED};
#[cfg(feature = "serde")]
pub(crate) use crate::broad::body::state::BodiesState;
use crate::broad::error::BroadPhaseError;
use crate::broad::grid::{Grid, Range};
use crate::broad::parallel::{Threads, ascends, join};
use crate::broad::simd_box::{Bounds, any_above};
use crate::broad::slots::{Slots, is_living};
use crate::broad::tables::read_ahead;
use crate::broad::tables::{push, trim};
use crate::broad::{BatchError, BodyOptions, Groups};
use alloc::vec::Vec;
use core::fmt;
use nalgebra::Point3;
use wide::f32x4;

/// Id of a body in one broad phase. After a removal the index is used again, with another
/// generation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BodyId {
    /// Index in tables; less than 2^31.
    pub index: u32,
    /// Odd for every body that ever lived.
    pub generation: u32,
}

impl fmt::Display for BodyId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "body {} (generation {})", self.index, self.generation)
    }
}

/// Largest number of bodies: one bit of a 32-bit index serves as a flag inside columns.
const MOST_BODIES: usize = (1 << 31) - 1;

/// Options of a body, which only events and newly computed boxes read.
#[derive(Clone, Copy, Debug)]
struct BodyDetail {
    groups: Groups,
    growth: f32,
    lookahead: f32,
    fixed: bool,
}

impl BodyDetail {
    fn new(body: BodyOptions) -> Self {
        let (growth, lookahead) = (body.growth as f32, body.lookahead as f32);
        Self {
            groups: body.groups,
            growth,
            lookahead,
            fixed: body.fixed,
        }
    }

    fn body(&self) -> BodyOptions {
        let (growth, lookahead) = (f64::from(self.growth), f64::from(self.lookahead));
        BodyOptions {
            groups: self.groups,
            fixed: self.fixed,
            growth,
            lookahead,
        }
    }
}

/// Bodies that changed since the last step.
#[derive(Clone, Debug, Default)]
#[repr(align(128))] // threads write into neighbours: none shall share cache lines
pub(crate) struct Marks {
    /// Bodies whose stored box differs from the box of the last step, in the order of the calls.
    pub(crate) moved: Vec<u32>,
    /// Moved bodies that may have changed columns.
    pub(crate) noted: Vec<u32>,
}

impl Marks {
    /// Moves all entries of `other` here; `other` keeps its memory.
    fn append(&mut self, other: &mut Self) {
        trim(&mut other.moved);
        trim(&mut other.noted);
        self.moved.append(&mut other.moved);
        self.noted.append(&mut other.noted);
    }
}

/// All bodies of one broad phase.
#[derive(Clone, Debug)]
pub(crate) struct Bodies {
    pub(crate) records: Vec<Record>,
    details: Vec<BodyDetail>,
    /// Ids; the pairs of removed bodies end with the next step.
    pub(crate) slots: Slots,
    /// Bodies whose groups changed: groups and filter are tested again for their pairs.
    pub(crate) regrouped: Vec<u32>,
    pub(crate) unbounded: Vec<u32>,
    pub(crate) marks: Marks,
    /// Marks made by single threads; empty between calls.
    shares: Vec<Marks>,
    /// Number of the step being prepared; never 0.
    pub(crate) step: u32,
    pub(crate) origin: Point3<f64>,
    pub(crate) grid: Grid,
    /// Largest number of bodies; less in tests.
    pub(super) most: usize,
}

impl Bodies {
    pub(crate) fn new(origin: Point3<f64>) -> Self {
        Self {
            records: Vec::new(),
            details: Vec::new(),
            slots: Slots::default(),
            regrouped: Vec::new(),
            unbounded: Vec::new(),
            marks: Marks::default(),
            shares: Vec::new(),
            step: 1,
            origin,
            grid: Grid::single(0),
            most: MOST_BODIES,
        }
    }

    /// Returns the number of living bodies.
    pub(crate) fn len(&self) -> usize {
        self.slots.len()
    }

    pub(crate) fn insert(
        &mut self,
        stored: StoredBox,
        body: BodyOptions,
        flags: u32,
    ) -> Result<BodyId, BroadPhaseError> {
        body.check()?;
        let index = self.vacant()?;
        let i = index as usize;
        let id = self.slots.begin(index);
        self.details[i] = BodyDetail::new(body);
        let is_loose = body.growth > 0.0 || body.lookahead > 0.0;
        let kind = if is_loose { LOOSE } else { 0 } | if body.fixed { FIXED } else { 0 };
        // Otherwise loose boxes that are inserted together would all be computed again together, in
        // waves.
        let stored = if is_loose {
            grown(&stored, body.growth as f32 * fraction(index))
        } else {
            stored
        };
        let bounds = Bounds::from_box(&stored);
        let record = &mut self.records[i];
        *record = Record::new(&bounds, self.step, flags | kind);
        self.marks.moved.push(index);
        if flags & UNBOUNDED != 0 {
            self.unbounded.push(index);
        } else {
            record.set_range(self.grid.range(&bounds));
            record.raise(NOTED);
            self.marks.noted.push(index);
        }
        Ok(id)
    }

    /// Returns a free index for a new body, unless there are too many bodies.
    fn vacant(&mut self) -> Result<u32, BroadPhaseError> {
        let index = self.slots.vacant(self.most).ok_or(BroadPhaseError::TooManyBodies)?;
        if index as usize == self.records.len() {
            push(&mut self.records, Record::absent());
            push(&mut self.details, BodyDetail::new(BodyOptions::default()));
        }
        Ok(index)
    }

    /// Removes a body. Its id is stale at once. Its box becomes empty, so the next step ends every
    /// pair of the body.
    pub(crate) fn remove(&mut self, id: BodyId) -> Result<(), BroadPhaseError> {
        let i = self.index_of(id)?;
        self.slots.remove(id.index);
        let step = self.step;
        let record = &mut self.records[i];
        record.touch(id.index, step, &mut self.marks.moved);
        record.set_new(&Bounds::from_box(&StoredBox::EMPTY));
        record.set_range(Range::NONE);
        if record.flags() & (NOTED | UNBOUNDED) == 0 {
            record.raise(NOTED);
            self.marks.noted.push(id.index);
        }
        Ok(())
    }

    pub(crate) fn set_box(&mut self, id: BodyId, aabb: &Aabb) -> Result<(), BroadPhaseError> {
        let i = self.index_of(id)?;
        let context = PlaceContext {
            origin: &self.origin,
            grid: &self.grid,
            details: &self.details,
            step: self.step,
        };
        let (record, marks) = (&mut self.records[i], &mut self.marks);
        let placed = match self.grid.axis {
            0 => context.place::<0>(record, id.index, aabb, marks),
            1 => context.place::<1>(record, id.index, aabb, marks),
            _ => context.place::<2>(record, id.index, aabb, marks),
        };
        placed.map_err(|error| BroadPhaseError::from_fault(error, Some(id)))
    }

    /// Returns the stored form of a box that no body has yet; the box must be finite unless the
    /// flags allow infinity.
    pub(crate) fn stored(&self, aabb: &Aabb, flags: u32) -> Result<StoredBox, BroadPhaseError> {
        checked(aabb, &self.origin, &self.grid, flags).map_err(|error| BroadPhaseError::from_fault(error, None))
    }

    pub(crate) fn index_of(&self, id: BodyId) -> Result<usize, BroadPhaseError> {
        self.slots.index_of(id).ok_or(BroadPhaseError::StaleId { body: id })
    }

    /// Returns the id of the body at `index`. Until the next step, a removed body keeps its id.
    pub(crate) fn id(&self, index: u32) -> BodyId {
        self.slots.id(index)
    }

    pub(crate) fn lives(&self, index: u32) -> bool {
        self.slots.lives(index)
    }

    /// Returns the options of a body.
    pub(crate) fn body(&self, index: u32) -> BodyOptions {
        self.details[index as usize].body()
    }

    pub(crate) fn set_groups(&mut self, id: BodyId, groups: Option<Groups>) -> Result<(), BroadPhaseError> {
        let i = self.index_of(id)?;
        if let Some(groups) = groups {
            self.details[i].groups = groups;
        }
        self.regrouped.push(id.index);
        Ok(())
    }

    /// Returns whether the options of two bodies allow a pair.
    #[inline]
    pub(crate) fn may_pair(&self, a: u32, b: u32) -> bool {
        let [a, b] = [a, b].each(|i| &self.details[i as usize]);
        if a.fixed && b.fixed {
            a.groups.meet_fixed(b.groups)
        } else {
            a.groups.meet(b.groups)
        }
    }

    /// Prefetches the data that [`may_pair`](Self::may_pair) and [`id`](Self::id) read of these
    /// bodies.
    pub(crate) fn read_ahead(&self, indices: impl Iterator<Item = u32>) {
        let generations = self.slots.generations();
        read_ahead(
            self.details.len(),
            indices.map(|i| self.details[i as usize].groups.member_of ^ generations[i as usize]),
        );
    }

    /// Iterates over the ids of all living bodies.
    pub(crate) fn ids(&self) -> impl Iterator<Item = BodyId> {
        self.slots.ids()
    }

    /// Computes the columns of every body in another grid, and lists all bodies that change
    /// columns.
    pub(crate) fn set_grid(&mut self, grid: Grid) {
        let turn = (3 + grid.axis - self.grid.axis) % 3;
        self.marks.noted.clear();
        for (i, record) in self.records.iter_mut().enumerate() {
            record.rotate(turn);
            if record.flags() & UNBOUNDED != 0 {
                continue;
            }
            record.set_range(if record.present() {
                grid.range(&record.now())
            } else {
                Range::NONE
            });
            record.lower(NOTED);
            if record.moved(self.step) {
                record.raise(NOTED);
                self.marks.noted.push(i as u32);
            }
        }
        self.grid = grid;
    }

    /// Decides for every listed body which entries it has in its columns in this step.
    pub(crate) fn classify(&mut self) {
        let (step, grid) = (self.step, &self.grid);
        for &index in &self.marks.noted {
            let record = &mut self.records[index as usize];
            let stays = record.present() && record.present_before(step);
            let jumps = stays && any_above(record.before(step).displacement(&record.now()), grid.leap);
            let migrates = record.range_before(step, grid) != record.range();
            record.lower(MIGRATES | JUMPS);
            record.raise(if jumps { JUMPS } else { 0 } | if migrates { MIGRATES } else { 0 });
        }
    }

    /// Ends the step: the new boxes become the old ones, indices of removed bodies become free.
    pub(crate) fn end_step(&mut self) {
        trim(&mut self.marks.noted);
        trim(&mut self.marks.moved);
        for index in self.marks.noted.drain(..) {
            self.records[index as usize].lower(NOTED | MIGRATES | JUMPS);
        }
        self.marks.moved.clear();
        self.regrouped.clear();
        let (slots, records) = (&mut self.slots, &mut self.records);
        if slots.has_leaving() {
            self.unbounded.retain(|&i| slots.lives(i));
        }
        slots.end_step(|index| records[index] = Record::absent());
        self.step = match self.step.checked_add(1) {
            Some(next) => next,
            None => {
                self.records.iter_mut().for_each(|r| r.set_stamp(0));
                1
            }
        };
    }

    /// Returns the bytes reserved for bodies.
    pub(crate) fn bytes(&self) -> usize {
        let lists = [&self.regrouped, &self.unbounded];
        let marks = self.shares.iter().chain([&self.marks]);
        self.records.capacity() * size_of::<Record>()
            + self.details.capacity() * size_of::<BodyDetail>()
            + self.slots.bytes()
            + lists
                .into_iter()
                .chain(marks.flat_map(|m| [&m.moved, &m.noted]))
                .map(|l| l.capacity() * 4)
                .sum::<usize>()
    }
}

/// The input for storing a box, in addition to the record.
struct PlaceContext<'a> {
    origin: &'a Point3<f64>,
    grid: &'a Grid,
    details: &'a [BodyDetail],
    step: u32,
}

impl PlaceContext<'_> {
    /// Stores a new box and records changes. Returns the error of the box, if any. `AXIS` must be
    /// the swept axis of the grid.
    #[inline(always)]
    fn place<const AXIS: usize>(
        &self,
        record: &mut Record,
        index: u32,
        aabb: &Aabb,
        marks: &mut Marks,
    ) -> Result<(), BoxFault> {
        match Bounds::outward::<AXIS>(aabb, self.origin) {
            Some(bounds) => {
                self.store(record, index, bounds, marks);
                Ok(())
            }
            None => self.place_slowly(record, index, aabb, marks),
        }
    }

    /// Handles invalid, unbounded and far boxes. The two paths must not join before the box is
    /// stored. Otherwise the box of the fast path would go through memory, written and read in
    /// units of different sizes, which costs as much as everything else together.
    #[inline(never)]
    fn place_slowly(&self, record: &mut Record, index: u32, aabb: &Aabb, marks: &mut Marks) -> Result<(), BoxFault> {
        let stored = checked(aabb, self.origin, self.grid, record.flags())?;
        self.store(record, index, Bounds::from_box(&stored), marks);
        Ok(())
    }

    /// Stores new bounds. The common case touches only the record.
    #[inline(always)]
    fn store(&self, record: &mut Record, index: u32, given: Bounds, marks: &mut Marks) {
        let present = record.now();
        let mut bounds = given;
        if record.flags() & LOOSE != 0 {
            if present.contains(&given) {
                return;
            }
            bounds = self.loosened(record, index, given);
        }
        let by = present.displacement(&bounds);
        if !any_above(by, f32x4::ZERO) {
            return;
        }
        record.touch(index, self.step, &mut marks.moved);
        record.set_new(&bounds);
        if record.flags() & UNBOUNDED != 0 {
            return;
        }
        let range = self.grid.range(&bounds);
        let far = any_above(by, self.grid.leap);
        if (range != record.range()) | far {
            record.set_range(range);
            if record.flags() & NOTED == 0 {
                record.raise(NOTED);
                marks.noted.push(index);
            }
        }
    }

    /// Returns the given box, extended by the options of the body.
    #[inline(never)]
    fn loosened(&self, record: &Record, index: u32, given: Bounds) -> Bounds {
        let Some(detail) = self.details.get(index as usize) else {
            return given;
        };
        let (given, present) = (given.to_box(), record.now().to_box());
        let mut stored = grown(&given, detail.growth);
        let steps = self.step.wrapping_sub(record.stamp()).max(1) as f32;
        let ahead = detail.lookahead / steps;
        if ahead > 0.0 {
            for k in 0..3 {
                let travel = 0.5 * (given.lo[k] - present.lo[k] + given.hi[k] - present.hi[k]) * ahead;
                stored.lo[k] = (stored.lo[k] + travel.at_most(0.0)).at_least(-FARTHEST);
                stored.hi[k] = (stored.hi[k] + travel.at_least(0.0)).at_most(FARTHEST);
            }
        }
        Bounds::from_box(&stored)
    }
}

/// Returns the stored form of a valid box.
fn checked(aabb: &Aabb, origin: &Point3<f64>, grid: &Grid, flags: u32) -> Result<StoredBox, BoxFault> {
    if flags & UNBOUNDED == 0 {
        aabb.finite()?;
    } else {
        aabb.ordered()?;
    }
    Ok(StoredBox::outward(aabb, origin).rotated(grid.axis))
}

fn grown(stored: &StoredBox, growth: f32) -> StoredBox {
    let mut out = *stored;
    for k in 0..3 {
        out.lo[k] = (stored.lo[k] - growth).at_least(-FARTHEST);
        out.hi[k] = (stored.hi[k] + growth).at_most(FARTHEST);
    }
    out
}

/// Returns a fixed number in (0, 1] for each index, evenly spread.
fn fraction(index: u32) -> f32 {
    (index.wrapping_mul(2_654_435_769) >> 8) as f32 / (1 << 24) as f32
}

/// A run of records that starts at index `first`.
struct BodyRun<'a> {
    first: u32,
    records: &'a mut [Record],
    generations: &'a [u32],
}

impl Bodies {
    /// Applies every valid entry; the error reports the invalid entries.
    pub(crate) fn set_boxes(&mut self, batch: &[(BodyId, Aabb)], threads: Threads) -> Result<(), BatchError> {
        let threads = threads.sharing(batch.len());
        let error = match self.grid.axis {
            0 => self.set_boxes_in::<0>(batch, threads),
            1 => self.set_boxes_in::<1>(batch, threads),
            _ => self.set_boxes_in::<2>(batch, threads),
        };
        error.map_or(Ok(()), Err)
    }

    fn set_boxes_in<const AXIS: usize>(&mut self, batch: &[(BodyId, Aabb)], threads: usize) -> Option<BatchError> {
        let context = PlaceContext {
            origin: &self.origin,
            grid: &self.grid,
            details: &self.details,
            step: self.step,
        };
        let run = BodyRun {
            first: 0,
            records: &mut self.records,
            generations: self.slots.generations(),
        };
        // Records can be distributed to threads only if each half of the batch refers to one half
        // of the table.
        if threads > 1 && ascends(batch, |entry| entry.0.index, threads) {
            self.shares.resize_with(threads.max(self.shares.len()), Marks::default);
            let shares = &mut self.shares[..threads];
            let error = split::<AXIS>(&context, run, batch, shares);
            shares.iter_mut().for_each(|share| self.marks.append(share));
            return error;
        }
        run.apply::<AXIS>(&context, batch, &mut self.marks)
    }
}

/// Halves batch and table until every thread has a separate range and separate marks. The marks are
/// joined in order, so the result equals that of one thread.
fn split<const AXIS: usize>(
    context: &PlaceContext<'_>,
    run: BodyRun<'_>,
    batch: &[(BodyId, Aabb)],
    shares: &mut [Marks],
) -> Option<BatchError> {
    let half = batch.len() / 2;
    if shares.len() <= 1 || half == 0 {
        let marks = shares.first_mut()?;
        return run.apply::<AXIS>(context, batch, marks);
    }
    let (low, high) = batch.split_at(half);
    let border = (high[0].0.index - run.first) as usize;
    let border = border.min(run.records.len());
    let (records_low, records_high) = run.records.split_at_mut(border);
    let (generations_low, generations_high) = run.generations.split_at(border);
    let run_low = BodyRun {
        first: run.first,
        records: records_low,
        generations: generations_low,
    };
    let run_high = BodyRun {
        first: run.first + border as u32,
        records: records_high,
        generations: generations_high,
    };
    let (shares_low, shares_high) = shares.split_at_mut(shares.len() / 2);
    let (mut error_low, mut error_high) = (None, None);
    join(
        || error_low = split::<AXIS>(context, run_low, low, shares_low),
        || error_high = split::<AXIS>(context, run_high, high, shares_high),
    );
    let error_high = error_high.map(|e| BatchError {
        index: e.index + half,
        ..e
    });
    BatchError::joined(error_low, error_high)
}

impl BodyRun<'_> {
    fn apply<const AXIS: usize>(
        self,
        context: &PlaceContext<'_>,
        batch: &[(BodyId, Aabb)],
        marks: &mut Marks,
    ) -> Option<BatchError> {
        let mut error = None;
        for (place, (id, aabb)) in batch.iter().enumerate() {
            let i = id.index.wrapping_sub(self.first) as usize;
            let is_living = is_living(self.generations, i, *id);
            let Some(record) = self.records.get_mut(i).filter(|_| is_living) else {
                let stale = BroadPhaseError::StaleId { body: *id };
                error = BatchError::joined(error, Some(BatchError::one(place, stale)));
                continue;
            };
            if let Err(fault) = context.place::<AXIS>(record, id.index, aabb, marks) {
                let fault = BroadPhaseError::from_fault(fault, Some(*id));
                error = BatchError::joined(error, Some(BatchError::one(place, fault)));
            }
        }
        error
    }
}
