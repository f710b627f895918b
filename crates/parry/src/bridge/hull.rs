//! The shape [`Hull`]: a convex polyhedron of [`lin_canny`], rounded or not, for parry.

use std::sync::Arc;

use lin_canny::nalgebra::Point3;
use lin_canny::{BuildError, ConvexPolyhedron, Shape};

use super::mass::UnitMass;
use super::number::{down, narrow, up, wide_point};
use super::parry::bounding_volume::{Aabb, BoundingSphere};
use super::parry::mass_properties::MassProperties;
use super::parry::math::{Real, Vector};
use super::parry::shape::{self, SharedShape};

/// A convex body as a shape for parry, with all derived data computed once.
///
/// It is cheap to clone, because clones share the body. `SharedShape::from(hull)` makes a shape for
/// a collider.
///
/// ```
/// use lin_canny_parry::single::{Hull, parry};
/// use parry::math::Vector;
/// use parry::shape::{Shape, SharedShape};
///
/// let tip = [[0., 0., 0.], [1e-3, 0., 0.], [0., 1e-3, 0.], [0., 0., 1e-3]].map(Vector::from);
/// let hull = Hull::from_points(&tip)?;
/// assert_eq!(hull.body().vertex_count(), 4);
/// assert!(hull.conversion().is_exact());
/// let shape = SharedShape::from(hull);
/// assert!((shape.mass_properties(6000.0).mass() - 1e-6).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Hull {
    pub(super) core: Solid,
    pub(super) border_radius: Real,
    /// The equivalent shape of parry, for snapshots, exact sweeps and debug renderers.
    pub(super) twin: Option<Arc<shape::RoundConvexPolyhedron>>,
    pub(super) aabb: Aabb,
    pub(super) ball: BoundingSphere,
    mass: UnitMass,
    conversion: Conversion,
}

/// A body without border, and a ball around it in the engine's numbers.
#[derive(Clone)]
pub(super) struct Solid {
    pub(super) body: Arc<ConvexPolyhedron>,
    pub(super) ball: BoundingSphere,
}

impl Solid {
    pub(super) fn new(body: Arc<ConvexPolyhedron>) -> Self {
        let (center, radius) = body.bounding_ball();
        let middle = narrow(&center.coords);
        let moved = (wide_point(middle) - center).norm();
        let radius = up((radius + moved) * (1.0 + 4.0 * f64::EPSILON));
        let ball = BoundingSphere::new(middle, radius);
        Self { body, ball }
    }
}

/// Report of the conversion of a body to the engine's precision.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Conversion {
    /// Number of vertices that the engine's precision cannot represent exactly.
    ///
    /// Contacts use the unrounded body. Support points and snapshots use the rounded vertices.
    pub rounded: usize,
    /// Largest distance, in the caller's unit, by which a vertex was rounded.
    pub shift: f64,
    /// Whether parry has an equivalent convex polyhedron with the same vertices and border.
    ///
    /// If not, the shape is not part of a snapshot, and fast bodies use the slower nonlinear cast.
    pub has_parry_equivalent: bool,
}

impl Conversion {
    /// Returns whether no vertex was rounded and the shape can be part of a snapshot.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.rounded == 0 && self.has_parry_equivalent
    }
}

/// Error of the conversion of a parry shape to a [`Hull`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HullError {
    /// Returned if the points cannot form a body. The error names the point.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// Returned if the shape is not a convex polyhedron, cuboid, triangle or segment, rounded or
    /// not.
    #[error("shape has no vertices (expected a convex polyhedron, cuboid, triangle or segment)")]
    Kind,
    /// Returned if the border radius, in the caller's unit, is negative or not finite.
    #[error("border radius is negative or not finite: {0}")]
    Radius(Real),
}

impl Hull {
    /// Returns the convex hull of points, which must span a volume.
    ///
    /// # Errors
    /// Returns an error if a point is not finite or the points span no volume.
    pub fn from_points(points: &[Vector]) -> Result<Self, BuildError> {
        let points: Vec<_> = points.iter().map(|&p| wide_point(p)).collect();
        Ok(Self::new(ConvexPolyhedron::from_points(&points)?))
    }

    /// Returns the hull of a body, which may be shared with other users.
    pub fn new(body: impl Into<Arc<ConvexPolyhedron>>) -> Self {
        let core = Solid::new(body.into());
        let twin = twin(&core.body).map(Arc::new);
        let (low, high) = core.body.aabb();
        Self {
            aabb: Aabb::new(outward(&low, down), outward(&high, up)),
            ball: core.ball,
            mass: UnitMass::of(&Shape::from(core.body.clone())),
            conversion: conversion(&core.body, twin.is_some()),
            border_radius: 0.0,
            core,
            twin,
        }
    }

    /// Returns the shape of all points within a border radius of this one, in the caller's unit.
    ///
    /// The shape is that of `SharedShape::round_convex_hull`, but the mass is that of the rounded
    /// body, while parry's mass is that of the core.
    ///
    /// # Errors
    /// Returns an error if the radius is negative or not finite.
    ///
    /// ```
    /// use lin_canny_parry::single::{Hull, parry};
    /// use parry::math::Vector;
    /// use parry::shape::Shape;
    ///
    /// let corners = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]].map(Vector::from);
    /// let stone = Hull::from_points(&corners)?.rounded(0.1)?;
    /// assert_eq!(stone.border_radius(), 0.1);
    /// assert!(stone.mass_properties(1.0).mass() > 0.35);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn rounded(&self, border_radius: Real) -> Result<Self, HullError> {
        let by = self.border_radius + border_radius;
        let rounded = Shape::from(self.core.body.clone()).rounded(f64::from(by));
        let (true, Ok(rounded)) = (border_radius >= 0.0, rounded) else {
            return Err(HullError::Radius(border_radius));
        };
        let (low, high) = self.core.body.aabb();
        let border = f64::from(by);
        let aabb = Aabb::new(outward(&low, |x| down(x - border)), outward(&high, |x| up(x + border)));
        let core = self.core.ball;
        let ball = BoundingSphere::new(core.center, up(f64::from(core.radius) + border));
        let twin = self.twin.as_ref().map(|twin| {
            let mut twin = shape::RoundConvexPolyhedron::clone(twin);
            twin.border_radius = by;
            Arc::new(twin)
        });
        Ok(Self {
            border_radius: by,
            twin,
            aabb,
            ball,
            mass: UnitMass::of(&rounded),
            ..self.clone()
        })
    }

    /// Returns the body without its border.
    #[must_use]
    pub fn body(&self) -> &Arc<ConvexPolyhedron> {
        &self.core.body
    }

    /// Returns the border radius, in the caller's unit.
    #[must_use]
    pub fn border_radius(&self) -> Real {
        self.border_radius
    }

    /// Returns the report of the conversion to the engine's precision.
    ///
    /// [`ConvexPolyhedron::report`] is the report of the construction of the body.
    #[must_use]
    pub fn conversion(&self) -> Conversion {
        self.conversion
    }

    /// Returns the body without its border as a convex polyhedron of parry, with the same vertex
    /// order.
    ///
    /// Returns `None` for flat bodies, and if parry's merging of faces leaves no face.
    #[must_use]
    pub fn to_parry(&self) -> Option<&shape::ConvexPolyhedron> {
        self.twin.as_deref().map(|twin| &twin.inner_shape)
    }

    /// Returns the mass properties at a density, in mass per unit of volume.
    ///
    /// The principal axes come from a decomposition in `f64` without an absolute tolerance.
    #[must_use]
    pub fn mass_properties_at(&self, density: Real) -> MassProperties {
        self.mass.at(density)
    }
}

impl From<ConvexPolyhedron> for Hull {
    fn from(body: ConvexPolyhedron) -> Self {
        Self::new(body)
    }
}

impl From<Hull> for SharedShape {
    fn from(hull: Hull) -> Self {
        SharedShape(Arc::new(hull))
    }
}

/// Converts a convex polyhedron, cuboid, triangle, segment or `Hull`; rounded shapes keep their
/// border.
impl TryFrom<&dyn shape::Shape> for Hull {
    type Error = HullError;

    fn try_from(shape: &dyn shape::Shape) -> Result<Self, HullError> {
        if let Some(hull) = shape.as_shape::<Self>() {
            Ok(hull.clone())
        } else if let Some(polyhedron) = shape.as_convex_polyhedron() {
            Ok(Self::from_points(polyhedron.points())?)
        } else if let Some(cuboid) = shape.as_cuboid() {
            Ok(Self::from_points(&corners(cuboid.half_extents))?)
        } else if let Some(triangle) = shape.as_triangle() {
            let points = triangle.vertices().map(wide_point);
            Ok(Self::new(ConvexPolyhedron::polygon(&points)?))
        } else if let Some(segment) = shape.as_segment() {
            let (start, end) = (wide_point(segment.a), wide_point(segment.b));
            Ok(Self::new(ConvexPolyhedron::segment(start, end)?))
        } else if let Some(round) = shape.as_round_convex_polyhedron() {
            Self::try_from(&round.inner_shape as &dyn shape::Shape)?.rounded(round.border_radius)
        } else if let Some(round) = shape.as_round_cuboid() {
            Self::try_from(&round.inner_shape as &dyn shape::Shape)?.rounded(round.border_radius)
        } else if let Some(round) = shape.as_round_triangle() {
            Self::try_from(&round.inner_shape as &dyn shape::Shape)?.rounded(round.border_radius)
        } else {
            Err(HullError::Kind)
        }
    }
}

/// Returns the eight vertices of a cuboid.
pub(super) fn corners(half: Vector) -> [Vector; 8] {
    let side = |k: usize, bit: usize, x: Real| if k & bit == 0 { -x } else { x };
    std::array::from_fn(|k| Vector::new(side(k, 1, half.x), side(k, 2, half.y), side(k, 4, half.z)))
}

fn outward(p: &Point3<f64>, round: impl Fn(f64) -> Real) -> Vector {
    Vector::new(round(p.x), round(p.y), round(p.z))
}

/// Returns the polyhedron without border, with vertices in the engine's precision and the body's
/// order and with faces as fans.
fn twin(body: &ConvexPolyhedron) -> Option<shape::RoundConvexPolyhedron> {
    let points: Vec<Vector> = body.vertex_points().map(|p| narrow(&p.coords)).collect();
    let mut triangles = Vec::new();
    for face in body.faces() {
        let rim: Vec<u32> = body.face_vertices(face).map(|v| v.index() as u32).collect();
        triangles.extend((2..rim.len()).map(|k| [rim[0], rim[k - 1], rim[k]]));
    }
    // The two sides of a polygon are not a polyhedron for parry.
    if body.face_count() < 4 || !points.iter().all(|p| p.is_finite()) {
        return None;
    }
    let twin = shape::ConvexPolyhedron::from_convex_mesh(points, &triangles)?;
    let has_faces = !twin.faces().is_empty();
    has_faces.then_some(shape::RoundShape {
        inner_shape: twin,
        border_radius: 0.0,
    })
}

fn conversion(body: &ConvexPolyhedron, has_parry_equivalent: bool) -> Conversion {
    let mut report = Conversion {
        has_parry_equivalent,
        ..Conversion::default()
    };
    for p in body.vertex_points() {
        let shift = (wide_point(narrow(&p.coords)) - p).norm();
        report.rounded += usize::from(shift != 0.0);
        report.shift = report.shift.max(shift);
    }
    report
}
