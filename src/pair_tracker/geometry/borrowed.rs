//! A geometry that a query borrows.

use alloc::sync::Arc;

use nalgebra::{Isometry3, Point3};

use super::{Borrowed, GeometryKind};
use crate::base::num::fingerprint::Fingerprint;
use crate::base::pose::Operand;
use crate::body::polyhedron::{BoxHint, ConvexPolyhedron};
use crate::body::shape::{Core, Shape};
use crate::convex::contact::HalfSpace;
use crate::half_space::{Above, HalfSpacePair};
#[cfg(feature = "meshes")]
use crate::nonconvex::{mesh::Mesh, parts::PartsRef, pieces::Compound};
#[cfg(feature = "surfaces")]
use crate::surface::BezierSurface;

/// A borrowed geometry of any kind: what a query of two geometries takes.
///
/// References to a [`Geometry`](super::Geometry) and to a body of each kind convert to this type,
/// so a body need not be shared to be queried. A [`Shape`] that is a polyhedron and not rounded
/// becomes a polyhedron.
#[derive(Clone, Copy, Debug)]
pub struct GeometryRef<'a>(pub(crate) Borrowed<'a>);

/// A body that is borrowed, and its owner if the body is shared.
#[derive(Debug)]
pub(crate) struct BorrowedBody<'a, T> {
    body: &'a T,
    owner: Option<&'a Arc<T>>,
}

impl<T> Clone for BorrowedBody<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for BorrowedBody<'_, T> {}

impl<'a, T> BorrowedBody<'a, T> {
    /// Returns the body for the lifetime of the borrow.
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

impl<'a, T> From<&'a T> for BorrowedBody<'a, T> {
    #[inline]
    fn from(body: &'a T) -> Self {
        Self { body, owner: None }
    }
}

impl<'a, T> BorrowedBody<'a, T> {
    #[inline]
    pub(super) fn shared(owner: &'a Arc<T>) -> Self {
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
            Borrowed::Polyhedron(body) => Some(body.get()),
            _ => None,
        }
    }

    /// Returns the shape of a geometry that is rounded or curved.
    #[inline]
    pub(crate) fn shape(self) -> Option<&'a Shape> {
        match self.0 {
            Borrowed::Convex(shape) => Some(shape.get()),
            _ => None,
        }
    }

    /// Returns the compound of a geometry that is a compound.
    #[cfg(feature = "meshes")]
    pub(crate) fn compound(self) -> Option<&'a Compound> {
        match self.0 {
            Borrowed::Compound(body) => Some(body.get()),
            _ => None,
        }
    }

    /// Returns the compound or the cloud of a geometry that is one of them.
    #[cfg(feature = "meshes")]
    pub(crate) fn union(self) -> Option<PartsRef<'a>> {
        match self.0 {
            Borrowed::Compound(body) => Some(PartsRef::Pieces(body.get())),
            Borrowed::Cloud(cloud) => Some(PartsRef::Cloud(cloud.get())),
            _ => None,
        }
    }

    /// Returns the mesh of a geometry that is a mesh.
    #[cfg(feature = "meshes")]
    pub(crate) fn mesh(self) -> Option<&'a Mesh> {
        match self.0 {
            Borrowed::Mesh(mesh) => Some(mesh.get()),
            _ => None,
        }
    }

    /// Returns the surface of a geometry that is a Bézier surface.
    #[cfg(feature = "surfaces")]
    pub(crate) fn surface(self) -> Option<&'a BezierSurface> {
        match self.0 {
            Borrowed::BezierSurface(surface) => Some(surface.get()),
            _ => None,
        }
    }

    /// Returns the half-space of a geometry that is a half-space.
    pub(crate) fn half_space(self) -> Option<&'a HalfSpace> {
        match self.0 {
            Borrowed::HalfSpace(space) => Some(space.get()),
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
            Borrowed::Polyhedron(body) => Above::Polyhedron(body.get()),
            Borrowed::Convex(shape) => Above::Shape(shape.get()),
            #[cfg(feature = "meshes")]
            Borrowed::Compound(body) => Above::Parts(PartsRef::Pieces(body.get())),
            #[cfg(feature = "meshes")]
            Borrowed::Mesh(mesh) => Above::Parts(PartsRef::Mesh(mesh.get())),
            #[cfg(feature = "meshes")]
            Borrowed::Cloud(cloud) => Above::Parts(PartsRef::Cloud(cloud.get())),
            #[cfg(feature = "surfaces")]
            Borrowed::BezierSurface(surface) => Above::Surface(surface.get()),
            Borrowed::HalfSpace(other) => Above::HalfSpace(other.get()),
        };
        Some(HalfSpacePair::new(space, above, order))
    }

    /// Returns a polyhedron as a shape to keep; `None` for all other kinds.
    pub(crate) fn polyhedron_as_shape(self) -> Option<Arc<Shape>> {
        match self.0 {
            Borrowed::Polyhedron(body) => Some(Arc::new(Shape::from(body.to_arc()))),
            _ => None,
        }
    }

    /// Returns a convex geometry as a shape to keep; `None` for a compound, mesh, cloud or surface.
    pub(crate) fn to_shape(self) -> Option<Arc<Shape>> {
        match self.0 {
            Borrowed::Convex(shape) => Some(shape.to_arc()),
            _ => self.polyhedron_as_shape(),
        }
    }

    /// Returns the hash by which cached state recognises the geometry: one hash for all positions
    /// of the vertices of a mesh.
    #[inline]
    pub(crate) fn fingerprint(self) -> Fingerprint {
        self.0.fingerprint()
    }

    /// Returns the kind of the geometry.
    #[must_use]
    pub fn kind(self) -> GeometryKind {
        self.0.body().kind()
    }

    /// Returns the axis-aligned box of the geometry in its frame, rounded outward.
    pub(crate) fn outer_box(self) -> (Point3<f64>, Point3<f64>) {
        self.aabb_at(&Isometry3::identity(), &mut BoxHint::default())
    }

    /// Returns the axis-aligned box of the geometry at a pose, rounded outward.
    #[inline]
    pub(super) fn aabb_at(self, pose: &Isometry3<f64>, hint: &mut BoxHint) -> (Point3<f64>, Point3<f64>) {
        self.0.body().aabb_at(pose, hint)
    }

    /// Returns the address of the body, equal for geometries that share it.
    pub(super) fn address(self) -> usize {
        core::ptr::from_ref(self.0.body()).addr()
    }

    /// Returns a ball that contains the geometry, in its frame: centre and radius.
    #[must_use]
    pub fn bounding_ball(self) -> (Point3<f64>, f64) {
        self.0.body().bounding_ball()
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

impl Borrowed<'_> {
    /// Returns a shape that is a polyhedron and not rounded as a polyhedron.
    #[inline]
    pub(super) fn unrounded(self) -> Self {
        if let Self::Convex(shape) = self
            && let Core::Polyhedron(body) = shape.get().core()
            && shape.get().rounding_radius() == 0.0
        {
            return Self::Polyhedron(BorrowedBody::shared(body));
        }
        self
    }
}
