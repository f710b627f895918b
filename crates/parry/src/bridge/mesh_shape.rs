//! Meshes of [`lin_canny`] as shapes of parry.

use std::sync::Arc;

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::{BoxHint, ConvexPatches, Geometry, Mesh, MeshError};

use super::mass::UnitMass;
use super::number::{down, isometry, up, wide, wide_point};
use super::parry::bounding_volume::{Aabb, BoundingSphere};
use super::parry::mass_properties::MassProperties;
use super::parry::math::{Pose, Real, Vector};
use super::parry::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
use super::parry::shape::{FeatureId, Shape, ShapeType, SharedShape, TriMesh, TypedShape};
use super::ray_point::{cast_ray, project};

/// A mesh as a shape for parry: a floor, a terrain, a tool or another body.
///
/// A closed mesh is solid. All queries with convex shapes of parry, [`Hull`](super::Hull)s and
/// other meshes use [`lin_canny`], in `f64` and without an absolute tolerance. Contacts belong to
/// the convex patches of the mesh, from outside only, so an edge between two triangles of a flat
/// floor has no contact. The shape is cheap to clone, because clones share all data.
///
/// ```
/// use lin_canny_parry::single::{CertifiedDispatcher, Hull, MeshShape, parry};
/// use parry::math::{Pose, Vector};
/// use parry::query::{ContactManifold, PersistentQueryDispatcher};
/// use parry::shape::Cuboid;
///
/// // A floor of two triangles, and a die of a millimetre on the edge between them.
/// let corners = [[0., 0., 0.], [1., 0., 0.], [1., 0., 1.], [0., 0., 1.]].map(Vector::from);
/// let floor = MeshShape::from_triangles(&corners, &[[0, 2, 1], [0, 3, 2]])?;
/// let die = Cuboid::new(Vector::splat(5e-4));
/// let at = Pose::translation(0.5, 5.1e-4, 0.5);
/// let mut found: Vec<ContactManifold<(), ()>> = Vec::new();
/// let dispatcher = CertifiedDispatcher::default();
/// dispatcher.contact_manifolds(&at, &floor, &die, 1e-4, &mut found, &mut None).unwrap();
/// assert_eq!((found.len(), found[0].points.len()), (1, 4));
/// assert!((found[0].points[0].dist - 1e-5).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct MeshShape {
    mesh: Arc<Mesh>,
    pub(super) geometry: Geometry,
    pub(super) patches: ConvexPatches,
    mass: UnitMass,
}

impl MeshShape {
    /// Returns the shape of a mesh, which may be shared with other users.
    ///
    /// Divides the mesh into convex patches, which takes microseconds per triangle.
    pub fn new(mesh: impl Into<Arc<Mesh>>) -> Self {
        Self::within(mesh, 0.0)
    }

    /// Returns the shape of a mesh whose patches are convex within a tolerance, in its unit.
    ///
    /// For flat floors that are stored in single precision, use about 1e-6 of their size.
    pub fn within(mesh: impl Into<Arc<Mesh>>, tolerance: f64) -> Self {
        let mesh: Arc<Mesh> = mesh.into();
        Self {
            geometry: Geometry::from(mesh.clone()),
            patches: ConvexPatches::from_mesh_within(mesh.clone(), tolerance),
            mass: UnitMass::new(mesh.volume().max(0.0), &mesh.centroid(), &mesh.inertia()),
            mesh,
        }
    }

    /// Returns the shape of triangles, counter-clockwise seen from outside.
    ///
    /// # Errors
    /// Returns an error if the triangles cannot form a [`Mesh`]. The error names the index.
    pub fn from_triangles(points: &[Vector], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        let points: Vec<Point3<f64>> = points.iter().map(|&p| wide_point(p)).collect();
        Ok(Self::new(Mesh::new(&points, triangles)?))
    }

    /// Returns the mesh.
    #[must_use]
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }
}

impl From<Mesh> for MeshShape {
    fn from(mesh: Mesh) -> Self {
        Self::new(mesh)
    }
}

/// Converts the triangles of a mesh of parry.
///
/// The flags of the mesh are ignored. The triangles decide which side is outside and whether the
/// mesh is closed.
impl TryFrom<&TriMesh> for MeshShape {
    type Error = MeshError;

    fn try_from(mesh: &TriMesh) -> Result<Self, MeshError> {
        Self::from_triangles(mesh.vertices(), mesh.indices())
    }
}

impl From<MeshShape> for SharedShape {
    fn from(mesh: MeshShape) -> Self {
        SharedShape(Arc::new(mesh))
    }
}

/// Returns the mesh if a shape is a `MeshShape`.
pub(super) fn mesh(shape: &dyn Shape) -> Option<&MeshShape> {
    shape.as_shape::<MeshShape>()
}

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
