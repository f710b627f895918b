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

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

use crate::checker::GROWN;
use crate::extremes::Extremes;
use crate::pairs::Pairs;
use crate::space::{BodyBall, SegmentMotion};
use crate::tolerance::{ATTACHED, PLACED, PLACED_BALL};
use crate::world::{WorldId, WorldPair};
use lin_canny::Geometry;
use lin_canny::broad::Aabb;
use lin_canny::polyhedron::BoxHint;

/// Maximum number of parts, a power of two. Not measured.
const PARTS: u32 = 64;

/// Distance of the points of a body from their chords, in radii of the body, beyond which the parts
/// are halved. On segments of Panda, certificates take 433 million instructions with 0.5 and with 1,
/// 465 with 0.25 and 561 with 0.125.
const NEAR: f64 = 0.5;

/// A box around a body, along the axes of the frame of its shape.
#[derive(Clone, Copy)]
pub(crate) struct OwnBox {
    pub(crate) middle: Point3<f64>,
    /// Half of each side; infinite if the body is unbounded.
    pub(crate) half: Vector3<f64>,
}

impl OwnBox {
    /// The box of a body that is not there.
    pub(crate) const NONE: Self = Self {
        middle: Point3::new(0.0, 0.0, 0.0),
        half: Vector3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
    };

    pub(crate) fn of(shape: &Geometry) -> Self {
        let (low, high) = shape.aabb_at(&Isometry3::identity(), &mut BoxHint::default());
        if !low.iter().chain(high.iter()).all(|x| x.is_finite()) {
            return Self::NONE;
        }
        Self {
            middle: Point3::from(low.coords * 0.5 + high.coords * 0.5),
            half: (high - low) * 0.5,
        }
    }
}

/// An [`OwnBox`] in the world.
#[derive(Clone, Copy)]
pub(crate) struct PlacedBox {
    pub(crate) middle: Point3<f64>,
    pub(crate) axes: Matrix3<f64>,
    pub(crate) half: Vector3<f64>,
    /// Rounding error of the box.
    pub(crate) error: f64,
}

impl PlacedBox {
    #[inline]
    pub(crate) fn new(own: &OwnBox, pose: &Isometry3<f64>) -> Self {
        let out = own.middle.coords.abs().sum() + own.half.sum();
        let at = pose.translation.vector.abs().sum();
        Self {
            middle: pose * own.middle,
            axes: pose.rotation.to_rotation_matrix().into_inner(),
            half: own.half,
            error: PLACED_BALL * out + PLACED * (out + at),
        }
    }

    /// Returns the rounding error of the heights of this box and another one along axes of either:
    /// the squared norms of the quaternions scale the heights.
    #[inline]
    pub(crate) fn error_of_heights(&self, other: &Self) -> f64 {
        let apart = (other.middle - self.middle).abs().sum();
        self.error + other.error + PLACED_BALL * (apart + self.half.sum() + other.half.sum())
    }
}

/// Returns a ball in the world, enlarged by the rounding of its position and of its distance from
/// another one.
#[inline]
pub(crate) fn placed_ball((centre, radius): (Point3<f64>, f64), pose: &Isometry3<f64>) -> (Point3<f64>, f64) {
    let (out, at) = (centre.coords.abs().sum(), pose.translation.vector.abs().sum());
    (pose * centre, radius + PLACED_BALL * out + PLACED * (radius + out + at))
}

/// Returns the box along the axes of the world around what a ball and a box share.
fn around((centre, radius): (Point3<f64>, f64), placed: &PlacedBox) -> Aabb {
    let by_ball = Aabb::new(centre, centre).grown(radius);
    let half = placed.axes.abs() * placed.half + Vector3::repeat(placed.error);
    let [low, high] = [placed.middle - half, placed.middle + half];
    // An unbounded box may have sides that are not numbers.
    Aabb::new(
        by_ball.min.coords.zip_map(&low.coords, f64::larger).into(),
        by_ball.max.coords.zip_map(&high.coords, f64::smaller).into(),
    )
}

/// Returns a box that is grown by a distance that a pair must keep. The boxes of movers have a
/// reserve for the rounding of this.
pub(crate) fn kept_around(aabb: &Aabb, kept: f64) -> Aabb {
    aabb.grown(kept * (1.0 + PLACED))
}

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
        let (places, movers) = (&pairs.places, pairs.mover_balls.len());
        let body_ball = |mover: usize| {
            let (body, carried) = places.carrier(mover);
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
        segment.poses(places.bodies, &self.times, &mut self.poses);
        self.courses.resize_with(movers, Course::default);
        for (mover, course) in self.courses.iter_mut().enumerate() {
            course.placed.clear();
            course.swept.clear();
            let (Some(ball), Some(of_body)) = (pairs.mover_balls[mover], body_ball(mover)) else {
                continue;
            };
            course.deviation = deviation(&of_body, self.parts);
            let carried = places.carrier(mover).1;
            if let Some(carried) = carried {
                let lengths = self.poses.iter().map(|pose| pose.translation.vector.abs().sum());
                let own = carried.pose.translation.vector.abs().sum() + ball.0.coords.abs().sum() + ball.1;
                course.deviation += 4.0 * ATTACHED * (own + lengths.fold(0.0, f64::larger));
            }
            let mut last: Option<(f64, Aabb)> = None;
            for (poses, &time) in self.poses.chunks(places.bodies).zip(&self.times) {
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
        pair: WorldPair,
        interval: &Range<f64>,
        kept: f64,
    ) -> Option<Range<f64>> {
        let course = |id| pairs.places.mover(id).map(|mover| &self.courses[mover]);
        let resting = match pair.b {
            WorldId::Obstacle(k) => Some(&pairs.placed(k).own_box),
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
