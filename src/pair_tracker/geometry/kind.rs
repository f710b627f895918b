//! The kinds of geometries, and the methods that a body of every kind has.

use nalgebra::{Isometry3, Point3};

use crate::base::num::fingerprint::Fingerprint;
use crate::body::polyhedron::{BoxHint, ConvexPolyhedron};
use crate::body::shape::{Core, Shape};

/// A body of one kind.
pub(super) trait OfKind {
    /// Returns the kind of the geometry.
    fn kind(&self) -> ShapeKind;

    /// Returns the hash by which kept state recognises the geometry: one for all places of the
    /// vertices of a mesh.
    fn fingerprint(&self) -> Fingerprint;

    /// Returns a ball that contains the geometry, in its frame: centre and radius.
    fn bounding_ball(&self) -> (Point3<f64>, f64);

    /// Returns the axis-aligned box at a pose, rounded outward: least and greatest corner.
    fn aabb_at(&self, pose: &Isometry3<f64>, hint: &mut BoxHint) -> (Point3<f64>, Point3<f64>);
}

/// The kind of a geometry; convex kinds come first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum ShapeKind {
    /// A convex polyhedron or polygon.
    Polyhedron,
    /// A point or a segment: a polyhedron without faces.
    Wire,
    /// A rounded polyhedron: ball, capsule, rounded box or hull.
    Rounded,
    /// A cylinder, cone, ellipsoid or superquadric, rounded or not.
    Curved,
    /// A union of convex pieces.
    Composite,
    /// A mesh of triangles.
    Mesh,
    /// A surface of curved patches.
    Surface,
}

impl core::fmt::Display for ShapeKind {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Self::Polyhedron => "polyhedron",
            Self::Wire => "point or segment",
            Self::Rounded => "rounded polyhedron",
            Self::Curved => "curved shape",
            Self::Composite => "composite",
            Self::Mesh => "mesh",
            Self::Surface => "surface of patches",
        })
    }
}

impl ShapeKind {
    pub(crate) fn is_convex(self) -> bool {
        self < Self::Composite
    }
}

impl OfKind for ConvexPolyhedron {
    fn kind(&self) -> ShapeKind {
        if self.face_count() == 0 {
            ShapeKind::Wire
        } else {
            ShapeKind::Polyhedron
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

impl OfKind for Shape {
    fn kind(&self) -> ShapeKind {
        match self.core() {
            Core::Polyhedron(body) if self.round() == 0.0 => body.kind(),
            Core::Polyhedron(_) => ShapeKind::Rounded,
            _ => ShapeKind::Curved,
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
