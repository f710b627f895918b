//! The point of a convex body that is highest along a direction, with a bound of what is missing.

use nalgebra::{Point3, Vector3};

use crate::base::num::extremes::Bounded;
use crate::body::polyhedron::{ConvexPolyhedron, Feature};
use crate::body::shape::{Core, Shape, Support, match_core};

/// A point of a body that is about the highest along a unit direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Top {
    /// The point, in the body's frame and the caller's unit.
    pub(crate) point: Vector3<f64>,
    /// The feature that contains the point.
    pub(crate) feature: Feature,
    /// No point of the body is higher by more than this, up to the rounding of heights
    /// (`tolerance::CERTIFICATE`).
    pub(crate) excess: f64,
    /// The body has a point that is no lower than the point by more than this, up to rounding.
    pub(crate) error: f64,
}

impl ConvexPolyhedron {
    /// Returns the support vertex along a unit direction.
    pub(crate) fn top(&self, n: &Vector3<f64>) -> Top {
        let vertex = self.support_certified(n, self.lookup.cell(n)).vertex;
        Top {
            point: self.vertex(vertex).unwrap_or_else(Point3::origin).coords,
            feature: Feature::Vertex(vertex),
            excess: 0.0,
            error: 0.0,
        }
    }
}

impl Shape {
    /// Returns a point of the shape that is about the highest along a unit direction.
    pub(crate) fn top(&self, n: &Vector3<f64>) -> Top {
        let along = [n.x, n.y, n.z];
        let top = match_core!(&self.core, body => body.top(n), core => {
            let (branch, point) = core.support(&along, 0);
            let point = Vector3::from(point);
            Top { point, feature: core.feature(&[branch], &point), excess: 0.0, error: 0.0 }
        });
        let point = top.point + n * self.rounding;
        if let Core::Polyhedron(_) = self.core {
            return Top { point, ..top };
        }
        let excess = (self.support_height(n) - n.dot(&point)).at_least(0.0);
        Top {
            point,
            excess,
            error: excess,
            ..top
        }
    }
}
