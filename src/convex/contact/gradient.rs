//! Gradient of the signed distance with respect to a motion of the bodies.
//!
//! As long as the closest features stay the same, the signed distance changes as the contact points
//! separate along the normal: `n . (velocity of the point on B - velocity of the point on A)`. The
//! rotation of the normal adds nothing, because the points lie opposite each other along the
//! normal. The formula holds for separated and overlapping bodies.

use nalgebra::Vector3;

use crate::base::num::extremes::Extremes;
use crate::base::pose::RelativePose;
use crate::pair::outcome::Outcome;

use super::Manifold;

/// Derivative of the signed distance with respect to the pose of a body: a wrench.
///
/// Both vectors are in the frame of the body and relative to its origin. A body that moves with
/// velocity `v` of its origin and angular velocity `w`, given along the axes of the body, changes
/// the signed distance at the rate `linear . v + angular . w`. The order of a twist is linear, then
/// angular. For world axes rotate both vectors by the rotation of the body; the reference point is
/// still the origin of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Gradient {
    /// Derivative with respect to the position of the body's origin: a unit vector.
    pub linear: Vector3<f64>,
    /// Derivative with respect to the body's rotation: a length times a unit vector.
    pub angular: Vector3<f64>,
}

impl Gradient {
    /// Returns the wrench of `force` applied at `point`.
    fn at(point: &Vector3<f64>, force: Vector3<f64>) -> Self {
        Self {
            linear: force,
            angular: point.cross(&force),
        }
    }

    /// Returns the rate of the signed distance along a twist.
    #[must_use]
    pub fn along(&self, linear: &Vector3<f64>, angular: &Vector3<f64>) -> f64 {
        self.linear.dot(linear) + self.angular.dot(angular)
    }
}

impl Outcome {
    /// Returns the gradient of the signed distance with respect to the pose of A.
    ///
    /// It is exact if the signed distance is differentiable. At ties no gradient exists:
    ///
    /// * If several pairs of points are equally close (parallel faces or edges), the rate of the
    ///   signed distance is the least over all pairs. The returned gradient is that of one pair, so
    ///   the true rate is at most the returned rate. [`Manifold::rate`] takes the least.
    /// * If an overlap is equally deep along several normals, the true rate is the largest over all
    ///   normals. The returned gradient is that of one normal, so the true rate is at least the
    ///   returned rate.
    /// * Bodies that touch, but not at a face, have both kinds of ties.
    #[must_use]
    pub fn gradient_a(&self) -> Gradient {
        Gradient::at(&self.point_on_a.coords, -self.normal.into_inner())
    }

    /// Returns the gradient of the signed distance with respect to the pose of B. `a_from_b` must
    /// be the pose of the query. See [`gradient_a`](Self::gradient_a).
    #[must_use]
    pub fn gradient_b(&self, a_from_b: &RelativePose) -> Gradient {
        Gradient::at(&self.point_on_b.coords, a_from_b.rotation().tr_mul(&self.normal))
    }
}

impl Manifold {
    /// Returns the one-sided rate of the signed distance for a twist of A and a twist of B.
    ///
    /// Each twist is in the frame of its body and relative to its origin, as in [`Gradient`].
    /// `a_from_b` must be the pose of the query. `None` without contacts.
    ///
    /// Parallel features touch at many points at once, and a motion may separate the bodies at some
    /// points and bring them closer at others. The rate is the least over the contacts that are as
    /// deep as the deepest, within the bounds. It is exact if the points include all vertices of
    /// the overlap of the faces and only one normal is deepest; otherwise see
    /// [`Outcome::gradient_a`].
    pub fn rate(
        &self,
        a_from_b: &RelativePose,
        linear_a: &Vector3<f64>,
        angular_a: &Vector3<f64>,
        linear_b: &Vector3<f64>,
        angular_b: &Vector3<f64>,
    ) -> Option<f64> {
        let deepest = self.deepest()?.separation;
        let tie = self.upper() - self.lower();
        let n = self.normal().into_inner();
        let m = a_from_b.rotation().tr_mul(&n);
        let tied = self.points().iter().filter(|p| p.separation <= deepest + tie);
        let rates = tied.map(|p| {
            Gradient::at(&p.point_on_a.coords, -n).along(linear_a, angular_a)
                + Gradient::at(&p.point_on_b.coords, m).along(linear_b, angular_b)
        });
        rates.reduce(f64::smaller)
    }
}
