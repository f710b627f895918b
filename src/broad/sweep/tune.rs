//! Choice of the axis to sweep and of the width of the columns.
//!
//! The cost of a sweep is a sum over entries and over tests. Narrow columns list a box often; wide
//! columns compare a box with many others. Both counts are known exactly from the last sweep. Their
//! change with the width follows from the sizes of the boxes, so a curve gives the best width. The
//! next sweep measures the errors of the curve that come from varying density. All counts are
//! numbers of entries, never times: equal calls give equal columns.
//!
//! The longer the columns remain right, the less often they are checked. The checks become frequent
//! again if a step compares several times as many entries as the last check, or if a check finds
//! the bodies spread along another axis. Axis and width are then chosen as for a new world.

use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::tolerance::{LEAST_MEAN, LEAST_START, LEAST_WIDTH};
use crate::broad::body::{Bodies, UNBOUNDED};
use crate::broad::grid::{Grid, MOST_COLUMNS_OF_AXIS};
use crate::broad::simd_box::Bounds;
use alloc::vec::Vec;

/// Cost of an entry, of a window of eight tests, of a column that holds bodies and of an empty
/// column, in nanoseconds as fitted to sweeps of 10,000 boxes; only the ratios matter.
const ENTRY: f64 = 6.0;
const WINDOW: f64 = 4.5;
const COLUMN: f64 = 30.0;
const EMPTY_COLUMN: f64 = 0.75;

/// Number of bodies sampled to choose columns.
const SAMPLE: usize = 512;

/// Largest average number of entries of a body; a grid that needs more is too fine.
const MOST_ENTRIES: usize = 6;

/// Longest wait between two checks of the column width, in steps.
const PATIENCE: u32 = 1024;

/// New columns are computed if a step compares this many times as many entries per body as the step
/// measured last. The factor is larger than the effect of the windows of fast bodies, and smaller
/// than that of a fourfold density.
const SURGE: f64 = 3.0;

/// A new column width must reduce the expected cost to at most this fraction of the present cost.
const GAIN: f64 = 0.85;

/// Sizes and positions of all bounded boxes, in the axes of the stored boxes.
pub(super) struct Survey {
    count: f64,
    /// Mean length along each axis.
    mean: [f64; 3],
    /// Mean product of the lengths along any two axes, indexed by the third axis.
    product: [f64; 3],
    /// Range of most centres.
    lo: [f64; 3],
    hi: [f64; 3],
}

impl Survey {
    /// Surveys a sample of the bodies: errors of the sample cost a little time, never a pair.
    pub(super) fn of(bodies: &Bodies) -> Self {
        let mut sample: [Vec<f64>; 3] = Default::default();
        let (mut mean, mut product) = ([0.0; 3], [0.0; 3]);
        let spread = bodies.records.iter().step_by(bodies.records.len() / SAMPLE + 1);
        for record in spread.filter(|r| r.flags() & UNBOUNDED == 0 && r.present()) {
            let stored = record.now().to_box();
            let length: [f64; 3] = core::array::from_fn(|k| f64::from(stored.hi[k]) - f64::from(stored.lo[k]));
            for k in 0..3 {
                sample[k].push(0.5 * (f64::from(stored.lo[k]) + f64::from(stored.hi[k])));
                mean[k] += length[k];
                product[k] += length[(k + 1) % 3] * length[(k + 2) % 3];
            }
        }
        let taken = sample[0].len().max(1) as f64;
        let count = (bodies.len().saturating_sub(bodies.unbounded.len())) as f64;
        let (mean, product) = (mean.each(|v| v / taken), product.each(|v| v / taken));
        let mut out = Self {
            count,
            mean,
            product,
            lo: [0.0; 3],
            hi: [0.0; 3],
        };
        for k in 0..3 {
            out.find_extent(k, &mut sample[k]);
        }
        out
    }

    /// Finds the range of most centres. A few far bodies must not make all columns wide; they are
    /// clamped into border columns instead.
    fn find_extent(&mut self, k: usize, centers: &mut [f64]) {
        let (Some(last), few) = (centers.len().checked_sub(1), centers.len() / 50) else {
            return;
        };
        // Selected, not sorted: this is done within a step.
        let (below, low, above) = centers.select_nth_unstable_by(few, f64::total_cmp);
        let (low, least) = (*low, below.iter().fold(*low, |a, b| a.smaller(*b)));
        let (high, most) = if last - few > few {
            let (_, high, beyond) = above.select_nth_unstable_by(last - 2 * few - 1, f64::total_cmp);
            (*high, beyond.iter().fold(*high, |a, b| a.larger(*b)))
        } else {
            (low, low)
        };
        let room = 0.25 * (high - low) + self.mean[k];
        self.lo[k] = least.larger(low - room);
        self.hi[k] = most.smaller(high + room);
    }

    fn extent(&self, k: usize) -> f64 {
        (self.hi[k] - self.lo[k])
            .larger(self.mean[k])
            .at_least(f64::MIN_POSITIVE)
    }

    /// Returns the axis along which bodies are spread farthest, in units of their size. The current
    /// axis (axis 0) is kept unless another is clearly better.
    pub(super) fn best_axis(&self) -> usize {
        let spread = |k: usize| self.extent(k) / self.mean[k].larger(LEAST_MEAN * self.extent(k));
        let mut best = 0;
        for k in 1..3 {
            if spread(k) > 1.5 * spread(best) {
                best = k;
            }
        }
        best
    }

    fn rotated(mut self, by: usize) -> Self {
        for field in [&mut self.mean, &mut self.product, &mut self.lo, &mut self.hi] {
            field.rotate_left(by);
        }
        self
    }

    /// Returns the average number of entries of a body in columns of this width.
    fn entries(&self, width: f64) -> f64 {
        1.0 + (self.mean[1] + self.mean[2]) / width + self.product[0] / (width * width)
    }

    /// Returns a number proportional to the number of tests at this width: the average number of
    /// columns that two boxes share, summed over all offsets of the two boxes.
    fn overlap_of_columns(&self, width: f64) -> f64 {
        let shared = |mean: f64| (width + mean) * (width + mean) / width;
        shared(self.mean[1]) * shared(self.mean[2])
    }

    /// Returns the number of tests per body if all bodies were spread evenly over their range.
    fn even_tests(&self, width: f64) -> f64 {
        let volume = self.extent(0) * self.extent(1) * self.extent(2);
        self.count / volume * self.mean[0] * self.overlap_of_columns(width)
    }

    /// Returns the cost of a sweep per body, if columns of this width give `tests` tests per body
    /// and `held` columns contain bodies.
    fn cost(&self, width: f64, tests: f64, held: f64) -> f64 {
        let entries = self.entries(width);
        let window = tests / entries;
        let count = self.count.at_least(1.0);
        let columns = self.columns(width) / count;
        let held = columns.smaller(entries).smaller(held / count);
        entries * (ENTRY + WINDOW * (1.0 + window * window / (8.0 * (window + 8.0))))
            + COLUMN * held
            + EMPTY_COLUMN * (columns - held)
    }

    /// Returns the number of columns of a grid of this width.
    fn columns(&self, width: f64) -> f64 {
        (self.extent(1) / width + 1.0) * (self.extent(2) / width + 1.0)
    }

    /// Returns the best width, and the ratio of the cost at the best width to the present cost.
    /// `tests` per body were counted with columns of width `known`, of which `held` contain bodies.
    fn best_width(&self, known: f64, tests: f64, held: f64) -> (f64, f64) {
        let scale = tests / self.overlap_of_columns(known);
        let present = self.cost(known, tests, held);
        let mut best = (known, 1.0);
        for k in -16..=16 {
            let width = known * libm::exp2(f64::from(k) / 4.0);
            // Each column is divided into as many as fit.
            let held = held * (known / width) * (known / width);
            let share = self.cost(width, scale * self.overlap_of_columns(width), held) / present;
            if share < best.1 {
                best = (width, share);
            }
        }
        best
    }

    /// Returns how far a body may move along the swept axis without a jump: a mean length, or the
    /// mean distance to the next entry of its column if that is larger.
    ///
    /// Windows widened by two such moves contain about two entries more, or are three times as
    /// long. A jump costs about as much as two entries. So a sweep costs at most a few times the
    /// cost at rest, however far bodies move.
    fn leap(&self, width: f64, columns: f64) -> f32 {
        let listed = (self.count * self.entries(width) / columns).at_least(1.0);
        self.mean[0].larger(self.extent(0) / listed) as f32
    }

    fn grid(&self, axis: usize, width: f64) -> Grid {
        let most = (2.0 * self.count).at_least(64.0);
        let mut width = width.at_least(LEAST_WIDTH);
        loop {
            let size = [1, 2].each(|k| (libm::ceil(self.extent(k) / width)).clamped(1.0, 1e9));
            if size[0] * size[1] <= most && size[0].larger(size[1]) <= MOST_COLUMNS_OF_AXIS as f64 {
                return Grid::new(
                    axis,
                    [self.lo[1] as f32, self.lo[2] as f32],
                    width as f32,
                    size.each(|n| n as u16),
                )
                .leaping(self.leap(width, size[0] * size[1]));
            }
            width *= 1.25;
        }
    }
}

/// Counts of a full sweep.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StepCounts {
    /// Entries swept, of columns in which something moved.
    pub(super) entries: u64,
    /// Entries compared with the entries of windows, in whole blocks.
    pub(super) compared: u64,
    /// Entries inside the windows of a sample of the entries.
    pub(super) tests: u64,
    pub(super) sampled: u64,
    /// Swept columns that contain bodies.
    pub(super) columns: u64,
}

impl StepCounts {
    pub(super) fn add(&mut self, other: Self) {
        self.entries += other.entries;
        self.compared += other.compared;
        self.tests += other.tests;
        self.sampled += other.sampled;
        self.columns += other.columns;
    }
}

/// Decides when new columns are computed.
#[derive(Clone, Debug)]
pub(super) struct Tuning {
    /// Number of bodies when the columns were computed.
    count: usize,
    /// Steps to wait before the width is checked again. The next field is the last waiting time,
    /// which doubles at each check.
    wait: u32,
    patience: u32,
    /// The width that promised to be clearly better, if any.
    wanted: Option<f64>,
    /// Entries compared per body, in a sweep of all columns, when the width was last checked.
    compared: f64,
    /// Whether axis and width are to be chosen as for a new world.
    anew: bool,
}

impl Tuning {
    pub(super) fn new() -> Self {
        Self {
            count: 0,
            wait: 0,
            patience: 1,
            wanted: None,
            compared: f64::INFINITY,
            anew: false,
        }
    }

    /// Returns whether the next sweep must count.
    pub(super) fn wants_counts(&self) -> bool {
        self.wait <= 1
    }

    /// Requests new columns if a step compared several times as many entries per body as the last
    /// check.
    pub(super) fn watch(&mut self, compared: f64) {
        self.anew |= compared > SURGE * self.compared;
    }

    /// Records the counts of a full sweep of this number of entries.
    pub(super) fn observe(&mut self, bodies: &Bodies, counts: StepCounts, entries: usize) {
        // Columns at rest are not swept. They are counted at the average of the swept columns.
        let compared = counts.compared as f64 / counts.entries as f64 * entries as f64 / bodies.len() as f64;
        self.watch(compared);
        self.wait = self.wait.saturating_sub(1);
        if self.wait > 0 || counts.entries == 0 || counts.sampled == 0 {
            return;
        }
        let survey = Survey::of(bodies);
        let width = f64::from(bodies.grid.width);
        let tests = counts.tests as f64 / counts.sampled as f64 * survey.entries(width);
        let (better, share) = survey.best_width(width, tests, counts.columns as f64);
        self.patience = (self.patience * 2).min(PATIENCE);
        self.wait = self.patience;
        self.wanted = (share < GAIN).then_some(better);
        self.compared = compared;
        self.anew |= survey.best_axis() != 0;
    }

    /// Returns the grid to use from this step, if a new grid is due.
    pub(super) fn due(&mut self, bodies: &Bodies, entries: usize) -> Option<Grid> {
        let count = bodies.len();
        let changed = count > 2 * self.count.max(8) || 4 * count < self.count;
        let crowded = entries > 2 * MOST_ENTRIES * count + 4096 && bodies.grid.column_count() > 1;
        let anew = core::mem::take(&mut self.anew) || changed || crowded;
        if !anew && self.wanted.is_none() {
            return None;
        }
        let survey = Survey::of(bodies);
        if anew {
            (self.wait, self.patience, self.compared) = (0, 1, f64::INFINITY);
        }
        self.count = count;
        let wanted = self.wanted.take().filter(|_| !anew);
        Some(choose(bodies, survey, wanted))
    }
}

/// Returns the grid for a known good width, or the best guess for bodies that were never swept.
fn choose(bodies: &Bodies, survey: Survey, width: Option<f64>) -> Grid {
    let turn = if width.is_some() { 0 } else { survey.best_axis() };
    let survey = survey.rotated(turn);
    let axis = (bodies.grid.axis + turn) % 3;
    let width = width.unwrap_or_else(|| {
        let start =
            (0.5 * (survey.mean[1] + survey.mean[2])).larger(LEAST_START * survey.extent(1).smaller(survey.extent(2)));
        let (better, _) = survey.best_width(start * 4.0, survey.even_tests(start * 4.0), f64::INFINITY);
        better
    });
    let mut grid = survey.grid(axis, width);
    let most = MOST_ENTRIES * bodies.len() + 1024;
    while grid.column_count() > 1 && entries_of(bodies, &grid, turn, most) > most {
        grid = survey.grid(axis, f64::from(grid.width) * 1.5);
    }
    grid
}

/// Counts the entries that all bodies would have in the grid. Counting stops beyond `most`.
fn entries_of(bodies: &Bodies, grid: &Grid, turn: usize, most: usize) -> usize {
    let mut total = 0;
    for record in bodies
        .records
        .iter()
        .filter(|r| r.flags() & UNBOUNDED == 0 && r.present())
    {
        total += grid
            .range(&Bounds::from_box(&record.now().to_box().rotated(turn)))
            .count();
        if total > most {
            break;
        }
    }
    total
}
