//! Geometries of curved patches: surfaces.

use alloc::sync::Arc;

use nalgebra::{Isometry3, Point3};

use super::kind::turned_box;
use super::{Geometry, OfKind, ShapeKind};
use crate::base::num::fingerprint::Fingerprint;
use crate::body::polyhedron::BoxHint;
use crate::patch::Surface;

impl OfKind for Surface {
    fn kind(&self) -> ShapeKind {
        ShapeKind::Surface
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

impl From<Surface> for Geometry {
    fn from(surface: Surface) -> Self {
        Self::from(Arc::new(surface))
    }
}

impl From<Arc<Surface>> for Geometry {
    fn from(surface: Arc<Surface>) -> Self {
        Self::Surface(surface)
    }
}
