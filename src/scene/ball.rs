//! Bounding balls of bodies: a lower bound of the distance of two bodies.

use nalgebra::{Isometry3, Point3, Vector3};

use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{CENTRE, LEAST_SQUARE, RADIUS_UP, ROUND_DOWN, ROUND_UP};
use crate::body::polyhedron::ConvexPolyhedron;
use crate::pair_tracker::geometry::Geometry;

/// A ball that contains a body, in one frame: centre and radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ball {
    pub(super) centre: Vector3<f64>,
    pub(super) radius: f64,
}

impl Ball {
    /// Placeholder of an index without a body.
    #[cfg(feature = "serde")]
    pub(super) const NONE: Self = Self {
        centre: Vector3::new(0.0, 0.0, 0.0),
        radius: 0.0,
    };

    /// Returns a ball that contains a shape, in the frame of the shape: about the frame's origin,
    /// if this ball is nearly as small as the ball about the middle of the box.
    pub(super) fn about(shape: &Geometry) -> Self {
        let (centre, radius) = shape.bounding_ball();
        let own = match shape {
            Geometry::Polyhedron(body) => about_origin(body),
            _ => (sqrt(centre.coords.norm_squared()) + radius) * RADIUS_UP,
        };
        if own <= 1.25 * radius || own == 0.0 {
            return Self {
                centre: Vector3::zeros(),
                radius: own,
            };
        }
        Self {
            centre: centre.coords,
            radius,
        }
    }

    /// Returns the ball of the posed body.
    #[inline]
    pub(super) fn at(&self, pose: &Isometry3<f64>) -> Self {
        let t = pose.translation.vector;
        if self.centre == Vector3::zeros() {
            return Self { centre: t, ..*self };
        }
        // If the norm of the quaternion is not exactly 1, the error of the centre is less than
        // CENTRE times the displacement.
        let centre = pose.rotation.coords.normalize();
        let turned = nalgebra::UnitQuaternion::new_unchecked(centre.into()) * self.centre;
        Self {
            centre: turned + t,
            radius: self.radius + self.error(&t),
        }
    }

    /// Returns an upper bound of the error of the posed centre.
    #[inline]
    pub(super) fn error(&self, t: &Vector3<f64>) -> f64 {
        let sum = |v: &Vector3<f64>| v.x.abs() + v.y.abs() + v.z.abs();
        if self.centre == Vector3::zeros() {
            0.0
        } else {
            CENTRE * (sum(&self.centre) + sum(t))
        }
    }
}

/// Returns the radius of the ball about the origin that contains a body.
fn about_origin(body: &ConvexPolyhedron) -> f64 {
    // Scaled, so that squares stay in range.
    let size = body.vertex_points().fold(0.0, |m: f64, p| m.larger(p.coords.amax()));
    if size == 0.0 {
        return 0.0;
    }
    let square = |p: Point3<f64>| (p.coords / size).norm_squared();
    size * sqrt(body.vertex_points().map(square).fold(0.0, f64::larger)) * RADIUS_UP
}

/// Returns a lower bound of the distance of the contents of two balls; may be negative.
#[inline]
pub(super) fn least_distance(a: &Ball, b: &Ball) -> f64 {
    let between = b.centre - a.centre;
    // Squares lose less than LEAST_SQUARE below the normal numbers.
    let squared = (between.norm_squared() - LEAST_SQUARE).at_least(0.0);
    sqrt(squared) * ROUND_DOWN - (a.radius + b.radius) * ROUND_UP
}
