//! The seam between pairs of shapes and what is built on their distance over time.
//!
//! [`Separation`] is a pair of shapes, of any two kinds, that can be measured at a relative pose.
//! [`impact`](crate::impact) asks for nothing else. A pair of convex shapes implements
//! [`ball`](Separation::ball), [`measure`](Separation::measure), [`meets`](Separation::meets) and
//! [`support`](Separation::support), and gets [`free_for`](Separation::free_for), one look ahead,
//! from a plane that turns (`separation/plane.rs`). A pair without one plane between its shapes
//! (meshes, composites) answers `free_for` by means of its own, and needs no `support`.
//!
//! [`PolyhedronPair`] is the pair of two [`ConvexPolyhedron`](crate::ConvexPolyhedron)s and a
//! [`Tracker`](crate::Tracker); [`ShapePair`] is the pair of two [`Shape`](crate::Shape)s, rounded
//! or curved, and a [`ShapeTracker`](crate::ShapeTracker).

mod balls;
mod bernstein;
mod plane;
mod polyhedra;
mod shapes;

use nalgebra::{Isometry3, Point3, Unit, Vector3};

use crate::motion::Course;
use crate::pair::outcome::{Class, Outcome, Solver};
use crate::polyhedron::FeaturePair;
use crate::pose::{Operand, RelativePose};

pub use polyhedra::PolyhedronPair;
pub use shapes::ShapePair;

/// Two shapes that can be measured against each other, and bounded over time.
///
/// Lengths are in the caller's units, points and directions in the frames of their shapes. Every
/// bound includes the rounding of its own computation. What a pair caches changes the time of an
/// answer, never its truth.
pub trait Separation {
    /// Returns a ball that holds a shape: its centre in the shape's frame, and its radius.
    fn ball(&self, of: Operand) -> (Point3<f64>, f64);

    /// Returns the closest points at a pose. Of an overlap the class alone counts; its depth need
    /// not be found.
    fn measure(&mut self, a_from_b: &RelativePose) -> Measure;

    /// Returns whether the shapes are proven to be at most `distance` apart at a pose; false if
    /// that is not proven. `seen` is the last measure, taken nearby.
    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, seen: &Measure) -> bool;

    /// Returns the height of a shape along a direction of its frame, of any length: a bound, from
    /// above, of `direction . (x - c)` over all points `x`, `c` the centre of its
    /// [`ball`](Self::ball). If not implemented, the height of the ball: sound, and loose.
    fn support(&mut self, of: Operand, direction: &Vector3<f64>) -> Support {
        let (_, radius) = self.ball(of);
        let length = direction.norm();
        let point = if length > 0.0 {
            direction * (radius / length)
        } else {
            Vector3::zeros()
        };
        Support {
            height: radius * length * (1.0 + 16.0 * crate::tolerance::UNIT),
            point,
        }
    }

    /// Returns for how long the shapes are proven to stay more than `flight.keep` apart: one look
    /// ahead from the pose at which `seen` was measured. If not implemented, by a separating plane
    /// that turns as the closest features do, bounded over both shapes by their
    /// [`support`](Self::support).
    fn free_for(&mut self, seen: &Measure, flight: &Flight) -> Free {
        plane::free_for(self, seen, flight)
    }
}

/// What one look at a pair finds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Measure {
    /// Which side of contact the pair is on.
    pub class: Class,
    /// The best estimate of the distance; zero or less if the shapes touch or overlap.
    pub distance: f64,
    /// Lower bound of the distance.
    #[cfg_attr(feature = "serde", serde(with = "crate::num::scalar::infinite"))]
    pub lower: f64,
    /// Upper bound of the distance.
    pub upper: f64,
    /// The closest features, for shapes that name theirs.
    pub features: Option<FeaturePair>,
    /// Which piece or triangle of either shape they are of; zero for shapes of one piece.
    pub pieces: (u32, u32),
    /// The witness on A, in A's frame.
    pub point_on_a: Point3<f64>,
    /// The witness on B, in B's frame.
    pub point_on_b: Point3<f64>,
    /// Unit direction from A to B, in A's frame.
    pub normal: Unit<Vector3<f64>>,
    /// How the direction turns as the shapes move.
    pub tangent: Tangent,
    /// Whether the shapes are proven `lower` apart along this very `normal`, as they are by its
    /// supporting planes.
    pub by_plane: bool,
}

/// How the closest direction of a pair turns with its shapes, to first order. Not a matter of
/// soundness: a tangent that fits makes a look reach farther.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Tangent {
    /// It depends on the points more than on the shapes' turns: two vertices, or curved shapes.
    #[default]
    Free,
    /// With A: a face of A, or an edge of A and a vertex of B.
    WithA,
    /// With B: a face of B, or a vertex of A and an edge of B.
    WithB,
    /// Perpendicular to an edge of A and an edge of B, whose directions are given each in its own
    /// frame.
    Edges(Vector3<f64>, Vector3<f64>),
}

/// A support point and the height that it proves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Support {
    /// Upper bound of the height of the whole shape along the direction, from the centre of its
    /// ball.
    pub height: f64,
    /// A point of about that height, less the centre of the ball. Not a matter of soundness.
    pub point: Vector3<f64>,
}

/// Both motions from one instant on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// Poses at the instant.
    pub pose_a: Isometry3<f64>,
    /// Pose of B at the instant.
    pub pose_b: Isometry3<f64>,
    /// What A does from there on, for at least `span`.
    pub course_a: Course,
    /// What B does from there on, for at least `span`.
    pub course_b: Course,
    /// How far ahead is of interest.
    pub span: f64,
    /// The distance to stay beyond: zero or more.
    pub keep: f64,
}

/// For how long a pair is free, and why.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Free {
    /// From the instant of the look on: at most its span.
    pub span: f64,
    /// What proves it.
    pub proof: Proof,
}

/// Why a pair is free of contact over an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Proof {
    /// The balls about the pivots, which hold the shapes however they turn, stay apart.
    Balls,
    /// A plane stays between the shapes: at `s` after the instant its normal is `normal`, turned by
    /// `spin * s` (a rotation vector), both in the world.
    Plane {
        /// Direction from A to B at the instant.
        normal: Vector3<f64>,
        /// Axis times radians a unit of time.
        spin: Vector3<f64>,
    },
    /// By means of the pair's own.
    Own,
}

impl Flight {
    /// Returns how long the witnesses take to come nearer by `way`, to second order: an
    /// expectation, no bound. `None` if never.
    #[must_use]
    pub fn forecast<S: Separation + ?Sized>(&self, pair: &S, seen: &Measure, way: f64) -> Option<f64> {
        plane::forecast(pair, seen, self, way)
    }

    /// Returns for how long the balls of a pair stay more than `keep` apart, however the shapes
    /// turn; with it what rounding may make of a distance here.
    pub(crate) fn apart<S: Separation + ?Sized>(&self, pair: &S) -> balls::Apart {
        balls::apart(pair, self)
    }

    /// Returns for how long no point of a shape moves, seen from the other, by as much as `way`.
    pub(crate) fn held<S: Separation + ?Sized>(&self, pair: &S, way: f64) -> f64 {
        balls::held(pair, self, way)
    }
}

impl Measure {
    /// Takes over the outcome of a query of two polyhedra.
    pub(crate) fn new(outcome: &Outcome, tangent: Tangent) -> Self {
        Self {
            class: outcome.class,
            distance: outcome.distance,
            lower: outcome.lower,
            upper: outcome.upper,
            features: Some(outcome.features),
            pieces: (0, 0),
            point_on_a: outcome.point_on_a,
            point_on_b: outcome.point_on_b,
            normal: outcome.normal,
            tangent,
            by_plane: outcome.class == Class::Separated && matches!(outcome.solver, Solver::Walk | Solver::Restart),
        }
    }
}
