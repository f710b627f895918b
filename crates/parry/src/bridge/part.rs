//! Shapes of parry as a core and a radius, for the dispatcher.

use std::ops::Deref;
use std::sync::Arc;

use lin_canny::nalgebra::{Isometry3, UnitQuaternion, Vector3};
use lin_canny::{ConvexPolyhedron, Geometry, Shape};

use super::far::are_balls_far;
use super::hull::{Hull, Solid, corners};
use super::known::Known;
use super::mesh_shape::mesh;
use super::parry::bounding_volume::BoundingSphere;
use super::parry::math::{Pose, Real, Vector};
use super::parry::shape;

/// A rounded polyhedron, polygon, segment or point: all points at most `radius` from the core.
pub(super) struct Part<'a> {
    pub(super) core: Core<'a>,
    pub(super) radius: f64,
}

/// A hull of the caller, or one that is made from a shape of parry.
pub(super) enum Core<'a> {
    Given(&'a Solid),
    Made(Arc<Solid>),
}

impl Deref for Core<'_> {
    type Target = Solid;

    fn deref(&self) -> &Solid {
        match self {
            Self::Given(solid) => solid,
            Self::Made(solid) => solid,
        }
    }
}

/// The kinds that decide for which pairs parry's manifold is a closed form.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Ball,
    Cuboid,
    /// Every other rounded polyhedron.
    Polyhedron,
}

/// Returns whether parry's manifold of a pair of kinds is a closed form that is right at every
/// size.
///
/// parry's code for two cuboids, two capsules, and a ball and a capsule compares lengths with
/// absolute numbers.
fn is_closed_form(a: Kind, b: Kind) -> bool {
    use Kind::{Ball, Cuboid};
    matches!((a, b), (Ball, Ball | Cuboid) | (Cuboid, Ball))
}

/// Returns whether two shapes are balls, for which all queries of parry are closed forms.
fn are_balls(a: &dyn shape::Shape, b: &dyn shape::Shape) -> bool {
    a.as_ball().is_some() && b.as_ball().is_some()
}

/// Returns whether parry's test of a pair is a closed form that is right at every size: the
/// distance of a ball's centre from a cuboid.
pub(super) fn has_closed_test(a: &dyn shape::Shape, b: &dyn shape::Shape) -> bool {
    let is_pair = |a: &dyn shape::Shape, b: &dyn shape::Shape| a.as_ball().is_some() && b.as_cuboid().is_some();
    is_pair(a, b) || is_pair(b, a)
}

fn kind(shape: &dyn shape::Shape) -> Option<Kind> {
    use shape::ShapeType::{
        Ball, Capsule, ConvexPolyhedron, Cuboid, Custom, RoundConvexPolyhedron, RoundCuboid, RoundTriangle, Segment,
        Triangle,
    };
    match shape.shape_type() {
        Ball => Some(Kind::Ball),
        Cuboid => Some(Kind::Cuboid),
        Capsule | ConvexPolyhedron | RoundConvexPolyhedron | RoundCuboid | RoundTriangle | Segment | Triangle => {
            Some(Kind::Polyhedron)
        }
        Custom => shape.as_shape::<Hull>().map(|_| Kind::Polyhedron),
        _ => None,
    }
}

/// Returns two shapes as rounded polyhedra; `None` if one is not or parry has a closed form.
pub(super) fn pair<'a>(
    known: &Known,
    a: &'a dyn shape::Shape,
    b: &'a dyn shape::Shape,
) -> Option<(Part<'a>, Part<'a>)> {
    let (k, l) = (kind(a)?, kind(b)?);
    if is_closed_form(k, l) {
        return None;
    }
    Some((part(known, a)?, part(known, b)?))
}

/// Returns a shape as a rounded polyhedron.
fn part<'a>(known: &Known, shape: &'a dyn shape::Shape) -> Option<Part<'a>> {
    if let Some(hull) = shape.as_shape::<Hull>() {
        let core = Core::Given(&hull.core);
        let radius = f64::from(hull.border_radius);
        return Some(Part { core, radius });
    }
    let made = |points: &[Vector], radius: Real| {
        let core = Core::Made(known.solid(points)?);
        let radius = f64::from(radius);
        (radius >= 0.0).then_some(Part { core, radius })
    };
    if let Some(polyhedron) = shape.as_convex_polyhedron() {
        made(polyhedron.points(), 0.0)
    } else if let Some(cuboid) = shape.as_cuboid() {
        made(&corners(cuboid.half_extents), 0.0)
    } else if let Some(ball) = shape.as_ball() {
        made(&[Vector::ZERO], ball.radius)
    } else if let Some(capsule) = shape.as_capsule() {
        made(&[capsule.segment.a, capsule.segment.b], capsule.radius)
    } else if let Some(round) = shape.as_round_cuboid() {
        made(&corners(round.inner_shape.half_extents), round.border_radius)
    } else if let Some(round) = shape.as_round_convex_polyhedron() {
        made(round.inner_shape.points(), round.border_radius)
    } else if let Some(triangle) = shape.as_triangle() {
        made(&triangle.vertices()[..], 0.0)
    } else if let Some(round) = shape.as_round_triangle() {
        made(&round.inner_shape.vertices()[..], round.border_radius)
    } else if let Some(segment) = shape.as_segment() {
        made(&[segment.a, segment.b], 0.0)
    } else {
        None
    }
}

/// A shape of [`lin_canny`] at its pose in the frame of the shape of parry.
pub(super) struct Placed {
    pub(super) shape: Geometry,
    pub(super) at: Isometry3<f64>,
}

impl Part<'_> {
    pub(super) fn body(&self) -> &ConvexPolyhedron {
        &self.core.body
    }

    /// Returns whether balls around two shapes are farther apart than a distance.
    pub(super) fn is_far(&self, other: &Part, pos12: &Pose, distance: Real) -> bool {
        let ball = |part: &Part| {
            let BoundingSphere { center, radius } = part.core.ball;
            BoundingSphere::new(center, radius + part.radius as Real)
        };
        are_balls_far(pos12, (&ball(self), &ball(other)), distance)
    }

    fn placed(&self) -> Option<Placed> {
        let shape = Shape::from(self.core.body.clone()).rounded(self.radius).ok()?;
        let (shape, at) = (shape.into(), Isometry3::identity());
        Some(Placed { shape, at })
    }
}

impl Placed {
    /// Returns the shape if it is convex.
    pub(super) fn convex(&self) -> Option<Shape> {
        self.shape.as_convex().map(|shape| shape.into_owned())
    }

    pub(super) fn is_convex(&self) -> bool {
        !matches!(self.shape, Geometry::Mesh(_))
    }
}

/// Returns two shapes as shapes of [`lin_canny`]; `None` if it lacks a kind, and for two balls.
pub(super) fn placed(known: &Known, a: &dyn shape::Shape, b: &dyn shape::Shape) -> Option<(Placed, Placed)> {
    if are_balls(a, b) {
        return None;
    }
    both(known, a, b)
}

/// Returns two shapes as shapes of [`lin_canny`]; `None` if it lacks a kind.
pub(super) fn both(known: &Known, a: &dyn shape::Shape, b: &dyn shape::Shape) -> Option<(Placed, Placed)> {
    Some((one(known, a)?, one(known, b)?))
}

/// Returns a shape as a shape of [`lin_canny`].
pub(super) fn one(known: &Known, shape: &dyn shape::Shape) -> Option<Placed> {
    if let Some(mesh) = mesh(shape) {
        let (shape, at) = (mesh.geometry.clone(), Isometry3::identity());
        return Some(Placed { shape, at });
    }
    match curved(shape) {
        Some(placed) => Some(placed),
        None => part(known, shape)?.placed(),
    }
}

/// Returns whether a shape is a cylinder or cone, rounded or not.
pub(super) fn is_curved(shape: &dyn shape::Shape) -> bool {
    use shape::ShapeType::{Cone, Cylinder, RoundCone, RoundCylinder};
    matches!(shape.shape_type(), Cylinder | Cone | RoundCylinder | RoundCone)
}

/// Returns a cylinder or cone, whose axis is y in parry and z in [`lin_canny`].
fn curved(shape: &dyn shape::Shape) -> Option<Placed> {
    let shape = if let Some(c) = shape.as_cylinder() {
        Shape::cylinder(f64::from(c.half_height), f64::from(c.radius))
    } else if let Some(c) = shape.as_round_cylinder() {
        let (core, by) = (&c.inner_shape, f64::from(c.border_radius));
        Shape::cylinder(f64::from(core.half_height), f64::from(core.radius)).and_then(|s| s.rounded(by))
    } else if let Some(c) = shape.as_cone() {
        Shape::cone(f64::from(c.half_height), f64::from(c.radius))
    } else if let Some(c) = shape.as_round_cone() {
        let (core, by) = (&c.inner_shape, f64::from(c.border_radius));
        Shape::cone(f64::from(core.half_height), f64::from(core.radius)).and_then(|s| s.rounded(by))
    } else {
        return None;
    };
    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -std::f64::consts::FRAC_PI_2);
    let at = Isometry3::from_parts(Vector3::zeros().into(), turn);
    let shape = shape.ok()?.into();
    Some(Placed { shape, at })
}

/// Returns a hull or convex polyhedron, rounded or not; `None` for other shapes.
pub(super) fn polyhedron<'a>(known: &Known, shape: &'a dyn shape::Shape) -> Option<Part<'a>> {
    (kind(shape)? == Kind::Polyhedron).then(|| part(known, shape))?
}
