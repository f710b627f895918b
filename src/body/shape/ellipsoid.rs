//! Ellipsoids.

use core::f64::consts::PI;

use nalgebra::{Point3, Vector3};

use super::support::{Disc, Support};
use super::{Curved, Mass, ShapeError, length};
use crate::base::num::each::Each;
use crate::base::num::extremes::{largest, smallest};
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::{Scalar, Vec3, dot, root, scaled, sub};
use crate::base::tolerance::INNER;
use crate::body::polyhedron::{FaceId, Feature};

/// An ellipsoid around the origin with axes along x, y and z.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "StoredEllipsoid"))]
pub struct Ellipsoid {
    semi_axes: Vector3<f64>,
}

/// The parameters of an ellipsoid before they are checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct StoredEllipsoid {
    semi_axes: Vector3<f64>,
}

#[cfg(feature = "serde")]
impl TryFrom<StoredEllipsoid> for Ellipsoid {
    type Error = ShapeError;

    fn try_from(stored: StoredEllipsoid) -> Result<Self, ShapeError> {
        Self::new(stored.semi_axes)
    }
}

impl Ellipsoid {
    pub(super) fn new(semi_axes: Vector3<f64>) -> Result<Self, ShapeError> {
        for &x in semi_axes.iter() {
            length("semi-axis", x)?;
        }
        Ok(Self { semi_axes })
    }

    /// Returns the semi-axes along x, y and z.
    #[must_use]
    pub fn semi_axes(&self) -> Vector3<f64> {
        self.semi_axes
    }

    #[inline(always)]
    fn axes<T: Scalar>(&self) -> Vec3<T> {
        let a = &self.semi_axes;
        [T::from(a.x), T::from(a.y), T::from(a.z)]
    }
}

/// Returns the products of coordinates.
#[inline(always)]
fn times<T: Scalar>(a: &Vec3<T>, b: &Vec3<T>) -> Vec3<T> {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

impl Curved for Ellipsoid {
    fn fingerprint(&self) -> Fingerprint {
        Fingerprint::of(*b"ellipsoi", self.semi_axes.as_slice())
    }

    fn scaled(&self, by: f64) -> Self {
        Self {
            semi_axes: self.semi_axes * by,
        }
    }

    fn contains(&self, p: &Vector3<f64>) -> bool {
        p.component_div(&self.semi_axes).norm_squared() <= 1.0
    }

    fn mass(&self) -> Mass {
        let a = self.semi_axes;
        let volume = 4.0 / 3.0 * PI * a.x * a.y * a.z;
        Mass::symmetric(volume, Point3::origin(), a.component_mul(&a) / 5.0)
    }

    #[cfg(any(test, feature = "__internals"))]
    fn of_half_lengths(half: Vector3<f64>) -> Self {
        Self { semi_axes: half }
    }
}

/// An ellipsoid has one branch. With `P` the diagonal matrix of the squared semi-axes, the support
/// function is `h(n) = sqrt(n . P n)` and the support point is `P n / h`.
impl Support for Ellipsoid {
    const IS_SMOOTH: bool = true;

    fn reach(&self) -> f64 {
        largest(&self.semi_axes)
    }

    #[inline(always)]
    fn support<T: Scalar>(&self, n: &Vec3<T>, _: u32) -> (u32, Vec3<T>) {
        (0, self.of_branch(0, n))
    }

    #[inline(always)]
    fn of_branch<T: Scalar>(&self, _: u32, n: &Vec3<T>) -> Vec3<T> {
        let a: Vec3<T> = self.axes();
        let turned = times(&a, n);
        scaled(&times(&a, &turned), T::from(1.0) / root(dot(&turned, &turned)))
    }

    /// Returns `(P d - s (s . d)) / h`.
    #[inline(always)]
    fn bent<T: Scalar>(&self, _: u32, s: &Vec3<T>, n: &Vec3<T>, d: &Vec3<T>) -> Vec3<T> {
        let (a, along, inverse): (Vec3<T>, T, T) = (self.axes(), dot(s, d), T::from(1.0) / dot(n, s));
        scaled(&sub(&times(&times(&a, &a), d), &scaled(s, along)), inverse)
    }

    #[inline(always)]
    fn ridge<T: Scalar>(&self, _: [u32; 2]) -> Option<(Vec3<T>, T)> {
        None
    }

    #[inline(always)]
    fn onto<T: Scalar>(&self, _: u32, place: &Vec3<T>) -> Vec3<T> {
        let a: Vec3<T> = self.axes();
        let unit = [0, 1, 2].each(|k| place[k] / a[k]);
        scaled(place, T::from(1.0) / root(dot(&unit, &unit)))
    }

    /// Returns the ball of radius `rho = c^2 / h` about `s - rho n`, with `c` the least semi-axis:
    /// `s` is the nearest point of the surface to `s - rho n` if and only if `rho h <= c^2`.
    fn inner_ball(&self, s: &Vector3<f64>, n: &Vector3<f64>) -> (Vector3<f64>, f64) {
        let c = smallest(&self.semi_axes);
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
