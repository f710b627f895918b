//! Decides whether a single configuration is free, by predicates alone.

use nalgebra::Isometry3;

use crate::checker::Checker;
use crate::error::PlanError;
use crate::space::ConfigurationSpace;
use crate::world::WorldId;
use lin_canny::RelativePose;

/// Number of recent collisions that are tested first at the next configuration. The first few of
/// them are tested before any box. Not measured.
const HITS: usize = 16;
const HITS_FIRST: usize = 2;

impl<C: ConfigurationSpace> Checker<C> {
    /// Returns whether every pair is proven farther apart than the margin at a configuration.
    ///
    /// Measures no distance, and ends at the first pair that is not free. Tests recent collisions
    /// first, then pairs with overlapping boxes, in the order of the distances of their balls.
    /// Equals [`is_free`](Self::is_free) of a one-point segment, except within rounding of the
    /// margin, where this call is exact wherever
    /// [`PairTracker::within`](lin_canny::PairTracker::within) is. Use [`nearest`](Self::nearest)
    /// to learn which pairs collide.
    ///
    /// # Errors
    /// Returns an error if the configuration is invalid.
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

    /// Returns the index of a pair that is not proven to keep the margin.
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
        // Recent collisions come first.
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

    /// Returns the distance of the balls around both bodies, unless it is beyond the margin.
    fn near_by(&self, index: usize, poses: &[Isometry3<f64>]) -> Option<f64> {
        let gap = self.ball_gap(index, poses);
        (gap <= self.margin()).then_some(gap)
    }

    /// Returns whether a pair is proven farther apart than the margin.
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
