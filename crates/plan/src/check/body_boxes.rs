//! Boxes and balls around bodies, in the frames of their shapes and in the world.

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

use crate::extremes::Extremes;
use crate::tolerance::{PLACED, PLACED_BALL};
use lin_canny::Geometry;
use lin_canny::broad::Aabb;
use lin_canny::polyhedron::BoxHint;

/// Factor by which the radius of a tube grows for swept boxes, more than sums round.
pub(crate) const GROWN: f64 = 1.0 + 8.0 * f64::EPSILON;

/// A box around a body, along the axes of the frame of its shape.
#[derive(Clone, Copy)]
pub(crate) struct OwnBox {
    pub(crate) middle: Point3<f64>,
    /// Half of each side; infinite if the body is unbounded.
    pub(crate) half: Vector3<f64>,
}

impl OwnBox {
    /// The box of a body that is not there.
    pub(crate) const NONE: Self = Self {
        middle: Point3::new(0.0, 0.0, 0.0),
        half: Vector3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
    };

    pub(crate) fn of(shape: &Geometry) -> Self {
        let (low, high) = shape.aabb_at(&Isometry3::identity(), &mut BoxHint::default());
        if !low.iter().chain(high.iter()).all(|x| x.is_finite()) {
            return Self::NONE;
        }
        Self {
            middle: Point3::from(low.coords * 0.5 + high.coords * 0.5),
            half: (high - low) * 0.5,
        }
    }
}

/// An [`OwnBox`] in the world.
#[derive(Clone, Copy)]
pub(crate) struct PlacedBox {
    pub(crate) middle: Point3<f64>,
    pub(crate) axes: Matrix3<f64>,
    pub(crate) half: Vector3<f64>,
    /// Rounding error of the box.
    pub(crate) error: f64,
}

impl PlacedBox {
    #[inline]
    pub(crate) fn new(own: &OwnBox, pose: &Isometry3<f64>) -> Self {
        let out = own.middle.coords.abs().sum() + own.half.sum();
        let at = pose.translation.vector.abs().sum();
        Self {
            middle: pose * own.middle,
            axes: pose.rotation.to_rotation_matrix().into_inner(),
            half: own.half,
            error: PLACED_BALL * out + PLACED * (out + at),
        }
    }

    /// Returns the rounding error of the heights of this box and another one along axes of either:
    /// the squared norms of the quaternions scale the heights.
    #[inline]
    pub(crate) fn error_of_heights(&self, other: &Self) -> f64 {
        let apart = (other.middle - self.middle).abs().sum();
        self.error + other.error + PLACED_BALL * (apart + self.half.sum() + other.half.sum())
    }
}

/// Returns a ball in the world, enlarged by the rounding of its position and of its distance from
/// another one.
#[inline]
pub(crate) fn placed_ball((centre, radius): (Point3<f64>, f64), pose: &Isometry3<f64>) -> (Point3<f64>, f64) {
    let (out, at) = (centre.coords.abs().sum(), pose.translation.vector.abs().sum());
    (pose * centre, radius + PLACED_BALL * out + PLACED * (radius + out + at))
}

/// Returns the box along the axes of the world around what a ball and a box share.
pub(crate) fn around((centre, radius): (Point3<f64>, f64), placed: &PlacedBox) -> Aabb {
    let by_ball = Aabb::new(centre, centre).grown(radius);
    let half = placed.axes.abs() * placed.half + Vector3::repeat(placed.error);
    let [low, high] = [placed.middle - half, placed.middle + half];
    // An unbounded box may have sides that are not numbers.
    Aabb::new(
        by_ball.min.coords.zip_map(&low.coords, f64::larger).into(),
        by_ball.max.coords.zip_map(&high.coords, f64::smaller).into(),
    )
}

/// Returns a box that is grown by a distance that a pair must keep. The boxes of movers have a
/// reserve for the rounding of this.
pub(crate) fn kept_around(aabb: &Aabb, kept: f64) -> Aabb {
    aabb.grown(kept * (1.0 + PLACED))
}
