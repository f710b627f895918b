//! The motion of the links of a serial arm whose joints all move evenly.
//!
//! # Bounds
//!
//! Link k turns at `w = sum q'_i z_i` over its revolute joints, `z_i` the axis of joint i in the
//! world, and `z_i' = w_{i-1} x z_i`. So the angular velocity changes at most at the rate
//! `sum |q'_i| W_{i-1}`, with `W_i` the sum of the rates of the revolute joints up to i.
//!
//! The origin of the link is the sum of vectors `R_1 .. R_i u_i`, each turned by the joints before
//! it. Each turn has a constant rate about a fixed axis of the frame before, so by Leibniz's rule
//! the n-th derivative of a vector of constant length is at most `W_i^n |u_i|`, and of a vector
//! along a prismatic joint of value d `W^3 |d| + 3 W^2 |d'|` for n = 3. Velocity and acceleration
//! at an instant are those of the forward recursion of Newton and Euler (Luh, Walker and Paul
//! 1980); the sum of the third derivatives bounds the deviation from there.
//!
//! Errors of rounding grow with the number of joints: see `ARM_TURN` and `ARM_PLACE`.

use alloc::sync::Arc;
use alloc::vec::Vec;

use nalgebra::{Isometry3, Point3, Unit, UnitQuaternion, Vector3};

use super::arm::{Joint, JointKind};
use super::space::SegmentMotion;
use crate::motion::{Course, Drift};
use crate::pose::normalize;
use crate::tolerance::{ARM_PLACE, ARM_TURN, ARM_VALUE};

/// Base and joints, shared by an arm and its segments.
#[derive(Clone, Debug)]
pub(super) struct Chain(Arc<(Isometry3<f64>, Vec<Joint>)>);

impl Chain {
    /// Normalises rotations and axes: bounds take them as unit to rounding.
    pub(super) fn new(base: &Isometry3<f64>, mut joints: Vec<Joint>) -> Self {
        for joint in &mut joints {
            joint.origin = normalize(&joint.origin);
            joint.axis = Unit::new_normalize(joint.axis.into_inner());
        }
        Self(Arc::new((normalize(base), joints)))
    }

    pub(super) fn joints(&self) -> &[Joint] {
        &self.0.1
    }

    /// Returns the poses of the base and of all links.
    pub(super) fn poses(&self, values: &[f64]) -> impl Iterator<Item = Isometry3<f64>> {
        let (base, joints) = &*self.0;
        let mut pose = *base;
        let moved = joints.iter().zip(values).map(move |(joint, &value)| {
            pose = joint.after(&pose, value);
            pose
        });
        core::iter::once(*base).chain(moved)
    }
}

/// The motion of the bodies of a [`SerialArm`](super::SerialArm) along a segment.
#[derive(Clone, Debug)]
pub struct ArmSegment {
    chain: Chain,
    links: Vec<usize>,
    from: Vec<f64>,
    rate: Vec<f64>,
    /// The greater absolute value of each joint.
    most: Vec<f64>,
    /// Pose and course of each link at the begin, where every pair is looked at first.
    begin: Vec<(Isometry3<f64>, Course)>,
}

impl ArmSegment {
    pub(super) fn new(chain: &Chain, links: &[usize], from: &[f64], to: &[f64]) -> Self {
        let ends = || from.iter().zip(to);
        let mut segment = Self {
            chain: chain.clone(),
            links: links.into(),
            from: from.into(),
            rate: ends().map(|(a, b)| b - a).collect(),
            most: ends().map(|(a, b)| a.abs().max(b.abs())).collect(),
            begin: Vec::new(),
        };
        segment.begin = chain.poses(from).zip(segment.courses(0.0)).collect();
        segment
    }

    fn values(&self, time: f64) -> impl Iterator<Item = f64> {
        self.from.iter().zip(&self.rate).map(move |(q, rate)| q + rate * time)
    }

    /// Returns the courses of the base and of all links.
    fn courses(&self, time: f64) -> impl Iterator<Item = Course> {
        let (base, joints) = &*self.chain.0;
        let mut link = LinkMotion::new(base);
        let first = link.course();
        let values = self.values(time).zip(&self.rate).zip(&self.most);
        let moved = joints.iter().zip(values).map(move |(joint, ((value, &rate), &most))| {
            link.pass(joint, value, rate, most);
            link.course()
        });
        core::iter::once(first).chain(moved)
    }
}

impl SegmentMotion for ArmSegment {
    fn pose(&self, body: usize, time: f64) -> Isometry3<f64> {
        let link = self.links[body];
        if time == 0.0 {
            return self.begin[link].0;
        }
        let (base, joints) = &*self.chain.0;
        let before = joints.iter().zip(self.values(time)).take(link);
        before.fold(*base, |pose, (joint, value)| joint.after(&pose, value))
    }

    fn course(&self, body: usize, time: f64, _: f64) -> Course {
        let link = self.links[body];
        let begin = self.begin[link].1;
        if time == 0.0 {
            begin
        } else {
            self.courses(time).nth(link).unwrap_or(begin)
        }
    }
}

/// A link while the recursion runs outward.
struct LinkMotion {
    rotation: UnitQuaternion<f64>,
    linear: Vector3<f64>,
    acceleration: Vector3<f64>,
    angular: Vector3<f64>,
    angular_acceleration: Vector3<f64>,
    bounds: RateBounds,
}

/// Upper bounds of magnitudes.
#[derive(Default)]
struct RateBounds {
    /// Sum of the rates of revolute joints.
    rate: f64,
    /// Rate of change of the angular velocity.
    bend: f64,
    /// Sum of the lengths from the world's origin.
    length: f64,
    /// First, second and third derivative of the place of the origin.
    speed: f64,
    push: f64,
    jerk: f64,
    /// Error of the angle and of the place, by rounding.
    turn: f64,
    place: f64,
}

impl LinkMotion {
    fn new(base: &Isometry3<f64>) -> Self {
        let length = base.translation.vector.abs().sum();
        Self {
            rotation: base.rotation,
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

    /// Goes on to the link behind a joint of this value and rate, whose greatest value is `most`.
    fn pass(&mut self, joint: &Joint, value: f64, rate: f64, most: f64) {
        self.carry(&joint.origin.translation.vector, 0.0, None);
        self.turn_by(&joint.origin.rotation);
        self.bounds.turn += ARM_TURN + ARM_VALUE * most;
        let axis = self.rotation * joint.axis.into_inner();
        match joint.kind {
            JointKind::Revolute => {
                self.spin(&axis, rate);
                self.turn_by(&joint.moved(value).rotation);
            }
            JointKind::Prismatic => self.carry(
                &(joint.axis.into_inner() * value),
                most - value.abs(),
                Some((axis, rate)),
            ),
        }
    }

    fn turn_by(&mut self, rotation: &UnitQuaternion<f64>) {
        let turned = self.rotation.into_inner() * rotation.into_inner();
        let norm = crate::num::scalar::sqrt(turned.norm_squared());
        self.rotation = UnitQuaternion::new_unchecked(turned / norm);
    }

    /// Goes along a vector of the link's frame, which is up to `longer` longer at other times, and
    /// slides along an axis of the world at a rate.
    fn carry(&mut self, vector: &Vector3<f64>, longer: f64, slide: Option<(Vector3<f64>, f64)>) {
        let (w, along) = (self.angular, self.rotation * vector);
        self.linear += w.cross(&along);
        self.acceleration += self.angular_acceleration.cross(&along) + w.cross(&w.cross(&along));
        let bounds = &mut self.bounds;
        let length = vector.abs().sum() + longer;
        let rate = bounds.rate;
        bounds.length += length;
        bounds.place += (bounds.turn + ARM_PLACE) * length + ARM_PLACE * bounds.length;
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

    /// Errors count twice: a bound begins at a pose that is placed, and ends at another.
    fn course(&self) -> Course {
        let b = &self.bounds;
        let error = 2.0 * b.turn + ARM_PLACE;
        let growth = 1.0 + ARM_PLACE;
        Course {
            pivot: Point3::origin(),
            linear: self.linear,
            angular: self.angular,
            acceleration: self.acceleration,
            shift: Drift([
                2.0 * b.place,
                2.0 * error * b.speed,
                4.0 * error * b.push,
                b.jerk * growth,
            ]),
            turn: Drift([2.0 * b.turn, error * b.rate, b.bend * growth, 0.0]),
        }
    }
}
