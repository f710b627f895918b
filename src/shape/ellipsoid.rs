//! Ellipsoids.

use nalgebra::Vector3;

use super::support::{Disc, Support};
use crate::num::scalar::{Scalar, Vec3, dot, root, scaled};
use crate::polyhedron::{FaceId, Feature};
use crate::tolerance::INNER;

/// An ellipsoid about the origin, its axes those of the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    pub(super) semi_axes: Vector3<f64>,
}

impl Ellipsoid {
    /// The semi-axes along x, y and z.
    #[must_use]
    pub fn semi_axes(&self) -> Vector3<f64> {
        self.semi_axes
    }

    pub(crate) fn scaled(&self, by: f64) -> Self {
        Self {
            semi_axes: self.semi_axes * by,
        }
    }

    fn axes<T: Scalar>(&self) -> Vec3<T> {
        [0, 1, 2].map(|k| T::from(self.semi_axes[k]))
    }
}

/// With `P` the diagonal matrix of the squared semi-axes, `h(n) = sqrt(n . P n)` and the support
/// point is `P n / h`.
impl Support for Ellipsoid {
    fn reach(&self) -> f64 {
        self.semi_axes.max()
    }

    #[inline(always)]
    fn support<T: Scalar>(&self, n: &Vec3<T>, _: u32) -> (u32, Vec3<T>) {
        (0, self.of_branch(0, n))
    }

    #[inline(always)]
    fn of_branch<T: Scalar>(&self, _: u32, n: &Vec3<T>) -> Vec3<T> {
        let a: Vec3<T> = self.axes();
        let turned = [0, 1, 2].map(|k| a[k] * n[k]);
        let inverse = T::from(1.0) / root(dot(&turned, &turned));
        [0, 1, 2].map(|k| a[k] * turned[k] * inverse)
    }

    /// `(P d - s (s . d)) / h`.
    #[inline(always)]
    fn bent<T: Scalar>(&self, _: u32, s: &Vec3<T>, n: &Vec3<T>, d: &Vec3<T>) -> Vec3<T> {
        let (a, along, inverse): (Vec3<T>, T, T) = (self.axes(), dot(s, d), T::from(1.0) / dot(n, s));
        [0, 1, 2].map(|k| (a[k] * a[k] * d[k] - s[k] * along) * inverse)
    }

    #[inline(always)]
    fn onto<T: Scalar>(&self, _: u32, place: &Vec3<T>) -> Vec3<T> {
        let a: Vec3<T> = self.axes();
        let unit = [0, 1, 2].map(|k| place[k] / a[k]);
        scaled(place, T::from(1.0) / root(dot(&unit, &unit)))
    }

    /// With `c` the least semi-axis, `s` is the nearest point of the surface to `s - rho n` if and
    /// only if `rho h <= c^2`.
    fn inner_ball(&self, s: &Vector3<f64>, n: &Vector3<f64>) -> (Vector3<f64>, f64) {
        let c = self.semi_axes.min();
        let rho = c * (c / n.dot(s)) * INNER;
        (s - n * rho, rho)
    }

    fn disc(&self, _: &Vector3<f64>) -> Option<Disc> {
        None
    }

    fn feature(&self, _: &[u32], _: &Vector3<f64>) -> Feature {
        Feature::Face(FaceId(0))
    }
}
