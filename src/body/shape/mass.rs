//! Volume, centre of mass and inertia.

use core::f64::consts::PI;

use nalgebra::{Matrix3, Point3, Vector3};

use super::{Core, Shape, Superquadric};

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
    /// Returns the mass of a body symmetric about three planes through `centroid`, from the volume
    /// and the mean squares of coordinates.
    fn symmetric(volume: f64, centroid: Point3<f64>, mean: Vector3<f64>) -> Self {
        let sums = Vector3::new(mean.y + mean.z, mean.z + mean.x, mean.x + mean.y);
        Self {
            volume,
            centroid,
            inertia: Matrix3::from_diagonal(&(sums * volume)),
        }
    }
}

impl Shape {
    /// Returns the mass properties at unit density, in closed form; `None` for rounded shapes other
    /// than balls and capsules.
    #[must_use]
    pub fn mass(&self) -> Option<Mass> {
        let origin = Point3::origin();
        match &self.core {
            Core::Polyhedron(body) if self.round == 0.0 => Some(Mass {
                volume: body.volume(),
                centroid: body.centroid(),
                inertia: body.inertia(),
            }),
            Core::Polyhedron(body) => match body.vertex_count() {
                1 => Some(ball(body.centroid(), self.round)),
                2 => Some(self.capsule_mass(body)),
                _ => None,
            },
            _ if self.round > 0.0 => None,
            Core::Ellipsoid(core) => {
                let a = core.semi_axes();
                let volume = 4.0 / 3.0 * PI * a.x * a.y * a.z;
                Some(Mass::symmetric(volume, origin, a.component_mul(&a) / 5.0))
            }
            Core::Cylinder(core) => {
                let (r, h) = (core.radius(), core.half_height());
                let mean = Vector3::new(r * r / 4.0, r * r / 4.0, h * h / 3.0);
                Some(Mass::symmetric(PI * r * r * 2.0 * h, origin, mean))
            }
            Core::Cone(core) => {
                let (r, h) = (core.radius(), core.half_height());
                // Mean squares about the centroid, a quarter of the height over the base.
                let mean = Vector3::new(r * r * 3.0 / 20.0, r * r * 3.0 / 20.0, h * h * 3.0 / 20.0);
                let centroid = Point3::new(0.0, 0.0, -h / 2.0);
                Some(Mass::symmetric(PI * r * r * 2.0 * h / 3.0, centroid, mean))
            }
            Core::Superquadric(core) => Some(superquadric(core)),
        }
    }

    /// Returns the mass of a cylinder between two half balls.
    fn capsule_mass(&self, segment: &crate::body::polyhedron::ConvexPolyhedron) -> Mass {
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

/// Returns the mass of a superquadric by beta functions (Jaklic, Leonardis and Solina 2000,
/// "Segmentation and recovery of superquadrics", section 2.3).
fn superquadric(core: &Superquadric) -> Mass {
    let ([e1, e2], a) = (core.exponents(), core.semi_axes());
    let beta = |x: f64, y: f64| libm::tgamma(x) * libm::tgamma(y) / libm::tgamma(x + y);
    let volume = 2.0 * a.x * a.y * a.z * e1 * e2 * beta(e1 / 2.0 + 1.0, e1) * beta(e2 / 2.0, e2 / 2.0);
    let crosswise = 0.5 * a.x * a.y * a.z * e1 * e2 * beta(1.5 * e2, 0.5 * e2) * beta(0.5 * e1, 2.0 * e1 + 1.0);
    let lengthwise = 2.0 * a.x * a.y * a.z * e1 * e2 * beta(0.5 * e2, 0.5 * e2 + 1.0) * beta(1.5 * e1, e1 + 1.0);
    let mean = Vector3::new(crosswise, crosswise, lengthwise).component_mul(&a.component_mul(&a)) / volume;
    Mass::symmetric(volume, Point3::origin(), mean)
}

fn ball(centroid: Point3<f64>, r: f64) -> Mass {
    let volume = 4.0 / 3.0 * PI * r * r * r;
    Mass::symmetric(volume, centroid, Vector3::repeat(r * r / 5.0))
}
