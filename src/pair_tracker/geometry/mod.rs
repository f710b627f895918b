//! A geometry of any kind: the one list of kinds, and what follows from it.
//!
//! A geometry has two forms. [`Geometry`] owns a shared body, [`GeometryRef`] borrows one. The list
//! in this file names each kind once. From it follow both forms, the serialised form, and the
//! conversions between them and from bodies. A body of a new kind implements [`Body`].

mod body;
mod borrowed;

use crate::base::num::fingerprint::Fingerprint;
use crate::body::polyhedron::{BoxHint, ConvexPolyhedron};
use crate::body::shape::{Core, Shape};
use crate::convex::contact::HalfSpace;
#[cfg(feature = "meshes")]
use crate::nonconvex::{cloud::Cloud, mesh::Mesh, pieces::Compound};
#[cfg(feature = "surfaces")]
use crate::surface::BezierSurface;
use alloc::borrow::Cow;
#[cfg(feature = "serde")]
use alloc::boxed::Box;
use alloc::sync::Arc;
use nalgebra::{Isometry3, Point3};

use body::Body;
pub use body::GeometryKind;
use borrowed::BorrowedBody;
pub use borrowed::GeometryRef;

/// Declares [`Geometry`], its borrowed and its serialised form, and what follows from the kinds.
macro_rules! kinds {
    (
        $(#[$of_all:meta])*
        pub enum Geometry {
            $($(#[doc = $doc:literal])* $(#[cfg($if:meta)])? $kind:ident($body:ty),)*
        }
    ) => {
        $(#[$of_all])*
        pub enum Geometry {
            $($(#[doc = $doc])* $(#[cfg($if)])? $kind(Arc<$body>),)*
        }

        /// A borrowed body of each kind.
        #[derive(Clone, Copy, Debug)]
        pub(crate) enum Borrowed<'a> {
            $($(#[cfg($if)])? $kind(BorrowedBody<'a, $body>),)*
        }

        /// The serialised form of a geometry: the body, not shared.
        #[cfg(feature = "serde")]
        #[derive(serde::Serialize, serde::Deserialize)]
        #[serde(rename = "Geometry")]
        enum StoredGeometry {
            $($(#[cfg($if)])? $kind(Box<$body>),)*
        }

        impl<'a> From<&'a Geometry> for GeometryRef<'a> {
            #[inline]
            fn from(geometry: &'a Geometry) -> Self {
                Self(match geometry {
                    $($(#[cfg($if)])? Geometry::$kind(body) => Borrowed::$kind(BorrowedBody::shared(body)),)*
                })
            }
        }

        #[cfg(feature = "serde")]
        impl From<StoredGeometry> for Geometry {
            fn from(stored: StoredGeometry) -> Self {
                match stored {
                    $($(#[cfg($if)])? StoredGeometry::$kind(body) => Self::from(*body),)*
                }
            }
        }

        #[cfg(feature = "serde")]
        impl From<Geometry> for StoredGeometry {
            fn from(geometry: Geometry) -> Self {
                match geometry {
                    $($(#[cfg($if)])? Geometry::$kind(body) => Self::$kind(Box::new(Arc::unwrap_or_clone(body))),)*
                }
            }
        }

        impl<'a> Borrowed<'a> {
            /// Returns the body as what all kinds have.
            #[inline]
            fn body(self) -> &'a dyn Body {
                match self {
                    $($(#[cfg($if)])? Self::$kind(body) => body.get(),)*
                }
            }

            /// [`Body::fingerprint`], without a call through a pointer: every query asks it.
            #[inline]
            fn fingerprint(self) -> Fingerprint {
                match self {
                    $($(#[cfg($if)])? Self::$kind(body) => Body::fingerprint(body.get()),)*
                }
            }
        }

        $($(#[cfg($if)])? of_body!($kind, $body);)*
    };
}

/// Converts a body of one kind to both forms.
macro_rules! of_body {
    ($kind:ident, $body:ty) => {
        impl From<$body> for Geometry {
            fn from(body: $body) -> Self {
                Self::from(Arc::new(body))
            }
        }

        impl From<Arc<$body>> for Geometry {
            fn from(body: Arc<$body>) -> Self {
                Self::$kind(body).unrounded()
            }
        }

        impl<'a> From<&'a $body> for GeometryRef<'a> {
            #[inline]
            fn from(body: &'a $body) -> Self {
                Self(Borrowed::$kind(BorrowedBody::from(body)).unrounded())
            }
        }

        impl<'a> From<&'a Arc<$body>> for GeometryRef<'a> {
            #[inline]
            fn from(body: &'a Arc<$body>) -> Self {
                Self(Borrowed::$kind(BorrowedBody::shared(body)).unrounded())
            }
        }
    };
}

kinds! {
    /// The shape of a body, shared by all bodies with this shape.
    ///
    /// A [`PairTracker`](crate::PairTracker) takes any two geometries. In a scene a pair answers
    /// all queries except these:
    ///
    /// | pair | queries that it cannot answer |
    /// |---|---|
    /// | two convex shapes, polyhedra included | none |
    /// | a compound, a mesh or a cloud, with any of these or a convex shape | depths |
    /// | a surface, with any other geometry but a half-space | depths, `manifold` |
    /// | a half-space, with any other geometry | none |
    ///
    /// Depths are the queries `depth` and `local_depth`. For a pair with a compound, mesh or cloud,
    /// the query `manifold` fills
    /// [`PairResults::contacts`](crate::scene::PairResults::contacts). Overlaps of such a pair have
    /// the distance 0.
    ///
    /// A scene rejects a call that would make a pair with a query that the pair cannot answer, with
    /// [`SceneError::Unanswered`](crate::scene::SceneError::Unanswered). Such calls are: insert a
    /// body, change a group, enable a query.
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
    /// or `2^-38` of the distance of the bodies, apart. Two surfaces that the bounds cannot
    /// distinguish from a threshold count as within. A surface has no inside: a body inside a
    /// closed surface does not overlap it.
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
    #[cfg_attr(feature = "serde", serde(from = "StoredGeometry", into = "StoredGeometry"))]
    #[non_exhaustive]
    // A new kind comes last: some formats store the number of a kind.
    pub enum Geometry {
        /// A convex polyhedron, polygon, segment or point.
        Polyhedron(ConvexPolyhedron),
        /// A convex shape that is rounded or curved.
        Convex(Shape),
        /// A union of convex pieces, each with a pose.
        #[cfg(feature = "meshes")]
        Compound(Compound),
        /// A mesh of triangles.
        #[cfg(feature = "meshes")]
        Mesh(Mesh),
        /// A surface of Bézier patches, without an inside.
        #[cfg(feature = "surfaces")]
        BezierSurface(BezierSurface),
        /// A half-space: all points on one side of a plane.
        HalfSpace(HalfSpace),
        /// One convex element at many points.
        #[cfg(feature = "meshes")]
        Cloud(Cloud),
    }
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
        GeometryRef::from(self).aabb_at(pose, hint)
    }

    /// Returns the address of the shared shape, equal for bodies that share it.
    pub(crate) fn address(&self) -> usize {
        GeometryRef::from(self).address()
    }

    /// Returns a shape that is a polyhedron and not rounded as a polyhedron.
    fn unrounded(self) -> Self {
        match &self {
            Self::Convex(shape) => match shape.core() {
                Core::Polyhedron(body) if shape.rounding_radius() == 0.0 => Self::Polyhedron(body.clone()),
                _ => self,
            },
            _ => self,
        }
    }
}
