//! The search for a path: methods, options, result and entry points.
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
/// bounds. Not measured.
const LONGEST: f64 = 1.0 / 16.0;
const SHORTEST: f64 = 1.0 / 32_768.0;

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
            clearance_cap: clearance_cap + self.margin(),
        })
    }
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
