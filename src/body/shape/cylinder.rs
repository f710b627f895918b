//! Circular cylinders.

use core::f64::consts::PI;

use nalgebra::{Point3, Vector3};

use super::support::{Disc, Flat, Support};
use super::{Curved, Mass, ShapeError, length};
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::{Scalar, Vec3, root, sqrt};
use crate::base::tolerance::{PIVOT, UNIT};
use crate::body::polyhedron::{EdgeId, FaceId, Feature};

/// A circular cylinder along z around the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "StoredCylinder"))]
pub struct Cylinder {
    half_height: f64,
    radius: f64,
}

/// The parameters of a cylinder before they are checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct StoredCylinder {
    half_height: f64,
    radius: f64,
}

#[cfg(feature = "serde")]
impl TryFrom<StoredCylinder> for Cylinder {
    type Error = ShapeError;

    fn try_from(stored: StoredCylinder) -> Result<Self, ShapeError> {
        Self::new(stored.half_height, stored.radius)
    }
}

impl Cylinder {
    pub(super) fn new(half_height: f64, radius: f64) -> Result<Self, ShapeError> {
        let (half_height, radius) = (length("half height", half_height)?, length("radius", radius)?);
        Ok(Self { half_height, radius })
    }

    /// Returns the radius of the discs.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns half the distance between the discs.
    #[must_use]
    pub fn half_height(&self) -> f64 {
        self.half_height
    }
}

/// Returns whether a point of a disc about the z axis lies on the rim, up to rounding.
pub(super) fn on_circle(radius: f64, p: &Vector3<f64>) -> bool {
    p.x * p.x + p.y * p.y >= radius * radius * (1.0 - PIVOT)
}

/// Returns the support point of a horizontal circle about the z axis; if `n` is vertical, the point
/// on the x axis.
#[inline(always)]
pub(super) fn of_circle<T: Scalar>(radius: f64, z: f64, n: &Vec3<T>) -> Vec3<T> {
    let length = root(n[0] * n[0] + n[1] * n[1]);
    if !(length > T::from(0.0)) {
        return [T::from(radius), T::from(0.0), T::from(z)];
    }
    let s = T::from(radius) / length;
    [n[0] * s, n[1] * s, T::from(z)]
}

/// Returns `r / |n_xy| tau (tau . d)` with `tau` the tangent of the circle: the second derivative
/// of the support function of a circle, applied to `d`.
#[inline(always)]
pub(super) fn circle_bent<T: Scalar>(radius: f64, n: &Vec3<T>, d: &Vec3<T>) -> Vec3<T> {
    let (zero, squared) = (T::from(0.0), n[0] * n[0] + n[1] * n[1]);
    if !(squared > zero) {
        return [zero; 3];
    }
    let along = T::from(radius) * (n[0] * d[1] - n[1] * d[0]) / (squared * root(squared));
    [-n[1] * along, n[0] * along, zero]
}

impl Curved for Cylinder {
    fn fingerprint(&self) -> Fingerprint {
        Fingerprint::of(*b"cylinder", &[self.radius, self.half_height])
    }

    fn scaled(&self, by: f64) -> Self {
        Self {
            radius: self.radius * by,
            half_height: self.half_height * by,
        }
    }

    fn contains(&self, p: &Vector3<f64>) -> bool {
        p.z.abs() <= self.half_height && p.xy().norm() <= self.radius
    }

    fn mass(&self) -> Mass {
        let (r, h) = (self.radius, self.half_height);
        let mean = Vector3::new(r * r / 4.0, r * r / 4.0, h * h / 3.0);
        Mass::symmetric(PI * r * r * 2.0 * h, Point3::origin(), mean)
    }

    #[cfg(any(test, feature = "__internals"))]
    fn of_half_lengths(half: Vector3<f64>) -> Self {
        Self {
            half_height: half.z,
            radius: half.x,
        }
    }
}

/// The branches are the upper rim (0) and the lower rim (1). The side of a cylinder is a generator
/// between a point of each.
impl Support for Cylinder {
    fn reach(&self) -> f64 {
        sqrt(self.radius * self.radius + self.half_height * self.half_height) * (1.0 + 4.0 * UNIT)
    }

    #[inline(always)]
    fn support<T: Scalar>(&self, n: &Vec3<T>, _: u32) -> (u32, Vec3<T>) {
        let branch = u32::from(n[2] < T::from(0.0));
        (branch, self.of_branch(branch, n))
    }

    #[inline(always)]
    fn of_branch<T: Scalar>(&self, branch: u32, n: &Vec3<T>) -> Vec3<T> {
        let z = if branch == 0 {
            self.half_height
        } else {
            -self.half_height
        };
        of_circle(self.radius, z, n)
    }

    #[inline(always)]
    fn bent<T: Scalar>(&self, _: u32, _: &Vec3<T>, n: &Vec3<T>, d: &Vec3<T>) -> Vec3<T> {
        circle_bent(self.radius, n, d)
    }

    #[inline(always)]
    fn ridge<T: Scalar>(&self, _: [u32; 2]) -> Option<(Vec3<T>, T)> {
        Some(([T::from(0.0), T::from(0.0), T::from(1.0)], T::from(0.0)))
    }

    #[inline(always)]
    fn onto<T: Scalar>(&self, branch: u32, place: &Vec3<T>) -> Vec3<T> {
        let z = if branch == 0 {
            self.half_height
        } else {
            -self.half_height
        };
        of_circle(self.radius, z, place)
    }

    /// Returns a ball that touches a cap or the side, whichever has its normal closer to `n`.
    fn inner_ball(&self, p: &Vector3<f64>, n: &Vector3<f64>) -> (Vector3<f64>, f64) {
        let (r, h) = (self.radius, self.half_height);
        let off = |p: &Vector3<f64>| sqrt(p.x * p.x + p.y * p.y);
        let room = if n.z * n.z > 0.5 {
            h.smaller(r - off(p))
        } else {
            r.smaller(h - p.z.abs())
        };
        let centre = p - n * room.at_least(0.0);
        (centre, (h - centre.z.abs()).smaller(r - off(&centre)).at_least(0.0))
    }

    fn meridian(&self) -> Option<[[f64; 2]; 3]> {
        Some([[0.0, 1.0], [0.0, -1.0], [1.0, 0.0]])
    }

    fn disc(&self, n: &Vector3<f64>) -> Option<Disc> {
        let side = if n.z < 0.0 { -1.0 } else { 1.0 };
        Some(Disc {
            z: side * self.half_height,
            side,
            radius: self.radius,
        })
    }

    fn flat(&self, n: &Vector3<f64>) -> Option<Flat> {
        if n.z * n.z > 0.5 {
            return self.disc(n).map(Flat::Disc);
        }
        let n = [n.x, n.y, n.z];
        Some(Flat::Line([0, 1].each(|branch| self.of_branch(branch, &n).into())))
    }

    /// Returns the feature: caps are faces 0 (upper) and 1, the side is face 2, rims are edges 0
    /// (upper) and 1.
    fn feature(&self, branches: &[u32], p: &Vector3<f64>) -> Feature {
        match branches {
            [first, rest @ ..] if rest.iter().any(|b| b != first) => Feature::Face(FaceId(2)),
            [first, ..] if !on_circle(self.radius, p) => Feature::Face(FaceId(*first)),
            _ => Feature::Edge(EdgeId(branches.first().copied().unwrap_or(0))),
        }
    }
}
