//! Decides whether a single configuration is free, by predicates alone.

use nalgebra::Isometry3;

use crate::check::checker::{Checker, HITS, HITS_FIRST};
use crate::error::PlanError;
use crate::motion::space::ConfigurationSpace;
use crate::names::CellPair;
use lin_canny::RelativePose;

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
        self.check_time()?;
        let hit = self.with_poses(configuration, |own, poses| own.first_hit(configuration, poses))?;
        if let Some(index) = hit {
            self.remember_hit(index);
        }
        Ok(hit.is_none())
    }

    /// Returns the index of a pair that is not proven to keep the margin.
    fn first_hit(&mut self, configuration: &[f64], poses: &[Isometry3<f64>]) -> Result<Option<usize>, PlanError> {
        self.place_balls(poses);
        for k in 0..self.hits.len().min(HITS_FIRST) {
            let index = self.hits[k];
            if self.near_by(index).is_some() && !self.keeps_margin(index, configuration, poses)? {
                return Ok(Some(index));
            }
        }
        self.gather_kept(poses)?;
        let mut order = core::mem::take(&mut self.order);
        order.clear();
        order.extend(self.candidates.iter().filter_map(|&k| {
            let gap = self.near_by(k)?;
            // Recent collisions come first; the first few are known to be apart.
            let rank = self.hits.iter().position(|&hit| hit == k);
            let is_new = rank.is_none_or(|rank| rank >= HITS_FIRST);
            is_new.then(|| (rank.unwrap_or(HITS), gap, self.pairs.all[k].key, k))
        }));
        order.sort_unstable_by(|x, y| {
            let by_rank = x.0.cmp(&y.0);
            by_rank.then(x.1.total_cmp(&y.1)).then(x.2.cmp(&y.2))
        });
        let mut found = Ok(None);
        for &(_, _, _, index) in &order {
            match self.keeps_margin(index, configuration, poses) {
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
    fn near_by(&self, index: usize) -> Option<f64> {
        let gap = self.ball_gap(index);
        (gap <= self.kept(index)).then_some(gap)
    }

    /// Returns whether a pair is proven farther apart than the margin.
    fn keeps_margin(&mut self, index: usize, q: &[f64], poses: &[Isometry3<f64>]) -> Result<bool, PlanError> {
        let kept = self.kept(index);
        if let Some(boxes) = &self.pairs.all[index].apart
            && boxes.apart_at(q, kept)
        {
            self.work.lookups += 1;
            return Ok(true);
        }
        if self.boxes_apart(index, poses, kept) || self.hulls_apart(index, poses, kept)? {
            return Ok(true);
        }
        self.work.decisions += 1;
        Ok(!self.is_within(index, poses, kept)?)
    }

    /// Returns whether a pair may be within a distance; `false` is proven.
    fn is_within(&mut self, index: usize, poses: &[Isometry3<f64>], distance: f64) -> Result<bool, PlanError> {
        let (tracked, body_poses) = self.pairs.tracked(index);
        let pair = tracked.pair;
        let relative = RelativePose::new(body_poses.pose(pair.a, poses), body_poses.pose(pair.b, poses))?;
        let [a, b] = self.cell.shapes(pair);
        Ok(tracked.tracker.within(a, b, &relative, distance))
    }

    /// Returns all pairs in contact at a configuration, in ascending order.
    ///
    /// A pair within rounding error of contact counts. Margins do not matter. This call measures no
    /// distance, so it costs less than [`nearest`](Self::nearest).
    ///
    /// # Errors
    /// Returns an error if the configuration is invalid.
    pub fn in_contact(&mut self, configuration: &[f64]) -> Result<Vec<CellPair>, PlanError> {
        self.space.check(configuration)?;
        self.check_time()?;
        self.with_poses(configuration, Self::touching)
    }

    /// Returns what `ask` returns about the poses of the bodies at a configuration.
    pub(super) fn with_poses<R>(
        &mut self,
        configuration: &[f64],
        ask: impl FnOnce(&mut Self, &[Isometry3<f64>]) -> R,
    ) -> R {
        self.work.configurations += 1;
        let mut poses = core::mem::take(&mut self.poses);
        self.space.place(configuration, &mut poses);
        self.pairs.body_poses.carry(&mut poses);
        let found = ask(self, &poses);
        self.poses = poses;
        found
    }

    fn touching(&mut self, poses: &[Isometry3<f64>]) -> Result<Vec<CellPair>, PlanError> {
        self.place_balls(poses);
        self.gather_within(0.0, poses)?;
        let candidates = core::mem::take(&mut self.candidates);
        let mut found = Vec::new();
        for &index in &candidates {
            if self.ball_gap(index) > 0.0
                || self.boxes_apart(index, poses, 0.0)
                || self.hulls_apart(index, poses, 0.0)?
            {
                continue;
            }
            self.work.decisions += 1;
            if self.is_within(index, poses, 0.0)? {
                found.push(self.pairs.all[index].pair);
            }
        }
        self.candidates = candidates;
        found.sort_unstable();
        Ok(found)
    }
}
