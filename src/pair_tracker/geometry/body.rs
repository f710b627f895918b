//! The kinds, and what a body of each kind answers.

#[cfg(feature = "meshes")]
use nalgebra::Vector3;
use nalgebra::{Isometry3, Point3};

use crate::base::num::fingerprint::Fingerprint;
#[cfg(feature = "meshes")]
use crate::base::pose::rotation_matrix;
#[cfg(feature = "meshes")]
use crate::base::tolerance::BOX_TURNED;
use crate::base::tolerance::EXTENT_MAX;
use crate::body::polyhedron::{BoxHint, ConvexPolyhedron};
use crate::body::shape::{Core, Shape};
use crate::convex::contact::HalfSpace;
#[cfg(feature = "meshes")]
use crate::nonconvex::{cloud::Cloud, mesh::Mesh, parts::Parted, pieces::Compound, separation::ball_about};
#[cfg(feature = "surfaces")]
use crate::surface::BezierSurface;

/// What a body of every kind answers. The trait is private: users add motions and robots, not
/// kinds.
pub(crate) trait Body {
    /// Returns the kind of the geometry.
    fn kind(&self) -> GeometryKind;

    /// Returns the hash by which cached state recognises the geometry: one hash for all positions
    /// of the vertices of a mesh.
    fn fingerprint(&self) -> Fingerprint;

    /// Returns a ball that contains the geometry, in its frame: centre and radius.
    fn bounding_ball(&self) -> (Point3<f64>, f64);

    /// Returns the axis-aligned box at a pose, rounded outward: minimum and maximum corner.
    fn aabb_at(&self, pose: &Isometry3<f64>, hint: &mut BoxHint) -> (Point3<f64>, Point3<f64>);
}

/// The kind of a geometry; convex kinds come first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum GeometryKind {
    /// A convex polyhedron or polygon.
    Polyhedron,
    /// A point or a segment: a polyhedron without faces.
    Wire,
    /// A rounded polyhedron: ball, capsule, rounded box or hull.
    Rounded,
    /// A shape with a curved [`Core`](crate::shape::Core), rounded or not.
    Curved,
    /// A union of convex pieces.
    Compound,
    /// A mesh of triangles.
    Mesh,
    /// One convex element at many points.
    Cloud,
    /// A surface of Bézier patches.
    BezierSurface,
    /// A half-space.
    HalfSpace,
}

impl core::fmt::Display for GeometryKind {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Self::Polyhedron => "polyhedron",
            Self::Wire => "point or segment",
            Self::Rounded => "rounded polyhedron",
            Self::Curved => "curved shape",
            Self::Compound => "compound",
            Self::Mesh => "mesh",
            Self::Cloud => "cloud",
            Self::BezierSurface => "Bézier surface",
            Self::HalfSpace => "half-space",
        })
    }
}

impl GeometryKind {
    pub(crate) fn is_convex(self) -> bool {
        self < Self::Compound
    }
}

impl Body for ConvexPolyhedron {
    fn kind(&self) -> GeometryKind {
        if self.face_count() == 0 {
            GeometryKind::Wire
        } else {
            GeometryKind::Polyhedron
        }
    }

    #[inline]
    fn fingerprint(&self) -> Fingerprint {
        self.fingerprint
    }

    fn bounding_ball(&self) -> (Point3<f64>, f64) {
        self.bounding_ball()
    }

    #[inline]
    fn aabb_at(&self, pose: &Isometry3<f64>, hint: &mut BoxHint) -> (Point3<f64>, Point3<f64>) {
        self.aabb_at(pose, hint)
    }
}

impl Body for HalfSpace {
    fn kind(&self) -> GeometryKind {
        GeometryKind::HalfSpace
    }

    fn fingerprint(&self) -> Fingerprint {
        self.fingerprint()
    }

    fn bounding_ball(&self) -> (Point3<f64>, f64) {
        (self.foot(), EXTENT_MAX)
    }

    fn aabb_at(&self, pose: &Isometry3<f64>, _: &mut BoxHint) -> (Point3<f64>, Point3<f64>) {
        self.aabb_at(pose)
    }
}

impl Body for Shape {
    fn kind(&self) -> GeometryKind {
        match self.core() {
            Core::Polyhedron(body) if self.rounding_radius() == 0.0 => body.kind(),
            Core::Polyhedron(_) => GeometryKind::Rounded,
            _ => GeometryKind::Curved,
        }
    }

    #[inline]
    fn fingerprint(&self) -> Fingerprint {
        self.fingerprint()
    }

    fn bounding_ball(&self) -> (Point3<f64>, f64) {
        self.bounding_ball()
    }

    #[inline]
    fn aabb_at(&self, pose: &Isometry3<f64>, hint: &mut BoxHint) -> (Point3<f64>, Point3<f64>) {
        self.aabb_at(pose, hint)
    }
}

#[cfg(feature = "meshes")]
impl Body for Compound {
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

#[cfg(feature = "meshes")]
impl Body for Mesh {
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

#[cfg(feature = "meshes")]
impl Body for Cloud {
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
impl Body for BezierSurface {
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
#[cfg(feature = "meshes")]
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
