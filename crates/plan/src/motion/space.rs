//! The trait of configuration spaces: poses at a configuration, motions along a segment.

use std::vec::Vec;

use nalgebra::{Isometry3, Point3, Vector3};

use crate::error::PlanError;
use crate::extremes::Extremes;
use crate::motion::curve::JointCurve;
use crate::motion::joint::TreeJoint;
use crate::tolerance::PLACED;
use lin_canny::motion::{Motion, MotionModel, Steady};

/// A configuration space: a configuration is a list of numbers that sets the poses of all bodies.
///
/// A *configuration* has [`coordinates`](Self::coordinates) numbers. A *step* is a tangent vector
/// with one component for each degree of freedom, [`degrees_of_freedom`](Self::degrees_of_freedom) in number. The first
/// components belong to the *sweep coordinates*: component k of a step changes coordinate k of a
/// configuration alone, for each k below the number of [`bounds`](Self::bounds). The rest, such as
/// the three components of a rotation, have no bounds.
pub trait ConfigurationSpace {
    /// The motion of all bodies along a segment.
    type Segment: SegmentMotion;

    /// Returns the length of a configuration vector.
    fn coordinates(&self) -> usize;

    /// Returns the number of degrees of freedom, which is the number of components of a step.
    fn degrees_of_freedom(&self) -> usize;

    /// Returns the number of bodies.
    fn bodies(&self) -> usize;

    /// Returns the least and the greatest value of each sweep coordinate.
    fn bounds(&self) -> &[[f64; 2]];

    /// Returns the length that corresponds to one unit of each component of a step: 1 for a length,
    /// the radius of the robot for an angle.
    fn scales(&self) -> &[f64];

    /// Checks that a configuration belongs to this space.
    ///
    /// # Errors
    /// Returns an error that names the invalid coordinate.
    fn check(&self, configuration: &[f64]) -> Result<(), PlanError>;

    /// Writes the poses of all bodies at a configuration, in the order of the bodies.
    fn place(&self, configuration: &[f64], poses: &mut Vec<Isometry3<f64>>);

    /// Returns the motion along the segment between two configurations, over the times 0 to 1.
    ///
    /// If the ends are exchanged, the segment must be the same motion backwards, even for half a
    /// turn, because a roadmap uses its segments in both directions.
    ///
    /// # Errors
    /// Returns an error if a number is out of range.
    fn segment(&self, from: &[f64], to: &[f64]) -> Result<Self::Segment, PlanError>;

    /// Returns the motion along a curve, after a check of the curve.
    ///
    /// By default, a curve of degree 1 is the segment between its ends, and others are refused.
    ///
    /// # Errors
    /// Returns an error if the curve has a wrong number of coordinates, if a coordinate exceeds its
    /// bounds at any time, or if the space does not move along curves of this degree.
    fn curve(&self, curve: &JointCurve) -> Result<Self::Segment, PlanError> {
        let (from, to) = (curve.start(), curve.end());
        self.check(&from)?;
        self.check(&to)?;
        if curve.degree() > 1 {
            return Err(PlanError::CurveDegree {
                coordinate: self.bounds().len(),
                degree: curve.degree(),
            });
        }
        self.segment(&from, &to)
    }

    /// Takes the middle of each body, in its frame: [`Checker::new`](crate::Checker::new) hands over
    /// the centres of balls around the bodies.
    ///
    /// A space may state the motion of a body about its middle ([`MotionModel::pivot`]). Bounds of
    /// the motion then hold for longer, because no point of the body is far from the pivot. By
    /// default, the middles are ignored.
    fn set_middles(&mut self, _middles: &[Point3<f64>]) {}

    /// Returns the step along the segment from one configuration to another.
    fn difference(&self, from: &[f64], to: &[f64]) -> Vec<f64>;

    /// Returns the configuration after a step; sweep coordinates are clamped to their bounds.
    fn moved(&self, from: &[f64], step: &[f64]) -> Vec<f64>;

    /// Returns a random configuration within the bounds; `uniform` returns numbers in `[0, 1)`.
    fn sample(&self, uniform: &mut dyn FnMut() -> f64) -> Vec<f64>;

    /// Writes the gradient of `direction . p` by a step, where p is the point of the body that is
    /// at `point` in the world at this configuration.
    fn gradient(
        &self,
        configuration: &[f64],
        body: usize,
        point: &Point3<f64>,
        direction: &Vector3<f64>,
        gradient: &mut [f64],
    );

    /// Returns whether two bodies keep their relative pose at all configurations. Such pairs are
    /// never measured.
    fn is_rigid(&self, a: usize, b: usize) -> bool {
        a == b
    }

    /// Returns the joints that move a body, from the world to the body; `None` if the space does not
    /// move its bodies by joints.
    ///
    /// [`RangeProver`](crate::RangeProver) and [`PairBoxes`](crate::PairBoxes) need them. In a space
    /// with joints and with bounds for all coordinates, segments must be straight in the
    /// coordinates. By default there are none.
    fn joint_path(&self, _body: usize) -> Option<JointPath> {
        None
    }

    /// Returns the configuration at the fraction `t` of the segment.
    fn between(&self, from: &[f64], to: &[f64], t: f64) -> Vec<f64> {
        let mut step = self.difference(from, to);
        step.iter_mut().for_each(|x| *x *= t);
        self.moved(from, &step)
    }

    /// Returns the length of a segment: the norm of the step, scaled by [`scales`](Self::scales).
    fn distance(&self, from: &[f64], to: &[f64]) -> f64 {
        let step = self.difference(from, to);
        let squares = step.iter().zip(self.scales()).map(|(x, s)| (x * s) * (x * s));
        f64::sqrt(squares.sum())
    }

    /// Returns the length of a path, the sum of the [`distance`](Self::distance) of its segments.
    fn path_length(&self, path: &[Vec<f64>]) -> f64 {
        path.windows(2).map(|ends| self.distance(&ends[0], &ends[1])).sum()
    }
}

/// The joints between the world and a body.
#[derive(Clone, Debug, PartialEq)]
pub struct JointPath {
    /// Pose in the world of the frame in which the first joint is given.
    pub base: Isometry3<f64>,
    /// The joints from the base to the body, each with its number in the space. Each is given in the
    /// frame of the joint before; its [`parent`](TreeJoint::parent) is not used. A number stands for
    /// the same joint on the paths of all bodies.
    pub joints: Vec<(usize, TreeJoint)>,
}

/// The motion of all bodies along a segment or a curve, over the times 0 to 1.
///
/// The motion of each body must satisfy the contract of [`Motion`].
pub trait SegmentMotion {
    /// Returns the pose of a body at a time.
    fn pose(&self, body: usize, time: f64) -> Isometry3<f64>;

    /// Returns the velocities of a body at a time, and bounds of the deviation within the next
    /// `span`.
    fn model(&self, body: usize, time: f64, span: f64) -> MotionModel;

    /// Returns the motion of a body if it has constant velocities; `None` for any other motion.
    ///
    /// A [`receipt`](crate::receipt) states it.
    fn steady(&self, _body: usize) -> Option<Steady> {
        None
    }

    /// Returns the *stem* of two bodies: a moving frame in which both move less than in the world.
    ///
    /// An example is the last link that carries both. 0 is the world.
    fn stem(&self, _a: usize, _b: usize) -> usize {
        0
    }

    /// Returns the pose of a body relative to a stem, and its motion model from this time on.
    ///
    /// The bounds must also hold for the poses that [`pose`](Self::pose) returns.
    fn placed(&self, _stem: usize, body: usize, time: f64, span: f64) -> (Isometry3<f64>, MotionModel) {
        (self.pose(body, time), self.model(body, time, span))
    }

    /// Appends the poses of all bodies in the world, `bodies` in number, at each of these times.
    fn poses(&self, bodies: usize, times: &[f64], poses: &mut Vec<Isometry3<f64>>) {
        for &time in times {
            poses.extend((0..bodies).map(|body| self.pose(body, time)));
        }
    }

    /// Returns an upper bound of the distance of a point of a body from the chord of its path, at all
    /// times, if the time is divided into so many equal parts, a power of two.
    ///
    /// A chord joins the positions of the point at the start and at the end of a part. The distance is
    /// that from the point of the chord at the same fraction of the part. The point of the body is at
    /// most `reach` from the origin of the body. The bound includes the rounding of
    /// [`pose`](Self::pose).
    ///
    /// By default, the motion models of all parts give the bound. The pivot follows a parabola, whose
    /// distance from its chord is at most an eighth of the acceleration times the square of the span.
    /// A point at the distance r from the pivot adds an eighth of `r (w s)^2`. Point and chord
    /// deviate from this by the bounds of the model each.
    fn chord_deviation(&self, body: usize, reach: f64, parts: u32) -> f64 {
        let span = 1.0 / f64::from(parts);
        let of_part = |k: u32| {
            let model = self.model(body, f64::from(k) * span, span);
            let arm = reach + model.pivot.coords.norm();
            let rate = model.angular.norm();
            let bend = model.acceleration.norm() + rate * rate * arm;
            let deviation = model.shift.at(span) + model.turn.at(span) * arm;
            (bend * span * span / 8.0 + 2.0 * deviation) * (1.0 + PLACED)
        };
        (0..parts).map(of_part).fold(0.0, f64::larger)
    }

    /// Returns the number of equal parts of the time in each of which bounds are worth asking for,
    /// a power of two up to 32.
    ///
    /// Bounds of a motion that bends hold for the whole span, so over a long span they are large.
    fn parts(&self) -> u32 {
        1
    }

    /// Returns an upper bound of how much nearer two bodies are within a tube than on this motion,
    /// at all times of a span; `None` if the space has no tubes.
    ///
    /// In the tube each coordinate deviates by at most its entry of `tube`. A body is given with a
    /// ball around it, in its frame. Without a second body, the bound is for a body at rest.
    fn spread(&self, _a: BodyBall, _b: Option<BodyBall>, _time: f64, _span: f64, _tube: &[f64]) -> Option<f64> {
        None
    }
}

/// A body of a space, and a ball that contains what moves with it: centre in the body's frame, and
/// radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyBall {
    /// Index of the body.
    pub body: usize,
    /// Centre of the ball.
    pub centre: Point3<f64>,
    /// Radius of the ball.
    pub radius: f64,
}

/// The motion of one body along a segment, relative to a stem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMotion<'a, M: ?Sized> {
    /// The motion of all bodies.
    pub segment: &'a M,
    /// Index of the body.
    pub body: usize,
    /// The [`stem`](SegmentMotion::stem): 0 for the world.
    pub stem: usize,
}

impl<M: SegmentMotion + ?Sized> Motion for BodyMotion<'_, M> {
    fn pose(&self, time: f64) -> Isometry3<f64> {
        if self.stem == 0 {
            return self.segment.pose(self.body, time);
        }
        self.placed(time, 0.0).0
    }

    fn model(&self, time: f64, span: f64) -> MotionModel {
        self.placed(time, span).1
    }

    fn placed(&self, time: f64, span: f64) -> (Isometry3<f64>, MotionModel) {
        self.segment.placed(self.stem, self.body, time, span)
    }
}

/// Returns an error if a configuration has the wrong length or a sweep coordinate is out of bounds.
pub(crate) fn check(configuration: &[f64], coordinates: usize, bounds: &[[f64; 2]]) -> Result<(), PlanError> {
    if configuration.len() != coordinates {
        return Err(PlanError::Length {
            expected: coordinates,
            found: configuration.len(),
        });
    }
    for (index, (&value, [low, high])) in configuration.iter().zip(bounds).enumerate() {
        if !(*low..=*high).contains(&value) {
            return Err(PlanError::Coordinate { index, value });
        }
    }
    Ok(())
}

/// Returns an error if bounds are empty or not finite.
pub(crate) fn check_bounds(what: &'static str, bounds: &[[f64; 2]]) -> Result<(), PlanError> {
    use lin_canny::EXTENT_MAX;
    for [low, high] in bounds {
        for &value in [low, high] {
            if !(value.abs() <= EXTENT_MAX) {
                return Err(PlanError::Value { what, value });
            }
        }
        if !(low <= high) {
            return Err(PlanError::Value { what, value: *high });
        }
    }
    Ok(())
}

/// Writes the given points over the first of a space's own.
pub(crate) fn overwrite(own: &mut [Point3<f64>], given: &[Point3<f64>]) {
    own.iter_mut().zip(given).for_each(|(own, given)| *own = *given);
}

/// Returns a sweep coordinate after a step, within its bounds.
pub(crate) fn within(value: f64, [low, high]: [f64; 2]) -> f64 {
    value.larger(low).smaller(high)
}
