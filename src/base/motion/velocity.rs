//! The velocity of a rigid body.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::turn::Spin;
use crate::base::num::scalar::sqrt;

/// The velocity of a rigid body in the world's frame: linear velocity of the body's own origin, and
/// angular velocity about this origin in radians. Physics engines mostly mean the velocity of the
/// centre of mass: the two agree if this is the origin, or if the body does not rotate.
///
/// For the time of impact of two bodies with constant velocities see
/// [`impact::cast`](crate::impact::cast) of two [`Steady`](crate::motion::Steady) motions.
#[doc(alias = "twist")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Velocity {
    /// Linear velocity of the body's own origin: length a unit of time.
    pub linear: Vector3<f64>,
    /// Angular velocity: axis of rotation, through the body's own origin, times radians a unit of
    /// time.
    pub angular: Vector3<f64>,
}

impl Default for Velocity {
    fn default() -> Self {
        Self::new(Vector3::zeros(), Vector3::zeros())
    }
}

impl Velocity {
    /// Returns the velocity with these two parts.
    #[must_use]
    pub const fn new(linear: Vector3<f64>, angular: Vector3<f64>) -> Self {
        Self { linear, angular }
    }

    /// Returns the pose of a body at `pose` after `time` at this velocity: the body turns by
    /// exactly `angular * time`, up to rounding.
    ///
    /// ```
    /// use lin_canny::Velocity;
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    ///
    /// let spin = Velocity::new(Vector3::x(), Vector3::z() * std::f64::consts::PI);
    /// let pose = spin.applied(&Isometry3::identity(), 0.5);
    /// assert!((pose * Vector3::x() - Vector3::y()).norm() < 1e-15);
    /// assert_eq!(pose.translation.vector, Vector3::x() * 0.5);
    /// ```
    #[must_use]
    pub fn applied(&self, pose: &Isometry3<f64>, time: f64) -> Isometry3<f64> {
        let at = pose.translation.vector + self.linear * time;
        let turned = Spin::new(&self.angular).after(time) * pose.rotation.into_inner();
        let rotation = turned / sqrt(turned.norm_squared());
        Isometry3::from_parts(Translation3::from(at), UnitQuaternion::new_unchecked(rotation))
    }
}

impl core::ops::Neg for Velocity {
    type Output = Self;

    /// Returns the velocity of the motion back.
    fn neg(self) -> Self {
        Self::new(-self.linear, -self.angular)
    }
}
