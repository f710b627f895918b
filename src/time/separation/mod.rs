//! Pairs of shapes that can be measured at a pose, and bounded over time.
//!
//! [`Separation`] is a pair of shapes of any two kinds that can be measured at a relative pose;
//! [`impact`](crate::impact) needs nothing else. A pair of convex shapes implements
//! [`ball`](Separation::ball), [`measure`](Separation::measure), [`meets`](Separation::meets) and
//! [`support`](Separation::support). The default of [`free_for`](Separation::free_for) then makes
//! one step by a plane that rotates (`separation/plane.rs`). Meshes and compounds need not be
//! separated by a plane, so their pairs implement `free_for` by another bound and need no
//! `support`.
//!
//! Trackers make such pairs: [`PairTracker::pair`](crate::PairTracker::pair) for any two
//! geometries, [`Tracker::pair`](crate::Tracker::pair) for two polyhedra.

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
/// Lengths are in the caller's unit, points and directions in the frames of their shapes. Every
/// bound includes the rounding of the computation. A cache changes the time of a query, never the
/// truth of its result.
pub trait Separation {
    /// Returns a ball that contains a shape: the centre, in the frame of the shape, and the radius.
    fn ball(&self, of: Operand) -> (Point3<f64>, f64);

    /// Returns a ball that contains the part of a shape that the other shape can meet during a
    /// motion, until [`free_for`](Self::free_for) ends.
    ///
    /// The centre is that of [`ball`](Self::ball). The default is this ball. A half-space is in no
    /// ball, but a step needs only a part of it.
    fn ball_during(&self, of: Operand, flight: &PairMotion) -> (Point3<f64>, f64) {
        let _ = flight;
        self.ball(of)
    }

    /// Returns the closest points at a pose.
    ///
    /// For an overlap only the contact state matters; the depth need not be computed.
    fn measure(&mut self, a_from_b: &RelativePose) -> Measurement;

    /// Returns whether the shapes are proven to be at most `distance` apart at a pose; false
    /// without a proof.
    ///
    /// `seen` is the last measurement, from a nearby pose.
    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, seen: &Measurement) -> bool;

    /// Returns an upper bound of a shape's support value along a direction, in the frame of the
    /// shape.
    ///
    /// The direction may have any length. The bound holds for `direction . (x - c)` over all points
    /// `x`, where `c` is the centre of the [`ball`](Self::ball). The default is the support value
    /// of the ball: valid, but not tight.
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

    /// Returns how long the shapes are proven to stay more than `flight.required` apart: one step.
    ///
    /// The time counts from the pose at which `seen` was measured. The default is a separating
    /// plane that rotates with the closest features, bounded over both shapes by
    /// [`support`](Self::support).
    fn free_for(&mut self, seen: &Measurement, flight: &PairMotion) -> FreeSpan {
        plane::free_for(self, seen, flight)
    }
}

/// The closest points of a pair at a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Measurement {
    /// Contact state of the two shapes.
    pub state: ContactState,
    /// The best estimate of the distance; zero or negative if the shapes touch or overlap.
    pub distance: f64,
    /// Lower bound of the distance.
    #[cfg_attr(feature = "serde", serde(with = "crate::base::num::scalar::infinite"))]
    pub lower: f64,
    /// Upper bound of the distance.
    pub upper: f64,
    /// The closest features, for shapes with named features.
    pub features: Option<FeaturePair>,
    /// The piece or triangle of A and of B to which the features belong; zero for a shape of one
    /// piece.
    pub subshapes: [u32; 2],
    /// The witness on A, in A's frame.
    pub point_on_a: Point3<f64>,
    /// The witness on B, in B's frame.
    pub point_on_b: Point3<f64>,
    /// Unit direction from A to B, in A's frame.
    pub normal: Unit<Vector3<f64>>,
    /// The rotation of the closest direction as the shapes move.
    pub tangent: Tangent,
    /// Whether the supporting planes perpendicular to exactly this `normal` prove the shapes
    /// `lower` apart.
    pub by_plane: bool,
}

/// First-order rotation of the closest direction as the shapes rotate.
///
/// A wrong value cannot make a proof wrong; a good one makes each step longer.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Tangent {
    /// Depends on the points more than on the rotation of the shapes: two vertices, or curved
    /// shapes.
    #[default]
    Free,
    /// Rotates with A: a face of A, or an edge of A and a vertex of B.
    WithA,
    /// Rotates with B: a face of B, or a vertex of A and an edge of B.
    WithB,
    /// Perpendicular to an edge of A and an edge of B: the directions of the edges, each in the
    /// frame of the shape.
    Edges(Vector3<f64>, Vector3<f64>),
}

/// A support point and the proven support value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportPoint {
    /// Upper bound of the shape's support value along the direction, from the ball's centre.
    pub height: f64,
    /// A point with about this support value, minus the centre of the ball. A wrong point cannot
    /// make a proof wrong.
    pub point: Vector3<f64>,
}

/// The motions of both bodies from one time on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairMotion {
    /// Pose of A at this time; the rotation is of unit length up to rounding.
    pub pose_a: Isometry3<f64>,
    /// Pose of B at this time; the rotation is of unit length up to rounding.
    pub pose_b: Isometry3<f64>,
    /// Velocities and bounds of A from this time on, for at least `span`.
    pub model_a: MotionModel,
    /// Velocities and bounds of B from this time on, for at least `span`.
    pub model_b: MotionModel,
    /// Duration that the query needs.
    pub span: f64,
    /// Distance that the shapes must exceed: zero or more.
    pub required: f64,
}

/// The time for which a pair is proven separated, and the proof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeSpan {
    /// Duration from the time of the measurement: at most the span of the motion.
    pub span: f64,
    /// The proof.
    pub proof: Proof,
}

/// Proof that a pair has no contact over an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Proof {
    /// The balls around the pivots stay separated; they contain the shapes at every rotation.
    Balls,
    /// A plane stays between the shapes.
    ///
    /// At `s` after the start the normal of the plane is `normal`, rotated by `spin * s` (a
    /// rotation vector), both in the world.
    Plane {
        /// Direction from A to B at the start.
        normal: Vector3<f64>,
        /// Axis times radians per unit of time.
        spin: Vector3<f64>,
    },
    /// Another bound, which the pair computes itself.
    Own,
}

impl PairMotion {
    /// Returns whether both models are known; otherwise nothing is proven about them.
    #[inline]
    pub(crate) fn is_known(&self) -> bool {
        self.model_a.is_known() && self.model_b.is_known()
    }

    /// Returns the motion on a clock that suits its span, and the unit of this clock.
    ///
    /// The unit is a power of two. The span on this clock is at least one and less than two.
    ///
    /// On this clock, rates are displacements and angles of the whole motion. So the underflow of
    /// squares and cubes of rates is negligible compared with the rounding of the pair size.
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

    /// Returns the time after which the witnesses are nearer by `way`, to second order; `None` if
    /// never.
    ///
    /// This is an expectation, not a bound.
    #[must_use]
    pub fn forecast<S: Separation + ?Sized>(&self, pair: &S, seen: &Measurement, way: f64) -> Option<f64> {
        plane::forecast(pair, seen, self, way)
    }

    /// Returns how long the balls of a pair stay more than `keep` apart, at every rotation of the
    /// shapes.
    ///
    /// Also returns the effect of rounding on a distance.
    pub(crate) fn apart<S: Separation + ?Sized>(&self, pair: &S) -> balls::Apart {
        balls::apart(pair, self)
    }

    /// Returns the time during which no point of A, seen from B, moves by as much as `way`.
    pub(crate) fn held<S: Separation + ?Sized>(&self, pair: &S, way: f64) -> f64 {
        balls::held(pair, self, way)
    }
}

impl Measurement {
    /// Returns the measurement of an outcome of two polyhedra.
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
    /// Returns the measurement of geometries that no plane separates.
    fn from(answer: &PairOutcome) -> Self {
        Self {
            subshapes: answer.parts(),
            by_plane: false,
            ..Self::new(&answer.outcome, Tangent::Free)
        }
    }
}
