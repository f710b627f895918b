//! Sweep and prune over columns: the world is divided into columns along the swept axis, and each
//! column has a sorted list. This file holds the step, the queries about the boxes of the last
//! step, and the check of the columns.

mod column;
mod repair;
mod scan;
mod tune;

use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use crate::base::tolerance::COLUMN_SEARCH;
use crate::broad::aabb::{StoredBox, order_key};
use crate::broad::body::{Bodies, JUMPS, Record, UNBOUNDED};
use crate::broad::change::note_unbounded;
use crate::broad::grid::Grid;
use crate::broad::parallel::{Threads, join};
use crate::broad::simd_box::Bounds;
use crate::broad::state::{BroadPhaseState, nearest};
use crate::broad::sweep::column::{Column, entry, index_of, who};
use crate::broad::sweep::repair::Touch;
use crate::broad::sweep::scan::Worker;
use crate::broad::sweep::tune::{StepCounts, Tuning};
use crate::broad::{
    Aabb, BatchError, BodyId, BodyOptions, BroadPhaseError, Events, Groups, Nearest, Pair, PairId, Settings,
};
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

/// All columns are swept if the number of moved bodies times this factor exceeds the number of all
/// bodies. A sweep and repairs cost the same if about 9 % of the bodies move.
const WORLD_SHARE: usize = 10;

/// The broad phase: sweep and prune over columns.
///
/// The world is divided into columns along the swept axis, and each column has a sorted list.
///
/// ```text
///    v ^   +------+------+------+        a column seen end on, along the swept axis
///      |   |    +-|--+   |      |        a box is listed in every column it touches
///      |   |    | |  |   |      |        a pair belongs to the column that holds the lower corner
///      |   +----|-+--|---+------+        of its intersection, so that it is found exactly once
///      |   |    +-|--+   |      |
///      |   +------+------+------+--> u
/// ```
///
/// Baraff 1992 (thesis, section 2.3), Lin 1993 (thesis, section 2.4) and Cohen, Lin, Manocha,
/// Ponamgi 1995 (I-COLLIDE, section 4) keep boxes sorted along the axes by insertion sort, which is
/// cheap because little changes between steps. The insertion sort is the same here. Departures:
///
/// 1. One axis is swept, not three, and only inside columns (Tracy, Buss, Woods 2009 subdivide in
///    the same way). At constant density the exchanges of a whole sorted axis grow as n^(5/3) over
///    all bodies, and bodies on a flat floor exchange positions on the vertical axis all the time.
///    Inside columns both are constant per body.
/// 2. Only lower bounds are sorted. The upper bound ends the window of a body (Terdiman's box
///    pruning).
/// 3. The window is tested for changes of overlap, not for overlap (`scan`), eight entries at once.
///    There are no flags per pair and no set of found pairs, so storage grows with bodies and
///    overlapping pairs only.
/// 4. If few boxes changed, only their entries and windows are scanned (`repair`), column by
///    column. Each column is swept or repaired, whichever is cheaper; the results are equal.
/// 5. The counts of a sweep determine the axis and the column width (`tune`). They are checked less
///    often the longer they remain right, and at once if a step compares several times as many
///    entries as there are.
///
/// Cost of a step: if most boxes move, proportional to the number of entries; otherwise to the
/// number of moved boxes and their windows. The worst case is n^2, if all boxes overlap on all axes
/// except those that do not help, as in a stack of wide thin plates swept along the wrong axis.
#[doc(alias = "sap")]
#[doc(alias = "bvh")]
#[doc(alias = "sweep and prune")]
#[derive(Clone, Debug)]
pub struct SweepAndPrune {
    pub(super) state: BroadPhaseState,
    columns: Vec<Column>,
    workers: Vec<Worker>,
    touched: Vec<Touch>,
    tuning: Tuning,
    /// Entries of all columns after the last full sweep.
    entries: usize,
    /// Positions by which entries moved in the last step.
    swaps: u64,
    /// Entries compared with the entries of windows in the last step.
    scanned: u64,
    pub(super) parallel_from: usize,
}

impl SweepAndPrune {
    /// Returns an empty broad phase around the origin.
    #[must_use]
    pub fn new() -> Self {
        Self::with_settings(Settings::default())
    }

    /// Returns an empty broad phase with the given settings.
    #[must_use]
    pub fn with_settings(settings: Settings) -> Self {
        Self::from_state(BroadPhaseState::new(settings.origin), settings.parallel_from)
    }

    /// Returns a structure with these bodies and pairs, all in one column until the first step.
    pub(super) fn from_state(state: BroadPhaseState, parallel_from: usize) -> Self {
        let first = Column::of_all(&state.bodies);
        Self {
            state,
            columns: Vec::from([first]),
            workers: Vec::from([Worker::default()]),
            touched: Vec::new(),
            tuning: Tuning::new(),
            entries: 0,
            swaps: 0,
            scanned: 0,
            parallel_from,
        }
    }

    /// Returns by how many positions entries of the sorted lists moved in the last step. These are
    /// the exchanges of the insertion sort.
    #[must_use]
    pub fn swaps(&self) -> u64 {
        self.swaps
    }

    /// Returns the number of entries compared with windows in the last step, a measure of its work.
    /// A sweep compares, and counts, eight entries at once.
    #[must_use]
    pub fn scanned(&self) -> u64 {
        self.scanned
    }

    fn threads(&self) -> Threads {
        if self.state.bodies.len() >= self.parallel_from {
            Threads::from(self.parallel_from)
        } else {
            Threads::ONE
        }
    }

    /// Returns the number of workers that share the given number of tasks.
    fn engage(&mut self, things: usize) -> usize {
        let threads = self.threads().sharing(things);
        self.workers
            .resize_with(threads.max(self.workers.len()), Worker::default);
        threads
    }

    /// Divides the world into new columns, and lists every body in the columns that this step
    /// needs.
    fn rebuild(&mut self, grid: Grid) {
        self.state.bodies.set_grid(grid);
        self.state.bodies.classify();
        self.columns.iter_mut().for_each(|c| {
            *c = Column {
                entries: core::mem::take(&mut c.entries),
                ..Column::default()
            }
        });
        self.columns.iter_mut().for_each(|c| c.entries.clear());
        self.columns
            .resize_with(self.state.bodies.grid.column_count(), Column::default);
        let bodies = &self.state.bodies;
        for (i, record) in bodies.records.iter().enumerate() {
            if record.flags() & UNBOUNDED != 0 {
                continue;
            }
            let old = record.range_before(bodies.step, &bodies.grid);
            for cell in old.columns() {
                self.columns[bodies.grid.index(cell)]
                    .entries
                    .push(u64::from(who(i as u32, 0)));
            }
        }
        self.list_arrivals();
    }

    /// Adds the bodies that may have changed columns to their new columns.
    fn list_arrivals(&mut self) {
        let bodies = &self.state.bodies;
        for &index in &bodies.marks.noted {
            let record = &bodies.records[index as usize];
            let old = record.range_before(bodies.step, &bodies.grid);
            let jumps = record.flags() & JUMPS != 0;
            for cell in record.range().columns().filter(|cell| jumps || !old.contains(*cell)) {
                self.columns[bodies.grid.index(cell)].arrive(index);
            }
        }
    }

    /// Returns the number of entries of all columns after [`list_arrivals`](Self::list_arrivals).
    fn entries_to_be(&self) -> usize {
        let records = &self.state.bodies.records;
        let coming: usize = self
            .state
            .bodies
            .marks
            .noted
            .iter()
            .map(|&i| records[i as usize].range().count())
            .sum();
        self.entries + coming
    }

    fn sweep_all(&mut self) {
        let total: usize = self.columns.iter().map(|c| c.entries.len()).sum();
        self.entries = total;
        let threads = self.engage(total);
        let counting = self.tuning.wants_counts();
        self.workers.iter_mut().for_each(|w| w.counting = counting);
        let bodies = &self.state.bodies;
        sweep_columns(&mut self.workers[..threads], &mut self.columns, 0, total, bodies);
        let mut counts = StepCounts::default();
        for worker in &mut self.workers {
            counts.add(core::mem::take(&mut worker.counts));
        }
        self.collect();
        self.tuning.observe(&self.state.bodies, counts, total);
    }

    fn repair_touched(&mut self) {
        repair::list_touched(&self.state.bodies, &mut self.touched);
        let threads = self.engage(self.touched.len());
        self.workers.iter_mut().for_each(|w| w.counting = false);
        let workers = &mut self.workers[..threads];
        repair_columns(workers, &mut self.columns, 0, &self.touched, &self.state.bodies);
        self.collect();
    }

    fn collect(&mut self) {
        for worker in &mut self.workers {
            self.state.changes.append(&mut worker.changes);
            worker.counts = StepCounts::default();
            self.swaps += core::mem::take(&mut worker.swaps);
            self.scanned += core::mem::take(&mut worker.scanned);
        }
    }

    fn find_changes(&mut self) {
        (self.swaps, self.scanned) = (0, 0);
        self.state.changes.clear();
        self.state.bodies.classify();
        let entries = self.entries_to_be();
        if let Some(grid) = self.tuning.due(&self.state.bodies, entries) {
            self.rebuild(grid);
            self.sweep_all();
        } else if self.state.bodies.marks.moved.len() * WORLD_SHARE > self.state.bodies.len() {
            self.list_arrivals();
            self.sweep_all();
        } else {
            self.repair_touched();
            self.tuning.watch(self.scanned as f64 / self.state.bodies.len() as f64);
        }
        note_unbounded(&self.state.bodies, &mut self.state.changes);
    }
}

/// Sweeps columns with as many threads as there are workers. Each worker takes a run of columns
/// with about equal work. The changes are sorted afterwards, so the result does not depend on the
/// distribution of work.
fn sweep_columns(workers: &mut [Worker], columns: &mut [Column], first: usize, total: usize, bodies: &Bodies) {
    if workers.len() > 1 && columns.len() > 1 {
        let (low, high) = workers.split_at_mut(workers.len() / 2);
        let share = total * low.len() / (low.len() + high.len());
        let mut border = 0;
        let mut below = 0;
        while border < columns.len() && below < share {
            below += columns[border].entries.len();
            border += 1;
        }
        let (left, right) = columns.split_at_mut(border);
        join(
            || sweep_columns(low, left, first, below, bodies),
            || sweep_columns(high, right, first + border, total - below, bodies),
        );
        return;
    }
    let Some(worker) = workers.first_mut() else { return };
    for (k, column) in columns.iter_mut().enumerate() {
        if !column.entries.is_empty() {
            worker.sweep(first + k, column, bodies);
        }
    }
    worker.changes.sort();
}

/// Repairs the touched columns; the first given column has number `first`. Workers share the
/// columns as in a sweep.
fn repair_columns(workers: &mut [Worker], columns: &mut [Column], first: usize, touched: &[Touch], bodies: &Bodies) {
    if workers.len() > 1
        && let Some((middle, _)) = touched.get(touched.len() / 2)
    {
        let (low, high) = workers.split_at_mut(workers.len() / 2);
        let (below, above) = touched.split_at(touched.partition_point(|touch| touch.0 < *middle));
        let border = (*middle as usize).clamp(first, first + columns.len());
        let (left, right) = columns.split_at_mut(border - first);
        join(
            || repair_columns(low, left, first, below, bodies),
            || repair_columns(high, right, border, above, bodies),
        );
        return;
    }
    let Some(worker) = workers.first_mut() else { return };
    for group in touched.chunk_by(|a, b| a.0 == b.0) {
        if let Some(column) = columns.get_mut(group[0].0 as usize - first) {
            worker.repair(column, group, bodies);
        }
    }
    worker.changes.sort();
}

impl Default for SweepAndPrune {
    fn default() -> Self {
        Self::new()
    }
}

/// The calls of a step, and queries about the last step.
impl SweepAndPrune {
    /// Applies all calls since the last step and returns the pairs that started and ended.
    ///
    /// `filter` is called once for each pair whose boxes start to overlap and whose groups match.
    /// If the filter rejects a pair, it is called again for that pair only after the boxes
    /// separated or after [`regroup`](Self::regroup).
    #[must_use]
    pub fn step_with(&mut self, filter: &mut dyn FnMut(BodyId, BodyId) -> bool) -> Events<'_> {
        self.find_changes();
        let threads = self.threads();
        let columns = &self.columns;
        let partners = |bodies: &Bodies, index: u32, found: &mut Vec<u32>| {
            let record = &bodies.records[index as usize];
            if record.flags() & UNBOUNDED != 0 {
                let hits = bodies
                    .records
                    .iter()
                    .enumerate()
                    .filter(|(_, r)| r.now().overlaps(&record.now()));
                found.extend(hits.map(|(i, _)| i as u32));
            } else {
                self::overlapping(bodies, columns, &record.now(), Record::now, |i| found.push(i));
            }
        };
        self.state.take_over(filter, partners, threads);
        self.state.pairs.events(&self.state.bodies)
    }

    /// Appends the bodies whose boxes overlapped `aabb` in the last step, in ascending order.
    ///
    /// # Errors
    /// Returns an error if a bound of the box is NaN or the box is inverted. The box may be
    /// infinite.
    pub fn overlapping(&self, aabb: &Aabb, found: &mut Vec<BodyId>) -> Result<(), BroadPhaseError> {
        let asked = self.state.asked(aabb)?;
        self.overlapping_stored(&asked, found);
        Ok(())
    }

    /// Calls [`step_with`](Self::step_with) with a filter that accepts every pair.
    pub fn step(&mut self) -> Events<'_> {
        self.step_with(&mut |_, _| true)
    }

    /// Inserts a body; its pairs start with the next step.
    ///
    /// # Errors
    /// Returns an error if the box, its growth or the origin of the structure is invalid, or if
    /// there are too many bodies.
    pub fn insert(&mut self, aabb: &Aabb, body: BodyOptions) -> Result<BodyId, BroadPhaseError> {
        self.state.insert(aabb, body, false)
    }

    /// Inserts a body whose box may be infinite.
    ///
    /// Use it for a half-space, the ground, or a sensor for the whole world. An unbounded body is
    /// compared with every body that moves, so use few of them. Margins do not apply.
    ///
    /// # Errors
    /// Returns an error if a bound is NaN, the box is inverted, the origin of the structure is
    /// invalid, or there are too many bodies.
    pub fn insert_unbounded(&mut self, aabb: &Aabb, body: BodyOptions) -> Result<BodyId, BroadPhaseError> {
        self.state.insert(
            aabb,
            BodyOptions {
                growth: 0.0,
                lookahead: 0.0,
                ..body
            },
            true,
        )
    }

    /// Removes a body. Its id is stale at once; its pairs end with the next step.
    ///
    /// # Errors
    /// Returns an error if the id is stale.
    pub fn remove(&mut self, id: BodyId) -> Result<(), BroadPhaseError> {
        self.state.bodies.remove(id)
    }

    /// Sets the box of a body, at any distance from the last one.
    ///
    /// # Errors
    /// Returns an error if the id is stale or the box is invalid; the body keeps its box and its
    /// pairs.
    #[doc(alias = "teleport")]
    pub fn set_box(&mut self, id: BodyId, aabb: &Aabb) -> Result<(), BroadPhaseError> {
        self.state.bodies.set_box(id, aabb)
    }

    /// Sets the boxes of many bodies. Every valid entry is applied, even if another entry is
    /// invalid. The call is fastest if the entries are in ascending order of their ids.
    ///
    /// # Errors
    /// Returns an error if any entry is invalid. It holds the index and the error of the first
    /// invalid entry, and the number of invalid entries.
    pub fn set_boxes(&mut self, batch: &[(BodyId, Aabb)]) -> Result<(), BatchError> {
        let threads = self.threads();
        self.state.bodies.set_boxes(batch, threads)
    }

    /// Sets the groups of a body. The next step tests groups and filter again for all its pairs.
    ///
    /// # Errors
    /// Returns an error if the id is stale.
    pub fn set_groups(&mut self, id: BodyId, groups: Groups) -> Result<(), BroadPhaseError> {
        self.state.bodies.set_groups(id, Some(groups))
    }

    /// Tests groups and filter again for all pairs of a body in the next step.
    ///
    /// # Errors
    /// Returns an error if the id is stale.
    pub fn regroup(&mut self, id: BodyId) -> Result<(), BroadPhaseError> {
        self.state.bodies.set_groups(id, None)
    }

    /// Returns the number of bodies.
    #[must_use]
    pub fn body_count(&self) -> usize {
        self.state.bodies.len()
    }

    /// Iterates over all bodies in ascending order.
    pub fn bodies(&self) -> impl Iterator<Item = BodyId> + '_ {
        self.state.bodies.ids()
    }

    /// Returns whether the id names a body.
    #[must_use]
    pub fn contains(&self, id: BodyId) -> bool {
        self.state.bodies.index_of(id).is_ok()
    }

    /// Returns the options of a body, with growth and look-ahead as stored, in `f32`.
    #[must_use]
    pub fn body(&self, id: BodyId) -> Option<BodyOptions> {
        let bodies = &self.state.bodies;
        bodies.index_of(id).ok().map(|_| bodies.body(id.index))
    }

    /// Returns the box of a body that the next step will use, growth included.
    #[must_use]
    pub fn stored_box(&self, id: BodyId) -> Option<StoredBox> {
        let bodies = &self.state.bodies;
        let record = &bodies.records[bodies.index_of(id).ok()?];
        Some(record.now().to_box().rotated(3 - bodies.grid.axis))
    }

    /// Iterates over the pairs of the last step, in the order of their slots.
    pub fn pairs(&self) -> impl Iterator<Item = Pair> + '_ {
        let BroadPhaseState { bodies, pairs, .. } = &self.state;
        pairs.iter(bodies)
    }

    /// Returns the number of pairs of the last step.
    #[must_use]
    pub fn pair_count(&self) -> usize {
        self.state.pairs.len()
    }

    /// Returns the pair of two bodies, in either order, if the boxes overlapped in the last step.
    #[must_use]
    pub fn pair(&self, a: BodyId, b: BodyId) -> Option<Pair> {
        self.state.pair(a, b)
    }

    /// Returns the pair with this id, if the pair has not ended.
    #[must_use]
    pub fn pair_of(&self, id: PairId) -> Option<Pair> {
        self.state.pair_of(id)
    }

    /// Iterates over the pairs between two sets of groups: one body is in a group of `these`, the
    /// other in a group of `those`.
    pub fn pairs_between(&self, these: u32, those: u32) -> impl Iterator<Item = Pair> + '_ {
        let bodies = &self.state.bodies;
        self.pairs().filter(move |pair| {
            let [a, b] = [pair.a, pair.b].each(|id| bodies.body(id.index).groups.member_of);
            (a & these != 0 && b & those != 0) || (b & these != 0 && a & those != 0)
        })
    }

    /// Returns at most `count` bodies whose boxes are nearest to `aabb` and at most `farthest`
    /// away.
    ///
    /// The nearest comes first; ties are in ascending order of ids. Distances are between stored
    /// boxes, and 0 if the boxes overlap.
    ///
    /// # Errors
    /// Returns an error if a bound of the box is NaN or infinite, or the box is inverted.
    pub fn nearest(&self, aabb: &Aabb, count: usize, farthest: f64) -> Result<Vec<Nearest>, BroadPhaseError> {
        nearest(self, aabb, count, farthest)
    }

    /// Returns the reserved memory in bytes: bodies, pairs, the structure itself and scratch
    /// buffers.
    #[must_use]
    pub fn memory_usage(&self) -> usize {
        let columns: usize = self.columns.iter().map(|c| c.entries.capacity() * 8).sum();
        let scratch: usize = self.workers.iter().map(Worker::bytes).sum();
        let touched = self.touched.capacity() * size_of::<Touch>();
        self.state.bytes() + self.columns.capacity() * size_of::<Column>() + columns + scratch + touched
    }

    /// Returns the first contradiction between lists, bodies and pairs, if any. Tests and fuzzing
    /// call it after each step. It reads everything, so it costs far more than a step.
    ///
    /// # Errors
    /// Returns the contradiction as an error. It is always a defect of the crate, regardless of the
    /// calls made.
    #[doc(hidden)]
    pub fn check(&self) -> Result<(), String> {
        self.state.check()?;
        self.check_columns()
    }

    /// Appends the bodies whose boxes overlapped a stored box in the last step, in ascending order.
    pub(super) fn overlapping_stored(&self, asked: &StoredBox, found: &mut Vec<BodyId>) {
        let bodies = &self.state.bodies;
        let first = found.len();
        self::overlapping(
            bodies,
            &self.columns,
            &Bounds::from_box(asked),
            |r| r.before(bodies.step),
            |i| found.push(bodies.id(i)),
        );
        found[first..].sort_unstable();
    }
}

/// Visits every body once whose box overlaps `asked`. The columns are sorted by the box that
/// `place` returns for a record.
fn overlapping(
    bodies: &Bodies,
    columns: &[Column],
    asked: &Bounds,
    place: impl Fn(&Record) -> Bounds,
    mut visit: impl FnMut(u32),
) {
    let StoredBox {
        lo: [start, ..],
        hi: [end, ..],
    } = asked.to_box();
    for cell in bodies.grid.range(asked).columns() {
        let Some(column) = columns.get(bodies.grid.index(cell)) else {
            continue;
        };
        let slack = COLUMN_SEARCH * start.abs().at_least(column.longest);
        let first = order_key(start - column.longest - slack);
        let last = order_key(end);
        let from = column.entries.partition_point(|e| ((e >> 32) as u32) < first);
        for &e in column.entries[from..].iter().take_while(|e| (*e >> 32) as u32 <= last) {
            let stored = place(&bodies.records[index_of(e)]);
            if stored.overlaps(asked) && bodies.grid.owner(&stored, asked) == cell {
                visit(index_of(e) as u32);
            }
        }
    }
    for &index in &bodies.unbounded {
        if place(&bodies.records[index as usize]).overlaps(asked) {
            visit(index);
        }
    }
}

impl SweepAndPrune {
    /// Iterates over the columns that list a body, for pictures and statistics. Each has its lower
    /// and upper corner on the two axes that are not swept, and its number of bodies.
    pub fn columns(&self) -> impl Iterator<Item = ColumnBounds> + '_ {
        let grid = &self.state.bodies.grid;
        let held = self
            .columns
            .iter()
            .enumerate()
            .filter(|(_, column)| !column.entries.is_empty());
        held.map(move |(i, column)| {
            let cell = grid.column(i);
            let lo = core::array::from_fn(|k| grid.corner()[k] + f32::from(cell[k]) * grid.width);
            ColumnBounds {
                swept_axis: grid.axis,
                lo,
                hi: lo.each(|v| v + grid.width),
                listed: column.entries.len(),
            }
        })
    }
}

/// A column of [`SweepAndPrune`]. A column at the border of the grid also contains all bodies
/// beyond that border.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ColumnBounds {
    /// The axis of the column: 0, 1, 2 for x, y, z. The two remaining axes follow in cyclic order.
    pub swept_axis: usize,
    /// Lower corner on the two remaining axes, relative to the origin of the structure.
    pub lo: [f32; 2],
    /// Upper corner on the two remaining axes.
    pub hi: [f32; 2],
    /// Number of bodies listed.
    pub listed: usize,
}

impl SweepAndPrune {
    /// Returns the first contradiction between columns and bodies. Valid only between steps.
    fn check_columns(&self) -> Result<(), String> {
        let bodies = &self.state.bodies;
        if self.columns.len() != bodies.grid.column_count() {
            return Err(format!("{} columns for {:?}", self.columns.len(), bodies.grid.size));
        }
        for (i, column) in self.columns.iter().enumerate() {
            column
                .check(bodies.grid.column(i), bodies)
                .map_err(|what| format!("column {i}: {what}"))?;
        }
        // Each entry belongs to a body of this column and no body is listed twice, so an equal
        // count means that no entry is missing.
        let listed: usize = self.columns.iter().map(|c| c.entries.len()).sum();
        let places = bodies
            .records
            .iter()
            .map(|r| r.range_before(bodies.step, &bodies.grid).count());
        let owed: usize = places.sum();
        if listed != owed {
            return Err(format!("{listed} entries, but bodies touch {owed} columns"));
        }
        Ok(())
    }
}

impl Column {
    fn check(&self, cell: [u16; 2], bodies: &Bodies) -> Result<(), String> {
        if self.settled != self.entries.len() {
            return Err(format!("{} of {} entries settled", self.settled, self.entries.len()));
        }
        if !self.entries.is_sorted_by(|a, b| a < b) {
            return Err("entries are out of order".into());
        }
        for &e in &self.entries {
            let i = index_of(e);
            let Some(record) = bodies.records.get(i) else {
                return Err(format!("body {i} is not there"));
            };
            let range = record.range_before(bodies.step, &bodies.grid);
            if record.flags() & UNBOUNDED != 0 || !range.contains(cell) {
                return Err(format!("body {i} does not belong there"));
            }
            let stored = record.before(bodies.step).to_box();
            if e != entry(stored.lo[0], who(i as u32, 0)) {
                return Err(format!("the entry of body {i} is not that of its box"));
            }
            let length = stored.hi[0] - stored.lo[0];
            if length > self.longest {
                return Err(format!(
                    "body {i} is {length} long, more than the longest, {}",
                    self.longest
                ));
            }
        }
        Ok(())
    }
}
