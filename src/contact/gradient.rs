//! What a motion does to the signed distance.
//!
//! While the closest features stay, the signed distance changes as the points of contact part along the normal: `n . (velocity of
//! the point on B - velocity of the point on A)`. The normal's own turning adds nothing, because the points are across from
//! each other along it. This holds apart and overlapping.

use nalgebra::Vector3;

use crate::pair::outcome::Outcome;
use crate::pose::RelativePose;

use super::Manifold;

/// The derivative of the signed distance by the pose of one body: a wrench.
///
/// Both parts are in that body's own frame, about its own origin: a body that moves with velocity `v` of its origin and angular
/// velocity `w`, given along its own axes, changes the signed distance at the rate `linear . v + angular . w`. The order of a
/// twist is linear, then angular. For world axes turn both parts by the body's rotation; the origin stays that of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Gradient {
    /// By the place of the body's origin: a unit vector.
    pub linear: Vector3<f64>,
    /// By its turn: a length times a unit vector.
    pub angular: Vector3<f64>,
}

impl Gradient {
    /// Of `force` at `point`.
    fn at(point: &Vector3<f64>, force: Vector3<f64>) -> Self {
        Self {
            linear: force,
            angular: point.cross(&force),
        }
    }

    /// The rate along a twist.
    #[must_use]
    pub fn along(&self, linear: &Vector3<f64>, angular: &Vector3<f64>) -> f64 {
        self.linear.dot(linear) + self.angular.dot(angular)
    }
}

impl Outcome {
    /// The gradient of the signed distance by the pose of A.
    ///
    /// Where the signed distance has a gradient, this is it. It has none at ties: where several pairs of points are equally close
    /// (parallel faces or edges), its rate is the least over these pairs, and this is one of them, so the rate is no more than this says
    /// ([`Manifold::rate`] takes the least); where an overlap is equally deep along several normals, its rate is the largest over
    /// those, and this is one of them, so the rate is no less. Bodies that touch at less than a face have both.
    #[must_use]
    pub fn gradient_a(&self) -> Gradient {
        Gradient::at(&self.point_on_a.coords, -self.normal.into_inner())
    }

    /// The gradient of the signed distance by the pose of B, `a_from_b` the pose that was asked with. See
    /// [`gradient_a`](Self::gradient_a).
    #[must_use]
    pub fn gradient_b(&self, a_from_b: &RelativePose) -> Gradient {
        Gradient::at(&self.point_on_b.coords, a_from_b.rotation().tr_mul(&self.normal))
    }
}

impl Manifold {
    /// The rate of the signed distance, one-sided, for twists `(linear, angular)` of A and of B, each in its own frame about its own
    /// origin as in [`Gradient`]; `a_from_b` is the pose that was asked with. `None` without contacts.
    ///
    /// Parallel features touch at many points at once, and what moves apart at one of them moves together at another: the rate is
    /// the least over the contacts that are as deep as the deepest within the bounds. It is exact where all corners of what
    /// the faces share are among the points, and where one normal is deepest; otherwise see [`Outcome::gradient_a`].
    pub fn rate(
        &self,
        a_from_b: &RelativePose,
        (linear_a, angular_a): (&Vector3<f64>, &Vector3<f64>),
        (linear_b, angular_b): (&Vector3<f64>, &Vector3<f64>),
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
        rates.reduce(f64::min)
    }
}
