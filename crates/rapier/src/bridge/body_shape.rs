//! Shapes of bodies.

use std::sync::Arc;

use lin_canny::Geometry;
use lin_canny::nalgebra::{Isometry3, Matrix3, Point3, Vector3};

use super::engine::{self, Hull, MeshShape};
use super::rapier::geometry::{Shape, SharedShape};
use super::rapier::math::Real;
use crate::free::Solid;

/// The shape of a body: a [`Hull`], a [`MeshShape`], or any shape of parry. Cheap to clone.
#[derive(Clone)]
pub struct BodyShape(SharedShape);

impl BodyShape {
    /// Returns the shape as a shape of rapier.
    #[must_use]
    pub fn shared(&self) -> &SharedShape {
        &self.0
    }

    /// Returns the inverse of the mass at a density; `None` for a shape without a volume.
    pub(super) fn inverse_mass(&self, density: f64) -> Option<Real> {
        let is_solid = match self.0.as_shape::<Hull>() {
            Some(hull) => hull.body().volume() > 0.0,
            None => self.0.mass_properties(1.0).inv_mass > 0.0,
        };
        is_solid.then(|| self.0.mass_properties(density as Real).inv_mass)
    }

    /// Returns the shape for the engine without response; `None` if [`lin_canny`] has no
    /// equivalent.
    pub(super) fn solid(&self) -> Option<Solid> {
        if let Some(hull) = self.0.as_shape::<Hull>() {
            let body = hull.body();
            let (at, geometry) = (Isometry3::identity(), Geometry::from(body.clone()));
            let (centroid, inertia) = (body.centroid(), body.inertia());
            return Some(Solid {
                geometry,
                at,
                centroid,
                inertia,
            });
        }
        let (geometry, at) = engine::geometry(&*self.0)?;
        let mass = self.0.mass_properties(1.0);
        let wide = |v: [Real; 3]| Vector3::from(v.map(f64::from));
        let inverse = wide(mass.inv_principal_inertia.to_array());
        let principal = inverse.map(|x| if x > 0.0 { 1.0 / x } else { 0.0 });
        let frame = engine::isometry(&super::rapier::math::Pose::from_parts(
            super::rapier::math::Vector::ZERO,
            mass.principal_inertia_local_frame,
        ));
        let turn = frame.rotation.to_rotation_matrix();
        Some(Solid {
            geometry,
            at,
            centroid: Point3::from(wide(mass.local_com.to_array())),
            inertia: turn * Matrix3::from_diagonal(&principal) * turn.inverse(),
        })
    }
}

impl std::fmt::Debug for BodyShape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("BodyShape").field(&self.0.shape_type()).finish()
    }
}

impl From<SharedShape> for BodyShape {
    fn from(shape: SharedShape) -> Self {
        Self(shape)
    }
}

impl From<&SharedShape> for BodyShape {
    fn from(shape: &SharedShape) -> Self {
        Self(shape.clone())
    }
}

impl From<Hull> for BodyShape {
    fn from(hull: Hull) -> Self {
        Self(hull.into())
    }
}

impl From<&Hull> for BodyShape {
    fn from(hull: &Hull) -> Self {
        hull.clone().into()
    }
}

impl From<MeshShape> for BodyShape {
    fn from(mesh: MeshShape) -> Self {
        Self(mesh.into())
    }
}

impl From<&MeshShape> for BodyShape {
    fn from(mesh: &MeshShape) -> Self {
        mesh.clone().into()
    }
}

impl From<Arc<dyn Shape>> for BodyShape {
    fn from(shape: Arc<dyn Shape>) -> Self {
        Self(SharedShape(shape))
    }
}
