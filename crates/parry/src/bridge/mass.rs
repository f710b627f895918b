//! Mass properties without an absolute tolerance.

use lin_canny::Shape;
use lin_canny::nalgebra::{Matrix3, Point3, Rotation3, SymmetricEigen, UnitQuaternion, Vector3};

use super::number::narrow;
use super::parry::mass_properties::MassProperties;
use super::parry::math::{Real, Rotation, Vector};

/// Mass properties at density 1.
#[derive(Clone, Copy)]
pub(super) struct UnitMass {
    mass: f64,
    center: Vector,
    principal: Vector3<f64>,
    frame: Rotation,
}

impl UnitMass {
    /// Returns the mass of a shape; zero if the mass is unknown.
    pub(super) fn of(shape: &Shape) -> Self {
        match shape.mass() {
            Some(mass) => Self::new(mass.volume, &mass.centroid, &mass.inertia),
            None => Self::new(0.0, &Point3::origin(), &Matrix3::zeros()),
        }
    }

    /// Returns the mass of a body from its volume, centroid, and inertia about the centroid.
    pub(super) fn new(volume: f64, centroid: &Point3<f64>, inertia: &Matrix3<f64>) -> Self {
        let size = inertia.amax();
        let (principal, frame) = if size > 0.0 && size.is_finite() {
            principal_axes(&(inertia / size))
        } else {
            (Vector3::zeros(), UnitQuaternion::identity())
        };
        let [i, j, k, w] = frame.coords.data.0[0].map(|x| x as Real);
        Self {
            mass: volume,
            center: narrow(&centroid.coords),
            principal: principal * size,
            frame: Rotation::from_xyzw(i, j, k, w).normalize(),
        }
    }

    /// Returns the mass properties at a density.
    pub(super) fn at(&self, density: Real) -> MassProperties {
        let density = f64::from(density);
        // The constructors of parry treat an inertia below 1e-20 as zero.
        let inverse = |x: f64| {
            let y = (1.0 / x) as Real;
            if x > 0.0 && y.is_finite() { y } else { 0.0 }
        };
        let inertia = self.principal * density;
        MassProperties {
            local_com: self.center,
            inv_mass: inverse(self.mass * density),
            inv_principal_inertia: Vector::new(inverse(inertia.x), inverse(inertia.y), inverse(inertia.z)),
            principal_inertia_local_frame: self.frame,
        }
    }
}

/// Returns the eigenvalues, none negative, and the rotation to their axes.
fn principal_axes(inertia: &Matrix3<f64>) -> (Vector3<f64>, UnitQuaternion<f64>) {
    let eigen = SymmetricEigen::new(*inertia);
    let mut axes = eigen.eigenvectors;
    if axes.determinant() < 0.0 {
        let flipped = -axes.column(2);
        axes.set_column(2, &flipped);
    }
    let frame = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
    (eigen.eigenvalues.map(|x| x.max(0.0)), frame)
}
