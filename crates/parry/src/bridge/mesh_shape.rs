//! Implements parry's traits for [`MeshShape`].

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::{BoxHint, Mesh};

use super::mesh::MeshShape;
use super::number::{down, isometry, up, wide};
use super::parry::bounding_volume::{Aabb, BoundingSphere};
use super::parry::mass_properties::MassProperties;
use super::parry::math::{Pose, Real, Vector};
use super::parry::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
use super::parry::shape::{FeatureId, Shape, ShapeType, TypedShape};
use super::ray_point::{cast_ray, project};

/// A ray that starts inside a solid hits at its start, filled or hollow.
impl RayCast for MeshShape {
    fn cast_local_ray_and_get_normal(&self, ray: &Ray, max: Real, _: bool) -> Option<RayIntersection> {
        cast_ray(&self.geometry, ray, max)
    }
}

/// A point inside a solid is its own projection.
impl PointQuery for MeshShape {
    fn project_local_point(&self, pt: Vector, _: bool) -> PointProjection {
        project(&self.geometry, pt, true)
    }

    fn project_local_point_and_get_feature(&self, pt: Vector) -> (PointProjection, FeatureId) {
        (project(&self.geometry, pt, true), FeatureId::Unknown)
    }
}

impl MeshShape {
    fn scaled(&self, scale: Vector3<f64>) -> Option<Self> {
        let corners = self.mesh.triangles().flat_map(|(_, t)| t);
        let points: Vec<Point3<f64>> = corners.map(|p| p.coords.component_mul(&scale).into()).collect();
        // A mirror inverts triangles.
        let order = if scale.product() < 0.0 { [0, 2, 1] } else { [0, 1, 2] };
        let triangles: Vec<_> = (0..points.len() as u32 / 3).map(|k| order.map(|c| 3 * k + c)).collect();
        Mesh::new(&points, &triangles).ok().map(Self::new)
    }
}

impl Shape for MeshShape {
    fn compute_local_aabb(&self) -> Aabb {
        let (low, high) = self.mesh.aabb();
        outward(low, high)
    }

    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        self.compute_local_aabb().bounding_sphere()
    }

    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }

    fn scale_dyn(&self, scale: Vector, _: u32) -> Option<Box<dyn Shape>> {
        Some(Box::new(self.scaled(wide(scale))?))
    }

    fn compute_aabb(&self, pose: &Pose) -> Aabb {
        let (low, high) = self.geometry.aabb_at(&isometry(pose), &mut BoxHint::default());
        outward(low, high)
    }

    /// Returns zero mass for an open mesh.
    fn mass_properties(&self, density: Real) -> MassProperties {
        self.mass.at(density)
    }

    fn is_convex(&self) -> bool {
        false
    }

    fn shape_type(&self) -> ShapeType {
        ShapeType::Custom
    }

    fn as_typed_shape(&self) -> TypedShape<'_> {
        TypedShape::Custom(self)
    }

    fn ccd_thickness(&self) -> Real {
        self.compute_local_aabb().half_extents().min_element()
    }

    fn ccd_angular_thickness(&self) -> Real {
        std::f64::consts::FRAC_PI_4 as Real
    }
}

fn outward(low: Point3<f64>, high: Point3<f64>) -> Aabb {
    let (low, high): ([f64; 3], [f64; 3]) = (low.into(), high.into());
    Aabb::new(Vector::from(low.map(down)), Vector::from(high.map(up)))
}
