//! A shape of any kind there is.

mod lent;

pub use lent::GeometryRef;
pub(crate) use lent::Lent;

use alloc::borrow::Cow;
use alloc::sync::Arc;

use nalgebra::{Isometry3, Point3, Vector3};

use crate::base::pose::rotation_matrix;
use crate::base::tolerance::BOX_TURNED;
use crate::body::polyhedron::{BoxHint, ConvexPolyhedron};
use crate::body::shape::{Core, Shape};
use crate::composite::mesh::Mesh;
use crate::composite::pieces::Composite;
use crate::patch::Surface;

/// The shape of a body, shared by all bodies of this shape.
///
/// A [`PairTracker`](crate::PairTracker) follows any two. In a scene a pair answers all effects but
/// these:
///
/// | pair | refused |
/// |---|---|
/// | two convex shapes, polyhedra among them | none |
/// | a composite or a mesh, with one or a convex shape | depths |
/// | a surface, with any other geometry | depths, `manifold` |
///
/// Depths are the effects `depth` and `local_depth`. The effect `manifold` of a pair with a
/// composite or mesh is answered by [`PairAnswer::contacts`](crate::scene::PairAnswer::contacts);
/// overlaps of such a pair have the distance 0.
///
/// A call that would make a pair with an effect that the pair cannot answer is refused with
/// [`SceneError::Unanswered`](crate::scene::SceneError::Unanswered): insertion of a body, change of
/// a group, call for an effect. Against a composite or a mesh a convex shape is a composite of one
/// piece, a single leaf with its own support points; against a mesh a composite of polyhedra is the
/// mesh of its surface; against a surface a mesh is its triangles as flat patches, and its inside
/// if it is closed. The pair makes those once, when the boxes meet. The patches for contacts are
/// made once for each shape, in the step after they are called for.
///
/// Distances of surfaces of patches have bounds that are at most `2^-30` of the size of the pair
/// apart; two that the bounds cannot tell from a threshold count as within. A surface has no
/// inside: a body within a closed one does not overlap it.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::polyhedron::solids;
/// use lin_canny::scene::{Body, Effects, Group, Scene};
/// use lin_canny::{Composite, Mesh, Piece, Shape};
///
/// let all = Group::default();
/// let mut scene = Scene::new();
/// scene.call_for(all, all, Effects::none().distance(10.0))?;
/// let die = solids::cuboid(Vector3::new(1.0, 1.0, 1.0))?;
/// let bracket = Composite::new(vec![Piece::new(die.clone())])?;
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
pub enum Geometry {
    /// A convex polyhedron, polygon, segment or point.
    Polyhedron(Arc<ConvexPolyhedron>),
    /// A convex shape that is rounded or curved.
    Convex(Arc<Shape>),
    /// A union of placed convex pieces.
    Composite(Arc<Composite>),
    /// A mesh of triangles.
    Mesh(Arc<Mesh>),
    /// A surface of curved patches, without an inside.
    Surface(Arc<Surface>),
}

impl Geometry {
    /// Returns the polyhedron of a body that is a polyhedron.
    #[must_use]
    pub fn as_polyhedron(&self) -> Option<&ConvexPolyhedron> {
        match self {
            Self::Polyhedron(body) => Some(body),
            _ => None,
        }
    }

    /// Returns the body as a convex shape, unless the body is a composite, a mesh or a
    /// surface.
    #[must_use]
    pub fn as_convex(&self) -> Option<Cow<'_, Shape>> {
        match self {
            Self::Polyhedron(body) => Some(Cow::Owned(Shape::from(body.clone()))),
            Self::Convex(shape) => Some(Cow::Borrowed(shape)),
            Self::Composite(_) | Self::Mesh(_) | Self::Surface(_) => None,
        }
    }

    /// Returns the kind of the shape.
    #[must_use]
    pub fn kind(&self) -> ShapeKind {
        GeometryRef::from(self).kind()
    }

    /// Returns a ball that contains the shape, in the frame of the shape: centre and radius.
    #[must_use]
    pub fn bounding_ball(&self) -> (Point3<f64>, f64) {
        GeometryRef::from(self).bounding_ball()
    }

    /// Returns the axis-aligned box of the shape at a pose, rounded outward: least and greatest
    /// corner. The box of a composite or a mesh is that of its turned bounding box.
    #[inline]
    #[must_use]
    pub fn aabb_at(&self, pose: &Isometry3<f64>, hint: &mut BoxHint) -> (Point3<f64>, Point3<f64>) {
        match self {
            Self::Polyhedron(body) => body.aabb_at(pose, hint),
            Self::Convex(shape) => shape.aabb_at(pose, hint),
            Self::Composite(composite) => turned_box(composite.aabb(), pose),
            Self::Mesh(mesh) => turned_box(mesh.aabb(), pose),
            Self::Surface(surface) => turned_box(surface.outer_box(), pose),
        }
    }

    /// Returns the address of the shared shape, equal for bodies that share the shape.
    pub(crate) fn address(&self) -> usize {
        match self {
            Self::Polyhedron(body) => Arc::as_ptr(body) as usize,
            Self::Convex(shape) => Arc::as_ptr(shape) as usize,
            Self::Composite(composite) => Arc::as_ptr(composite) as usize,
            Self::Mesh(mesh) => Arc::as_ptr(mesh) as usize,
            Self::Surface(surface) => Arc::as_ptr(surface) as usize,
        }
    }
}

/// The kind of a geometry.
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
        !matches!(self, Self::Composite | Self::Mesh | Self::Surface)
    }
}

/// Returns the box about a posed box.
fn turned_box((low, high): (Point3<f64>, Point3<f64>), pose: &Isometry3<f64>) -> (Point3<f64>, Point3<f64>) {
    let q = pose.rotation.coords;
    let matrix = rotation_matrix(&[q.x, q.y, q.z, q.w], 2.0 / q.norm_squared());
    let half = (high - low) * 0.5;
    let centre = low.coords + half;
    let t = pose.translation.vector;
    let far = centre.abs().sum() + half.sum();
    let half = matrix.abs() * half + (t.abs().add_scalar(far)) * BOX_TURNED;
    let centre: Vector3<f64> = matrix * centre + t;
    (Point3::from(centre - half), Point3::from(centre + half))
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
        match shape.core() {
            Core::Polyhedron(body) if shape.round() == 0.0 => Self::Polyhedron(body.clone()),
            _ => Self::Convex(Arc::new(shape)),
        }
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

impl From<Composite> for Geometry {
    fn from(composite: Composite) -> Self {
        Self::Composite(Arc::new(composite))
    }
}

impl From<Arc<Composite>> for Geometry {
    fn from(composite: Arc<Composite>) -> Self {
        Self::Composite(composite)
    }
}

impl From<Mesh> for Geometry {
    fn from(mesh: Mesh) -> Self {
        Self::Mesh(Arc::new(mesh))
    }
}

impl From<Arc<Mesh>> for Geometry {
    fn from(mesh: Arc<Mesh>) -> Self {
        Self::Mesh(mesh)
    }
}

impl From<Surface> for Geometry {
    fn from(surface: Surface) -> Self {
        Self::Surface(Arc::new(surface))
    }
}

impl From<Arc<Surface>> for Geometry {
    fn from(surface: Arc<Surface>) -> Self {
        Self::Surface(surface)
    }
}

/// The serialized form of a shape.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename = "Geometry")]
enum StoredGeometry {
    Polyhedron(alloc::boxed::Box<ConvexPolyhedron>),
    Convex(Shape),
    Composite(alloc::boxed::Box<Composite>),
    Mesh(alloc::boxed::Box<Mesh>),
    Surface(alloc::boxed::Box<Surface>),
}

#[cfg(feature = "serde")]
impl From<StoredGeometry> for Geometry {
    fn from(stored: StoredGeometry) -> Self {
        match stored {
            StoredGeometry::Polyhedron(body) => Self::from(*body),
            StoredGeometry::Convex(shape) => Self::Convex(Arc::new(shape)),
            StoredGeometry::Composite(composite) => Self::from(*composite),
            StoredGeometry::Mesh(mesh) => Self::from(*mesh),
            StoredGeometry::Surface(surface) => Self::from(*surface),
        }
    }
}

#[cfg(feature = "serde")]
impl From<Geometry> for StoredGeometry {
    fn from(shape: Geometry) -> Self {
        use alloc::boxed::Box;
        match shape {
            Geometry::Polyhedron(body) => Self::Polyhedron(Box::new(Arc::unwrap_or_clone(body))),
            Geometry::Convex(shape) => Self::Convex(Arc::unwrap_or_clone(shape)),
            Geometry::Composite(composite) => Self::Composite(Box::new(Arc::unwrap_or_clone(composite))),
            Geometry::Mesh(mesh) => Self::Mesh(Box::new(Arc::unwrap_or_clone(mesh))),
            Geometry::Surface(surface) => Self::Surface(Box::new(Arc::unwrap_or_clone(surface))),
        }
    }
}
