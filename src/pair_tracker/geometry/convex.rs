//! Convex geometries: polyhedra and shapes.

use alloc::sync::Arc;

use nalgebra::{Isometry3, Point3};

use super::{Geometry, OfKind, ShapeKind};
use crate::base::num::fingerprint::Fingerprint;
use crate::body::polyhedron::{BoxHint, ConvexPolyhedron};
use crate::body::shape::{Core, Shape};

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

impl From<ConvexPolyhedron> for Geometry {
    fn from(body: ConvexPolyhedron) -> Self {
        Self::from(Arc::new(body))
    }
}

impl From<Arc<ConvexPolyhedron>> for Geometry {
    fn from(body: Arc<ConvexPolyhedron>) -> Self {
        Self::Polyhedron(body)
    }
}

impl From<Shape> for Geometry {
    /// A shape that is a polyhedron and not rounded becomes a polyhedron.
    fn from(shape: Shape) -> Self {
        Self::from(Arc::new(shape))
    }
}

impl From<Arc<Shape>> for Geometry {
    fn from(shape: Arc<Shape>) -> Self {
        match shape.core() {
            Core::Polyhedron(body) if shape.round() == 0.0 => Self::Polyhedron(body.clone()),
            _ => Self::Convex(shape),
        }
    }
}
