//! Box, ball and kind of compounds, meshes, clouds and surfaces.

use nalgebra::{Isometry3, Point3, Vector3};

use crate::base::num::fingerprint::Fingerprint;
use crate::base::pose::rotation_matrix;
use crate::base::tolerance::BOX_TURNED;
use crate::body::polyhedron::BoxHint;
use crate::nonconvex::cloud::Cloud;
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::parts::Parted;
use crate::nonconvex::pieces::Compound;
use crate::nonconvex::separation::ball_about;
use crate::pair_tracker::geometry::{GeometryKind, OfKind};
#[cfg(feature = "surfaces")]
use crate::surface::BezierSurface;

impl OfKind for Compound {
    fn kind(&self) -> GeometryKind {
        GeometryKind::Compound
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
    fn kind(&self) -> GeometryKind {
        GeometryKind::Mesh
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

impl OfKind for Cloud {
    fn kind(&self) -> GeometryKind {
        GeometryKind::Cloud
    }

    fn fingerprint(&self) -> Fingerprint {
        Parted::fingerprint(self)
    }

    fn bounding_ball(&self) -> (Point3<f64>, f64) {
        self.bounding_ball()
    }

    fn aabb_at(&self, pose: &Isometry3<f64>, _: &mut BoxHint) -> (Point3<f64>, Point3<f64>) {
        turned_box(self.aabb(), pose)
    }
}

#[cfg(feature = "surfaces")]
impl OfKind for BezierSurface {
    fn kind(&self) -> GeometryKind {
        GeometryKind::BezierSurface
    }

    fn fingerprint(&self) -> Fingerprint {
        self.fingerprint
    }

    fn bounding_ball(&self) -> (Point3<f64>, f64) {
        self.bounding_ball()
    }

    fn aabb_at(&self, pose: &Isometry3<f64>, _: &mut BoxHint) -> (Point3<f64>, Point3<f64>) {
        turned_box(self.outer_box(), pose)
    }
}

/// Returns the axis-aligned box that contains a box at a pose.
fn turned_box((low, high): (Point3<f64>, Point3<f64>), pose: &Isometry3<f64>) -> (Point3<f64>, Point3<f64>) {
    let q = pose.rotation.coords;
    let matrix = rotation_matrix(&[q.x, q.y, q.z, q.w], 2.0 / q.norm_squared());
    let half = (high - low) * 0.5;
    let centre = low.coords + half;
    let t = pose.translation.vector;
    let far = centre.abs().sum() + half.sum();
    let half = matrix.abs() * half + (t.abs().add_scalar(far)) * BOX_TURNED;
    let centre: Vector3<f64> = matrix * centre + t;
    (Point3::from(centre - half), Point3::from(centre + half))
}
