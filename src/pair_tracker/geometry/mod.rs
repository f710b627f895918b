//! A geometry of any kind, its kind, and the methods that bodies of every kind have.

mod lent;
#[cfg(feature = "meshes")]
mod not_convex;
#[cfg(feature = "serde")]
mod persist;

use crate::base::num::fingerprint::Fingerprint;
use crate::base::tolerance::EXTENT_MAX;
use crate::body::polyhedron::{BoxHint, ConvexPolyhedron};
use crate::body::shape::{Core, Shape};
use crate::convex::contact::HalfSpace;
#[cfg(feature = "meshes")]
use crate::nonconvex::cloud::Cloud;
#[cfg(feature = "meshes")]
use crate::nonconvex::mesh::Mesh;
#[cfg(feature = "meshes")]
use crate::nonconvex::pieces::Compound;
pub use crate::pair_tracker::geometry::lent::GeometryRef;
pub(crate) use crate::pair_tracker::geometry::lent::Lent;
#[cfg(feature = "surfaces")]
use crate::surface::BezierSurface;
use alloc::borrow::Cow;
use alloc::sync::Arc;
use nalgebra::{Isometry3, Point3};

/// Evaluates one expression for the body of a geometry of any kind, owned or borrowed.
macro_rules! match_kind {
    ($all:ident, $geometry:expr, $body:ident => $result:expr) => {
        match $geometry {
            $all::Polyhedron($body) => $result,
            $all::Convex($body) => $result,
            #[cfg(feature = "meshes")]
            $all::Compound($body) => $result,
            #[cfg(feature = "meshes")]
            $all::Mesh($body) => $result,
            #[cfg(feature = "meshes")]
            $all::Cloud($body) => $result,
            #[cfg(feature = "surfaces")]
            $all::BezierSurface($body) => $result,
            $all::HalfSpace($body) => $result,
        }
    };
}

use match_kind;

/// The shape of a body, shared by all bodies with this shape.
///
/// A [`PairTracker`](crate::PairTracker) takes any two geometries. In a scene a pair answers all
/// queries except these:
///
/// | pair | queries that it cannot answer |
/// |---|---|
/// | two convex shapes, polyhedra included | none |
/// | a compound, a mesh or a cloud, with any of these or a convex shape | depths |
/// | a surface, with any other geometry but a half-space | depths, `manifold` |
/// | a half-space, with any other geometry | none |
///
/// Depths are the queries `depth` and `local_depth`. For a pair with a compound, mesh or cloud, the
/// query `manifold` fills [`PairResults::contacts`](crate::scene::PairResults::contacts).
/// Overlaps of such a pair have the distance 0.
///
/// A scene rejects a call that would make a pair with a query that the pair cannot answer, with
/// [`SceneError::Unanswered`](crate::scene::SceneError::Unanswered). Such calls are: insert a body,
/// change a group, enable a query.
///
/// Pairs of two kinds convert one of the bodies, once, when the boxes meet:
///
/// - a convex shape against a compound, mesh or cloud becomes a compound of one piece, a single
///   leaf with support points;
/// - a cloud against a surface, and for contacts, becomes a compound with a piece per point;
/// - a compound of polyhedra against a mesh becomes the mesh of its surface;
/// - a mesh against a surface becomes its triangles as flat patches, and its inside if it is
///   closed.
///
/// The patches for contacts are made once per shape, in the step after contacts are enabled.
///
/// Distances of Bézier surfaces have bounds that are at most `2^-30` of the sum of both radii,
/// or `2^-38` of the distance of the bodies, apart. Two surfaces that the bounds cannot distinguish
/// from a threshold count as within. A surface has no inside: a body inside a closed surface does
/// not overlap it.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::polyhedron::solids;
/// use lin_canny::scene::{Body, PairQueries, Group, Scene};
/// use lin_canny::{Compound, Mesh, Piece, Shape};
///
/// let all = Group::default();
/// let mut scene = Scene::new();
/// scene.set_queries(all, all, PairQueries::none().distance(10.0))?;
/// let die = solids::cuboid(Vector3::new(1.0, 1.0, 1.0))?;
/// let bracket = Compound::new(vec![Piece::new(die.clone())])?;
/// let part = Mesh::from_convex(&die)?;
/// let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
/// scene.insert(Body::moving(die), at(0.0))?;
/// scene.insert(Body::moving(bracket), at(3.0))?;
/// scene.insert(Body::moving(part), at(6.0))?;
/// scene.step();
/// let distances = scene.pairs().map(|pair| pair.distance.unwrap().value);
/// let apart: Vec<f64> = distances.collect();
/// assert_eq!(apart.len(), 3);
/// let is = |d: f64, value: f64| (d - value).abs() < 1e-14;
/// assert!(apart.iter().all(|d| is(*d, 1.0) || is(*d, 4.0)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(from = "persist::StoredGeometry", into = "persist::StoredGeometry")
)]
#[non_exhaustive]
pub enum Geometry {
    /// A convex polyhedron, polygon, segment or point.
    Polyhedron(Arc<ConvexPolyhedron>),
    /// A convex shape that is rounded or curved.
    Convex(Arc<Shape>),
    /// A union of convex pieces, each with a pose.
    #[cfg(feature = "meshes")]
    Compound(Arc<Compound>),
    /// A mesh of triangles.
    #[cfg(feature = "meshes")]
    Mesh(Arc<Mesh>),
    /// One convex element at many points.
    #[cfg(feature = "meshes")]
    Cloud(Arc<Cloud>),
    /// A surface of Bézier patches, without an inside.
    #[cfg(feature = "surfaces")]
    BezierSurface(Arc<BezierSurface>),
    /// A half-space: all points on one side of a plane.
    HalfSpace(Arc<HalfSpace>),
}

impl Geometry {
    /// Returns the polyhedron if the body is one.
    #[must_use]
    pub fn as_polyhedron(&self) -> Option<&ConvexPolyhedron> {
        match self {
            Self::Polyhedron(body) => Some(body),
            _ => None,
        }
    }

    /// Returns the body as a convex shape; `None` for all other kinds.
    #[must_use]
    pub fn as_convex(&self) -> Option<Cow<'_, Shape>> {
        match self {
            Self::Polyhedron(body) => Some(Cow::Owned(Shape::from(body.clone()))),
            Self::Convex(shape) => Some(Cow::Borrowed(shape)),
            _ => None,
        }
    }

    /// Returns the kind of the shape.
    #[must_use]
    pub fn kind(&self) -> GeometryKind {
        GeometryRef::from(self).kind()
    }

    /// Returns a ball that contains the shape, in the frame of the shape: centre and radius.
    ///
    /// No ball contains a half-space. Its ball has the radius [`EXTENT_MAX`](crate::EXTENT_MAX)
    /// about the point of the plane that is closest to the origin.
    #[must_use]
    pub fn bounding_ball(&self) -> (Point3<f64>, f64) {
        GeometryRef::from(self).bounding_ball()
    }

    /// Returns the axis-aligned box of the shape at a pose, rounded outward: minimum and maximum
    /// corner.
    ///
    /// The box of a compound, mesh or cloud is the box of its rotated bounding box. The box of a
    /// half-space is infinite on all sides, except the outer side if the normal is along an axis.
    #[inline]
    #[must_use]
    pub fn aabb_at(&self, pose: &Isometry3<f64>, hint: &mut BoxHint) -> (Point3<f64>, Point3<f64>) {
        match_kind!(Self, self, body => OfKind::aabb_at(&**body, pose, hint))
    }

    /// Returns the address of the shared shape, equal for bodies that share it.
    pub(crate) fn address(&self) -> usize {
        match_kind!(Self, self, body => Arc::as_ptr(body) as usize)
    }
}

/// Converts bodies to geometries, for types whose bodies all have the same variant.
macro_rules! of_body {
    ($kind:ident, $body:ty) => {
        impl From<$body> for Geometry {
            fn from(body: $body) -> Self {
                Self::from(Arc::new(body))
            }
        }

        impl From<Arc<$body>> for Geometry {
            fn from(body: Arc<$body>) -> Self {
                Self::$kind(body)
            }
        }
    };
}

of_body!(Polyhedron, ConvexPolyhedron);
#[cfg(feature = "meshes")]
of_body!(Compound, Compound);
#[cfg(feature = "meshes")]
of_body!(Mesh, Mesh);
#[cfg(feature = "meshes")]
of_body!(Cloud, Cloud);
#[cfg(feature = "surfaces")]
of_body!(BezierSurface, BezierSurface);
of_body!(HalfSpace, HalfSpace);

impl From<Shape> for Geometry {
    /// A shape that is a polyhedron and not rounded becomes a polyhedron.
    fn from(shape: Shape) -> Self {
        Self::from(Arc::new(shape))
    }
}

impl From<Arc<Shape>> for Geometry {
    fn from(shape: Arc<Shape>) -> Self {
        match shape.core() {
            Core::Polyhedron(body) if shape.rounding_radius() == 0.0 => Self::Polyhedron(body.clone()),
            _ => Self::Convex(shape),
        }
    }
}

/// A body of one kind.
pub(super) trait OfKind {
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
    /// A cylinder, cone or ellipsoid, rounded or not.
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

impl OfKind for ConvexPolyhedron {
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

impl OfKind for HalfSpace {
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

impl OfKind for Shape {
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
