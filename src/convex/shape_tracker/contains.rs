//! Containment of points in a shape.

use nalgebra::{Isometry3, Point3};

use super::ShapeTracker;
use crate::base::pose::RelativePose;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::body::shape::{Core, Curved, Shape, match_core};

impl Shape {
    /// Returns whether the closed shape contains a point, up to rounding of `1e-14` times the size
    /// of the shape; exact for polyhedra that are not rounded. `false` for a point that is not
    /// finite.
    #[must_use]
    pub fn contains(&self, point: &Point3<f64>) -> bool {
        if let Core::Polyhedron(body) = self.core() {
            let near = || {
                body.closest_point(point)
                    .is_some_and(|p| (p - point).norm() <= self.round())
            };
            return body.contains(point) || self.round() > 0.0 && near();
        }
        if self.round() > 0.0 {
            return self.is_near(point).unwrap_or(false);
        }
        match_core!(self.core(), _ => false, core => core.contains(&point.coords))
    }

    /// Returns whether a rounded shape contains a point, by the distance of the point.
    fn is_near(&self, point: &Point3<f64>) -> Option<bool> {
        let point = Self::from(ConvexPolyhedron::point(*point).ok()?);
        let pose = RelativePose::from_isometry(&Isometry3::identity()).ok()?;
        Some(ShapeTracker::new().within(self, &point, &pose, 0.0))
    }
}
