//! Volume, centre of mass and inertia.

use core::f64::consts::PI;

use nalgebra::{Matrix3, Point3, Vector3};

use super::rounded_mass::rounded;
use super::{Core, Curved, Shape, match_core};
use crate::body::polyhedron::ConvexPolyhedron;

/// Mass properties at unit density, in the frame of the shape.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Mass {
    /// Volume.
    pub volume: f64,
    /// Centre of mass.
    pub centroid: Point3<f64>,
    /// Inertia tensor about the centre of mass.
    pub inertia: Matrix3<f64>,
}

impl Mass {
    fn of(body: &ConvexPolyhedron) -> Self {
        Self {
            volume: body.volume(),
            centroid: body.centroid(),
            inertia: body.inertia(),
        }
    }

    /// Returns the mass of a body symmetric about three planes through `centroid`, from the volume
    /// and the mean squares of coordinates.
    pub(super) fn symmetric(volume: f64, centroid: Point3<f64>, mean: Vector3<f64>) -> Self {
        let sums = Vector3::new(mean.y + mean.z, mean.z + mean.x, mean.x + mean.y);
        Self {
            volume,
            centroid,
            inertia: Matrix3::from_diagonal(&(sums * volume)),
        }
    }
}

impl Shape {
    /// Returns the mass properties at unit density, in closed form; `None` for rounded shapes whose
    /// core is curved.
    #[must_use]
    pub fn mass(&self) -> Option<Mass> {
        if let Core::Polyhedron(body) = &self.core {
            return self.polyhedral_mass(body);
        }
        (self.round == 0.0).then(|| match_core!(&self.core, body => Mass::of(body), core => core.mass()))
    }

    fn polyhedral_mass(&self, body: &ConvexPolyhedron) -> Option<Mass> {
        match body.vertex_count() {
            _ if self.round == 0.0 => Some(Mass::of(body)),
            1 => Some(ball(body.centroid(), self.round)),
            2 => Some(self.capsule_mass(body)),
            _ => Some(rounded(body, self.round)),
        }
    }

    /// Returns the mass of a cylinder between two half balls.
    fn capsule_mass(&self, segment: &ConvexPolyhedron) -> Mass {
        let mut ends = segment.vertex_points();
        let along = match (ends.next(), ends.next()) {
            (Some(p), Some(q)) => q - p,
            _ => Vector3::zeros(),
        };
        let (r, length) = (self.round, along.norm());
        let (h, axis) = (length / 2.0, along / length);
        let (tube, caps) = (PI * r * r * length, 4.0 / 3.0 * PI * r * r * r);
        // Half balls: h + 3/8 r is the mean distance of their centres of mass from the middle.
        let lengthwise = tube * h * h / 3.0 + caps * (r * r / 5.0 + h * h + 0.75 * h * r);
        let crosswise = tube * r * r / 4.0 + caps * r * r / 5.0;
        let outer = axis * axis.transpose();
        let inertia = outer * (2.0 * crosswise) + (Matrix3::identity() - outer) * (crosswise + lengthwise);
        Mass {
            volume: tube + caps,
            centroid: segment.centroid(),
            inertia,
        }
    }
}

fn ball(centroid: Point3<f64>, r: f64) -> Mass {
    let volume = 4.0 / 3.0 * PI * r * r * r;
    Mass::symmetric(volume, centroid, Vector3::repeat(r * r / 5.0))
}
