//! Pairs of shapes that can be measured at a pose and bounded over time.
//!
//! [`Separation`] is a pair of shapes, of any two kinds, that can be measured at a relative pose.
//! [`impact`](crate::impact) needs nothing more. A pair of convex shapes implements
//! [`ball`](Separation::ball), [`measure`](Separation::measure), [`meets`](Separation::meets) and
//! [`support`](Separation::support), and gets [`free_for`](Separation::free_for), one look ahead,
//! from a plane that turns (`separation/plane.rs`). A pair of shapes that no plane need separate
//! (meshes, compounds) implements `free_for` by another bound, and needs no `support`.
//!
//! Trackers make such pairs: [`PairTracker::pair`](crate::PairTracker::pair) of any two geometries,
//! [`Tracker::pair`](crate::Tracker::pair) of two polyhedra.

pub(crate) mod balls;
pub(crate) mod bernstein;
mod fixed_normal;
pub(crate) mod pairs;
pub(crate) mod plane;

use nalgebra::{Isometry3, Point3, Unit, Vector3};

use crate::base::motion::MotionModel;
use crate::base::num::scalar::magnitude;
use crate::base::pose::{Operand, RelativePose};
use crate::body::polyhedron::FeaturePair;
use crate::pair::location::PairOutcome;
use crate::pair::outcome::{ContactState, Outcome, Solver};

pub(crate) use pairs::PolyhedronPair;
pub(crate) use pairs::ShapePair;

/// Two shapes that can be measured against each other, and bounded over time.
///
/// Lengths are in the caller's units, points and directions in the frames of their shapes. Every
/// bound includes the rounding of the computation. A cache changes the time of an answer, never the
/// truth.
pub trait Separation {
    /// Returns a ball that contains a shape: centre, in the frame of the shape, and radius.
    fn ball(&self, of: Operand) -> (Point3<f64>, f64);

    /// Returns the closest points at a pose. Of an overlap only the contact state counts; the depth
    /// need not be found.
    fn measure(&mut self, a_from_b: &RelativePose) -> Measurement;

    /// Returns whether the shapes are proven to be at most `distance` apart at a pose; false
    /// without a proof. `seen` is the last measure, taken nearby.
    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, seen: &Measurement) -> bool;

    /// Returns the height of a shape along a direction of any length, in the frame of the shape: an
    /// upper bound of `direction . (x - c)` over all points `x`, with `c` the centre of the
    /// [`ball`](Self::ball). The default is the height of the ball: sound, and loose.
    fn support(&mut self, of: Operand, direction: &Vector3<f64>) -> SupportPoint {
        let (_, radius) = self.ball(of);
        let length = direction.norm();
        let point = if length > 0.0 {
            direction * (radius / length)
        } else {
            Vector3::zeros()
        };
        SupportPoint {
            height: radius * length * (1.0 + 16.0 * crate::base::tolerance::UNIT),
            point,
        }
    }

    /// Returns the time for which the shapes are proven to stay more than `flight.keep` apart: one
    /// look ahead from the pose at which `seen` was measured. The default is a separating plane
    /// that turns with the closest features, bounded over both shapes by
    /// [`support`](Self::support).
    fn free_for(&mut self, seen: &Measurement, flight: &PairMotion) -> FreeSpan {
        plane::free_for(self, seen, flight)
    }
}

/// The closest points of a pair at a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Measurement {
    /// Whether the shapes are apart, touch or overlap.
    pub state: ContactState,
    /// The best estimate of the distance; zero or less if the shapes touch or overlap.
    pub distance: f64,
    /// Lower bound of the distance.
    #[cfg_attr(feature = "serde", serde(with = "crate::base::num::scalar::infinite"))]
    pub lower: f64,
    /// Upper bound of the distance.
    pub upper: f64,
    /// The closest features, for shapes with named features.
    pub features: Option<FeaturePair>,
    /// The piece or triangle of A and of B to which the features belong; zero for shapes of one
    /// piece.
    pub subshapes: [u32; 2],
    /// The witness on A, in A's frame.
    pub point_on_a: Point3<f64>,
    /// The witness on B, in B's frame.
    pub point_on_b: Point3<f64>,
    /// Unit direction from A to B, in A's frame.
    pub normal: Unit<Vector3<f64>>,
    /// The turn of the direction as the shapes move.
    pub tangent: Tangent,
    /// Whether the supporting planes perpendicular to this very `normal` prove the shapes `lower`
    /// apart.
    pub by_plane: bool,
}

/// The turn of the closest direction of a pair as the shapes turn, to first order. Not a matter of
/// soundness: the right tangent makes a look reach farther.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Tangent {
    /// Depends on the points more than on the turns of the shapes: two vertices, or curved shapes.
    #[default]
    FreeSpan,
    /// With A: a face of A, or an edge of A and a vertex of B.
    WithA,
    /// With B: a face of B, or a vertex of A and an edge of B.
    WithB,
    /// Perpendicular to an edge of A and an edge of B: the directions of the edges, each in the
    /// frame of the shape.
    Edges(Vector3<f64>, Vector3<f64>),
}

/// A support point and the proven height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportPoint {
    /// Upper bound of the height of the whole shape along the direction, from the centre of the
    /// ball.
    pub height: f64,
    /// A point of about this height, less the centre of the ball. Not a matter of soundness.
    pub point: Vector3<f64>,
}

/// Both motions from one instant on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairMotion {
    /// Poses at the instant.
    pub pose_a: Isometry3<f64>,
    /// Pose of B at the instant.
    pub pose_b: Isometry3<f64>,
    /// Velocities and bounds of A from the instant on, for at least `span`.
    pub model_a: MotionModel,
    /// Velocities and bounds of B from the instant on, for at least `span`.
    pub model_b: MotionModel,
    /// How far ahead is of interest.
    pub span: f64,
    /// The distance to stay beyond: zero or more.
    pub keep: f64,
}

/// The time for which a pair is proven free, and the proof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeSpan {
    /// Time from the instant of the look on: at most the span of the flight.
    pub span: f64,
    /// The proof.
    pub proof: Proof,
}

/// Proof that a pair is free of contact over an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Proof {
    /// The balls about the pivots, which contain the shapes at every turn, stay apart.
    Balls,
    /// A plane stays between the shapes: at `s` after the instant the normal of the plane is
    /// `normal`, turned by `spin * s` (a rotation vector), both in the world.
    Plane {
        /// Direction from A to B at the instant.
        normal: Vector3<f64>,
        /// Axis times radians a unit of time.
        spin: Vector3<f64>,
    },
    /// Another bound, known to the pair.
    Own,
}

impl PairMotion {
    /// Returns whether both models are those of motions: else nothing is proven of them.
    #[inline]
    pub(crate) fn is_known(&self) -> bool {
        self.model_a.is_known() && self.model_b.is_known()
    }

    /// Returns the flight on a clock on which the span is at least one and less than two, and the
    /// unit of the clock, a power of two. On that clock rates are ways and angles of the whole
    /// flight: what squares and cubes of rates lose by underflow is nothing beside the rounding of
    /// the size of the pair.
    #[inline(always)]
    pub(crate) fn on_own_clock(&self) -> (Self, f64) {
        let unit = magnitude(self.span);
        let timed = Self {
            model_a: self.model_a.on_clock(unit),
            model_b: self.model_b.on_clock(unit),
            span: self.span / unit,
            ..*self
        };
        (timed, unit)
    }

    /// Returns the time in which the witnesses come nearer by `way`, to second order: an
    /// expectation, no bound. `None` if never.
    #[must_use]
    pub fn forecast<S: Separation + ?Sized>(&self, pair: &S, seen: &Measurement, way: f64) -> Option<f64> {
        plane::forecast(pair, seen, self, way)
    }

    /// Returns the time for which the balls of a pair stay more than `keep` apart at every turn of
    /// the shapes, and the effect of rounding on a distance.
    pub(crate) fn apart<S: Separation + ?Sized>(&self, pair: &S) -> balls::Apart {
        balls::apart(pair, self)
    }

    /// Returns the time in which no point of A, seen from B, moves by as much as `way`.
    pub(crate) fn held<S: Separation + ?Sized>(&self, pair: &S, way: f64) -> f64 {
        balls::held(pair, self, way)
    }
}

impl Measurement {
    /// Returns the measure of an outcome of two polyhedra.
    pub(crate) fn new(outcome: &Outcome, tangent: Tangent) -> Self {
        Self {
            state: outcome.state,
            distance: outcome.distance,
            lower: outcome.lower,
            upper: outcome.upper,
            features: Some(outcome.features),
            subshapes: [0; 2],
            point_on_a: outcome.point_on_a,
            point_on_b: outcome.point_on_b,
            normal: outcome.normal,
            tangent,
            by_plane: outcome.state == ContactState::Separated
                && matches!(outcome.solver, Solver::Walk | Solver::Restart),
        }
    }
}

impl From<&PairOutcome> for Measurement {
    /// Returns the measure of geometries that no plane keeps apart.
    fn from(answer: &PairOutcome) -> Self {
        Self {
            subshapes: answer.parts(),
            by_plane: false,
            ..Self::new(&answer.outcome, Tangent::FreeSpan)
        }
    }
}
