//! Configuration spaces of one rigid body: in the plane, translations, in space.

use core::f64::consts::{PI, TAU};
use std::sync::Arc;
use std::vec::Vec;

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, Unit, UnitQuaternion, Vector3};

use crate::error::PlanError;
use crate::motion::curve::JointCurve;
use crate::motion::joint::JointKind;
use crate::motion::joint::{Drive, TreeJoint};
use crate::motion::space::{
    BodyBall, ConfigurationSpace, JointPath, SegmentMotion, check, check_bounds, overwrite, within,
};
use crate::motion::tree_motion::{LinkTree, TreeBodies, TreeSegment};
use lin_canny::motion::{Motion, MotionModel, Steady, Velocity};
use lin_canny::{EXTENT_MAX, POSE_UNIT};

/// Largest angle of a planar configuration, in radians. Sums and remainders of angles err by UNIT
/// of their size, so a thousand radians keep thirteen digits.
const ANGLE_MAX: f64 = 1024.0;

/// All bodies share one rigid motion.
impl SegmentMotion for Steady {
    fn pose(&self, _: usize, time: f64) -> Isometry3<f64> {
        Motion::pose(self, time)
    }

    fn model(&self, _: usize, time: f64, span: f64) -> MotionModel {
        Motion::model(self, time, span)
    }

    fn steady(&self, _: usize) -> Option<Self> {
        Some(*self)
    }
}

/// The motion of a rigid body whose coordinates are independent, along a segment or a curve.
#[derive(Clone, Debug)]
pub struct RigidSegment(Way);

#[derive(Clone, Debug)]
enum Way {
    /// A segment.
    Straight(Steady),
    /// A curve: each coordinate is a joint, one after another.
    Curve(TreeSegment),
}

impl RigidSegment {
    /// Returns the motion along a curve of slides along x, y and so on, and of a turn about z if
    /// there is one more coordinate than slides. All bodies move as one.
    fn along(base: Isometry3<f64>, slides: usize, middles: &[Point3<f64>], curve: &JointCurve) -> Self {
        let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
        let joint = |k: usize| TreeJoint {
            parent: k,
            kind: if k < slides {
                JointKind::Prismatic
            } else {
                JointKind::Revolute
            },
            origin: Isometry3::identity(),
            axis: if k < slides { axes[k] } else { Vector3::z_axis() },
            drive: Some(Drive::by(k)),
        };
        // The base turns the bodies, not the slides.
        let mut joints: Vec<TreeJoint> = (0..curve.coordinates()).map(joint).collect();
        joints.push(TreeJoint::fixed(joints.len(), base));
        let bodies = TreeBodies {
            links: std::vec![joints.len(); middles.len()],
            middles: middles.into(),
        };
        let tree = LinkTree::new(&Isometry3::identity(), joints);
        Self(Way::Curve(TreeSegment::new(&tree, &Arc::new(bodies), curve.clone())))
    }
}

impl SegmentMotion for RigidSegment {
    fn pose(&self, body: usize, time: f64) -> Isometry3<f64> {
        match &self.0 {
            Way::Straight(motion) => SegmentMotion::pose(motion, body, time),
            Way::Curve(motion) => motion.pose(body, time),
        }
    }

    fn model(&self, body: usize, time: f64, span: f64) -> MotionModel {
        match &self.0 {
            Way::Straight(motion) => SegmentMotion::model(motion, body, time, span),
            Way::Curve(motion) => motion.model(body, time, span),
        }
    }

    fn steady(&self, _: usize) -> Option<Steady> {
        match self.0 {
            Way::Straight(motion) => Some(motion),
            Way::Curve(_) => None,
        }
    }

    fn placed(&self, stem: usize, body: usize, time: f64, span: f64) -> (Isometry3<f64>, MotionModel) {
        match &self.0 {
            Way::Straight(motion) => SegmentMotion::placed(motion, stem, body, time, span),
            Way::Curve(motion) => motion.placed(stem, body, time, span),
        }
    }

    fn poses(&self, bodies: usize, times: &[f64], poses: &mut Vec<Isometry3<f64>>) {
        match &self.0 {
            Way::Straight(motion) => motion.poses(bodies, times, poses),
            Way::Curve(motion) => motion.poses(bodies, times, poses),
        }
    }

    fn chord_deviation(&self, body: usize, reach: f64, parts: u32) -> f64 {
        match &self.0 {
            Way::Straight(motion) => motion.chord_deviation(body, reach, parts),
            Way::Curve(motion) => motion.chord_deviation(body, reach, parts),
        }
    }

    fn parts(&self) -> u32 {
        match &self.0 {
            Way::Straight(_) => 1,
            Way::Curve(motion) => motion.parts(),
        }
    }

    fn spread(&self, a: BodyBall, b: Option<BodyBall>, time: f64, span: f64, tube: &[f64]) -> Option<f64> {
        match &self.0 {
            Way::Straight(_) => None,
            Way::Curve(motion) => motion.spread(a, b, time, span, tube),
        }
    }
}

/// Returns an error unless a radius is positive and finite.
fn check_radius(value: f64) -> Result<(), PlanError> {
    if value > 0.0 && value <= EXTENT_MAX {
        Ok(())
    } else {
        let what = "radius";
        Err(PlanError::Value { what, value })
    }
}

/// A rigid body in the plane z = 0: a configuration is x, y and the angle about z in radians.
///
/// Along a segment the origin of the body moves along a straight line, and the body rotates by the
/// smaller angle at a constant rate. The absolute angle is at most 1024. Angles that differ by a
/// full turn are the same configuration. Along a curve the angle is a number like x and y: a curve
/// from 3 to -3 makes nearly a full turn.
#[doc(alias = "SE2")]
#[derive(Clone, Debug, PartialEq)]
pub struct PlanarSpace {
    bounds: [[f64; 2]; 2],
    scales: [f64; 3],
    middles: Vec<Point3<f64>>,
}

impl PlanarSpace {
    /// Returns the space with the least and greatest x and y.
    ///
    /// `radius` is the length that corresponds to one radian; use the radius of the body around its
    /// origin. All `bodies` of the robot move as one.
    ///
    /// # Errors
    /// Returns an error if the bounds are not finite or empty, or `radius` is not finite and
    /// positive.
    pub fn new(bounds: [[f64; 2]; 2], radius: f64, bodies: usize) -> Result<Self, PlanError> {
        check_bounds("bound of the plane", &bounds)?;
        check_radius(radius)?;
        Ok(Self {
            bounds,
            scales: [1.0, 1.0, radius],
            middles: std::vec![Point3::origin(); bodies],
        })
    }

    fn pose(q: &[f64]) -> Isometry3<f64> {
        let (sine, cosine) = libm::sincos(0.5 * q[2]);
        let turn = UnitQuaternion::new_unchecked(Quaternion::new(cosine, 0.0, 0.0, sine));
        Isometry3::from_parts(Translation3::new(q[0], q[1], 0.0), turn)
    }
}

/// Returns the smaller rotation between two angles, in [-pi, pi].
///
/// If the ends are exchanged, the result changes its sign, even for half a turn, because a roadmap
/// uses segments in both directions.
fn shorter(from: f64, to: f64) -> f64 {
    let turn = libm::fmod(to - from, TAU);
    if turn > PI {
        turn - TAU
    } else if turn < -PI {
        turn + TAU
    } else {
        turn
    }
}

impl ConfigurationSpace for PlanarSpace {
    type Segment = RigidSegment;

    fn coordinates(&self) -> usize {
        3
    }
    fn degrees_of_freedom(&self) -> usize {
        3
    }
    fn bodies(&self) -> usize {
        self.middles.len()
    }
    fn bounds(&self) -> &[[f64; 2]] {
        &self.bounds
    }
    fn scales(&self) -> &[f64] {
        &self.scales
    }

    fn check(&self, q: &[f64]) -> Result<(), PlanError> {
        check(q, 3, &self.bounds)?;
        if q[2].abs() <= ANGLE_MAX {
            Ok(())
        } else {
            Err(PlanError::Coordinate { index: 2, value: q[2] })
        }
    }

    fn place(&self, q: &[f64], poses: &mut Vec<Isometry3<f64>>) {
        poses.clear();
        poses.resize(self.middles.len(), Self::pose(q));
    }

    fn set_middles(&mut self, middles: &[Point3<f64>]) {
        overwrite(&mut self.middles, middles);
    }

    fn curve(&self, curve: &JointCurve) -> Result<RigidSegment, PlanError> {
        curve.check(&[self.bounds[0], self.bounds[1], [-ANGLE_MAX, ANGLE_MAX]])?;
        Ok(RigidSegment::along(Isometry3::identity(), 2, &self.middles, curve))
    }

    fn segment(&self, from: &[f64], to: &[f64]) -> Result<RigidSegment, PlanError> {
        let linear = Vector3::new(to[0] - from[0], to[1] - from[1], 0.0);
        let velocity = Velocity::new(linear, Vector3::z() * shorter(from[2], to[2]));
        Ok(RigidSegment(Way::Straight(Steady::new(&Self::pose(from), velocity)?)))
    }

    fn difference(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        [to[0] - from[0], to[1] - from[1], shorter(from[2], to[2])].into()
    }

    fn moved(&self, q: &[f64], step: &[f64]) -> Vec<f64> {
        let [x, y] = [0, 1].map(|k| within(q[k] + step[k], self.bounds[k]));
        [x, y, shorter(0.0, q[2] + step[2])].into()
    }

    fn sample(&self, uniform: &mut dyn FnMut() -> f64) -> Vec<f64> {
        let [x, y] = self.bounds.map(|[low, high]| low + (high - low) * uniform());
        [x, y, (2.0 * uniform() - 1.0) * PI].into()
    }

    fn gradient(&self, q: &[f64], _: usize, point: &Point3<f64>, direction: &Vector3<f64>, gradient: &mut [f64]) {
        let arm = point.coords - Vector3::new(q[0], q[1], 0.0);
        let parts = [direction.x, direction.y, arm.cross(direction).z];
        gradient.copy_from_slice(&parts);
    }

    fn is_rigid(&self, _: usize, _: usize) -> bool {
        true
    }
    fn joint_path(&self, _: usize) -> Option<JointPath> {
        let slides = [Vector3::x_axis(), Vector3::y_axis()];
        let mut joints: Vec<TreeJoint> = slides.iter().enumerate().map(|(k, axis)| slide(k, *axis)).collect();
        joints.push(TreeJoint {
            kind: JointKind::Revolute,
            ..slide(2, Vector3::z_axis())
        });
        Some(numbered(joints))
    }
}

/// Returns a joint at the origin that slides along an axis by a coordinate.
fn slide(coordinate: usize, axis: Unit<Vector3<f64>>) -> TreeJoint {
    TreeJoint {
        axis,
        drive: Some(Drive::by(coordinate)),
        ..TreeJoint::fixed(0, Isometry3::identity())
    }
}

/// Returns the path of joints from the origin of the world.
fn numbered(joints: Vec<TreeJoint>) -> JointPath {
    JointPath {
        base: Isometry3::identity(),
        joints: joints.into_iter().enumerate().collect(),
    }
}

/// A rigid body that does not rotate: a configuration is x, y and z of its origin.
#[derive(Clone, Debug, PartialEq)]
pub struct TranslationSpace {
    bounds: [[f64; 2]; 3],
    rotation: UnitQuaternion<f64>,
    middles: Vec<Point3<f64>>,
}

impl TranslationSpace {
    /// Returns the space with the least and greatest x, y and z, for bodies with this rotation.
    ///
    /// # Errors
    /// Returns an error if the bounds are not finite or empty, or `rotation` is not a unit
    /// quaternion.
    pub fn new(bounds: [[f64; 2]; 3], rotation: UnitQuaternion<f64>, bodies: usize) -> Result<Self, PlanError> {
        check_bounds("bound of the space", &bounds)?;
        lin_canny::RelativePose::from_isometry(&Isometry3::from_parts(Translation3::identity(), rotation))?;
        Ok(Self {
            bounds,
            rotation,
            middles: std::vec![Point3::origin(); bodies],
        })
    }

    fn pose(&self, q: &[f64]) -> Isometry3<f64> {
        Isometry3::from_parts(Translation3::new(q[0], q[1], q[2]), self.rotation)
    }
}

impl ConfigurationSpace for TranslationSpace {
    type Segment = RigidSegment;

    fn coordinates(&self) -> usize {
        3
    }
    fn degrees_of_freedom(&self) -> usize {
        3
    }
    fn bodies(&self) -> usize {
        self.middles.len()
    }
    fn bounds(&self) -> &[[f64; 2]] {
        &self.bounds
    }
    fn scales(&self) -> &[f64] {
        &[1.0; 3]
    }
    fn check(&self, q: &[f64]) -> Result<(), PlanError> {
        check(q, 3, &self.bounds)
    }
    fn place(&self, q: &[f64], poses: &mut Vec<Isometry3<f64>>) {
        poses.clear();
        poses.resize(self.middles.len(), self.pose(q));
    }
    fn set_middles(&mut self, middles: &[Point3<f64>]) {
        overwrite(&mut self.middles, middles);
    }
    fn curve(&self, curve: &JointCurve) -> Result<RigidSegment, PlanError> {
        curve.check(&self.bounds)?;
        Ok(RigidSegment::along(self.pose(&[0.0; 3]), 3, &self.middles, curve))
    }
    fn segment(&self, from: &[f64], to: &[f64]) -> Result<RigidSegment, PlanError> {
        let linear = Vector3::new(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
        let velocity = Velocity::new(linear, Vector3::zeros());
        Ok(RigidSegment(Way::Straight(Steady::new(&self.pose(from), velocity)?)))
    }
    fn difference(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        from.iter().zip(to).map(|(a, b)| b - a).collect()
    }
    fn moved(&self, q: &[f64], step: &[f64]) -> Vec<f64> {
        (0..3).map(|k| within(q[k] + step[k], self.bounds[k])).collect()
    }
    fn sample(&self, uniform: &mut dyn FnMut() -> f64) -> Vec<f64> {
        self.bounds
            .iter()
            .map(|[low, high]| low + (high - low) * uniform())
            .collect()
    }
    fn gradient(&self, _: &[f64], _: usize, _: &Point3<f64>, direction: &Vector3<f64>, gradient: &mut [f64]) {
        gradient.copy_from_slice(direction.as_slice());
    }
    fn is_rigid(&self, _: usize, _: usize) -> bool {
        true
    }
    fn joint_path(&self, _: usize) -> Option<JointPath> {
        let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
        let mut joints: Vec<TreeJoint> = axes.iter().enumerate().map(|(k, axis)| slide(k, *axis)).collect();
        let rotation = Isometry3::from_parts(Translation3::identity(), self.rotation);
        joints.push(TreeJoint::fixed(0, rotation));
        Some(numbered(joints))
    }
}

/// A rigid body in space: a configuration is `x, y, z, qx, qy, qz, qw`.
///
/// These are the position of the body's origin and a unit quaternion. Along a segment the origin
/// moves along a straight line, and the body rotates by the smaller angle about a fixed axis at a
/// constant rate (slerp). A step is a displacement of the origin and a rotation vector, both in
/// world axes.
#[doc(alias = "SE3")]
#[derive(Clone, Debug, PartialEq)]
pub struct RigidSpace {
    bounds: [[f64; 2]; 3],
    scales: [f64; 6],
    bodies: usize,
}

impl RigidSpace {
    /// Returns the space with the least and greatest x, y and z.
    ///
    /// `radius` is the length that corresponds to one radian; use the radius of the body around its
    /// origin. All `bodies` of the robot move as one.
    ///
    /// # Errors
    /// Returns an error if the bounds are not finite or empty, or `radius` is not finite and
    /// positive.
    pub fn new(bounds: [[f64; 2]; 3], radius: f64, bodies: usize) -> Result<Self, PlanError> {
        check_bounds("bound of the space", &bounds)?;
        check_radius(radius)?;
        Ok(Self {
            bounds,
            scales: [1.0, 1.0, 1.0, radius, radius, radius],
            bodies,
        })
    }

    /// Returns the configuration of a pose.
    #[must_use]
    pub fn configuration(pose: &Isometry3<f64>) -> Vec<f64> {
        let (t, q) = (pose.translation.vector, pose.rotation.coords);
        [t.x, t.y, t.z, q.x, q.y, q.z, q.w].into()
    }

    /// Returns the pose of a configuration.
    fn pose(q: &[f64]) -> Isometry3<f64> {
        let turn = UnitQuaternion::new_unchecked(Quaternion::new(q[6], q[3], q[4], q[5]));
        Isometry3::from_parts(Translation3::new(q[0], q[1], q[2]), turn)
    }
}

impl ConfigurationSpace for RigidSpace {
    type Segment = Steady;

    fn coordinates(&self) -> usize {
        7
    }
    fn degrees_of_freedom(&self) -> usize {
        6
    }
    fn bodies(&self) -> usize {
        self.bodies
    }
    fn bounds(&self) -> &[[f64; 2]] {
        &self.bounds
    }
    fn scales(&self) -> &[f64] {
        &self.scales
    }

    fn check(&self, q: &[f64]) -> Result<(), PlanError> {
        check(q, 7, &self.bounds)?;
        let squared_norm = Self::pose(q).rotation.coords.norm_squared();
        if (squared_norm - 1.0).abs() <= POSE_UNIT {
            Ok(())
        } else {
            Err(PlanError::Rotation { squared_norm })
        }
    }

    fn place(&self, q: &[f64], poses: &mut Vec<Isometry3<f64>>) {
        poses.clear();
        poses.resize(self.bodies, Self::pose(q));
    }

    fn segment(&self, from: &[f64], to: &[f64]) -> Result<Steady, PlanError> {
        Ok(Steady::between(
            &Self::pose(from),
            &Self::pose(to),
            1.0,
            Point3::origin(),
        )?)
    }

    fn difference(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        let (p, q) = (Self::pose(from), Self::pose(to));
        let turn = q.rotation.into_inner() * p.rotation.into_inner().conjugate();
        let turn = if turn.w < 0.0 { -turn } else { turn };
        let sine = f64::sqrt(turn.imag().norm_squared());
        let factor = if sine > 0.0 {
            2.0 * libm::atan2(sine, turn.w) / sine
        } else {
            2.0
        };
        let (way, angle) = (q.translation.vector - p.translation.vector, turn.imag() * factor);
        [way.x, way.y, way.z, angle.x, angle.y, angle.z].into()
    }

    fn moved(&self, q: &[f64], step: &[f64]) -> Vec<f64> {
        let spin = Velocity::new(Vector3::zeros(), Vector3::new(step[3], step[4], step[5]));
        let mut pose = spin.applied(&Self::pose(q), 1.0);
        let at = |k: usize| within(q[k] + step[k], self.bounds[k]);
        pose.translation = Translation3::new(at(0), at(1), at(2));
        Self::configuration(&pose)
    }

    fn sample(&self, uniform: &mut dyn FnMut() -> f64) -> Vec<f64> {
        let [x, y, z] = self.bounds.map(|[low, high]| low + (high - low) * uniform());
        // Shoemake 1992: uniform on the sphere of unit quaternions.
        let (part, first, second) = (uniform(), TAU * uniform(), TAU * uniform());
        let (small, large) = (f64::sqrt(part), f64::sqrt(1.0 - part));
        let ((s, c), (u, v)) = (libm::sincos(first), libm::sincos(second));
        let q = [large * s, large * c, small * u, small * v];
        let norm = f64::sqrt(q.iter().map(|x| x * x).sum());
        let [i, j, k, w] = q.map(|x| x / norm);
        [x, y, z, i, j, k, w].into()
    }

    fn gradient(&self, q: &[f64], _: usize, point: &Point3<f64>, direction: &Vector3<f64>, gradient: &mut [f64]) {
        let turned = (point.coords - Vector3::new(q[0], q[1], q[2])).cross(direction);
        gradient[..3].copy_from_slice(direction.as_slice());
        gradient[3..].copy_from_slice(turned.as_slice());
    }

    fn is_rigid(&self, _: usize, _: usize) -> bool {
        true
    }
}
