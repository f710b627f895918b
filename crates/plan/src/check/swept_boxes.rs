//! The boxes that bodies sweep along a motion: they find the pairs that may meet, and prove most of
//! the others apart.
//!
//! The time is divided into equal parts. At a fraction u of a part, a point of a body is at most the
//! [`chord_deviation`](SegmentMotion::chord_deviation) from the point at u of the chord between its
//! positions at the start and at the end of the part. So the gap between two bodies along a fixed
//! direction is, during the whole part, at least the smaller one of the gaps at its two ends, less
//! both deviations. Two sets of directions are tested: the axes of the world, by the broad phase,
//! and then the axes of the boxes around the bodies, as those of one of them are at the start of the
//! part (Gottschalk, Lin and Manocha 1996, without the products of two axes).

use core::ops::Range;
use std::vec::Vec;

use nalgebra::{Isometry3, Matrix3, Vector3};

use crate::check::body_boxes::{GROWN, PlacedBox, around, kept_around, placed_ball};
use crate::check::pairs::{PairInterval, Pairs, TrackedPair};
use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::motion::space::{BodyBall, SegmentMotion};
use crate::names::{CellBody, CellPair};
use crate::tolerance::ATTACHED;
use lin_canny::broad::Aabb;

/// Maximum number of parts, a power of two.
const PARTS: u32 = 64;

/// Distance of the points of a body from their chords, in radii of the body, beyond which the parts
/// are halved. On segments of Panda, certificates take 433 million instructions with 0.5 and with 1,
/// 465 with 0.25 and 561 with 0.125. A random curve of degree 7 of an arm takes 39 us with 0.5, 27
/// with 1 and 25 with 2, the segment between its ends 6.3, 6.2 and 6.7.
const NEAR: f64 = 1.0;

/// The boxes of all movers along a motion.
#[derive(Default)]
pub(crate) struct Sweep {
    /// Number of equal parts of the time, a power of two.
    parts: u32,
    courses: Vec<Course>,
    /// Scratch memory: the poses of all bodies at the ends of all parts.
    poses: Vec<Isometry3<f64>>,
    times: Vec<f64>,
}

/// The boxes of a mover; none if it has no geometry.
#[derive(Default)]
struct Course {
    /// The box around the mover at the start of each part, and at the end of the last.
    placed: Vec<PlacedBox>,
    /// Upper bound of the distance of its points from their chords.
    deviation: f64,
    /// The box that contains it during each part, with what a tube adds.
    swept: Vec<Aabb>,
}

impl Sweep {
    /// Sweeps all movers along a motion, in at least `least` parts. `spread` returns what a tube adds
    /// to the boxes of a body from a time on, over a span.
    pub(crate) fn run<M: SegmentMotion>(
        &mut self,
        pairs: &Pairs,
        segment: &M,
        least: u32,
        spread: impl Fn(BodyBall, f64, f64) -> f64,
    ) {
        let (body_poses, movers) = (&pairs.body_poses, pairs.mover_balls.len());
        let body_ball = |mover: usize| {
            let (body, carried) = body_poses.carrier(mover);
            pairs.mover_balls[mover].map(|ball| BodyBall::new(ball, body, carried))
        };
        let deviation = |ball: &BodyBall, parts: u32| {
            let reach = (ball.centre.coords.norm() + ball.radius) * GROWN;
            // What is not a number is no bound.
            segment.chord_deviation(ball.body, reach, parts).at_most(f64::INFINITY)
        };
        self.parts = least;
        for ball in (0..movers).filter_map(body_ball) {
            while self.parts < PARTS && deviation(&ball, self.parts) > NEAR * ball.radius {
                self.parts *= 2;
            }
        }
        let span = 1.0 / f64::from(self.parts);
        self.times.clear();
        self.times.extend((0..=self.parts).map(|k| f64::from(k) * span));
        self.poses.clear();
        segment.poses(body_poses.bodies, &self.times, &mut self.poses);
        self.courses.resize_with(movers, Course::default);
        for (mover, course) in self.courses.iter_mut().enumerate() {
            course.placed.clear();
            course.swept.clear();
            let (Some(ball), Some(of_body)) = (pairs.mover_balls[mover], body_ball(mover)) else {
                continue;
            };
            course.deviation = deviation(&of_body, self.parts);
            let carried = body_poses.carrier(mover).1;
            if let Some(carried) = carried {
                let lengths = self.poses.iter().map(|pose| pose.translation.vector.abs().sum());
                let own = carried.pose.translation.vector.abs().sum() + ball.0.coords.abs().sum() + ball.1;
                course.deviation += 4.0 * ATTACHED * (own + lengths.fold(0.0, f64::larger));
            }
            let mut last: Option<(f64, Aabb)> = None;
            for (poses, &time) in self.poses.chunks(body_poses.bodies).zip(&self.times) {
                let pose = poses[of_body.body];
                let pose = carried.map_or(pose, |carried| carried.placed(&pose));
                let placed = PlacedBox::new(pairs.mover_own_box(mover), &pose);
                let now = around(placed_ball(ball, &pose), &placed);
                course.placed.push(placed);
                if let Some((start, before)) = last.replace((time, now)) {
                    let beyond = (course.deviation + spread(of_body, start, span)) * GROWN;
                    course.swept.push(before.united(&now).grown(beyond));
                }
            }
        }
    }

    /// Returns the end of a part.
    pub(crate) fn end(&self, part: usize) -> f64 {
        self.times[part + 1]
    }

    /// Returns the box that contains a mover during each part; none for one without geometry.
    pub(crate) fn swept(&self, mover: usize) -> &[Aabb] {
        &self.courses[mover].swept
    }

    /// Returns the start of the first and the end of the last part in which the boxes of two movers are
    /// within a distance along the axes. A mover without geometry may be anywhere.
    pub(crate) fn overlap(&self, a: usize, b: usize, kept: f64) -> Option<[f64; 2]> {
        let [a, b] = [a, b].map(|mover| self.swept(mover));
        if a.is_empty() || b.is_empty() {
            return Some([0.0, 1.0]);
        }
        let is_near = |k: &usize| kept_around(&a[*k], kept).overlaps(&b[*k]);
        let (first, last) = ((0..a.len()).find(is_near)?, (0..a.len()).rev().find(is_near)?);
        Some([self.times[first], self.end(last)])
    }

    /// Returns the times of an interval between which a pair is not proven farther apart than `kept`
    /// by the boxes around both bodies; `None` if it is for the whole interval.
    ///
    /// An obstacle is at rest.
    pub(crate) fn boxes_meet(
        &self,
        pairs: &Pairs,
        pair: CellPair,
        interval: &Range<f64>,
        kept: f64,
    ) -> Option<Range<f64>> {
        let course = |id| pairs.body_poses.mover(id).map(|mover| &self.courses[mover]);
        let resting = match pair.b {
            CellBody::Obstacle(k) => Some(&pairs.placed(k).own_box),
            _ => None,
        };
        let (a, b) = (course(pair.a), course(pair.b));
        let far = [a, b].iter().flatten().map(|course| course.deviation).sum::<f64>();
        let parts = f64::from(self.parts);
        let first = ((interval.start * parts) as usize).min(self.parts as usize - 1);
        let last = ((interval.end * parts).ceil() as usize).max(first + 1);
        let (mut from, mut until, mut before) = (None, interval.end, None);
        for k in first..last {
            let [a, b] = [a, b].map(|course| course.and_then(|course| course.placed.get(k..k + 2)));
            let is_apart = match (a, resting, b) {
                (Some([start, end]), Some(b), _) => {
                    let start = before.take().unwrap_or_else(|| Gaps::new(&b.axes, start, b));
                    let end = Gaps::new(&b.axes, end, b);
                    let is_apart = start.exceed(&end, kept + far);
                    before = Some(end);
                    is_apart
                }
                (Some([a, a_end]), None, Some([b, b_end])) => [&b.axes, &a.axes]
                    .into_iter()
                    .any(|axes| Gaps::new(axes, a, b).exceed(&Gaps::new(axes, a_end, b_end), kept + far)),
                _ => false,
            };
            if !is_apart {
                from = from.or(Some(self.times[k].larger(interval.start)));
                until = self.end(k).smaller(interval.end);
            }
        }
        from.map(|from| from..until)
    }
}

/// The gaps between two boxes along three axes, towards the positive and towards the negative side,
/// and their rounding error. A gap is negative where the boxes overlap.
struct Gaps {
    sides: [Vector3<f64>; 2],
    error: f64,
}

impl Gaps {
    fn new(axes: &Matrix3<f64>, a: &PlacedBox, b: &PlacedBox) -> Self {
        let extent = |own: &PlacedBox| axes.tr_mul(&own.axes).abs() * own.half;
        let apart = axes.tr_mul(&(b.middle - a.middle));
        let extents = extent(a) + extent(b);
        Self {
            sides: [apart - extents, -apart - extents],
            error: a.error_of_heights(b),
        }
    }

    /// Returns whether along one axis, on the same side, both gaps exceed a distance.
    fn exceed(&self, other: &Self, least: f64) -> bool {
        let least = (least + self.error.larger(other.error)) * GROWN;
        let sides = self.sides.iter().zip(&other.sides);
        sides
            .into_iter()
            .any(|(x, y)| (0..3).any(|i| x[i] > least && y[i] > least))
    }
}

/// Pairs that may meet along a motion.
impl Pairs {
    /// Appends the pairs of a mover and the obstacles whose boxes overlap its swept boxes, grown by what
    /// the pair must keep, with the times of these boxes.
    pub(crate) fn near_along(
        &mut self,
        mover: usize,
        sweep: &Sweep,
        pair_intervals: &mut Vec<PairInterval>,
    ) -> Result<(), PlanError> {
        let swept = sweep.swept(mover);
        let Some(whole) = swept.iter().copied().reduce(|all, part| all.united(&part)) else {
            return Ok(());
        };
        let widest = kept_around(&whole, self.most_kept[mover]);
        let mut found = core::mem::take(&mut self.near);
        found.clear();
        self.near(mover, &widest, &mut found)?;
        for &pair in &found {
            let TrackedPair {
                pair: CellPair { b, .. },
                kept,
                key,
                ..
            } = self.all[pair];
            let CellBody::Obstacle(obstacle) = b else { continue };
            let around = kept_around(&self.obstacle_boxes[obstacle], kept);
            let (mut from, mut was_near) = (0.0, false);
            for (part, aabb) in swept.iter().enumerate() {
                let (is_near, until) = (aabb.overlaps(&around), sweep.end(part));
                match pair_intervals.last_mut() {
                    Some(last) if is_near && was_near => last.until = until,
                    _ if is_near => pair_intervals.push(PairInterval { pair, key, from, until }),
                    _ => {}
                }
                (from, was_near) = (until, is_near);
            }
        }
        self.near = found;
        Ok(())
    }
}
