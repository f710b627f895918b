//! The convex hulls of meshes, which answer before the meshes.
//!
//! A hull contains its mesh exactly, because it is made by exact decisions.

use core::fmt;
use std::sync::{Arc, OnceLock};

use lin_canny::Geometry;

/// The hull of a mesh. It is made when a query needs it, and all copies share it.
#[derive(Clone, Default)]
pub(crate) struct MeshHull(Arc<OnceLock<Option<Geometry>>>);

/// Cells with equal bodies have equal texts, whichever queries made hulls.
impl fmt::Debug for MeshHull {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("MeshHull")
    }
}

impl MeshHull {
    /// Returns the hull of a mesh; `None` if the mesh is flat.
    pub(crate) fn of(&self, geometry: &Geometry) -> Option<&Geometry> {
        let hull = || match geometry {
            Geometry::Mesh(mesh) => mesh.hull().ok().map(Geometry::from),
            _ => None,
        };
        self.0.get_or_init(hull).as_ref()
    }
}
