//! A query for the contacts of two bodies.

use nalgebra::{Matrix3, Vector3};

use crate::motion::BallAtPose;
use crate::num::scalar::sqrt;
use crate::polyhedron::ConvexPolyhedron;
use crate::pose::{Operand, RelativePose};

use super::ManifoldOptions;

/// Two bodies, their relative pose, and the options of their contacts.
pub(crate) struct Query<'a> {
    pub(super) a: &'a ConvexPolyhedron,
    pub(super) b: &'a ConvexPolyhedron,
    /// Rotation of `a_from_b`.
    pub(super) rotation: Matrix3<f64>,
    pub(super) translation: Vector3<f64>,
    /// Bounding ball of the smaller body at its pose relative to the larger body.
    pub(super) ball: BallAtPose,
    pub(super) options: &'a ManifoldOptions,
}

impl<'a> Query<'a> {
    #[inline(always)]
    pub(crate) fn new(
        a: &'a ConvexPolyhedron,
        b: &'a ConvexPolyhedron,
        pose: &RelativePose,
        options: &'a ManifoldOptions,
    ) -> Self {
        let (rotation, translation) = (pose.rotation(), pose.translation());
        let (ra, rb) = (radius(a), radius(b));
        let (moving, ball) = if rb <= ra {
            (Operand::B, (&b.origin, rb))
        } else {
            (Operand::A, (&a.origin, ra))
        };
        let ball = BallAtPose::new(moving, ball, &rotation, &translation);
        Self {
            a,
            b,
            rotation,
            translation,
            ball,
            options,
        }
    }

    pub(super) fn bodies(&self) -> [u64; 2] {
        [self.a.fingerprint, self.b.fingerprint]
    }

    /// Returns the radius of the smaller body.
    pub(super) fn least_radius(&self) -> f64 {
        radius(self.a).min(radius(self.b))
    }

    /// Returns how far the bodies may move before the contacts are computed again, for an outcome
    /// with this lower bound.
    pub(super) fn budget(&self, lower: f64) -> f64 {
        if !(self.a.is_unscaled && self.b.is_unscaled) {
            // If stored coordinates are rescaled, old points would be measured more coarsely than
            // new points.
            -1.0
        } else if lower <= self.options.prediction {
            self.options.drift * self.least_radius()
        } else {
            lower - self.options.prediction
        }
    }

    /// Returns the pair's size L.
    #[inline(always)]
    pub(super) fn size(&self) -> f64 {
        let apart = self.rotation * self.b.origin + self.translation - self.a.origin;
        radius(self.a) + radius(self.b) + sqrt(apart.norm_squared())
    }
}

/// Returns the radius about the origin of the stored coordinates, in the caller's unit.
#[inline(always)]
fn radius(body: &ConvexPolyhedron) -> f64 {
    if body.is_unscaled {
        body.radius
    } else {
        body.radius * body.unit()
    }
}
