//! A geometry that is lent to a query.

use alloc::sync::Arc;

use nalgebra::Point3;

use super::{Geometry, ShapeKind};
use crate::base::num::fingerprint::Fingerprint;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::body::shape::{Core, Shape};
use crate::composite::mesh::Mesh;
use crate::composite::pieces::Composite;
use crate::composite::separation::ball_about;
use crate::patch::Surface;

/// A geometry of any kind, lent to a query: what a query of two geometries takes.
///
/// References to a [`Geometry`] and to a body of each kind become one, so that a body need not be
/// shared to be asked. A [`Shape`] that is a polyhedron and not rounded is a polyhedron.
#[derive(Clone, Copy, Debug)]
pub struct GeometryRef<'a>(pub(crate) Lent<'a>);

/// The kinds of geometries.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Lent<'a> {
    Polyhedron(LentBody<'a, ConvexPolyhedron>),
    Convex(LentBody<'a, Shape>),
    Composite(LentBody<'a, Composite>),
    Mesh(LentBody<'a, Mesh>),
    Surface(LentBody<'a, Surface>),
}

/// A body that is lent, and its owner if the body is shared.
#[derive(Debug)]
pub(crate) struct LentBody<'a, T> {
    body: &'a T,
    owner: Option<&'a Arc<T>>,
}

impl<T> Clone for LentBody<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for LentBody<'_, T> {}

impl<'a, T> LentBody<'a, T> {
    /// Returns the body for as long as it is lent.
    #[inline]
    pub(crate) fn get(self) -> &'a T {
        self.body
    }

    /// Returns the body to keep: shared if it was shared, else a copy.
    pub(crate) fn to_arc(self) -> Arc<T>
    where
        T: Clone,
    {
        self.owner.map_or_else(|| Arc::new(self.body.clone()), Arc::clone)
    }
}

impl<'a, T> From<&'a T> for LentBody<'a, T> {
    #[inline]
    fn from(body: &'a T) -> Self {
        Self { body, owner: None }
    }
}

impl<'a, T> LentBody<'a, T> {
    #[inline]
    fn shared(owner: &'a Arc<T>) -> Self {
        Self {
            body: owner,
            owner: Some(owner),
        }
    }
}

impl<'a> GeometryRef<'a> {
    /// Returns the polyhedron of a geometry that is a polyhedron.
    #[inline]
    pub(crate) fn polyhedron(self) -> Option<&'a ConvexPolyhedron> {
        match self.0 {
            Lent::Polyhedron(body) => Some(body.get()),
            _ => None,
        }
    }

    /// Returns the shape of a geometry that is rounded or curved.
    #[inline]
    pub(crate) fn shape(self) -> Option<&'a Shape> {
        match self.0 {
            Lent::Convex(shape) => Some(shape.get()),
            _ => None,
        }
    }

    /// Returns the composite of a geometry that is a composite.
    pub(crate) fn composite(self) -> Option<&'a Composite> {
        match self.0 {
            Lent::Composite(body) => Some(body.get()),
            _ => None,
        }
    }

    /// Returns the mesh of a geometry that is a mesh.
    pub(crate) fn mesh(self) -> Option<&'a Mesh> {
        match self.0 {
            Lent::Mesh(mesh) => Some(mesh.get()),
            _ => None,
        }
    }

    /// Returns the surface of a geometry that is a surface of patches.
    pub(crate) fn surface(self) -> Option<&'a Surface> {
        match self.0 {
            Lent::Surface(surface) => Some(surface.get()),
            _ => None,
        }
    }

    /// Returns a polyhedron as a shape to keep; `None` for all other kinds.
    pub(crate) fn polyhedron_as_shape(self) -> Option<Arc<Shape>> {
        match self.0 {
            Lent::Polyhedron(body) => Some(Arc::new(Shape::from(body.to_arc()))),
            _ => None,
        }
    }

    /// Returns a convex geometry as a shape to keep; `None` for a composite, mesh or surface.
    pub(crate) fn to_shape(self) -> Option<Arc<Shape>> {
        match self.0 {
            Lent::Convex(shape) => Some(shape.to_arc()),
            _ => self.polyhedron_as_shape(),
        }
    }

    /// Returns the hash by which kept state recognises the geometry.
    #[inline]
    pub(crate) fn fingerprint(self) -> Fingerprint {
        match self.0 {
            Lent::Polyhedron(body) => body.get().fingerprint,
            Lent::Convex(shape) => shape.get().fingerprint(),
            Lent::Composite(body) => body.get().recognised(),
            Lent::Mesh(mesh) => mesh.get().fingerprint,
            Lent::Surface(surface) => surface.get().fingerprint,
        }
    }

    /// Returns the kind of the geometry.
    #[must_use]
    pub fn kind(self) -> ShapeKind {
        let polyhedral = |body: &ConvexPolyhedron| {
            if body.face_count() == 0 {
                ShapeKind::Wire
            } else {
                ShapeKind::Polyhedron
            }
        };
        match self.0 {
            Lent::Polyhedron(body) => polyhedral(body.get()),
            Lent::Convex(shape) => match shape.get().core() {
                Core::Polyhedron(body) if shape.get().round() == 0.0 => polyhedral(body),
                Core::Polyhedron(_) => ShapeKind::Rounded,
                _ => ShapeKind::Curved,
            },
            Lent::Composite(_) => ShapeKind::Composite,
            Lent::Mesh(_) => ShapeKind::Mesh,
            Lent::Surface(_) => ShapeKind::Surface,
        }
    }

    /// Returns a ball that contains the geometry, in its frame: centre and radius.
    #[must_use]
    pub fn bounding_ball(self) -> (Point3<f64>, f64) {
        match self.0 {
            Lent::Polyhedron(body) => body.get().bounding_ball(),
            Lent::Convex(shape) => shape.get().bounding_ball(),
            Lent::Composite(body) => ball_about(body.get().aabb()),
            Lent::Mesh(mesh) => ball_about(mesh.get().aabb()),
            Lent::Surface(surface) => surface.get().bounding_ball(),
        }
    }
}

impl<'a> From<&'a Geometry> for GeometryRef<'a> {
    #[inline]
    fn from(geometry: &'a Geometry) -> Self {
        Self(match geometry {
            Geometry::Polyhedron(body) => Lent::Polyhedron(LentBody::shared(body)),
            Geometry::Convex(shape) => Lent::Convex(LentBody::shared(shape)),
            Geometry::Composite(body) => Lent::Composite(LentBody::shared(body)),
            Geometry::Mesh(mesh) => Lent::Mesh(LentBody::shared(mesh)),
            Geometry::Surface(surface) => Lent::Surface(LentBody::shared(surface)),
        })
    }
}

impl<'a> From<&GeometryRef<'a>> for GeometryRef<'a> {
    #[inline]
    fn from(geometry: &GeometryRef<'a>) -> Self {
        *geometry
    }
}

impl<'a> From<&'a Shape> for GeometryRef<'a> {
    #[inline]
    fn from(shape: &'a Shape) -> Self {
        Self(match shape.core() {
            Core::Polyhedron(body) if shape.round() == 0.0 => Lent::Polyhedron(LentBody::shared(body)),
            _ => Lent::Convex(LentBody::from(shape)),
        })
    }
}

macro_rules! lend {
    ($kind:ident, $body:ty) => {
        impl<'a> From<&'a $body> for GeometryRef<'a> {
            #[inline]
            fn from(body: &'a $body) -> Self {
                Self(Lent::$kind(LentBody::from(body)))
            }
        }

        impl<'a> From<&'a Arc<$body>> for GeometryRef<'a> {
            #[inline]
            fn from(body: &'a Arc<$body>) -> Self {
                Self(Lent::$kind(LentBody::shared(body)))
            }
        }
    };
}

lend!(Polyhedron, ConvexPolyhedron);
lend!(Composite, Composite);
lend!(Mesh, Mesh);
lend!(Surface, Surface);
