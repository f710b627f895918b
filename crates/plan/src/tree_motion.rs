//! The motion of the links of a tree of joints that move at constant rates.
//!
//! # Bounds
//!
//! All sums run along the path from the base to a link, without other branches.
//!
//! The angular velocity of link k is `w = sum q'_i z_i` over its revolute joints, where `z_i` is
//! the axis of joint i in the world, and `z_i' = w_{i-1} x z_i`. So the angular velocity changes at
//! most at the rate `sum |q'_i| W_{i-1}`, where `W_i` is the sum of the rates of the revolute
//! joints up to i.
//!
//! The pivot, the middle of the body, is the sum of vectors `R_1 .. R_i u_i`, each rotated by the
//! joints before it: the last one leads from the origin of the link to the pivot. Each rotation has
//! a constant rate about a fixed axis of the frame before. So by Leibniz's rule the n-th derivative
//! of a vector of constant length is at most `W_i^n |u_i|`. For a vector along a prismatic joint of
//! value d, the third derivative is at most `W^3 |d| + 3 W^2 |d'|`. Velocity and acceleration come
//! from the forward recursion of Newton and Euler (Luh, Walker and Paul 1980). The sum of the third
//! derivatives bounds the deviation from them.
//!
//! Rounding errors grow with the number of joints on the path: see `ARM_TURN`, `ARM_PLACE` and
//! `ARM_VALUE`.

use std::sync::Arc;
use std::vec::Vec;

use nalgebra::{Isometry3, Point3, Unit, Vector3};

use crate::arm::JointKind;
use crate::extremes::Extremes;
use crate::space::SegmentMotion;
use crate::tolerance::{ARM_PLACE, ARM_TURN, ARM_VALUE};
use crate::tree::TreeJoint;
use lin_canny::motion::{MotionModel, Remainder};
use lin_canny::normalize_rotation;

/// Rotation of the joints that two links share, in radians, beyond which the pair is measured
/// relative to the last link that carries both. Not measured.
const TURNED: f64 = 1.0;

/// Base, joints and paths; a space and its segments share them.
#[derive(Clone, Debug)]
pub(crate) struct LinkTree(Arc<Paths>);

#[derive(Debug)]
struct Paths {
    base: Isometry3<f64>,
    joints: Vec<TreeJoint>,
    /// The joints between the base and each link, outward.
    paths: Vec<Vec<usize>>,
}

impl LinkTree {
    /// Normalises rotations and axes, because the bounds require unit length up to rounding. The
    /// parent of each joint must come before the joint.
    pub(crate) fn new(base: &Isometry3<f64>, mut joints: Vec<TreeJoint>) -> Self {
        let mut paths: Vec<Vec<usize>> = std::vec![Vec::new()];
        for (index, joint) in joints.iter_mut().enumerate() {
            joint.origin = normalize_rotation(&joint.origin);
            joint.axis = Unit::new_normalize(joint.axis.into_inner());
            let mut path = paths[joint.parent].clone();
            path.push(index);
            paths.push(path);
        }
        let base = normalize_rotation(base);
        Self(Arc::new(Paths { base, joints, paths }))
    }

    pub(crate) fn base(&self) -> &Isometry3<f64> {
        &self.0.base
    }

    pub(crate) fn joints(&self) -> &[TreeJoint] {
        &self.0.joints
    }

    /// Returns the joints between the base and a link, outward.
    pub(crate) fn path(&self, link: usize) -> impl Iterator<Item = (usize, &TreeJoint)> {
        self.0.paths[link].iter().map(|&k| (k, &self.0.joints[k]))
    }

    /// Returns the last link on the paths of both links: up to this one they move alike.
    fn stem(&self, a: usize, b: usize) -> usize {
        let [of_a, of_b] = [a, b].map(|link| self.0.paths[link].iter());
        let shared = of_a.zip(of_b).take_while(|(x, y)| x == y);
        shared.last().map_or(0, |(&joint, _)| joint + 1)
    }

    /// Returns the poses of the base and of all links.
    pub(crate) fn poses(&self, configuration: &[f64]) -> Vec<Isometry3<f64>> {
        let mut poses = std::vec![self.0.base];
        for joint in &self.0.joints {
            poses.push(joint.after(&poses[joint.parent], joint.value(configuration)));
        }
        poses
    }
}

/// The values of a joint along a segment.
#[derive(Clone, Copy, Debug)]
struct JointCourse {
    from: f64,
    rate: f64,
    /// The greater absolute value of both ends.
    most: f64,
    /// Upper bound of all terms of a value; its rounding error is in units of this bound.
    size: f64,
}

impl JointCourse {
    fn new(joint: &TreeJoint, from: &[f64], to: &[f64]) -> Self {
        let ends = [joint.value(from), joint.value(to)];
        let size = joint.drive.map_or(0.0, |drive| {
            let most = from[drive.coordinate].abs().larger(to[drive.coordinate].abs());
            drive.factor.abs() * most + drive.offset.abs()
        });
        Self {
            from: ends[0],
            rate: ends[1] - ends[0],
            most: ends[0].abs().larger(ends[1].abs()),
            size,
        }
    }

    fn at(&self, time: f64) -> f64 {
        self.from + self.rate * time
    }
}

/// The motion of the bodies of a [`JointTree`](super::JointTree) along a segment.
#[derive(Clone, Debug)]
pub struct TreeSegment {
    tree: LinkTree,
    links: Vec<usize>,
    /// The middle of each body, about which its motion is stated, in the frame of its link.
    middles: Vec<Point3<f64>>,
    joints: Vec<JointCourse>,
    /// Pose and motion model of each body at the start, where the first query of every pair is.
    begin: Vec<(Isometry3<f64>, MotionModel)>,
}

impl TreeSegment {
    pub(crate) fn new(tree: &LinkTree, links: &[usize], middles: &[Point3<f64>], from: &[f64], to: &[f64]) -> Self {
        let joints: Vec<_> = tree.joints().iter().map(|j| JointCourse::new(j, from, to)).collect();
        let mut motions = std::vec![LinkMotion::new(tree.base())];
        for (joint, model) in tree.joints().iter().zip(&joints) {
            let mut motion = motions[joint.parent].clone();
            motion.pass(joint, model, 0.0);
            motions.push(motion);
        }
        let bodies = links.iter().zip(middles);
        let begin = bodies.map(|(&link, middle)| (motions[link].pose, motions[link].clone().model(middle)));
        Self {
            begin: begin.collect(),
            tree: tree.clone(),
            links: links.into(),
            middles: middles.into(),
            joints,
        }
    }
}

impl SegmentMotion for TreeSegment {
    fn pose(&self, body: usize, time: f64) -> Isometry3<f64> {
        let link = self.links[body];
        if time == 0.0 {
            return self.begin[body].0;
        }
        let path = self.tree.path(link);
        path.fold(*self.tree.base(), |pose, (k, joint)| {
            joint.after(&pose, self.joints[k].at(time))
        })
    }

    fn model(&self, body: usize, time: f64, span: f64) -> MotionModel {
        self.placed(0, body, time, span).1
    }

    fn stem(&self, a: usize, b: usize) -> usize {
        let stem = self.tree.stem(self.links[a], self.links[b]);
        // If the stem hardly rotates, use the world frame, whose start is cached.
        let turns = self
            .tree
            .path(stem)
            .filter(|(_, joint)| joint.kind == JointKind::Revolute);
        let turned: f64 = turns.map(|(k, _)| self.joints[k].rate.abs()).sum();
        if turned > TURNED { stem } else { 0 }
    }

    fn placed(&self, stem: usize, body: usize, time: f64, _: f64) -> (Isometry3<f64>, MotionModel) {
        let link = self.links[body];
        if stem == 0 && time == 0.0 {
            return self.begin[body];
        }
        let mut motion = LinkMotion::new(self.tree.base());
        let mut path = self.tree.path(link);
        if stem > 0 {
            for (k, joint) in path.by_ref().take(self.tree.path(stem).count()) {
                motion.share(joint, &self.joints[k]);
            }
            motion.pose = Isometry3::identity();
        }
        path.for_each(|(k, joint)| motion.pass(joint, &self.joints[k], time));
        (motion.pose, motion.model(&self.middles[body]))
    }
}

/// State of the recursion from the base outward: one link.
#[derive(Clone)]
struct LinkMotion {
    pose: Isometry3<f64>,
    linear: Vector3<f64>,
    acceleration: Vector3<f64>,
    angular: Vector3<f64>,
    angular_acceleration: Vector3<f64>,
    bounds: RateBounds,
}

/// Upper bounds of magnitudes.
#[derive(Clone, Default)]
struct RateBounds {
    /// Sum of the rates of revolute joints.
    rate: f64,
    /// Rate of change of the angular velocity.
    bend: f64,
    /// Sum of the lengths from the world's origin.
    length: f64,
    /// First, second and third derivative of the position of the origin.
    speed: f64,
    push: f64,
    jerk: f64,
    /// Rounding errors of the angle and of the position.
    turn: f64,
    place: f64,
}

impl RateBounds {
    /// Adds the rounding of a position after a further vector of this length.
    fn reach_on(&mut self, length: f64) {
        self.length += length;
        self.place += (self.turn + ARM_PLACE) * length + ARM_PLACE * self.length;
    }

    /// Adds the rounding of the value of a joint and of the rotation by the joint.
    fn round(&mut self, kind: JointKind, model: &JointCourse) {
        self.turn += ARM_TURN + ARM_VALUE * model.size;
        if kind == JointKind::Prismatic {
            // The rounding of a mimic value exceeds the part in `ARM_PLACE` by this much.
            self.place += ARM_VALUE * (model.size - model.most).at_least(0.0);
        }
    }
}

impl LinkMotion {
    fn new(base: &Isometry3<f64>) -> Self {
        let length = base.translation.vector.abs().sum();
        Self {
            pose: *base,
            linear: Vector3::zeros(),
            acceleration: Vector3::zeros(),
            angular: Vector3::zeros(),
            angular_acceleration: Vector3::zeros(),
            bounds: RateBounds {
                length,
                turn: ARM_TURN,
                place: ARM_PLACE * length,
                ..RateBounds::default()
            },
        }
    }

    /// Passes a joint that moves both links: skips the shared motion, but counts its rounding.
    fn share(&mut self, joint: &TreeJoint, model: &JointCourse) {
        self.bounds.reach_on(joint.origin.translation.vector.abs().sum());
        self.bounds.round(joint.kind, model);
        if joint.kind == JointKind::Prismatic {
            self.bounds.reach_on(joint.axis.abs().sum() * model.most);
        }
    }

    /// Passes a joint at a time, to the link that it moves.
    fn pass(&mut self, joint: &TreeJoint, model: &JointCourse, time: f64) {
        let (value, rate) = (model.at(time), model.rate);
        let offset = self.pose.rotation * joint.origin.translation.vector;
        self.carry(&offset, &joint.origin.translation.vector, 0.0, None);
        self.bounds.round(joint.kind, model);
        self.pose = joint.after(&self.pose, value);
        let axis = self.pose.rotation * joint.axis.into_inner();
        match joint.kind {
            JointKind::Revolute => self.spin(&axis, rate),
            JointKind::Prismatic => {
                let longer = model.most - value.abs();
                self.carry(
                    &(axis * value),
                    &(joint.axis.into_inner() * value),
                    longer,
                    Some((axis, rate)),
                );
            }
        }
    }

    /// Moves the origin along a vector, and slides it along an axis of the world at a rate.
    ///
    /// The vector is given in world axes and in the axes of the link. At other times it may be
    /// longer by up to `longer`.
    fn carry(&mut self, along: &Vector3<f64>, own: &Vector3<f64>, longer: f64, slide: Option<(Vector3<f64>, f64)>) {
        let w = self.angular;
        self.linear += w.cross(along);
        self.acceleration += self.angular_acceleration.cross(along) + w.cross(&w.cross(along));
        let bounds = &mut self.bounds;
        let length = own.abs().sum() + longer;
        let rate = bounds.rate;
        bounds.reach_on(length);
        bounds.speed += rate * length;
        bounds.push += rate * rate * length;
        bounds.jerk += rate * rate * rate * length;
        if let Some((axis, pace)) = slide {
            self.linear += axis * pace;
            self.acceleration += w.cross(&axis) * (2.0 * pace);
            bounds.speed += pace.abs();
            bounds.push += 2.0 * rate * pace.abs();
            bounds.jerk += 3.0 * rate * rate * pace.abs();
        }
    }

    fn spin(&mut self, axis: &Vector3<f64>, rate: f64) {
        self.angular_acceleration += self.angular.cross(axis) * rate;
        self.angular += axis * rate;
        self.bounds.bend += rate.abs() * self.bounds.rate;
        self.bounds.rate += rate.abs();
    }

    /// Returns the motion about a point of the link.
    ///
    /// Errors count twice, because a bound holds between two rounded poses.
    fn model(mut self, middle: &Point3<f64>) -> MotionModel {
        if *middle != Point3::origin() {
            let along = self.pose.rotation * middle.coords;
            self.carry(&along, &middle.coords, 0.0, None);
        }
        let b = &self.bounds;
        let error = 2.0 * b.turn + ARM_PLACE;
        let growth = 1.0 + ARM_PLACE;
        MotionModel {
            pivot: *middle,
            linear: self.linear,
            angular: self.angular,
            acceleration: self.acceleration,
            shift: Remainder([
                2.0 * b.place,
                2.0 * error * b.speed,
                4.0 * error * b.push,
                b.jerk * growth,
            ]),
            turn: Remainder([2.0 * b.turn, error * b.rate, b.bend * growth, 0.0]),
        }
    }
}
