//! A geometry that a query borrows.

use alloc::sync::Arc;

use nalgebra::{Isometry3, Point3};

use super::{Geometry, GeometryKind, OfKind, match_kind};
use crate::base::num::fingerprint::Fingerprint;
use crate::base::pose::Operand;
use crate::body::polyhedron::{BoxHint, ConvexPolyhedron};
use crate::body::shape::{Core, Shape};
use crate::convex::contact::HalfSpace;
use crate::half_space::{Above, HalfSpacePair};
#[cfg(feature = "meshes")]
use crate::nonconvex::{cloud::Cloud, mesh::Mesh, parts::PartsRef, pieces::Compound};
#[cfg(feature = "surfaces")]
use crate::surface::BezierSurface;

/// A borrowed geometry of any kind: what a query of two geometries takes.
///
/// References to a [`Geometry`] and to a body of each kind convert to this type, so a body need not
/// be shared to be queried. A [`Shape`] that is a polyhedron and not rounded becomes a polyhedron.
#[derive(Clone, Copy, Debug)]
pub struct GeometryRef<'a>(pub(crate) Lent<'a>);

/// The kinds of geometries.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Lent<'a> {
    Polyhedron(LentBody<'a, ConvexPolyhedron>),
    Convex(LentBody<'a, Shape>),
    #[cfg(feature = "meshes")]
    Compound(LentBody<'a, Compound>),
    #[cfg(feature = "meshes")]
    Mesh(LentBody<'a, Mesh>),
    #[cfg(feature = "meshes")]
    Cloud(LentBody<'a, Cloud>),
    #[cfg(feature = "surfaces")]
    BezierSurface(LentBody<'a, BezierSurface>),
    HalfSpace(LentBody<'a, HalfSpace>),
}

/// A body that is borrowed, and its owner if the body is shared.
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
    /// Returns the body for the lifetime of the loan.
    #[inline]
    pub(crate) fn get(self) -> &'a T {
        self.body
    }

    /// Returns the body to keep: the shared body if it is shared, else a copy.
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

    /// Returns the compound of a geometry that is a compound.
    #[cfg(feature = "meshes")]
    pub(crate) fn compound(self) -> Option<&'a Compound> {
        match self.0 {
            Lent::Compound(body) => Some(body.get()),
            _ => None,
        }
    }

    /// Returns the compound or the cloud of a geometry that is one of them.
    #[cfg(feature = "meshes")]
    pub(crate) fn union(self) -> Option<PartsRef<'a>> {
        match self.0 {
            Lent::Compound(body) => Some(PartsRef::Pieces(body.get())),
            Lent::Cloud(cloud) => Some(PartsRef::Cloud(cloud.get())),
            _ => None,
        }
    }

    /// Returns the mesh of a geometry that is a mesh.
    #[cfg(feature = "meshes")]
    pub(crate) fn mesh(self) -> Option<&'a Mesh> {
        match self.0 {
            Lent::Mesh(mesh) => Some(mesh.get()),
            _ => None,
        }
    }

    /// Returns the surface of a geometry that is a Bézier surface.
    #[cfg(feature = "surfaces")]
    pub(crate) fn surface(self) -> Option<&'a BezierSurface> {
        match self.0 {
            Lent::BezierSurface(surface) => Some(surface.get()),
            _ => None,
        }
    }

    /// Returns the half-space of a geometry that is a half-space.
    pub(crate) fn half_space(self) -> Option<&'a HalfSpace> {
        match self.0 {
            Lent::HalfSpace(space) => Some(space.get()),
            _ => None,
        }
    }

    /// Returns two geometries, one of which is a half-space, as a pair; `None` for any other pair.
    pub(crate) fn half_space_pair([a, b]: [Self; 2]) -> Option<HalfSpacePair<'a>> {
        let (space, other, order) = match (a.half_space(), b.half_space()) {
            (Some(space), _) => (space, b, Operand::A),
            (None, Some(space)) => (space, a, Operand::B),
            (None, None) => return None,
        };
        let above = match other.0 {
            Lent::Polyhedron(body) => Above::Polyhedron(body.get()),
            Lent::Convex(shape) => Above::Shape(shape.get()),
            #[cfg(feature = "meshes")]
            Lent::Compound(body) => Above::Parts(PartsRef::Pieces(body.get())),
            #[cfg(feature = "meshes")]
            Lent::Mesh(mesh) => Above::Parts(PartsRef::Mesh(mesh.get())),
            #[cfg(feature = "meshes")]
            Lent::Cloud(cloud) => Above::Parts(PartsRef::Cloud(cloud.get())),
            #[cfg(feature = "surfaces")]
            Lent::BezierSurface(surface) => Above::Surface(surface.get()),
            Lent::HalfSpace(other) => Above::HalfSpace(other.get()),
        };
        Some(HalfSpacePair::new(space, above, order))
    }

    /// Returns a polyhedron as a shape to keep; `None` for all other kinds.
    pub(crate) fn polyhedron_as_shape(self) -> Option<Arc<Shape>> {
        match self.0 {
            Lent::Polyhedron(body) => Some(Arc::new(Shape::from(body.to_arc()))),
            _ => None,
        }
    }

    /// Returns a convex geometry as a shape to keep; `None` for a compound, mesh, cloud or surface.
    pub(crate) fn to_shape(self) -> Option<Arc<Shape>> {
        match self.0 {
            Lent::Convex(shape) => Some(shape.to_arc()),
            _ => self.polyhedron_as_shape(),
        }
    }

    /// Returns the hash by which cached state recognises the geometry: one hash for all positions
    /// of the vertices of a mesh.
    #[inline]
    pub(crate) fn fingerprint(self) -> Fingerprint {
        match_kind!(Lent, self.0, body => OfKind::fingerprint(body.get()))
    }

    /// Returns the kind of the geometry.
    #[must_use]
    pub fn kind(self) -> GeometryKind {
        match_kind!(Lent, self.0, body => OfKind::kind(body.get()))
    }

    /// Returns the axis-aligned box of the geometry in its frame, rounded outward.
    pub(crate) fn outer_box(self) -> (Point3<f64>, Point3<f64>) {
        let (pose, hint) = (Isometry3::identity(), &mut BoxHint::default());
        match_kind!(Lent, self.0, body => OfKind::aabb_at(body.get(), &pose, hint))
    }

    /// Returns a ball that contains the geometry, in its frame: centre and radius.
    #[must_use]
    pub fn bounding_ball(self) -> (Point3<f64>, f64) {
        match_kind!(Lent, self.0, body => OfKind::bounding_ball(body.get()))
    }
}

impl<'a> From<&'a Geometry> for GeometryRef<'a> {
    #[inline]
    fn from(geometry: &'a Geometry) -> Self {
        match_kind!(Geometry, geometry, body => Self::from(LentBody::shared(body)))
    }
}

#[cfg(feature = "meshes")]
impl<'a> From<PartsRef<'a>> for GeometryRef<'a> {
    fn from(body: PartsRef<'a>) -> Self {
        match body {
            PartsRef::Mesh(mesh) => Self::from(mesh),
            PartsRef::Pieces(pieces) => Self::from(pieces),
            PartsRef::Cloud(cloud) => Self::from(cloud),
        }
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
            Core::Polyhedron(body) if shape.rounding_radius() == 0.0 => Lent::Polyhedron(LentBody::shared(body)),
            _ => Lent::Convex(LentBody::from(shape)),
        })
    }
}

impl<'a> From<LentBody<'a, Shape>> for GeometryRef<'a> {
    #[inline]
    fn from(shape: LentBody<'a, Shape>) -> Self {
        Self(Lent::Convex(shape))
    }
}

/// Converts borrowed bodies, for types whose bodies all have the same variant.
macro_rules! lend {
    ($kind:ident, $body:ty) => {
        impl<'a> From<LentBody<'a, $body>> for GeometryRef<'a> {
            #[inline]
            fn from(body: LentBody<'a, $body>) -> Self {
                Self(Lent::$kind(body))
            }
        }

        impl<'a> From<&'a $body> for GeometryRef<'a> {
            #[inline]
            fn from(body: &'a $body) -> Self {
                Self::from(LentBody::from(body))
            }
        }

        impl<'a> From<&'a Arc<$body>> for GeometryRef<'a> {
            #[inline]
            fn from(body: &'a Arc<$body>) -> Self {
                Self::from(LentBody::shared(body))
            }
        }
    };
}

lend!(Polyhedron, ConvexPolyhedron);
#[cfg(feature = "meshes")]
lend!(Compound, Compound);
#[cfg(feature = "meshes")]
lend!(Mesh, Mesh);
#[cfg(feature = "meshes")]
lend!(Cloud, Cloud);
#[cfg(feature = "surfaces")]
lend!(BezierSurface, BezierSurface);
lend!(HalfSpace, HalfSpace);
