//! Geometries of parts under a tree: composites and meshes.

use alloc::sync::Arc;

use nalgebra::{Isometry3, Point3};

use super::kind::turned_box;
use super::{Geometry, OfKind, ShapeKind};
use crate::base::num::fingerprint::Fingerprint;
use crate::body::polyhedron::BoxHint;
use crate::composite::mesh::Mesh;
use crate::composite::pieces::Composite;
use crate::composite::separation::ball_about;

impl OfKind for Composite {
    fn kind(&self) -> ShapeKind {
        ShapeKind::Composite
    }

    fn fingerprint(&self) -> Fingerprint {
        self.recognised()
    }

    fn bounding_ball(&self) -> (Point3<f64>, f64) {
        ball_about(self.aabb())
    }

    fn aabb_at(&self, pose: &Isometry3<f64>, _: &mut BoxHint) -> (Point3<f64>, Point3<f64>) {
        turned_box(self.aabb(), pose)
    }
}

impl OfKind for Mesh {
    fn kind(&self) -> ShapeKind {
        ShapeKind::Mesh
    }

    fn fingerprint(&self) -> Fingerprint {
        self.lineage()
    }

    fn bounding_ball(&self) -> (Point3<f64>, f64) {
        ball_about(self.aabb())
    }

    fn aabb_at(&self, pose: &Isometry3<f64>, _: &mut BoxHint) -> (Point3<f64>, Point3<f64>) {
        turned_box(self.aabb(), pose)
    }
}

impl From<Composite> for Geometry {
    fn from(composite: Composite) -> Self {
        Self::from(Arc::new(composite))
    }
}

impl From<Arc<Composite>> for Geometry {
    fn from(composite: Arc<Composite>) -> Self {
        Self::Composite(composite)
    }
}

impl From<Mesh> for Geometry {
    fn from(mesh: Mesh) -> Self {
        Self::from(Arc::new(mesh))
    }
}

impl From<Arc<Mesh>> for Geometry {
    fn from(mesh: Arc<Mesh>) -> Self {
        Self::Mesh(mesh)
    }
}
