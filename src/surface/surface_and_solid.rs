//! A surface and a convex shape, and a surface and a compound, with a tracker for each piece: the
//! states of both pairs, their queries, and their motion over time.
//!
//! No plane separates surfaces that reach into each other's hollows. So an advancement step bounds
//! the displacement of all points, as for compounds (Mirtich 1996, conservative advancement).
//! Bodies that are proven `d` apart stay separated until their points, seen from each other, may
//! have moved by `d`. The width of a measurement is a fraction of the distance, so steps near
//! contact are as effective as steps far away. The number of steps grows with the logarithm of the
//! tolerance. The same holds for two surfaces (`two_surfaces`).

use alloc::vec::Vec;
use nalgebra::{Isometry3, Point3, Unit, Vector3};

use super::bezier_surface::{BezierSurface, SurfaceWork};
use super::gap::{NetFrame, SearchWork, Trees};
use super::search::{NetGoal, SPLITS, SurfaceMemory};
use super::solid::{Feet, ShapeNode};
use super::tree::{Grown, Nodes};
use super::two_surfaces::KEPT;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::pose::{Operand, RelativePose};
use crate::base::tolerance::{CERTIFICATE, ROUND_UP, SHAPE_POINT, SURFACE_POINT, UNIT};
use crate::body::polyhedron::{ConvexPolyhedron, Feature, VertexId};
use crate::body::shape::Shape;
use crate::convex::shape_tracker::ShapeTracker;
use crate::nonconvex::parts::{Parted, Placed};
use crate::nonconvex::pieces::{Compound, Piece};
use crate::nonconvex::separation::ball_about;
use crate::pair::draft::{far, unit};
use crate::pair::location::{PairOutcome, WitnessLocation, features_on};
use crate::pair::options::QueryOptions;
use crate::pair::outcome::{ContactState, Decision, Outcome};
use crate::time::separation::{FreeSpan, Measurement, PairMotion, Proof, Separation};

/// Width of a measurement over time, as a fraction of the distance. A step of conservative
/// advancement is shorter by this fraction.
pub(super) const MEASURED: f64 = 1.0 / 4.0;

/// Default width of the bounds, as a fraction of the sum of the radii of both bounding balls.
const DEFAULT_WIDTH: f64 = 1.0 / (1u64 << 30) as f64;

/// Least default width, as a fraction of the largest offset of the origins. The rounding of the
/// poses keeps the bounds of bodies far apart about `2^-42` of this distance apart; pairs of
/// surfaces at `1e4` to `1e16` radii reached `2^-39`.
const DEFAULT_WIDTH_FAR: f64 = 1.0 / (1u64 << 38) as f64;

/// If the bound of a step leaves unproven more than this fraction of the remaining distance, the
/// distance is measured again with a smaller width.
const NARROWER: f64 = 1.0 / 2.0;

/// A step gives up if its bound proves less than this fraction of the remaining distance. The
/// search for a narrower interval has then reached its limit, and each further step would cost as
/// much and prove less. Measured: no cast of the tests ends for this reason.
const HOPE: f64 = 0.125;

/// The tracker of a surface (A) and a body of another kind (B).
pub(crate) trait BesideSurface {
    /// The other body.
    type Body;

    /// Returns a ball that contains the other body: centre and radius.
    fn ball(body: &Self::Body) -> (Point3<f64>, f64);

    /// Returns the closest points with bounds as close as the goal requires.
    fn answer(&mut self, a: &BezierSurface, b: &Self::Body, a_from_b: &RelativePose, goal: NetGoal) -> PairOutcome;

    /// Sets the number of splits that a query may make; `None` for the default budget.
    fn allow(&mut self, splits: Option<usize>);
}

/// A surface and a convex shape or compound, in either order, that can be measured over time.
#[derive(Debug)]
pub(crate) struct SurfaceSolidPair<'a, T: BesideSurface> {
    pub(crate) surface: &'a BezierSurface,
    pub(crate) body: &'a T::Body,
    /// The operand that is the surface.
    pub(crate) order: Operand,
    pub(crate) tracker: &'a mut T,
}

impl<T: BesideSurface> SurfaceSolidPair<'_, T> {
    /// Returns the closest points, with bounds of the width that the options set.
    pub(crate) fn closest_with(&mut self, a_from_b: &RelativePose, question: &QueryOptions) -> PairOutcome {
        let width = width_of(self, a_from_b, question);
        self.tracker.allow(question.splits);
        self.answer(a_from_b, NetGoal::Width(width)).without_depth()
    }

    /// Returns whether the distance is at most `d`, within the budget that the options set.
    pub(crate) fn decide_within(&mut self, a_from_b: &RelativePose, d: f64, question: &QueryOptions) -> Decision {
        self.tracker.allow(question.splits);
        self.is_within(a_from_b, d)
    }

    /// Returns whether the distance is at most `d`. Undecided only if `d` is within rounding of the
    /// distance, or if a budget is used up. For a `d` of zero, pairs that merely touch are
    /// undecided.
    fn is_within(&mut self, a_from_b: &RelativePose, d: f64) -> Decision {
        if !(d >= 0.0) {
            return Decision::No;
        }
        let pose = from_surface(self.order, a_from_b);
        let found = self.tracker.answer(self.surface, self.body, &pose, NetGoal::Within(d));
        Decision::by(found.lower, found.upper, d)
    }

    fn answer(&mut self, a_from_b: &RelativePose, goal: NetGoal) -> PairOutcome {
        let pose = from_surface(self.order, a_from_b);
        let found = self.tracker.answer(self.surface, self.body, &pose, goal);
        if self.order == Operand::A {
            found
        } else {
            exchanged(found, &pose)
        }
    }
}

/// Returns the pose of the other body in the frame of the surface, which is A or B.
fn from_surface(order: Operand, a_from_b: &RelativePose) -> RelativePose {
    if order == Operand::A {
        *a_from_b
    } else {
        a_from_b.swapped()
    }
}

/// Returns an outcome of B and A as an outcome of A and B, from the pose of B and A.
fn exchanged(found: PairOutcome, pose: &RelativePose) -> PairOutcome {
    let normal = unit(&-pose.rotation().tr_mul(&found.normal));
    let o = found.outcome;
    PairOutcome {
        outcome: Outcome {
            features: o.features.swapped(),
            point_on_a: o.point_on_b,
            point_on_b: o.point_on_a,
            normal,
            ..o
        },
        locations: [found.locations[1], found.locations[0]],
        ..found
    }
}

/// Returns the width of the bounds that the options set, or the default width.
pub(super) fn width_of(pair: &impl Separation, pose: &RelativePose, options: &QueryOptions) -> f64 {
    let radius = |of| pair.ball(of).1;
    let default = || {
        let near = DEFAULT_WIDTH * (radius(Operand::A) + radius(Operand::B));
        near.larger(DEFAULT_WIDTH_FAR * pose.translation().amax())
    };
    options.width.unwrap_or_else(default)
}

/// Returns how long a lower bound stays valid. `bounds` takes a width and returns both bounds of a
/// new search. It is called if the measured bound is far below the remaining distance, which the
/// new upper bound may shorten. The span is zero if the search does not come near that distance.
pub(super) fn held<S: Separation>(
    pair: &mut S,
    seen: &Measurement,
    flight: &PairMotion,
    bounds: impl FnOnce(&mut S, &RelativePose, f64) -> [f64; 2],
) -> FreeSpan {
    let [mut lower, mut upper] = [seen.lower, seen.upper];
    let left = upper - flight.required;
    if left > 0.0
        && lower - flight.required < (1.0 - NARROWER) * left
        && let Ok(pose) = RelativePose::new(&flight.pose_a, &flight.pose_b)
    {
        let found = bounds(pair, &pose, MEASURED * left);
        (lower, upper) = (lower.larger(found[0]), upper.smaller(found[1]));
    }
    let proof = Proof::Own;
    if lower - flight.required < HOPE * (upper - flight.required) {
        return FreeSpan { span: 0.0, proof };
    }
    let way = lower - flight.required - flight.apart(pair).noise;
    let span = flight.held(pair, way);
    FreeSpan { span, proof }
}

impl<T: BesideSurface> Separation for SurfaceSolidPair<'_, T> {
    fn ball(&self, of: Operand) -> (Point3<f64>, f64) {
        if of == self.order {
            self.surface.bounding_ball()
        } else {
            T::ball(self.body)
        }
    }

    fn measure(&mut self, a_from_b: &RelativePose) -> Measurement {
        Measurement::from(&self.answer(a_from_b, NetGoal::Part(MEASURED)))
    }

    fn meets(&mut self, a_from_b: &RelativePose, distance: f64, _: &Measurement) -> bool {
        self.is_within(a_from_b, distance).is_yes()
    }

    fn free_for(&mut self, seen: &Measurement, flight: &PairMotion) -> FreeSpan {
        held(self, seen, flight, |pair, pose, width| {
            let found = pair.answer(pose, NetGoal::Width(width));
            [found.lower, found.upper]
        })
    }
}

/// State of a surface and a convex [`Shape`]: the front of the last outcome, from which the next
/// query starts, the nodes made so far, and counters.
///
/// It is the counterpart of `SurfaceTracker` for every kind of shape. The shape is not split; its
/// support function bounds it. The surface is A and the shape is B; for the other order see
/// [`RelativePose::swapped`]. The shape is solid, so a surface inside it has the distance zero.
/// Like a `SurfaceTracker`, it is not serialised.
#[derive(Clone, Debug)]
pub(crate) struct SurfaceShapeTracker {
    state: SurfaceMemory,
    grown: Grown,
    /// The tracker of a point of the surface and the shape.
    feet: ShapeTracker,
    /// A point at the origin.
    point: Shape,
}

impl Default for SurfaceShapeTracker {
    fn default() -> Self {
        Self {
            state: SurfaceMemory::default(),
            grown: Grown::default(),
            feet: ShapeTracker::new(),
            point: Shape::from(ConvexPolyhedron::origin()),
        }
    }
}

impl SurfaceShapeTracker {
    /// Returns a tracker that starts cold.
    #[must_use]
    pub(crate) fn new() -> Self {
        Self::default()
    }

    /// Returns the work of all queries so far.
    #[must_use]
    pub(crate) fn work(&self) -> SurfaceWork {
        self.state.work
    }

    /// Returns the number of entries of the cached front.
    #[must_use]
    pub(crate) fn front_len(&self) -> usize {
        self.state.front.entries.len()
    }

    /// Returns the bytes on the heap, without shapes.
    #[must_use]
    pub(crate) fn memory_usage(&self) -> usize {
        self.grown.memory_usage() + self.state.memory_usage()
    }

    /// Returns the closest points at a pose that may displace points of B by up to `placing`.
    fn answer_placed(
        &mut self,
        a: &BezierSurface,
        b: &Shape,
        a_from_b: &RelativePose,
        goal: NetGoal,
        placing: f64,
    ) -> PairOutcome {
        let is_full = self.grown.numbers() > KEPT;
        if !self.state.recognises([a.fingerprint, b.fingerprint()], is_full) {
            (self.grown, self.feet) = (Grown::default(), ShapeTracker::new());
        }
        let reach = [a.reach, reach(b)];
        let points = reach[0] * SURFACE_POINT + reach[1] * SHAPE_POINT;
        let Some(frame) = NetFrame::new(reach, points, a_from_b) else {
            return far_apart(a, b, a_from_b);
        };
        let frame = frame.placed(placing);
        let mut trees = Trees {
            a: Nodes::new(&a.tree, &mut self.grown),
            b: ShapeNode::new(b),
            frame: &frame,
            counts: SearchWork::default(),
        };
        let mut feet = Feet::new(a.patches(), [&self.point, b], &mut self.feet, &frame, a_from_b);
        match self.state.search(&mut trees, &mut feet, goal) {
            Some((lower, best)) => {
                let locations = [best.place(0), WitnessLocation::new(0, best.feature)];
                let outcome = Outcome {
                    state: state(lower, best.upper),
                    distance: best.distance.clamped(lower, best.upper),
                    lower,
                    upper: best.upper,
                    point_on_a: best.on_a.into(),
                    point_on_b: best.on_b.into(),
                    normal: Unit::new_unchecked(best.normal.unwrap_or_else(Vector3::x)),
                    ..Outcome::starting_at(features_on(&locations))
                };
                let is_converged = goal.is_converged(lower, best.upper);
                PairOutcome {
                    outcome,
                    locations,
                    is_converged,
                }
            }
            None => far_apart(a, b, a_from_b),
        }
    }
}

impl BesideSurface for SurfaceShapeTracker {
    type Body = Shape;

    fn ball(body: &Shape) -> (Point3<f64>, f64) {
        body.bounding_ball()
    }

    fn answer(&mut self, a: &BezierSurface, b: &Shape, a_from_b: &RelativePose, goal: NetGoal) -> PairOutcome {
        self.answer_placed(a, b, a_from_b, goal, 0.0)
    }

    fn allow(&mut self, splits: Option<usize>) {
        self.state.allow(splits.unwrap_or(SPLITS));
    }
}

/// Returns the contact state. A point of the surface inside the shape proves an upper bound of
/// zero.
pub(super) fn state(lower: f64, upper: f64) -> ContactState {
    if lower > 0.0 {
        ContactState::Separated
    } else if upper == 0.0 {
        ContactState::Overlapping
    } else {
        ContactState::Undecided
    }
}

/// Returns the largest distance of a point of a shape from the origin, rounded up.
fn reach(shape: &Shape) -> f64 {
    let (centre, radius) = shape.bounding_ball();
    (sqrt(centre.coords.norm_squared()) + radius) * ROUND_UP * ROUND_UP
}

/// Returns the outcome of bodies so far apart, or so small, that only balls around their origins
/// count.
pub(super) fn far_apart(a: &BezierSurface, b: &Shape, a_from_b: &RelativePose) -> PairOutcome {
    let (lower, upper, n) = far([a.reach, reach(b)], a_from_b);
    let facing = -a_from_b.rotation().tr_mul(&n);
    let locations = [
        WitnessLocation::on_patch(0, [0.0; 2]),
        WitnessLocation::new(0, Feature::Vertex(VertexId(0))),
    ];
    let outcome = Outcome {
        state: state(lower, upper),
        distance: 0.5 * lower + 0.5 * upper,
        lower,
        upper,
        point_on_a: a.patches()[0].point(0.0, 0.0),
        point_on_b: (b.core_point(&facing).1 + facing * b.rounding_radius()).into(),
        normal: Unit::new_unchecked(n),
        ..Outcome::starting_at(features_on(&locations))
    };
    PairOutcome {
        outcome,
        locations,
        is_converged: false,
    }
}

/// Lowers the lower bound of an outcome to the bound of other pieces.
fn lower_to(answer: &mut PairOutcome, lower: f64, goal: NetGoal) {
    let o = &mut answer.outcome;
    o.lower = o.lower.smaller(lower);
    o.distance = o.distance.larger(o.lower);
    o.state = state(o.lower, o.upper);
    answer.is_converged = goal.is_converged(o.lower, o.upper);
}

/// The trackers of a surface and the pieces of a [`Compound`].
///
/// It is the counterpart of [`SurfaceShapeTracker`] for compounds: the surface is A and the
/// compound is B. A piece is not queried if its ball is farther away than the closest piece. The
/// state is not serialised.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceCompoundTracker {
    pieces: Vec<SurfaceShapeTracker>,
    /// The piece that was closest.
    last: usize,
    splits: Option<usize>,
}

impl SurfaceCompoundTracker {
    /// Returns the work of all queries so far.
    pub(crate) fn work(&self) -> SurfaceWork {
        self.pieces.iter().fold(SurfaceWork::default(), |mut sum, piece| {
            sum += piece.work();
            sum
        })
    }

    /// Returns the number of entries of the cached fronts.
    pub(crate) fn front_len(&self) -> usize {
        self.pieces.iter().map(SurfaceShapeTracker::front_len).sum()
    }

    /// Returns the bytes on the heap, without shapes.
    #[must_use]
    pub(crate) fn memory_usage(&self) -> usize {
        let own = self.pieces.capacity() * size_of::<SurfaceShapeTracker>();
        own + self.pieces.iter().map(SurfaceShapeTracker::memory_usage).sum::<usize>()
    }
}

impl BesideSurface for SurfaceCompoundTracker {
    type Body = Compound;

    fn ball(body: &Compound) -> (Point3<f64>, f64) {
        ball_about(body.aabb())
    }

    fn allow(&mut self, splits: Option<usize>) {
        self.splits = splits;
    }

    /// Returns the closest points of all pieces with bounds as close as the goal requires.
    fn answer(&mut self, a: &BezierSurface, b: &Compound, a_from_b: &RelativePose, goal: NetGoal) -> PairOutcome {
        let pieces = b.pieces();
        self.pieces.resize_with(pieces.len(), SurfaceShapeTracker::new);
        let placed = Placed::new(a_from_b, b.is_in_place());
        // The radius counts the origins of the pieces too, which may be far from the body.
        let radius = b.side().radius * b.stored_unit();
        let offset = sqrt(a_from_b.translation().norm_squared());
        let noise = 2.0 * CERTIFICATE * UNIT * (a.reach + radius + offset);
        let mut ask = |k: usize, most: f64| {
            let (pose, is_exact) = placed.between(&Isometry3::identity(), &pieces[k].pose);
            if apart(a, &pieces[k], &pose) - 2.0 * noise > most {
                return None;
            }
            // The rounding of composed poses: two products of rotations and two sums.
            let placing = if is_exact { 0.0 } else { noise };
            self.pieces[k].allow(self.splits);
            Some(self.pieces[k].answer_placed(a, &pieces[k].shape, &pose, goal, placing))
        };
        let mut last = self.last.min(pieces.len() - 1);
        let first = last;
        let mut best = ask(first, f64::INFINITY).unwrap_or_else(|| far_apart(a, &pieces[first].shape, a_from_b));
        let mut lower = best.lower;
        for k in (0..pieces.len()).filter(|&k| k != first) {
            let Some(found) = ask(k, best.upper) else { continue };
            lower = lower.smaller(found.lower);
            if found.upper < best.upper {
                (last, best) = (k, found);
            }
        }
        self.last = last;
        lower_to(&mut best, lower, goal);
        best.outcome.point_on_b = pieces[last].pose * best.point_on_b;
        best.locations[1].subshape = last as u32;
        best
    }
}

/// Returns the gap between the balls around a surface and a piece, up to rounding.
fn apart(a: &BezierSurface, piece: &Piece, pose: &RelativePose) -> f64 {
    let ((centre, radius), (of_piece, reach)) = (a.bounding_ball(), piece.shape.bounding_ball());
    let between = pose.rotation() * of_piece.coords + pose.translation() - centre.coords;
    sqrt(between.norm_squared()) - radius - reach
}
