//! Whether a single configuration is free, by predicates alone.

use nalgebra::Isometry3;

use crate::checker::Checker;
use crate::error::PlanError;
use crate::space::ConfigurationSpace;
use crate::world::WorldId;
use lin_canny::RelativePose;

/// Pairs that were hit lately and come first at the next configuration; of these the first few are
/// asked before any box is looked at. Not measured.
const HITS: usize = 16;
const HITS_FIRST: usize = 2;

impl<C: ConfigurationSpace> Checker<C> {
    /// Returns whether every pair is proven farther apart than the margin at a configuration: what
    /// sampling planners ask most.
    ///
    /// Measures no distance, and ends at the first pair that is not free; which pairs are in contact
    /// says [`nearest`](Self::nearest). Pairs that were hit
    /// lately come first, then those whose boxes overlap, by the overlap of the balls about them.
    /// Equals [`is_free`](Self::is_free) for a segment of one configuration, but for pairs at the
    /// margin up to rounding, which this call decides exactly where
    /// [`PairTracker::within`](lin_canny::PairTracker::within) does.
    ///
    /// # Errors
    /// A configuration that is not of the space.
    pub fn is_free_at(&mut self, configuration: &[f64]) -> Result<bool, PlanError> {
        self.space.check(configuration)?;
        self.work.configurations += 1;
        let mut poses = core::mem::take(&mut self.poses);
        self.space.place(configuration, &mut poses);
        let hit = self.first_hit(&poses);
        self.poses = poses;
        let hit = hit?;
        if let Some(index) = hit {
            self.hits.retain(|&k| k != index);
            self.hits.insert(0, index);
            self.hits.truncate(HITS);
        }
        Ok(hit.is_none())
    }

    /// Returns a pair that is not proven to keep the margin.
    fn first_hit(&mut self, poses: &[Isometry3<f64>]) -> Result<Option<usize>, PlanError> {
        let margin = self.margin();
        for k in 0..self.hits.len().min(HITS_FIRST) {
            let index = self.hits[k];
            if self.near_by(index, poses).is_some() && !self.keeps_margin(index, poses)? {
                return Ok(Some(index));
            }
        }
        let asked = self.hits.len().min(HITS_FIRST);
        self.gather_within(margin, poses)?;
        let mut order = core::mem::take(&mut self.order);
        order.clear();
        let candidates = self.candidates.iter().filter(|k| !self.hits[..asked].contains(k));
        order.extend(candidates.filter_map(|&k| Some((self.near_by(k, poses)?, k))));
        // Pairs hit before come first.
        let rank = |k: usize| self.hits.iter().position(|&h| h == k).unwrap_or(HITS);
        order.sort_unstable_by(|x, y| rank(x.1).cmp(&rank(y.1)).then(x.0.total_cmp(&y.0)).then(x.1.cmp(&y.1)));
        let mut found = Ok(None);
        for &(_, index) in &order {
            match self.keeps_margin(index, poses) {
                Ok(true) => continue,
                Ok(false) => found = Ok(Some(index)),
                Err(error) => found = Err(error),
            }
            break;
        }
        self.order = order;
        found
    }

    /// Returns the distance of the balls about both parts, if it is not proven beyond the margin.
    fn near_by(&self, index: usize, poses: &[Isometry3<f64>]) -> Option<f64> {
        let gap = self.ball_gap(index, poses);
        (gap <= self.margin()).then_some(gap)
    }

    /// Returns whether a pair is proven farther apart than the margin at posed bodies.
    fn keeps_margin(&mut self, index: usize, poses: &[Isometry3<f64>]) -> Result<bool, PlanError> {
        self.work.decisions += 1;
        let margin = self.margin();
        let (tracked, _) = self.pairs.tracked(index);
        let (pair, world) = (tracked.pair, &self.world);
        let pose_of = |part: WorldId| match part {
            WorldId::Robot(k) => &poses[k],
            WorldId::Obstacle(k) => &world.obstacles[k].2,
        };
        let relative = RelativePose::new(pose_of(pair.a), pose_of(pair.b))?;
        let [a, b] = world.shapes(pair);
        Ok(!tracked.tracker.within(a, b, &relative, margin))
    }
}
