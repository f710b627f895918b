//! The motion of objects that links carry.
//!
//! # Bounds
//!
//! An object has the fixed pose X in the frame of the body that carries it. The model of that body
//! moves its pivot m by `v s + a s^2 / 2` and rotates by `exp(w s)`. A point n of the object is at
//! `d` from m in the world, where `|d| = |X n - m|`. In the same model, n moves by
//! `v s + a s^2 / 2 + (exp(w s) - 1) d`. That is `v' s + a' s^2 / 2` with `v' = v + w x d` and
//! `a' = a + w x (w x d)`, up to `|w|^2 |w x d| s^3 / 6`. The body deviates from its model by
//! `shift` at m and by `turn`, so it deviates at n by at most `shift + |d| turn`.
//!
//! The pose of the object is the product of two rounded poses: see [`ATTACHED`].

use nalgebra::{Isometry3, Point3};

use crate::motion::space::BodyBall;
use crate::motion::space::{BodyMotion, SegmentMotion};
use crate::motion::timed_poses::PosePart;
use crate::tolerance::ATTACHED;
use lin_canny::motion::{Motion, MotionModel, Remainder, Steady};
use lin_canny::normalize_rotation;

/// Where an object is carried.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carried {
    /// The body of the space that carries the object.
    pub(crate) body: usize,
    /// Pose of the object in the frame of that body.
    pub(crate) pose: Isometry3<f64>,
    /// The middle of the object, about which its motion is stated, in its frame.
    pub(crate) middle: Point3<f64>,
}

impl Carried {
    /// Returns the pose of the object from the pose of the body.
    pub(crate) fn placed(&self, body: &Isometry3<f64>) -> Isometry3<f64> {
        normalize_rotation(&(normalize_rotation(body) * self.pose))
    }

    /// Returns pose and motion model of the object from those of the body.
    pub(crate) fn after(&self, (pose, model): &(Isometry3<f64>, MotionModel)) -> (Isometry3<f64>, MotionModel) {
        (self.placed(pose), self.model(pose, model))
    }

    /// Returns the motion model of the object from pose and model of the body.
    fn model(&self, body: &Isometry3<f64>, model: &MotionModel) -> MotionModel {
        let own = (self.pose * self.middle) - model.pivot;
        let away = normalize_rotation(body).rotation * own;
        let (turning, bent) = (
            model.angular.cross(&away),
            model.angular.cross(&model.angular.cross(&away)),
        );
        // Lengths of all terms, and of the position of the body.
        let terms =
            self.pose.translation.vector.abs().sum() + self.middle.coords.abs().sum() + model.pivot.coords.abs().sum();
        let size = terms + body.translation.vector.abs().sum();
        let arm = own.abs().sum() + ATTACHED * terms;
        let rate = model.angular.abs().sum();
        let straight = [
            size,
            model.linear.abs().sum() + rate * terms,
            model.acceleration.abs().sum() + rate * rate * terms,
            rate * rate * rate * terms,
        ];
        let bend = [
            0.0,
            0.0,
            0.0,
            rate * rate * (turning.abs().sum() + rate * ATTACHED * terms),
        ];
        let (Remainder(shift), Remainder(turn)) = (model.shift, model.turn);
        let growth = 1.0 + ATTACHED;
        let deviation = |k: usize| (shift[k] + arm * turn[k] + bend[k]) * growth;
        let rounding = |k: usize| 2.0 * ATTACHED * (straight[k] + shift[k] + terms * turn[k]);
        MotionModel {
            pivot: self.middle,
            linear: model.linear + turning,
            angular: model.angular,
            acceleration: model.acceleration + bent,
            shift: Remainder([0, 1, 2, 3].map(|k| deviation(k) + rounding(k))),
            turn: Remainder([turn[0] + 2.0 * ATTACHED, turn[1], turn[2], turn[3]]),
        }
    }
}

/// The motion of a body that moves with the robot, or of an object that such a body carries.
pub(crate) struct CarriedMotion<'a, M> {
    pub(crate) motion: BodyMotion<'a, M>,
    pub(crate) carried: Option<&'a Carried>,
}

impl<M: SegmentMotion> Motion for CarriedMotion<'_, M> {
    fn pose(&self, time: f64) -> Isometry3<f64> {
        let pose = self.motion.pose(time);
        self.carried.map_or(pose, |carried| carried.placed(&pose))
    }

    fn model(&self, time: f64, span: f64) -> MotionModel {
        self.placed(time, span).1
    }

    fn placed(&self, time: f64, span: f64) -> (Isometry3<f64>, MotionModel) {
        let body = self.motion.placed(time, span);
        self.carried.map_or(body, |carried| carried.after(&body))
    }
}

/// The motion of the second body of a pair.
pub(crate) enum PartMotion<'a, M> {
    Robot(CarriedMotion<'a, M>),
    Obstacle(&'a Steady),
    Moving(&'a PosePart),
}

impl<M: SegmentMotion> Motion for PartMotion<'_, M> {
    fn pose(&self, time: f64) -> Isometry3<f64> {
        match self {
            Self::Robot(motion) => motion.pose(time),
            Self::Obstacle(motion) => motion.pose(time),
            Self::Moving(motion) => motion.pose(time),
        }
    }

    fn model(&self, time: f64, span: f64) -> MotionModel {
        match self {
            Self::Robot(motion) => motion.model(time, span),
            Self::Obstacle(motion) => motion.model(time, span),
            Self::Moving(motion) => motion.model(time, span),
        }
    }

    fn placed(&self, time: f64, span: f64) -> (Isometry3<f64>, MotionModel) {
        match self {
            Self::Robot(motion) => motion.placed(time, span),
            Self::Obstacle(motion) => motion.placed(time, span),
            Self::Moving(motion) => motion.placed(time, span),
        }
    }
}

impl BodyBall {
    /// Returns the ball around a mover, as one of the body that is the mover or carries it.
    pub(crate) fn new((centre, radius): (Point3<f64>, f64), body: usize, carried: Option<&Carried>) -> Self {
        let Some(carried) = carried else {
            return Self { body, centre, radius };
        };
        let length = carried.pose.translation.vector.abs().sum() + centre.coords.abs().sum();
        Self {
            body,
            centre: carried.pose * centre,
            radius: radius + ATTACHED * length,
        }
    }
}
