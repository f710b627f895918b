//! The planners, and what their searches share.
//!
//! Beyond rounding, predicates and verdicts do not depend on the state of the trackers, so neither
//! do the trees of RRT-Connect. An ascent of the opportunistic planner uses distances, whose last
//! bits do, and a budget counts queries, whose number does.

use core::ops::ControlFlow;
use std::string::ToString;

use lin_canny::Progress;

use crate::check::checker::Checker;
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::motion::joint_motion::JointMotion;
use crate::motion::space::ConfigurationSpace;
use crate::random::Random;
use crate::search::ascent::Slice;
use crate::search::opportunistic::PathSearch;
use crate::search::options::{Plan, PlanMethod, PlanOptions, PlanWork};
use crate::search::roadmap::{GOAL, Roadmap, START};
use crate::search::rrt_connect::TreeSearch;

/// The longest and the shortest step of an ascent or a trace, in units of the largest extent of the
/// bounds.
const LONGEST: f64 = 1.0 / 16.0;
const SHORTEST: f64 = 1.0 / 32_768.0;

/// Receives the progress of a search, and may stop it.
type Watch<'a> = Option<&'a mut dyn FnMut(Progress) -> ControlFlow<()>>;

/// RRT-Connect: two trees of segments proven free, from start and goal (Kuffner and LaValle 2000).
///
/// ```
/// use lin_canny::nalgebra::Isometry3;
/// use lin_canny::{Progress, Shape};
/// use lin_canny_plan::{Checker, PlanOptions, RrtConnect, TranslationSpace, Cell};
///
/// let mut cell = Cell::new();
/// cell.robot_body("drone", Shape::ball(0.1)?);
/// cell.add_obstacle("mast", Shape::ball(0.5)?, Isometry3::identity())?;
/// let space = TranslationSpace::new([[-2.0, 2.0]; 3], Default::default(), 1)?;
/// let mut checker = Checker::new(space, cell)?;
///
/// let options = PlanOptions::default().seed(1);
/// let mut stop = |now: Progress| Progress::stop_if(now.done > 100_000);
/// let planner = RrtConnect::new(&options).progress(&mut stop);
/// let plan = planner.plan(&mut checker, &[-1.0, 0.0, 0.0], &[1.0, 0.0, 0.0])?;
/// assert!(plan.path.is_some_and(|path| path.len() > 2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct RrtConnect<'a> {
    options: PlanOptions,
    progress: Watch<'a>,
}

impl<'a> RrtConnect<'a> {
    /// Returns the planner with these options.
    #[must_use]
    pub fn new(options: &PlanOptions) -> Self {
        Self {
            options: options.clone(),
            progress: None,
        }
    }

    /// Sets the progress callback, which receives the number of queries before each sample. If it
    /// stops the search, for example at a time limit, [`Plan::path`] is `None`.
    #[must_use]
    pub fn progress(mut self, progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>) -> Self {
        self.progress = Some(progress);
        self
    }

    /// Searches for a path from `start` to `goal`.
    ///
    /// # Errors
    /// Returns an error if a configuration is invalid or closer to contact than the margin, or if
    /// an option is out of range.
    pub fn plan<C: ConfigurationSpace>(
        self,
        checker: &mut Checker<C>,
        start: &[f64],
        goal: &[f64],
    ) -> Result<Plan, PlanError> {
        checker.search(PlanMethod::RrtConnect, &self.options, self.progress, [start, goal])
    }
}

// Each planner has a type, and both have the same setters, because a caller reads the promise of a
// planner where it is made. The planners share `Checker::search`.
/// The opportunistic planner: freeways of largest clearance in slices (Canny and Lin 1993).
pub struct Opportunistic<'a> {
    options: PlanOptions,
    progress: Watch<'a>,
}

impl<'a> Opportunistic<'a> {
    /// Returns the planner with these options.
    #[must_use]
    pub fn new(options: &PlanOptions) -> Self {
        Self {
            options: options.clone(),
            progress: None,
        }
    }

    /// Sets the progress callback, which receives the number of queries before each slice: see
    /// [`RrtConnect::progress`].
    #[must_use]
    pub fn progress(mut self, progress: &'a mut dyn FnMut(Progress) -> ControlFlow<()>) -> Self {
        self.progress = Some(progress);
        self
    }

    /// Searches for a path from `start` to `goal`.
    ///
    /// # Errors
    /// As [`RrtConnect::plan`].
    pub fn plan<C: ConfigurationSpace>(
        self,
        checker: &mut Checker<C>,
        start: &[f64],
        goal: &[f64],
    ) -> Result<Plan, PlanError> {
        checker.search(PlanMethod::Opportunistic, &self.options, self.progress, [start, goal])
    }
}

impl PlanMethod {
    /// Searches for a path from start to goal by the planner of this name.
    ///
    /// # Errors
    /// As [`RrtConnect::plan`].
    pub fn plan<C: ConfigurationSpace>(
        self,
        checker: &mut Checker<C>,
        ends: [&[f64]; 2],
        options: &PlanOptions,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Plan, PlanError> {
        checker.search(self, options, Some(progress), ends)
    }
}

impl<C: ConfigurationSpace> Checker<C> {
    fn search(
        &mut self,
        method: PlanMethod,
        options: &PlanOptions,
        progress: Watch<'_>,
        [start, goal]: [&[f64]; 2],
    ) -> Result<Plan, PlanError> {
        let mut unwatched = |_| ControlFlow::Continue(());
        let progress = progress.unwrap_or(&mut unwatched);
        for (q, end) in [(start, "start"), (goal, "goal")] {
            if self.is_free_at(q)? {
                continue;
            }
            // If all pairs must keep the same distance, the closest pair decides.
            let slack = if self.pairs.is_uniform { 0.0 } else { f64::INFINITY };
            let near = self.nearest(q, slack)?;
            let blocked = near
                .iter()
                .filter(|near| !(near.lower > self.cell.required_distance(near.pair).distance));
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
        search.run(&mut trees, method, options)?;
        let is_by_trees = trees.is_solved();
        let solved = if is_by_trees { &trees.roadmap } else { &search.roadmap };
        let found = search.path(solved);
        let (mut roadmap, mut work) = (search.roadmap, search.work);
        roadmap.absorb(trees.roadmap);
        // The trees have proven each segment in the direction of travel, and the opportunistic
        // planner in one of the two directions.
        let path = match found {
            Some(path) if is_by_trees || self.certify(&JointMotion::path(&path)?)?.is_free() => Some(path),
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
            clearance_cap: clearance_cap + self.cell.margin(),
        })
    }
}

impl<C: ConfigurationSpace> PathSearch<'_, C> {
    /// Makes steps of the method until there is a path or the first budget is spent.
    fn run(&mut self, trees: &mut TreeSearch, method: PlanMethod, options: &PlanOptions) -> Result<(), PlanError> {
        if self.tried(START, GOAL)? {
            return Ok(());
        }
        while !trees.is_solved() && !self.is_over() {
            match method {
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
