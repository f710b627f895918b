//! The opportunistic global path planner of Canny and Lin: what it is asked and what it answers.

use core::ops::ControlFlow;
use std::string::ToString;

use lin_canny::Progress;

use crate::ascent::Slice;
use crate::checker::Checker;
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::path::Path;
use crate::random::Random;
use crate::roadmap::Roadmap;
use crate::space::ConfigurationSpace;
use crate::verdict::CheckWork;

/// The longest and the shortest step of an ascent or a trace, in units of the largest extent of the
/// bounds. Not measured.
const LONGEST: f64 = 1.0 / 16.0;
const SHORTEST: f64 = 1.0 / 32_768.0;

/// The budget of a search, and its seed.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlanOptions {
    /// The seed of the random slices: the same seed gives the same answer.
    pub seed: u64,
    /// Random slices, at most.
    pub slices: u64,
    /// Queries of pairs, at most; looked at between freeways. The default, a million, takes some
    /// seconds to tens of seconds, as the bodies are; a search that is watched by the caller takes
    /// `u64::MAX`, with [`Checker::plan_with_progress`].
    pub queries: u64,
    /// The clearance beyond which no configuration is better: ascents end there. `None` for an
    /// eighth of the largest extent of the bounds.
    pub clearance_cap: Option<f64>,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            seed: 0,
            slices: 10_000,
            queries: 1_000_000,
            clearance_cap: None,
        }
    }
}

impl PlanOptions {
    /// Returns the options with another seed.
    #[must_use]
    pub const fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Returns the options with another budget of random slices.
    #[must_use]
    pub const fn slices(mut self, slices: u64) -> Self {
        self.slices = slices;
        self
    }

    /// Returns the options with another budget of distance queries.
    #[must_use]
    pub const fn queries(mut self, queries: u64) -> Self {
        self.queries = queries;
        self
    }

    /// Returns the options with a clearance that is enough.
    #[must_use]
    pub const fn clearance_cap(mut self, clearance_cap: f64) -> Self {
        self.clearance_cap = Some(clearance_cap);
        self
    }
}

/// The work of a search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlanWork {
    /// Random slices.
    pub slices: u64,
    /// Freeways traced, those in slices not counted.
    pub freeways: u64,
    /// Freeways traced within slices: bridges.
    pub bridges: u64,
    /// Straight segments tried between parts of the roadmap, and those proven free.
    pub links: [u64; 2],
    /// The work of the checker.
    pub checks: CheckWork,
}

/// The answer of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The path from start to goal, every segment proven free in the direction of travel; `None` if
    /// the budget ended first, or if the segments of the space are not the same motions both ways.
    /// No answer says that there is no path.
    pub path: Option<Path>,
    /// What was found.
    pub roadmap: Roadmap,
    /// The work done.
    pub work: PlanWork,
}

impl<C: ConfigurationSpace> Checker<C> {
    /// Searches a path from one configuration to another: see the [module](super).
    ///
    /// # Errors
    /// A configuration that is not of the space or not clear of contact by the margin, or options
    /// out of range.
    pub fn plan(&mut self, start: &[f64], goal: &[f64], options: &PlanOptions) -> Result<Plan, PlanError> {
        self.plan_with_progress(start, goal, options, &mut |_| ControlFlow::Continue(()))
    }

    /// Searches a path as [`plan`](Self::plan) does, and tells the caller between freeways how many
    /// queries of distances it has made. A caller that stops the search, by a limit of time for
    /// example, gets no path.
    ///
    /// # Errors
    /// As [`plan`](Self::plan).
    pub fn plan_with_progress(
        &mut self,
        start: &[f64],
        goal: &[f64],
        options: &PlanOptions,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Plan, PlanError> {
        for (q, end) in [(start, "start"), (goal, "goal")] {
            if let Some(near) = self.clearance(q)?.filter(|near| !(near.lower > self.margin())) {
                let (a, b) = (self.name(near.pair.a).to_string(), self.name(near.pair.b).to_string());
                return Err(PlanError::Contact { end, a, b });
            }
        }
        let lengths = self.lengths(options)?;
        let before = self.work;
        let mut search = PathSearch {
            checker: self,
            roadmap: Roadmap::default(),
            work: PlanWork::default(),
            random: Random::new(options.seed),
            lengths,
            queries: options.queries,
            before,
            progress,
        };
        search.run(start, goal, options.slices)?;
        let found = search.path();
        let (roadmap, mut work) = (search.roadmap, search.work);
        // The roadmap has proven its segments in either direction.
        let path = match found {
            Some(path) if self.certify_path(&path)?.1.is_free() => Some(path),
            _ => None,
        };
        work.checks = self.work.since(&before);
        Ok(Plan { path, roadmap, work })
    }

    /// Lengths of steps, from the extent of the bounds.
    fn lengths(&self, options: &PlanOptions) -> Result<Slice, PlanError> {
        let bounds = self.space.bounds().iter().zip(self.space.scales());
        let extents = bounds.map(|([low, high], scale)| (high - low) * scale);
        let extent = extents.fold(0.0, f64::larger);
        if !(extent > 0.0) {
            let what = "extent of the bounds";
            return Err(PlanError::Value { what, value: extent });
        }
        let clearance_cap = options.clearance_cap.unwrap_or(0.125 * extent);
        if !(clearance_cap > 0.0) {
            let what = "cap of the clearance";
            return Err(PlanError::Value {
                what,
                value: clearance_cap,
            });
        }
        Ok(Slice {
            fixed: std::vec![false; self.space.degrees_of_freedom()],
            longest: LONGEST * extent,
            shortest: SHORTEST * extent,
            clearance_cap: clearance_cap + self.margin(),
        })
    }
}

impl CheckWork {
    pub(crate) fn since(&self, before: &Self) -> Self {
        Self {
            segments: self.segments - before.segments,
            free: self.free - before.free,
            pairs: self.pairs - before.pairs,
            queries: self.queries - before.queries,
            configurations: self.configurations - before.configurations,
            measures: self.measures - before.measures,
            decisions: self.decisions - before.decisions,
        }
    }
}

/// A search in the making.
pub(crate) struct PathSearch<'a, C> {
    pub(crate) checker: &'a mut Checker<C>,
    pub(crate) roadmap: Roadmap,
    pub(crate) work: PlanWork,
    pub(crate) random: Random,
    /// No component fixed.
    pub(crate) lengths: Slice,
    pub(crate) queries: u64,
    pub(crate) before: CheckWork,
    pub(crate) progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>,
}
