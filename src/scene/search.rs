//! Queries on top of a step, about the poses of the last step: all pairs within a distance, the
//! nearest bodies, the first contact. The closest pair of two groups is in `closest`.
//!
//! The queries use the boxes of the step and are allowed for groups between which any effect is
//! called for, be it `boxes` alone. No result is stored; if a step follows a pair, the stored
//! tracker is the start of the query.

use alloc::vec::Vec;

use super::ball::least_distance;
use super::body::box_of;
use super::effects::{Detail, Group, group_pair_of};
use super::{BodyId, Scene, SceneError};
use crate::base::pose::RelativePose;
use crate::base::tolerance::{BOX_DISTANCE_DOWN, SCENE_REACH};
use crate::body::polyhedron::BoxHint;
use crate::broad::{Aabb, BroadPhase};
use crate::pair::outcome::{Outcome, Until};
use crate::pair::question::Question;
use crate::pair::spot::Answer;
use crate::pair_tracker::Engine;
use crate::pair_tracker::geometry::GeometryRef;

/// A pair and its closest features, in the frames of the bodies as in
/// [`PairAnswer`](super::PairAnswer).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct ClosestPair {
    /// The query body, or the body of the first group; of two bodies of one group the one with the
    /// lower index. A of the outcome.
    pub a: BodyId,
    /// The second body: B of the outcome.
    pub b: BodyId,
    /// Distance with bounds, features, witnesses and normal.
    pub outcome: Outcome,
    /// The pieces or triangles of the features, as in
    /// [`PairAnswer::pieces`](super::PairAnswer::pieces).
    pub pieces: [u32; 2],
}

impl Scene {
    /// Returns all pairs of a body of group `these` and a body of group `those` that are at most
    /// `d` apart, exactly; in ascending order of the bodies. Two fixed bodies are no pair. Overlaps
    /// have the distance 0; no depth is computed.
    ///
    /// # Errors
    /// If nothing is called for between the groups, a step is due, or `d` is NaN, negative or
    /// beyond 1e37.
    pub fn pairs_within(&self, these: Group, those: Group, d: f64) -> Result<Vec<ClosestPair>, SceneError> {
        if !(0.0..=SCENE_REACH).contains(&d) {
            return Err(SceneError::Range { value: d });
        }
        let mut found = Vec::new();
        self.visit_pairs(these, those, d, |a, b| {
            found.extend(self.near_within(a, b, d));
            true
        })?;
        Ok(found)
    }

    /// Returns the first pair of a body of group `these` and a body of group `those`, in ascending
    /// order, that shares a point; with the depth if both are convex. The search ends there.
    ///
    /// # Errors
    /// If nothing is called for between the groups, or a step is due.
    #[doc(alias = "early exit")]
    pub fn first_contact(&self, these: Group, those: Group) -> Result<Option<ClosestPair>, SceneError> {
        let mut found = None;
        self.visit_pairs(these, those, 0.0, |a, b| {
            found = self.near_within(a, b, 0.0);
            found.is_none()
        })?;
        Ok(found.map(|near| {
            let outcome = self
                .query(near.a.index, near.b.index)
                .map(|mut q| q.measure(Until::Depth).outcome);
            ClosestPair {
                outcome: outcome.unwrap_or(near.outcome),
                ..near
            }
        }))
    }

    /// Returns the `count` bodies nearest to a body and no farther away than `farthest`, nearest
    /// first, ties in ascending order: only bodies of groups between which and the group of the
    /// body any effect is called for. Overlaps have the distance 0; no depth is computed.
    ///
    /// # Errors
    /// If the id is stale, a step is due, nothing is called for between the group of the body and
    /// any group, or `farthest` is NaN or negative.
    #[doc(alias = "k-nearest")]
    pub fn nearest(&self, id: BodyId, count: usize, farthest: f64) -> Result<Vec<ClosestPair>, SceneError> {
        let i = self.bodies.index_of(id)?;
        if self.is_due() {
            return Err(SceneError::StepDue);
        }
        if let Some(group) = self.bodies.group(id.index).filter(|g| self.table.partners(*g) == 0) {
            return Err(SceneError::GroupNotCalledFor { group });
        }
        if !(farthest >= 0.0) {
            return Err(SceneError::Range { value: farthest });
        }
        let around = self.box_around(i, 0.0);
        let mut asked = count.saturating_add(1);
        loop {
            asked = asked.saturating_mul(2);
            let boxes = self.broad.nearest(&around, asked, farthest)?;
            let others = boxes.iter().map(|n| self.bodies.body_of_proxy[n.body.index as usize]);
            let mut found: Vec<ClosestPair> = others
                .filter(|&other| self.may_pair(id.index, other))
                .filter_map(|other| self.near_within(id.index, other, farthest))
                .collect();
            found.sort_by(|x, y| x.outcome.distance.total_cmp(&y.outcome.distance).then(x.b.cmp(&y.b)));
            found.truncate(count);
            // Boxes that were not listed are no nearer than the last box; bodies are no nearer than
            // their boxes.
            let covered = boxes.last().map_or(0.0, |n| n.distance * BOX_DISTANCE_DOWN);
            let settled = found.len() == count && found.last().is_none_or(|n| n.outcome.upper <= covered);
            if settled || boxes.len() < asked {
                return Ok(found);
            }
        }
    }

    /// Refuses a query about two groups whose boxes are not kept, or not of the present poses.
    pub(super) fn check_query(&self, these: Group, those: Group) -> Result<(), SceneError> {
        if self.is_due() {
            return Err(SceneError::StepDue);
        }
        if self.table.plan(group_pair_of(these, those)).detail == Detail::Nothing {
            return Err(SceneError::NotCalledFor { these, those });
        }
        Ok(())
    }

    /// Visits pairs whose boxes are at most `d` apart, in ascending order, until `visit` returns
    /// false.
    fn visit_pairs(
        &self,
        these: Group,
        those: Group,
        d: f64,
        mut visit: impl FnMut(u32, u32) -> bool,
    ) -> Result<(), SceneError> {
        self.check_query(these, those)?;
        let mut near = Vec::new();
        let mut others: Vec<u32> = Vec::new();
        for id in self
            .bodies
            .ids()
            .filter(|id| self.bodies.group(id.index) == Some(these))
        {
            near.clear();
            self.broad
                .overlapping(&self.box_around(id.index as usize, d), &mut near)?;
            others.clear();
            others.extend(near.iter().map(|other| self.bodies.body_of_proxy[other.index as usize]));
            others.sort_unstable();
            for &other in &others {
                let twice = these == those && other < id.index;
                let asked = self.bodies.group(other) == Some(those) && self.may_pair(id.index, other);
                if asked && !twice && !visit(id.index, other) {
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    pub(super) fn box_around(&self, i: usize, d: f64) -> Aabb {
        let pose = &self.bodies.poses[i];
        match &self.bodies.solids[i] {
            Some(solid) => box_of(&solid.shape, pose, d, &mut BoxHint::default()),
            None => Aabb::from_center(pose.translation.vector.into(), nalgebra::Vector3::zeros()),
        }
    }

    pub(super) fn may_pair(&self, a: u32, b: u32) -> bool {
        let [x, y] = [a, b].map(|i| self.bodies.solids[i as usize].as_ref());
        let (Some(x), Some(y)) = (x, y) else { return false };
        let pairs = a != b && !(x.fixed && y.fixed) && !self.ignored.contains(a, b);
        pairs && self.table.plan(group_pair_of(x.group, y.group)).detail > Detail::Nothing
    }

    /// Returns the pair, if at most `d` apart.
    fn near_within(&self, a: u32, b: u32, d: f64) -> Option<ClosestPair> {
        let [x, y] = [a, b].map(|i| &self.bodies.balls[i as usize]);
        if least_distance(x, y) > d {
            return None;
        }
        let mut query = self.query(a, b)?;
        let answer = query.measure(Until::Class);
        query.decides_within(&answer, d).then(|| ClosestPair {
            a: self.bodies.id(a),
            b: self.bodies.id(b),
            outcome: answer.outcome,
            pieces: answer.parts(),
        })
    }

    /// Returns a query of two bodies whose tracker begins with the state of the step's own tracker.
    pub(super) fn query(&self, a: u32, b: u32) -> Option<PairQuery<'_>> {
        let [i, j] = [a as usize, b as usize];
        let (x, y) = (
            &self.bodies.solids[i].as_ref()?.shape,
            &self.bodies.solids[j].as_ref()?.shape,
        );
        let pose = RelativePose::new(&self.bodies.poses[i], &self.bodies.poses[j]).ok()?;
        let pair = self.broad.pair(self.bodies.proxies[i], self.bodies.proxies[j]);
        let known = pair.and_then(|pair| self.pair_tables.started(pair.id.slot, [x, y], a < b));
        let shapes = [x.into(), y.into()];
        Some(PairQuery {
            engine: known.unwrap_or_else(|| Engine::new(shapes)),
            shapes,
            pose,
        })
    }
}

/// Two bodies and their engine.
pub(super) struct PairQuery<'a> {
    engine: Engine,
    shapes: [GeometryRef<'a>; 2],
    pose: RelativePose,
}

impl PairQuery<'_> {
    pub(super) fn measure(&mut self, until: Until) -> Answer {
        let question = Question::new().until(until);
        self.engine.lend(self.shapes).ask(&self.pose, &question)
    }

    fn decides_within(&mut self, outcome: &Outcome, d: f64) -> bool {
        self.engine.lend(self.shapes).decides_within(&self.pose, outcome, d)
    }
}
