//! The serialised form of a geometry (feature `serde`): the body, not shared.

use alloc::boxed::Box;
use alloc::sync::Arc;

use super::{Geometry, match_kind};
use crate::body::polyhedron::ConvexPolyhedron;
use crate::body::shape::Shape;
use crate::convex::contact::HalfSpace;
#[cfg(feature = "meshes")]
use crate::nonconvex::{cloud::Cloud, mesh::Mesh, pieces::Compound};
#[cfg(feature = "surfaces")]
use crate::surface::BezierSurface;

/// The serialised form of a geometry.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "Geometry")]
pub(super) enum StoredGeometry {
    Polyhedron(Box<ConvexPolyhedron>),
    Convex(Box<Shape>),
    #[cfg(feature = "meshes")]
    Compound(Box<Compound>),
    #[cfg(feature = "meshes")]
    Mesh(Box<Mesh>),
    #[cfg(feature = "surfaces")]
    BezierSurface(Box<BezierSurface>),
    HalfSpace(Box<HalfSpace>),
    #[cfg(feature = "meshes")]
    Cloud(Box<Cloud>),
}

impl From<StoredGeometry> for Geometry {
    fn from(stored: StoredGeometry) -> Self {
        match_kind!(StoredGeometry, stored, body => Self::from(*body))
    }
}

macro_rules! stored {
    ($($kind:ident: $body:ty),*) => {
        $(impl From<Arc<$body>> for StoredGeometry {
            fn from(body: Arc<$body>) -> Self {
                Self::$kind(Box::new(Arc::unwrap_or_clone(body)))
            }
        })*
    };
}

stored!(Polyhedron: ConvexPolyhedron, Convex: Shape);
#[cfg(feature = "meshes")]
stored!(Compound: Compound, Mesh: Mesh, Cloud: Cloud);
#[cfg(feature = "surfaces")]
stored!(BezierSurface: BezierSurface);
stored!(HalfSpace: HalfSpace);

impl From<Geometry> for StoredGeometry {
    fn from(shape: Geometry) -> Self {
        match_kind!(Geometry, shape, body => Self::from(body))
    }
}
