//! The clearance at a configuration and along a segment.

use core::cmp::Ordering;
use core::fmt;
use std::collections::BinaryHeap;
use std::vec::Vec;

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

use crate::cell::Named;
use crate::check::body_boxes::{GROWN, PlacedBox, placed_ball};
use crate::check::checker::Checker;
use crate::check::pairs::PairKey;
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::motion::joint_motion::{JointMotion, PieceRef};
use crate::motion::space::{ConfigurationSpace, SegmentMotion};
use crate::names::{CellBody, CellPair};
use crate::tolerance::PLACED;
use lin_canny::ContactState;
use lin_canny::RelativePose;
use lin_canny::broad::Aabb;
use lin_canny::impact::Impact;

/// Configurations of a segment that are measured before its clearance is proven.
const SAMPLES: u32 = 8;

/// Maximum number of times that the clearance to be proven is lowered along a segment.
const LOWERED: u32 = 1000;

/// Factor by which the search distance grows if no obstacle is within the distance of the last
/// clearance. If none is within the larger distance, all obstacles are measured.
const ENLARGED: f64 = 4.0;

/// A pair at a configuration: signed distance, bounds, witness points and gradient.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct NearPair {
    /// The pair.
    pub pair: CellPair,
    /// Signed distance: negative for an overlap, zero for an overlap of unknown depth.
    pub distance: f64,
    /// Lower bound of the signed distance.
    pub lower: f64,
    /// Upper bound of the signed distance.
    pub upper: f64,
    /// The signed distance less the required distance of the pair
    /// ([`Cell::required_distance`](crate::Cell::required_distance)).
    pub excess: f64,
    /// Witness points on both bodies, in the world.
    pub witnesses: [Point3<f64>; 2],
    /// Unit vector from the first body to the second, in the world; zero for an overlap of unknown
    /// depth.
    pub normal: Vector3<f64>,
    /// Derivative of the signed distance by each component of a step: by each coordinate, or for a
    /// [`RigidSpace`](crate::RigidSpace) by position and rotation vector. Zero for an overlap of
    /// unknown depth.
    ///
    /// Where two places of a body are equally close, as at parallel faces, the distance has a kink:
    /// the gradient is that of the witness points alone.
    pub gradient: Vec<f64>,
}

impl NearPair {
    /// Returns the gradient, each component divided by its
    /// [`scale`](ConfigurationSpace::scales): derivatives by a length.
    #[must_use]
    pub fn scaled_gradient(&self, scales: &[f64]) -> Vec<f64> {
        self.gradient.iter().zip(scales).map(|(g, s)| g / s).collect()
    }
}

impl fmt::Display for Named<'_, NearPair> {
    /// Writes the names, the signed distance and its bounds.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let near = self.value;
        let pair = self.cell.show(&near.pair);
        write!(
            f,
            "{pair} at {:?} ({:?} to {:?})",
            near.distance, near.lower, near.upper
        )
    }
}

/// A measured pair without its gradient.
struct MeasuredPair {
    /// Distance of the balls around both bodies, and key of the pair: they order pairs of equal
    /// distance.
    gap: f64,
    key: PairKey,
    near: NearPair,
}

/// A pair that may be the closest. The greatest candidate is the next: that of the least bound.
#[derive(Clone, Copy)]
struct Candidate {
    /// Lower bound of the distance, by balls or by hulls.
    bound: f64,
    key: PairKey,
    index: usize,
    /// Distance of the balls.
    gap: f64,
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound).then(other.key.cmp(&self.key))
    }
}

/// The clearance along a motion: a proven lower bound, and a distance that is attained.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SegmentClearance {
    /// Lower bound of the distance of all pairs over the whole motion; zero if nothing is proven,
    /// infinite if there is no pair.
    pub lower: f64,
    /// Upper bound of the least distance: at `t` of `piece`, `pair` is at most this far apart.
    pub upper: f64,
    /// A time of the piece at which `upper` holds.
    pub t: f64,
    /// Index of the piece of the motion.
    pub piece: usize,
    /// The closest pair at `t`; `None` if there is no pair.
    pub pair: Option<CellPair>,
}

impl<C: ConfigurationSpace> Checker<C> {
    /// Returns the pair of least signed distance at a configuration; `None` if there is no pair.
    ///
    /// Only convex bodies have depths. An overlapping pair with a mesh has the distance 0 and a
    /// [`NearPair::lower`] of minus infinity, so among pairs in contact the deepest convex pair
    /// comes first. [`in_contact`](Self::in_contact) returns all pairs in contact. Margins and
    /// paddings do not change the distance.
    ///
    /// # Errors
    /// Returns an error if the configuration is invalid.
    pub fn clearance(&mut self, configuration: &[f64]) -> Result<Option<NearPair>, PlanError> {
        let mut near = self.nearest(configuration, 0.0)?;
        near.truncate(1);
        Ok(near.pop())
    }

    /// Returns the pair of least [`excess`](NearPair::excess) at a configuration; `None` if there is no
    /// pair. The pair keeps its required distance if the excess is above 0, and then all pairs do.
    ///
    /// If all pairs have the same required distance, this is the pair of [`clearance`](Self::clearance).
    ///
    /// # Errors
    /// Returns an error if the configuration is invalid.
    pub fn least_excess(&mut self, configuration: &[f64]) -> Result<Option<NearPair>, PlanError> {
        let slack = if self.pairs.is_uniform {
            0.0
        } else {
            self.pairs.spread()
        };
        let near = self.nearest(configuration, slack)?;
        // The first of equal pairs.
        Ok(near.into_iter().min_by(|x, y| x.excess.total_cmp(&y.excess)))
    }

    /// Returns all pairs whose signed distance exceeds the least by at most `slack`.
    ///
    /// The closest pair comes first, by true distance; [`NearPair::excess`] takes off what the pair
    /// must keep. These pairs are the active set of the clearance.
    ///
    /// # Errors
    /// Returns an error if the configuration is invalid, or if `slack` is negative or NaN.
    pub fn nearest(&mut self, configuration: &[f64], slack: f64) -> Result<Vec<NearPair>, PlanError> {
        if !(slack >= 0.0) {
            let (what, value) = ("slack of the distances", slack);
            return Err(PlanError::Value { what, value });
        }
        self.space.check(configuration)?;
        self.check_time()?;
        self.nearest_within_rounding(configuration, slack)
    }

    /// Returns what [`nearest`](Self::nearest) returns, at a configuration that may exceed its
    /// bounds by rounding.
    fn nearest_within_rounding(&mut self, configuration: &[f64], slack: f64) -> Result<Vec<NearPair>, PlanError> {
        self.with_poses(configuration, |own, poses| own.measured(configuration, poses, slack))
    }

    fn measured(&mut self, q: &[f64], poses: &[Isometry3<f64>], slack: f64) -> Result<Vec<NearPair>, PlanError> {
        self.place_balls(poses);
        let mut found: Vec<MeasuredPair> = Vec::new();
        let mut least = f64::INFINITY;
        // Start with the distance of the last result. Pairs left out are farther than `reach`.
        let mut reach = self.reach;
        loop {
            self.gather_within(reach, poses)?;
            let is_all = self.candidates.len() == self.pairs.len();
            self.measure_nearest(poses, slack, &mut least, &mut found)?;
            if is_all || least + slack <= reach {
                break;
            }
            let wide = ENLARGED * self.reach;
            reach = match least < f64::INFINITY {
                true => least + slack,
                false if reach < wide => wide,
                false => f64::INFINITY,
            };
        }
        if least + slack < f64::INFINITY {
            self.reach = (least + slack).larger(self.pairs.robot_radius);
        }
        found.retain(|m| m.near.distance <= least + slack);
        found.sort_by(|x, y| {
            let by_distance = x.near.distance.total_cmp(&y.near.distance);
            by_distance.then(x.gap.total_cmp(&y.gap)).then(x.key.cmp(&y.key))
        });
        for m in &mut found {
            self.slope(&mut m.near, q);
        }
        Ok(found.into_iter().map(|m| m.near).collect())
    }

    /// Collects the pairs that may be within `reach`, and all pairs of two bodies that move with
    /// the robot.
    pub(crate) fn gather_within(&mut self, reach: f64, poses: &[Isometry3<f64>]) -> Result<(), PlanError> {
        self.gather_about(|_| reach, poses)
    }

    /// Collects the pairs that may be closer than they must be, and all pairs of two bodies that
    /// move with the robot.
    pub(crate) fn gather_kept(&mut self, poses: &[Isometry3<f64>]) -> Result<(), PlanError> {
        let most = core::mem::take(&mut self.pairs.most_kept);
        let found = self.gather_about(|mover| most[mover], poses);
        self.pairs.most_kept = most;
        found
    }

    /// Collects the pairs whose boxes overlap that of the ball around a mover, grown by a distance.
    fn gather_about(&mut self, reach: impl Fn(usize) -> f64, poses: &[Isometry3<f64>]) -> Result<(), PlanError> {
        self.candidates.clear();
        for mover in 0..poses.len() {
            if self.pairs.mover_balls[mover].is_none() {
                continue;
            }
            let reach = reach(mover);
            if !(reach < f64::INFINITY) {
                self.candidates.clear();
                self.pairs.with_obstacles(&mut self.candidates);
                break;
            }
            let (centre, radius) = self.placed_balls[mover];
            let most = (radius + reach) * GROWN + PLACED * centre.coords.abs().sum();
            let about = Aabb::new(centre, centre).grown(most);
            self.pairs.near(mover, &about, &mut self.candidates)?;
        }
        self.candidates.extend(self.pairs.own.values());
        self.work.pairs += self.candidates.len() as u64;
        Ok(())
    }

    /// Measures candidates in the order of the lower bounds of their distances, as long as one may
    /// be within `slack` of the least. The bounds are those of balls first, then those of hulls.
    fn measure_nearest(
        &mut self,
        poses: &[Isometry3<f64>],
        slack: f64,
        least: &mut f64,
        found: &mut Vec<MeasuredPair>,
    ) -> Result<(), PlanError> {
        let candidates = self.candidates.iter();
        let keyed = candidates.map(|&index| {
            let (gap, key) = (self.ball_gap(index), self.pairs.all[index].key);
            Candidate {
                bound: gap,
                key,
                index,
                gap,
            }
        });
        // By falling bound: the nearest candidate is the last.
        let mut by_balls: Vec<Candidate> = keyed.collect();
        by_balls.sort_unstable();
        let mut by_hulls: BinaryHeap<Candidate> = BinaryHeap::new();
        let now = self.work.configurations;
        loop {
            let is_hull = match (by_balls.last(), by_hulls.peek()) {
                (Some(ball), Some(hull)) => hull > ball,
                (ball, _) => ball.is_none(),
            };
            let next = if is_hull { by_hulls.pop() } else { by_balls.pop() };
            let Some(next) = next.filter(|next| next.bound <= *least + slack) else {
                break;
            };
            if !is_hull {
                if core::mem::replace(&mut self.pairs.all[next.index].measured, now) == now {
                    continue;
                }
                if let Some(gap) = self.hull_gap(next.index, poses)? {
                    let bound = next.bound.larger(gap);
                    by_hulls.push(Candidate { bound, ..next });
                    continue;
                }
            }
            let near = self.measure(next.index, poses)?;
            *least = least.smaller(near.distance);
            found.push(MeasuredPair {
                gap: next.gap,
                key: next.key,
                near,
            });
        }
        Ok(())
    }

    /// Places the balls around all movers, for [`ball_gap`](Self::ball_gap) and
    /// [`boxes_apart`](Self::boxes_apart).
    pub(crate) fn place_balls(&mut self, poses: &[Isometry3<f64>]) {
        let mut placed = core::mem::take(&mut self.placed_balls);
        placed.clear();
        let balls = self.pairs.mover_balls.iter().zip(poses);
        placed.extend(balls.map(|(ball, pose)| placed_ball(ball.unwrap_or((Point3::origin(), 0.0)), pose)));
        self.placed_balls = placed;
        self.placed_boxes.clear();
        self.placed_boxes.resize(poses.len(), None);
    }

    /// Returns a lower bound of the distance of the balls around both bodies; negative if they
    /// overlap. [`place_balls`](Self::place_balls) comes first.
    pub(crate) fn ball_gap(&self, index: usize) -> f64 {
        let pair = self.pairs.all[index].pair;
        let [(p, r), (q, s)] = [pair.a, pair.b].map(|part| match (part, self.pairs.body_poses.mover(part)) {
            (CellBody::Obstacle(k), _) => self.pairs.placed(k).ball,
            (_, mover) => self.placed_balls[mover.unwrap_or_default()],
        });
        (q - p).norm() - r - s
    }

    /// Returns whether the boxes around both bodies are proven farther apart than a distance.
    ///
    /// Along each axis of a box there is a gap between it and the extent of the other box, or none.
    /// The root of the sum of the squared gaps is at most the distance of the bodies.
    pub(crate) fn boxes_apart(&mut self, index: usize, poses: &[Isometry3<f64>], distance: f64) -> bool {
        let pair = self.pairs.all[index].pair;
        let [a, b] = [pair.a, pair.b].map(|part| match (part, self.pairs.body_poses.mover(part)) {
            (CellBody::Obstacle(k), _) => self.pairs.placed(k).own_box,
            (_, mover) => {
                let mover = mover.unwrap_or_default();
                let own = self.pairs.mover_own_box(mover);
                *self.placed_boxes[mover].get_or_insert_with(|| PlacedBox::new(own, &poses[mover]))
            }
        });
        let (apart, turn) = (b.middle - a.middle, a.axes.tr_mul(&b.axes));
        let least = distance + a.error_of_heights(&b);
        let is_apart = |apart: &Vector3<f64>, half: &Vector3<f64>, turn: &Matrix3<f64>, other: &Vector3<f64>| {
            let gaps = apart.abs() - half - turn.abs() * other;
            gaps.map(|x| if x > 0.0 { x } else { 0.0 }).norm() > least
        };
        is_apart(&a.axes.tr_mul(&apart), &a.half, &turn, &b.half)
            || is_apart(&b.axes.tr_mul(&apart), &b.half, &turn.transpose(), &a.half)
    }

    /// Measures one pair without its gradient.
    fn measure(&mut self, index: usize, poses: &[Isometry3<f64>]) -> Result<NearPair, PlanError> {
        self.work.measures += 1;
        let (tracked, body_poses) = self.pairs.tracked(index);
        let pair = tracked.pair;
        let [pose_a, pose_b] = [pair.a, pair.b].map(|part| *body_poses.pose(part, poses));
        let relative = RelativePose::new(&pose_a, &pose_b)?;
        let [a, b] = self.cell.shapes(pair);
        let outcome = tracked.tracker.closest(a, b, &relative);
        let is_known = outcome.state != ContactState::Overlapping || outcome.lower > f64::NEG_INFINITY;
        let distance = if is_known { outcome.distance } else { 0.0 };
        let normal = pose_a.rotation * outcome.normal.into_inner();
        Ok(NearPair {
            pair,
            distance,
            lower: outcome.lower,
            upper: outcome.upper,
            excess: distance - tracked.kept,
            witnesses: [pose_a * outcome.point_on_a, pose_b * outcome.point_on_b],
            normal: if is_known { normal } else { Vector3::zeros() },
            gradient: Vec::new(),
        })
    }

    /// Fills in the gradient of a pair.
    fn slope(&self, near: &mut NearPair, q: &[f64]) {
        let mut gradient = std::vec![0.0; self.space.degrees_of_freedom()];
        let mut part = gradient.clone();
        let body_poses = &self.pairs.body_poses;
        for (k, (of, sign)) in [(near.pair.a, -1.0), (near.pair.b, 1.0)].into_iter().enumerate() {
            if let Some(mover) = body_poses.mover(of) {
                let body = body_poses.carrier(mover).0;
                self.space
                    .gradient(q, body, &near.witnesses[k], &near.normal, &mut part);
                gradient.iter_mut().zip(&part).for_each(|(g, p)| *g += sign * p);
            }
        }
        near.gradient = gradient;
    }

    /// Returns bounds of the least clearance along a motion.
    ///
    /// The bounds differ by at most the fraction `relative` of the upper bound, if a proof is
    /// found. This is nearly always so for 1e-3 and more; a smaller `relative` may end without a
    /// proof. A tube around the motion does not matter.
    ///
    /// # Errors
    /// Returns an error as [`certify`](Self::certify) does, or if `relative` is not between 0 and 1.
    pub fn clearance_along(&mut self, motion: &JointMotion, relative: f64) -> Result<SegmentClearance, PlanError> {
        if !(relative > 0.0 && relative < 1.0) {
            return Err(PlanError::Value {
                what: "relative width of the clearance",
                value: relative,
            });
        }
        let mut all = self.bounded(motion, 0, relative)?;
        for piece in 1..motion.pieces() {
            let next = self.bounded(motion, piece, relative)?;
            let lower = all.lower.smaller(next.lower);
            if next.upper < all.upper {
                all = next;
            }
            all.lower = lower;
        }
        if let Some(time) = self.time {
            self.place_moving(time)?;
        }
        Ok(all)
    }

    /// Returns bounds of the least clearance along a piece.
    fn bounded(&mut self, motion: &JointMotion, piece: usize, relative: f64) -> Result<SegmentClearance, PlanError> {
        let segment = self.along(motion, piece)?;
        let is_empty = self.pairs.len() == 0;
        let mut found = SegmentClearance {
            lower: if is_empty { f64::INFINITY } else { 0.0 },
            upper: f64::INFINITY,
            t: 0.0,
            piece,
            pair: None,
        };
        for k in 0..=SAMPLES {
            let t = f64::from(k) / f64::from(SAMPLES);
            let q = match motion.piece_ref(piece) {
                PieceRef::Segment([from, to]) => self.space.between(from, to, t),
                PieceRef::Curve(curve) => curve.at(t),
            };
            self.pairs.place_along(t);
            if let Some(near) = self.nearest_within_rounding(&q, 0.0)?.first() {
                found.lower_to(near.upper, t, near.pair);
            }
        }
        let mut keep = found.upper * (1.0 - relative);
        if found.pair.is_none() || !(keep > 0.0) {
            return Ok(found);
        }
        for k in self.pairs.ordered() {
            match self.lowered(k, &segment, keep, relative, &mut found)? {
                Some(kept) => keep = kept,
                None => return Ok(found),
            }
        }
        found.lower = keep;
        Ok(found)
    }

    /// Lowers the distance to be proven until the pair keeps it; `None` if nothing is proven.
    fn lowered(
        &mut self,
        index: usize,
        segment: &C::Segment,
        mut keep: f64,
        relative: f64,
        found: &mut SegmentClearance,
    ) -> Result<Option<f64>, PlanError> {
        for part in self.intervals(index, segment.parts()) {
            let Some(mut time) = self.hulls_meet(index, segment, &part, keep)? else {
                continue;
            };
            let mut is_kept = false;
            for _ in 0..LOWERED {
                let cast = self.cast(index, segment, time..part.end, keep, None, None)?;
                self.work.queries += u64::from(cast.queries + cast.proofs);
                let pair = self.pairs.all[index].pair;
                match cast.impact {
                    Impact::Miss => {
                        is_kept = true;
                        break;
                    }
                    Impact::AtStart { seen } => found.lower_to(seen.upper, time, pair),
                    Impact::Hit { safe, seen, .. } => {
                        time = safe;
                        found.lower_to(seen.upper, time, pair);
                    }
                    Impact::Undecided { safe, .. } | Impact::Incomplete { safe } => time = safe,
                    // A variant that is unknown here proves nothing.
                    _ => break,
                }
                keep = keep.smaller(found.upper) * (1.0 - relative);
                if !(keep > 0.0) {
                    break;
                }
            }
            if !is_kept {
                return Ok(None);
            }
        }
        Ok(Some(keep))
    }
}

impl SegmentClearance {
    fn lower_to(&mut self, upper: f64, t: f64, pair: CellPair) {
        if upper < self.upper {
            (self.upper, self.t, self.pair) = (upper, t, Some(pair));
        }
    }
}
