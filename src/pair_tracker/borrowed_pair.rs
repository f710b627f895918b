//! Two geometries with a borrowed tracker: the queries that every pair answers, at one pose and
//! over time.

use alloc::string::String;

use nalgebra::{Point3, Unit, Vector3};

use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use crate::base::pose::{Operand, RelativePose};
use crate::body::polyhedron::{ConvexPolyhedron, FeaturePair};
use crate::convex::contact::{Manifold, ManifoldOptions};
use crate::convex::replay::Replay;
use crate::convex::tracker::Tracker;
use crate::half_space::HalfSpacePair;
#[cfg(feature = "meshes")]
use crate::nonconvex::separation::{CompoundPair, MeshPair};
use crate::pair::draft::far;
use crate::pair::location::PairOutcome;
use crate::pair::options::QueryOptions;
use crate::pair::outcome::{Accuracy, ContactState, Decision, Outcome};
use crate::pair_tracker::geometry::GeometryRef;
#[cfg(feature = "surfaces")]
use crate::surface::{SurfaceCompoundTracker, SurfacePair, SurfaceShapeTracker, SurfaceSolidPair};
use crate::time::separation::{
    FreeSpan, Measurement, PairMotion, PolyhedronPair, Proof, Separation, ShapePair, SupportPoint,
};

/// Two geometries, or their converted copies, and the tracker of their
/// [`Engine`](super::engine::Engine), which has the same variants.
#[derive(Debug)]
pub(crate) enum BorrowedPair<'p> {
    Polyhedra(PolyhedronPair<'p>),
    Shapes(ShapePair<'p>),
    HalfSpace(HalfSpacePair<'p>),
    #[cfg(feature = "meshes")]
    Pieces(CompoundPair<'p>),
    #[cfg(feature = "meshes")]
    Meshes(MeshPair<'p>),
    #[cfg(feature = "surfaces")]
    Surfaces(SurfacePair<'p>),
    #[cfg(feature = "surfaces")]
    SurfaceAndShape(SurfaceSolidPair<'p, SurfaceShapeTracker>),
    #[cfg(feature = "surfaces")]
    SurfaceAndPieces(SurfaceSolidPair<'p, SurfaceCompoundTracker>),
    /// Geometries that no tracker measures.
    Balls(BallPair),
}

/// Calls a method of the pair of any kind.
macro_rules! each {
    ($all:expr, $pair:ident => $asked:expr) => {
        match $all {
            BorrowedPair::Polyhedra($pair) => $asked,
            BorrowedPair::Shapes($pair) => $asked,
            BorrowedPair::HalfSpace($pair) => $asked,
            #[cfg(feature = "meshes")]
            BorrowedPair::Pieces($pair) => $asked,
            #[cfg(feature = "meshes")]
            BorrowedPair::Meshes($pair) => $asked,
            #[cfg(feature = "surfaces")]
            BorrowedPair::Surfaces($pair) => $asked,
            #[cfg(feature = "surfaces")]
            BorrowedPair::SurfaceAndShape($pair) => $asked,
            #[cfg(feature = "surfaces")]
            BorrowedPair::SurfaceAndPieces($pair) => $asked,
            BorrowedPair::Balls($pair) => $asked,
        }
    };
}

impl<'p> BorrowedPair<'p> {
    /// Returns the closest points with bounds of the signed distance.
    #[inline]
    pub(crate) fn closest_with(&mut self, pose: &RelativePose, question: &QueryOptions) -> PairOutcome {
        each!(self, pair => pair.closest_with(pose, question))
    }

    /// Returns whether the geometries are at most `d` apart.
    #[inline]
    pub(crate) fn decide_within(&mut self, pose: &RelativePose, d: f64, question: &QueryOptions) -> Decision {
        each!(self, pair => pair.decide_within(pose, d, question))
    }

    /// Returns whether the geometries are at most `d` apart, from the outcome of the last query.
    ///
    /// True if this is undecided.
    pub(crate) fn decides_within(&mut self, pose: &RelativePose, outcome: &Outcome, d: f64) -> bool {
        if outcome.state == ContactState::Overlapping || outcome.upper <= d {
            true
        } else if outcome.lower > d {
            false
        } else if let Self::Polyhedra(pair) = self {
            let (a, b, tracker) = pair.sides();
            tracker.decides_within(a, b, pose, outcome, d)
        } else {
            !self.decide_within(pose, d, &QueryOptions::default()).is_no()
        }
    }

    /// Returns the cheapest available lower bound of the distance.
    pub(super) fn lower_bound(&mut self, pose: &RelativePose) -> f64 {
        match self {
            #[cfg(feature = "meshes")]
            Self::Pieces(pair) => pair.tracker.lower_bound(&pair.a, &pair.b, pose),
            #[cfg(feature = "meshes")]
            Self::Meshes(pair) => pair.tracker.lower_bound(pair.a, pair.b, pose),
            _ => self.closest_with(pose, &QueryOptions::default()).lower.at_least(0.0),
        }
    }

    /// Computes the manifold of two convex bodies; returns whether both are convex.
    pub(super) fn manifold(&mut self, pose: &RelativePose, options: &ManifoldOptions, manifold: &mut Manifold) -> bool {
        match self {
            Self::Polyhedra(pair) => {
                let (a, b, tracker) = pair.sides();
                tracker.manifold(a, b, pose, options, manifold);
            }
            Self::Shapes(pair) => {
                let (a, b, tracker) = pair.sides();
                tracker.manifold(a, b, pose, options, manifold);
            }
            _ => return false,
        }
        true
    }

    /// Returns a query of two polyhedra, rounded or not, as a text.
    pub(super) fn replay(&mut self, pose: &RelativePose) -> Option<Replay> {
        match self {
            Self::Polyhedra(pair) => {
                let (a, b, tracker) = pair.sides();
                Some(tracker.replay(a, b, pose, Accuracy::Certified))
            }
            Self::Shapes(pair) => {
                let (a, b, tracker) = pair.sides();
                tracker.replay(a, b, pose)
            }
            _ => None,
        }
    }

    /// Returns the first broken invariant of the cached state.
    pub(super) fn check(&mut self, pose: &RelativePose) -> Result<(), String> {
        // Only a front of meshes uses the pose.
        let _ = pose;
        match self {
            Self::Polyhedra(pair) => pair.sides().2.check(),
            #[cfg(feature = "meshes")]
            Self::Meshes(pair) => {
                let checked = pair.tracker.audit(pair.a, pair.b, pose);
                checked.map_err(|fault| alloc::format!("{fault}"))
            }
            _ => Ok(()),
        }
    }

    /// Returns the pair for queries over time.
    pub(crate) fn over_time(self) -> MovingPair<'p> {
        MovingPair(match self {
            Self::Shapes(pair) => Self::Shapes(pair.with_balls()),
            _ => self,
        })
    }
}

/// Two geometries that can be measured over time, with a borrowed tracker: what
/// [`impact`](crate::impact) takes.
#[derive(Debug)]
pub struct MovingPair<'p>(BorrowedPair<'p>);

impl Separation for MovingPair<'_> {
    #[inline]
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        each!(&self.0, pair => pair.ball(of))
    }

    #[inline]
    fn ball_during(&self, of: Operand, flight: &PairMotion) -> (Point3<f64>, f64) {
        each!(&self.0, pair => pair.ball_during(of, flight))
    }

    #[inline]
    fn measure(&mut self, a_from_b: &RelativePose) -> Measurement {
        each!(&mut self.0, pair => pair.measure(a_from_b))
    }

    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, seen: &Measurement) -> bool {
        each!(&mut self.0, pair => pair.meets(a_from_b, distance, seen))
    }

    fn support(&mut self, of: Operand, direction: &Vector3<f64>) -> SupportPoint {
        each!(&mut self.0, pair => pair.support(of, direction))
    }

    fn free_for(&mut self, seen: &Measurement, flight: &PairMotion) -> FreeSpan {
        each!(&mut self.0, pair => pair.free_for(seen, flight))
    }
}

impl Tracker {
    /// Returns two polyhedra that can be measured over time with this tracker.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::separation::Separation;
    /// use lin_canny::{RelativePose, Tracker, polyhedron::solids};
    ///
    /// let a = solids::cuboid(Vector3::new(1.0, 1.0, 1.0))?;
    /// let b = solids::octahedron(0.5)?;
    /// let mut tracker = Tracker::new();
    /// let mut pair = tracker.pair(&a, &b);
    /// let pose = Isometry3::translation(3.0, 0.0, 0.0);
    /// let seen = pair.measure(&RelativePose::from_isometry(&pose)?);
    /// assert!(seen.lower <= 1.5 && 1.5 <= seen.upper);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn pair<'p>(&'p mut self, a: &'p ConvexPolyhedron, b: &'p ConvexPolyhedron) -> MovingPair<'p> {
        MovingPair(BorrowedPair::Polyhedra(PolyhedronPair::new(a, b, self)))
    }
}

/// Two geometries that no tracker measures: only balls around them are known.
#[derive(Debug)]
pub(crate) struct BallPair {
    balls: [(Point3<f64>, f64); 2],
}

impl BallPair {
    pub(super) fn new(bodies: [GeometryRef<'_>; 2]) -> Self {
        Self {
            balls: bodies.each(GeometryRef::bounding_ball),
        }
    }

    fn closest_with(&self, pose: &RelativePose, _: &QueryOptions) -> PairOutcome {
        let reach = self.balls.each(|(centre, radius)| centre.coords.norm() + radius);
        let (lower, upper, normal) = far(reach, pose);
        PairOutcome {
            is_converged: false,
            ..PairOutcome::of_convex(Outcome {
                state: if lower > 0.0 {
                    ContactState::Separated
                } else {
                    ContactState::Undecided
                },
                distance: 0.5 * lower + 0.5 * upper,
                lower,
                upper,
                point_on_a: self.balls[0].0,
                point_on_b: self.balls[1].0,
                normal: Unit::new_unchecked(normal),
                ..Outcome::starting_at(FeaturePair::FIRST)
            })
        }
    }

    fn decide_within(&self, pose: &RelativePose, d: f64, question: &QueryOptions) -> Decision {
        let found = self.closest_with(pose, question);
        if d >= 0.0 {
            Decision::by(found.lower, found.upper, d)
        } else {
            Decision::No
        }
    }
}

impl Separation for BallPair {
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        self.balls[usize::from(of == Operand::B)]
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measurement {
        Measurement::from(&self.closest_with(a_from_b, &QueryOptions::default()))
    }

    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measurement) -> bool {
        self.closest_with(a_from_b, &QueryOptions::default()).upper <= distance
    }

    fn free_for(&mut self, seen: &Measurement, flight: &PairMotion) -> FreeSpan {
        let way = seen.lower - flight.required - flight.apart(self).noise;
        FreeSpan {
            span: flight.held(self, way),
            proof: Proof::Own,
        }
    }
}
