//! Circular cones.

use core::f64::consts::PI;

use nalgebra::{Point3, Vector3};

use super::cylinder::{circle_bent, of_circle, on_circle};
use super::support::{Disc, Flat, Support};
use super::{Curved, Mass, ShapeError, length};
use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::{Scalar, Vec3, root, sqrt};
use crate::base::tolerance::UNIT;
use crate::body::polyhedron::{EdgeId, FaceId, Feature, VertexId};

/// A circular cone along z with its apex up. The origin is half-way between apex and base.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "StoredCone"))]
pub struct Cone {
    half_height: f64,
    radius: f64,
}

/// The parameters of a cone before they are checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct StoredCone {
    half_height: f64,
    radius: f64,
}

#[cfg(feature = "serde")]
impl TryFrom<StoredCone> for Cone {
    type Error = ShapeError;

    fn try_from(stored: StoredCone) -> Result<Self, ShapeError> {
        Self::new(stored.half_height, stored.radius)
    }
}

/// Branch of the apex; branch 1 is the rim of the base.
const APEX: u32 = 0;

impl Cone {
    pub(super) fn new(half_height: f64, radius: f64) -> Result<Self, ShapeError> {
        let (half_height, radius) = (length("half height", half_height)?, length("radius", radius)?);
        Ok(Self { half_height, radius })
    }

    /// Returns the radius of the base.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns half the distance between apex and base.
    #[must_use]
    pub fn half_height(&self) -> f64 {
        self.half_height
    }
}

impl Curved for Cone {
    fn fingerprint(&self) -> Fingerprint {
        Fingerprint::of(*b"cone    ", &[self.radius, self.half_height])
    }

    fn scaled(&self, by: f64) -> Self {
        Self {
            radius: self.radius * by,
            half_height: self.half_height * by,
        }
    }

    fn contains(&self, p: &Vector3<f64>) -> bool {
        let (r, h) = (self.radius, self.half_height);
        p.z.abs() <= h && p.xy().norm() * (2.0 * h) <= r * (h - p.z)
    }

    fn mass(&self) -> Mass {
        let (r, h) = (self.radius, self.half_height);
        // Mean squares about the centroid, a quarter of the height over the base.
        let mean = Vector3::new(r * r * 3.0 / 20.0, r * r * 3.0 / 20.0, h * h * 3.0 / 20.0);
        let centroid = Point3::new(0.0, 0.0, -h / 2.0);
        Mass::symmetric(PI * r * r * 2.0 * h / 3.0, centroid, mean)
    }

    #[cfg(any(test, feature = "__internals"))]
    fn of_half_lengths(half: Vector3<f64>) -> Self {
        Self {
            half_height: half.z,
            radius: half.x,
        }
    }
}

/// The side of a cone is a generator between the apex (branch 0) and a point of the rim (branch 1).
impl Support for Cone {
    fn reach(&self) -> f64 {
        sqrt(self.radius * self.radius + self.half_height * self.half_height) * (1.0 + 4.0 * UNIT)
    }

    #[inline(always)]
    fn support<T: Scalar>(&self, n: &Vec3<T>, _: u32) -> (u32, Vec3<T>) {
        let (r, h) = (T::from(self.radius), T::from(self.half_height));
        let rim = r * root(n[0] * n[0] + n[1] * n[1]) - h * n[2];
        let branch = if h * n[2] >= rim { APEX } else { 1 };
        (branch, self.of_branch(branch, n))
    }

    #[inline(always)]
    fn of_branch<T: Scalar>(&self, branch: u32, n: &Vec3<T>) -> Vec3<T> {
        if branch == APEX {
            return [T::from(0.0), T::from(0.0), T::from(self.half_height)];
        }
        of_circle(self.radius, -self.half_height, n)
    }

    #[inline(always)]
    fn bent<T: Scalar>(&self, branch: u32, _: &Vec3<T>, n: &Vec3<T>, d: &Vec3<T>) -> Vec3<T> {
        if branch == APEX {
            return [T::from(0.0); 3];
        }
        circle_bent(self.radius, n, d)
    }

    /// Returns the circle of the normals of the side.
    #[inline(always)]
    fn ridge<T: Scalar>(&self, _: [u32; 2]) -> Option<(Vec3<T>, T)> {
        let (r, height) = (T::from(self.radius), T::from(2.0 * self.half_height));
        let level = r / root(r * r + height * height);
        Some(([T::from(0.0), T::from(0.0), T::from(1.0)], level))
    }

    #[inline(always)]
    fn onto<T: Scalar>(&self, branch: u32, place: &Vec3<T>) -> Vec3<T> {
        if branch == APEX {
            return self.of_branch(branch, place);
        }
        of_circle(self.radius, -self.half_height, place)
    }

    /// Returns a ball that touches the base or the side, whichever has its normal closer to `n`.
    /// The other one limits the ball.
    fn inner_ball(&self, p: &Vector3<f64>, n: &Vector3<f64>) -> (Vector3<f64>, f64) {
        let (r, h, height) = (self.radius, self.half_height, 2.0 * self.half_height);
        let slant = sqrt(r * r + height * height);
        let off = |p: &Vector3<f64>| sqrt(p.x * p.x + p.y * p.y);
        let to_side = |p: &Vector3<f64>| ((h - p.z) * r - off(p) * height) / slant;
        let room = if n.z < 0.0 {
            to_side(p) * slant / (slant + r)
        } else {
            (off(p) * slant / height).smaller((p.z + h) * slant / (slant + r))
        };
        let centre = p - n * room.at_least(0.0);
        (centre, to_side(&centre).smaller(centre.z + h).at_least(0.0))
    }

    /// Returns the normals of the base and of the side. The meridian is a triangle, and half of it
    /// is rotated.
    fn meridian(&self) -> Option<[[f64; 2]; 3]> {
        let (r, height) = (self.radius, 2.0 * self.half_height);
        let slant = sqrt(r * r + height * height);
        let side = [height / slant, r / slant];
        Some([[0.0, -1.0], side, side])
    }

    fn disc(&self, n: &Vector3<f64>) -> Option<Disc> {
        (n.z < 0.0).then_some(Disc {
            z: -self.half_height,
            side: -1.0,
            radius: self.radius,
        })
    }

    /// Returns the base or a generator of the side, whichever has the normal closer to `n`.
    fn flat(&self, n: &Vector3<f64>) -> Option<Flat> {
        let (r, height) = (self.radius, 2.0 * self.half_height);
        let slant = sqrt(r * r + height * height);
        let to_side = (sqrt(n.x * n.x + n.y * n.y) * height + n.z * r) / slant;
        if -n.z > to_side {
            return self.disc(n).map(Flat::Disc);
        }
        let n = [n.x, n.y, n.z];
        Some(Flat::Line([0, 1].each(|branch| self.of_branch(branch, &n).into())))
    }

    /// Returns the feature: the base is face 0, the side face 1, the apex vertex 0, the rim edge 0.
    fn feature(&self, branches: &[u32], p: &Vector3<f64>) -> Feature {
        match branches {
            [first, rest @ ..] if rest.iter().any(|b| b != first) => Feature::Face(FaceId(1)),
            [APEX, ..] => Feature::Vertex(VertexId(0)),
            _ if !on_circle(self.radius, p) => Feature::Face(FaceId(0)),
            _ => Feature::Edge(EdgeId(0)),
        }
    }
}
