//! Hulls that answer before meshes.
//!
//! If the hulls of two bodies are proven farther apart than a distance, the bodies are too, and the
//! meshes are not queried. In all other cases the meshes decide.

use core::ops::Range;
use std::boxed::Box;

use nalgebra::Isometry3;

use crate::check::checker::{Checker, contact_tolerance, motions};
use crate::error::PlanError;
use crate::motion::space::ConfigurationSpace;
use lin_canny::impact::{Impact, cast_within};
use lin_canny::{Geometry, PairTracker, RelativePose};

impl<C: ConfigurationSpace> Checker<C> {
    /// Returns whether a pair with a mesh is proven farther apart than a distance by hulls.
    pub(crate) fn hulls_apart(
        &mut self,
        index: usize,
        poses: &[Isometry3<f64>],
        distance: f64,
    ) -> Result<bool, PlanError> {
        let Some((tracker, [a, b], relative)) = self.posed_hulls(index, poses)? else {
            return Ok(false);
        };
        Ok(!tracker.within(a, b, &relative, distance))
    }

    /// Returns a lower bound of the distance of a pair with a mesh by hulls; `None` if there are no
    /// hulls, or if they overlap.
    pub(crate) fn hull_gap(&mut self, index: usize, poses: &[Isometry3<f64>]) -> Result<Option<f64>, PlanError> {
        let Some((tracker, [a, b], relative)) = self.posed_hulls(index, poses)? else {
            return Ok(None);
        };
        // The depth of hulls that overlap would cost more than it saves.
        let is_apart = !tracker.within(a, b, &relative, 0.0);
        Ok(is_apart.then(|| tracker.lower_bound(a, b, &relative)))
    }

    /// Returns the hulls of a pair with a mesh, with their tracker, and counts a query of them.
    fn posed_hulls(&mut self, index: usize, poses: &[Isometry3<f64>]) -> Result<Option<HullQuery<'_>>, PlanError> {
        let pair = self.pairs.all[index].pair;
        let Some(hulls) = self.cell.hulls(pair) else {
            return Ok(None);
        };
        self.work.hulls += 1;
        let (tracked, body_poses) = self.pairs.tracked(index);
        let relative = RelativePose::new(body_poses.pose(pair.a, poses), body_poses.pose(pair.b, poses))?;
        let tracker = tracked.hull_tracker.get_or_insert_default();
        Ok(Some((tracker, hulls, relative)))
    }

    /// Returns the time of an interval up to which a pair is proven farther apart than a distance
    /// by hulls: the start if there are no hulls. Returns `None` if this is proven for the whole
    /// interval.
    pub(crate) fn hulls_meet(
        &mut self,
        index: usize,
        segment: &C::Segment,
        interval: &Range<f64>,
        distance: f64,
    ) -> Result<Option<f64>, PlanError> {
        let pair = self.pairs.all[index].pair;
        let Some(hulls) = self.cell.hulls(pair) else {
            return Ok(Some(interval.start));
        };
        let (tracked, body_poses) = self.pairs.tracked(index);
        let tracker = tracked.hull_tracker.get_or_insert_default();
        let (motion, partner) = motions(segment, body_poses, pair, interval.start, false);
        let mut hulls = tracker.pair(hulls[0], hulls[1]);
        let tolerance = contact_tolerance(&hulls);
        let found = cast_within(&mut hulls, &motion, &partner, interval.clone(), tolerance, distance)?;
        self.work.hulls += u64::from(found.queries + found.proofs);
        Ok(match found.impact {
            Impact::Miss => None,
            Impact::Hit { safe, .. } | Impact::Undecided { safe, .. } | Impact::Incomplete { safe } => Some(safe),
            // A variant that is unknown here proves nothing.
            _ => Some(interval.start),
        })
    }
}

/// A tracker, the hulls and their relative pose.
type HullQuery<'a> = (&'a mut Box<PairTracker>, [&'a Geometry; 2], RelativePose);
