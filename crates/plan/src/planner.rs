//! The search for a path: methods, options, result and entry points.
//!
//! Beyond rounding, predicates and verdicts do not depend on the state of the trackers, so neither
//! do the trees of RRT-Connect. An ascent of the opportunistic planner uses distances, whose last
//! bits do, and a budget counts queries, whose number does.

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
use crate::rrt_connect::TreeSearch;
use crate::search::{GOAL, START};
use crate::space::ConfigurationSpace;
use crate::verdict::CheckWork;

/// The longest and the shortest step of an ascent or a trace, in units of the largest extent of the
/// bounds. Not measured.
const LONGEST: f64 = 1.0 / 16.0;
const SHORTEST: f64 = 1.0 / 32_768.0;

/// The method of [`Checker::plan`].
///
/// Every segment of a path is proven free, whatever the method. The [crate](crate) explains both
/// methods.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum PlanMethod {
    /// Two trees of segments, from start and goal, that grow towards random configurations and
    /// towards each other (Kuffner and LaValle 2000; the default).
    #[default]
    RrtConnect,
    /// Freeways of largest clearance in slices (Canny and Lin 1993).
    Opportunistic,
}

impl PlanMethod {
    /// All methods.
    pub const ALL: [Self; 2] = [Self::RrtConnect, Self::Opportunistic];

    /// Returns the name: `rrt-connect` or `opportunistic`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::RrtConnect => "rrt-connect",
            Self::Opportunistic => "opportunistic",
        }
    }

    /// Returns the method with a name, as [`name`](Self::name) returns it; `None` for any other.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }
}

/// Method, budget and seed of a search. The search ends when the first budget is spent.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlanOptions {
    /// The method (default [`PlanMethod::RrtConnect`]).
    pub method: PlanMethod,
    /// Random seed (default 0). A new checker returns the same result for the same seed, and so
    /// does any checker after [`Checker::forget`].
    pub seed: u64,
    /// Maximum number of random slices of the opportunistic planner (default 10,000).
    pub slices: u64,
    /// Maximum number of samples of RRT-Connect (default 100,000).
    pub samples: u64,
    /// Maximum number of pair queries, checked between steps (default 1,000,000).
    ///
    /// A step is a freeway or a sample. The default takes seconds to tens of seconds, depending on
    /// the bodies. To stop by a clock, set all three budgets to `u64::MAX`
    /// ([`unlimited`](Self::unlimited)) and call [`Checker::plan_with_progress`].
    pub queries: u64,
    /// Clearance at which an ascent ends, because more is no better. `None` is an eighth of the
    /// largest extent of the bounds.
    pub clearance_cap: Option<f64>,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            method: PlanMethod::default(),
            seed: 0,
            slices: 10_000,
            samples: 100_000,
            queries: 1_000_000,
            clearance_cap: None,
        }
    }
}

impl PlanOptions {
    /// Sets the method.
    #[must_use]
    pub const fn method(mut self, method: PlanMethod) -> Self {
        self.method = method;
        self
    }

    /// Sets the random seed.
    #[must_use]
    pub const fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Sets the maximum number of random slices.
    #[must_use]
    pub const fn slices(mut self, slices: u64) -> Self {
        self.slices = slices;
        self
    }

    /// Sets the maximum number of samples.
    #[must_use]
    pub const fn samples(mut self, samples: u64) -> Self {
        self.samples = samples;
        self
    }

    /// Removes the budgets of slices, samples and queries, for a search that a callback stops.
    #[must_use]
    pub const fn unlimited(self) -> Self {
        self.slices(u64::MAX).samples(u64::MAX).queries(u64::MAX)
    }

    /// Sets the maximum number of pair queries.
    #[must_use]
    pub const fn queries(mut self, queries: u64) -> Self {
        self.queries = queries;
        self
    }

    /// Sets the clearance at which an ascent ends.
    #[must_use]
    pub const fn clearance_cap(mut self, clearance_cap: f64) -> Self {
        self.clearance_cap = Some(clearance_cap);
        self
    }
}

/// Counts of the work of a search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct PlanWork {
    /// Number of random slices.
    pub slices: u64,
    /// Number of freeways traced, without bridges.
    pub freeways: u64,
    /// Number of bridges traced (freeways within slices).
    pub bridges: u64,
    /// Number of straight segments tried between components, and number proven free. The segment
    /// from start to goal, which every method tries first, is one of them.
    pub links: [u64; 2],
    /// Number of samples of RRT-Connect.
    pub samples: u64,
    /// Number of segments tried by RRT-Connect, and number proven free.
    pub extensions: [u64; 2],
    /// Counts of the checker.
    pub checks: CheckWork,
}

/// Result of a search.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Plan {
    /// The path from start to goal, with every segment proven free in the direction of travel.
    ///
    /// `None` if the budget ended first, or if a segment of the space is another motion in the
    /// opposite direction. `None` does not prove that there is no path.
    pub path: Option<Path>,
    /// The roadmap at the end of the search.
    pub roadmap: Roadmap,
    /// Counts of the work.
    pub work: PlanWork,
}

impl<C: ConfigurationSpace> Checker<C> {
    /// Searches for a path from `start` to `goal`; [`PlanOptions::method`] is how.
    ///
    /// # Errors
    /// Returns an error if a configuration is invalid or closer to contact than the margin, or if
    /// an option is out of range.
    pub fn plan(&mut self, start: &[f64], goal: &[f64], options: &PlanOptions) -> Result<Plan, PlanError> {
        self.plan_with_progress(start, goal, options, &mut |_| ControlFlow::Continue(()))
    }

    /// Searches for a path as [`plan`](Self::plan) does, with a progress callback.
    ///
    /// The callback receives the number of queries between two steps: freeways or samples. If it
    /// stops the search, for example at a time limit, `path` is `None`.
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
            if self.is_free_at(q)? {
                continue;
            }
            // If all pairs must keep the same distance, the closest pair decides.
            let slack = if self.pairs.is_uniform { 0.0 } else { f64::INFINITY };
            let near = self.nearest(q, slack)?;
            let blocked = near
                .iter()
                .filter(|near| !(near.lower > self.world.kept_distance(near.pair)));
            if let Some(near) = blocked.min_by(|x, y| x.excess.total_cmp(&y.excess)) {
                let (a, b) = (self.name(near.pair.a).to_string(), self.name(near.pair.b).to_string());
                return Err(PlanError::Contact { end, a, b });
            }
        }
        let extent = self.extent()?;
        let lengths = self.lengths(extent, options)?;
        let before = self.work;
        let mut search = PathSearch {
            checker: self,
            roadmap: Roadmap::new(start, goal),
            work: PlanWork::default(),
            random: Random::new(options.seed),
            lengths,
            queries: options.queries,
            explored: 0,
            before,
            progress,
        };
        let mut trees = TreeSearch::new(start, goal, options.seed, extent);
        search.run(&mut trees, options)?;
        let is_by_trees = trees.is_solved();
        let solved = if is_by_trees { &trees.roadmap } else { &search.roadmap };
        let found = search.path(solved);
        let (mut roadmap, mut work) = (search.roadmap, search.work);
        roadmap.absorb(trees.roadmap);
        // The trees have proven each segment in the direction of travel, and the opportunistic
        // planner in one of the two directions.
        let path = match found {
            Some(path) if is_by_trees || self.certify_path(&path)?.1.is_free() => Some(path),
            _ => None,
        };
        work.checks = self.work.since(&before);
        Ok(Plan { path, roadmap, work })
    }

    /// Returns the largest extent of the bounds, as a length.
    fn extent(&self) -> Result<f64, PlanError> {
        let bounds = self.space.bounds().iter().zip(self.space.scales());
        let extents = bounds.map(|([low, high], scale)| (high - low) * scale);
        let extent = extents.fold(0.0, f64::larger);
        if !(extent > 0.0) {
            let what = "extent of the bounds";
            return Err(PlanError::Value { what, value: extent });
        }
        Ok(extent)
    }

    /// Returns the lengths of steps of the opportunistic planner, from the extent of the bounds.
    fn lengths(&self, extent: f64, options: &PlanOptions) -> Result<Slice, PlanError> {
        let clearance_cap = options.clearance_cap.unwrap_or(0.125 * extent);
        if !(clearance_cap > 0.0) {
            let what = "option `clearance_cap`";
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
            hulls: self.hulls - before.hulls,
            lookups: self.lookups - before.lookups,
            pairs_made: self.pairs_made - before.pairs_made,
        }
    }
}

/// State of a search, and of the opportunistic planner.
pub(crate) struct PathSearch<'a, C> {
    pub(crate) checker: &'a mut Checker<C>,
    pub(crate) roadmap: Roadmap,
    pub(crate) work: PlanWork,
    pub(crate) random: Random,
    /// A slice without fixed components.
    pub(crate) lengths: Slice,
    pub(crate) queries: u64,
    /// Number of slices through start and goal that are explored.
    pub(crate) explored: usize,
    pub(crate) before: CheckWork,
    pub(crate) progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>,
}

impl<C: ConfigurationSpace> PathSearch<'_, C> {
    /// Makes steps of the method until there is a path or the first budget is spent.
    fn run(&mut self, trees: &mut TreeSearch, options: &PlanOptions) -> Result<(), PlanError> {
        if self.tried(START, GOAL)? {
            return Ok(());
        }
        while !trees.is_solved() && !self.is_over() {
            match options.method {
                PlanMethod::RrtConnect if self.work.samples < options.samples => {
                    trees.grow(self.checker, &mut self.work)?;
                }
                PlanMethod::Opportunistic if self.has_slices(options.slices) => self.next_slice()?,
                _ => break,
            }
        }
        Ok(())
    }
}
