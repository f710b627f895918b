//! The state a user keeps per pair: the features of the last answer, from which the next query
//! starts.

use alloc::string::String;
use alloc::vec::Vec;

use crate::base::pose::RelativePose;
use crate::base::tolerance::LEAST_SQUARE;
use crate::base::tuning::tracker::STEADY;
use crate::body::polyhedron::{ConvexPolyhedron, FeaturePair};
pub(crate) use crate::convex::depth::Workspace;
use crate::convex::depth::{self, Memory};
use crate::convex::minimum::overlap_proof::OverlapProof;
use crate::convex::replay::Replay;
use crate::convex::solve::{self, out_of_range};
use crate::convex::walk::rings::predict::predict;
use crate::convex::walk::seed;
use crate::convex::walk::trace::trace;
use crate::pair::draft::Draft;
use crate::pair::outcome::{Accuracy, Ask, Class, Distance, Outcome, Proposal, Until};
use crate::pair::posed::PosedPair;

mod counts;

use counts::Starts;
pub use counts::Totals;

/// The features of the last answer of a pair, from which the next walk starts, and counters.
///
/// Owns no body. A tracker that comes from another pair, or is out of date, costs time and never an
/// answer: classification and predicates are equal warm and cold, and distances agree within their
/// bounds. Only among exact ties may features, witnesses and normal depend on the history.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::{RelativePose, Tracker, polyhedron::solids};
///
/// let a = solids::cuboid(Vector3::new(1.0, 1.0, 1.0))?;
/// let b = solids::octahedron(0.5)?;
/// let mut pair = Tracker::default();
/// for k in 0..10 {
///     let at = Isometry3::translation(3.0, 0.1 * k as f64, 0.0);
///     let a_from_b = RelativePose::from_isometry(&at)?;
///     let c = pair.closest(&a, &b, &a_from_b);
///     assert!(c.lower <= 1.5 && 1.5 <= c.upper);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "v-clip")]
#[doc(alias = "gjk")]
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Tracker {
    last: Option<FeaturePair>,
    /// Start of the next walk: the last features, or features extrapolated by the motion of a step.
    #[cfg_attr(feature = "serde", serde(default))]
    next: Option<FeaturePair>,
    starts: Starts,
    totals: Totals,
    /// The surface of the last answer, if the last answer was an overlap.
    #[cfg_attr(feature = "serde", serde(default))]
    memory: Memory,
    /// The proof of the last answer, if the last answer was an overlap without depth.
    #[cfg_attr(feature = "serde", serde(default))]
    overlap_proof: Option<OverlapProof>,
}

impl Tracker {
    /// Returns a tracker without a start: the first query begins at the support vertices along the
    /// line of centres.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the closest features, their witnesses and bounds of the distance, certified:
    /// separated bodies get bounds no wider than `1e-13 L`, with `L` the size of the pair ([front
    /// page](crate#guarantees)). Overlapping bodies get their depth as a negative distance, bounded
    /// as well. Queries of separated bodies allocate nothing, unless exact arithmetic is needed;
    /// the depth of an overlap takes memory that the tracker keeps, or has allocated before
    /// ([`reserve`](Self::reserve)).
    ///
    /// A query tests a few vertices, even if faces or fans of thousands of edges lie flush. Only
    /// one query takes time in proportion to the number of such edges: the depth of an overlap
    /// whose centre is equally deep under all of them, as of two cones with coaxial apexes. Each
    /// may be the deepest, and is tested, in some 3 to 7 us.
    #[inline]
    pub fn closest(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose) -> Outcome {
        self.checked(a, b, a_from_b, Until::Depth)
    }

    /// Returns the closest features as [`closest`](Self::closest) does, with the distance of
    /// separated bodies within one unit in the last place of the truth. Costs microseconds: every
    /// answer is computed again in double-double arithmetic, some answers in exact integers. The
    /// depth of an overlap keeps the bounds of [`closest`](Self::closest) unless its facets are
    /// decided over integers ([`Solver::Exact`](crate::Solver)).
    #[cfg(feature = "exact")]
    pub fn closest_exact(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose) -> Outcome {
        let before = self.before(a, b);
        let mut outcome = self.answer(
            a,
            b,
            a_from_b,
            Ask {
                accuracy: Accuracy::Exact,
                until: Until::Depth,
            },
        );
        // Second case: a distance that f64 holds in the caller's unit only, below the normal
        // numbers in the stored unit.
        if outcome.solver == crate::pair::outcome::Solver::Far
            || outcome.class == Class::Separated && !outcome.is_tight()
        {
            outcome = out_of_range::exactly(a, b, a_from_b, outcome);
        }
        debug_check(a, b, a_from_b, &before, Accuracy::Exact, &outcome);
        outcome
    }

    /// Returns the closest points of bodies apart, and of an overlap the class without its depth.
    pub(crate) fn closest_or_class(
        &mut self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
    ) -> Outcome {
        self.measure(a, b, a_from_b, Until::Class)
    }

    /// Returns the distance and its bounds without the witnesses.
    pub fn distance(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose) -> Distance {
        self.bounds(a, b, a_from_b, Until::Depth)
    }

    /// Returns the closest features as the walk proposes, without bounds. If the walk does not end,
    /// the minimum-norm solver in f64 is used.
    #[inline]
    pub fn propose(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose) -> Proposal {
        let o = self.answer(
            a,
            b,
            a_from_b,
            Ask {
                accuracy: Accuracy::Walk,
                until: Until::Class,
            },
        );
        Proposal {
            distance: (o.class != Class::Overlapping).then_some(o.distance),
            features: o.features,
            point_on_a: o.point_on_a,
            point_on_b: o.point_on_b,
            normal: o.normal,
            solver: o.solver,
            work: o.work,
        }
    }

    /// Returns a tracker that starts from the given features; features that the bodies do not have
    /// are ignored.
    #[must_use]
    pub fn starting_from(features: FeaturePair, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> Self {
        let features = features.is_of(a, b).then(|| features.walkable(a, b));
        Self {
            last: features,
            next: features,
            starts: Starts::default(),
            totals: Totals::default(),
            memory: Memory::default(),
            overlap_proof: None,
        }
    }

    /// Allocates all the memory that overlaps may need later (some 50 kB): afterwards no query
    /// allocates if the walk or its solvers in f64 suffice, as long as surfaces have no more than
    /// 256 triangles. Only round bodies deep in each other need more.
    pub fn reserve(&mut self) {
        self.memory.reserve();
    }

    /// Returns the features of the last answer.
    #[must_use]
    pub fn features(&self) -> Option<FeaturePair> {
        self.last
    }

    /// Returns the pairs of features that the walk of the next query would test, in order, and
    /// whether the walk ends on the last pair rather than handing over there. Nothing is changed or
    /// counted. Empty for bodies on which no walk is tried: too far apart, or of sizes too
    /// different.
    #[must_use]
    pub fn trace(
        &self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
    ) -> (Vec<FeaturePair>, bool) {
        match PosedPair::new(a, b, a_from_b) {
            Ok(posed) => trace(&posed, self.start(a, b)),
            Err(_) => (Vec::new(), false),
        }
    }

    /// Returns the query as a text that rebuilds the query bit for bit: call this before the query,
    /// or the recorded start is the start of the next query.
    #[must_use]
    pub fn replay(
        &self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        accuracy: Accuracy,
    ) -> Replay {
        replay(a, b, a_from_b, (self.start(a, b), self.memory.clone()), accuracy)
    }

    /// Returns the first broken invariant of the cached state: a tool of tests and fuzzing.
    ///
    /// # Errors
    /// A text that names the broken invariant.
    pub fn check(&self) -> Result<(), String> {
        self.memory.check()
    }

    /// Returns the counters since the tracker was made or reset.
    #[must_use]
    pub fn work(&self) -> Totals {
        self.totals
    }

    /// Forgets features and counters.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// Answers at one accuracy, an overlap with its depth if `deep`. The draft is written in
    /// place: copied whole, the draft would wait for its parts to leave the store queue.
    #[inline(always)]
    fn answer(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose, ask: Ask) -> Outcome {
        let mut draft = Draft::starting_at(FeaturePair::FIRST);
        self.solve(a, b, a_from_b, ask, &mut draft);
        draft.into_outcome()
    }

    #[inline(never)]
    fn solve(
        &mut self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        ask: Ask,
        draft: &mut Draft,
    ) {
        if a.exponent != b.exponent && has_the_unit(b, a) {
            self.solve_in_units_of_b(a, b, a_from_b, ask, draft);
        } else if let Ok(posed) = PosedPair::new(a, b, a_from_b) {
            let mut near = None;
            if ask.until.has_depth() && !self.memory.is_empty() {
                match self.resume(&posed, ask.until, draft) {
                    Resumed::Proven => return,
                    Resumed::Apart(start) => near = Some(start),
                    Resumed::Open => {}
                }
            }
            if ask == Ask::certified(Until::Class) && self.overlap_proof.is_some() && self.still_overlaps(&posed, draft)
            {
                return;
            }
            let warm = near.or_else(|| self.start(a, b));
            match warm {
                Some(pair) => draft.features = pair,
                None => draft.features = seed::cold(&posed, &mut draft.work),
            }
            let memory = &mut self.memory;
            solve::solve(ask.accuracy, &posed, warm.is_some(), draft, |draft| {
                ask.until.has_depth() && enters_overlap(&posed, memory, draft)
            });
            self.deepen(ask, &posed, draft);
            self.count(warm.is_some(), a, b, draft);
            if !(a.is_unscaled && b.is_unscaled) {
                to_user_units(a, b, draft);
            }
        } else {
            self.solve_far(a, b, a_from_b, draft);
        }
    }

    /// Computes the depth of an overlap, if requested; if not, the next query begins with the
    /// expectation of another overlap.
    #[inline(always)]
    fn deepen(&mut self, ask: Ask, posed: &PosedPair, draft: &mut Draft) {
        if draft.class == Class::Overlapping {
            self.overlap_proof = (ask.until == Until::Class).then(OverlapProof::default);
            let is_open = ask.until.has_depth() && draft.lower == f64::NEG_INFINITY;
            let is_touch = is_open && ask.accuracy != Accuracy::Exact && depth::of_touch(posed, draft);
            if is_open && !is_touch {
                depth::penetration_depth(posed, &mut self.memory, draft);
            }
        }
    }

    #[cold]
    fn solve_in_units_of_b(
        &mut self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        ask: Ask,
        draft: &mut Draft,
    ) {
        let b_from_a = a_from_b.swapped();
        let Ok(posed) = PosedPair::new(b, a, &b_from_a) else {
            return self.solve_far(a, b, a_from_b, draft);
        };
        let warm = self.start(a, b).map(FeaturePair::swapped);
        draft.features = warm.unwrap_or_else(|| seed::cold(&posed, &mut draft.work));
        solve::solve(ask.accuracy, &posed, warm.is_some(), draft, |_| false);
        self.deepen(ask, &posed, draft);
        // The names of the surface are the names of the bodies exchanged.
        self.memory.clear();
        self.overlap_proof = None;
        draft.swap(&b_from_a);
        self.count(warm.is_some(), a, b, draft);
        to_user_units(a, b, draft);
    }

    #[cold]
    fn solve_far(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose, draft: &mut Draft) {
        *draft = out_of_range::answer(a, b, a_from_b).into();
        self.count(false, a, b, draft);
    }

    /// Returns the start of the next query: the cached pair, if its features belong to these bodies
    /// and the cached pair has been the cheaper start of late. The start is the only influence of a
    /// tracker on an answer, and hence all that a replay records.
    #[inline(always)]
    fn start(&self, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> Option<FeaturePair> {
        self.next.filter(|pair| self.starts.prefer_warm() && pair.is_of(a, b))
    }

    /// Captures the data a fault is reported with, in builds that check for faults.
    #[inline(always)]
    fn before(&self, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> Option<(Option<FeaturePair>, Memory)> {
        cfg!(debug_assertions).then(|| (self.start(a, b), self.memory.clone()))
    }

    #[inline(always)]
    fn count(&mut self, warm: bool, a: &ConvexPolyhedron, b: &ConvexPolyhedron, draft: &Draft) {
        self.starts.learn(warm, &draft.work);
        self.totals.note(warm, draft.solver, &draft.work);
        // Longer walks, and walks that began at extrapolated features: on long face boundaries and
        // around large fans.
        if (a.has_large_rings | b.has_large_rings) && (draft.work.steps > STEADY || self.next != self.last) {
            let now = draft.features;
            let next = self.last.map_or(now, |before| predict(a, b, before, now));
            (self.last, self.next) = (Some(now), Some(next));
        } else {
            self.stay(draft.features);
        }
    }

    /// Starts the next walk at the end of this walk.
    #[inline(always)]
    fn stay(&mut self, features: FeaturePair) {
        (self.last, self.next) = (Some(features), Some(features));
    }
}

// Below the methods above, so that the documentation begins with `new` and `closest`.
mod contacts;
mod local;
mod look;
mod reach;
mod resume;

use resume::{Resumed, enters_overlap};

fn replay(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    pose: &RelativePose,
    (start, surface): (Option<FeaturePair>, Memory),
    accuracy: Accuracy,
) -> Replay {
    Replay {
        a: a.clone(),
        b: b.clone(),
        round: [0.0; 2],
        pose: *pose,
        start,
        surface,
        accuracy,
    }
}

/// In debug builds: an answer that contradicts itself ends the program with the text that replays
/// the query.
#[inline(always)]
fn debug_check(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    pose: &RelativePose,
    before: &Option<(Option<FeaturePair>, Memory)>,
    accuracy: Accuracy,
    outcome: &Outcome,
) {
    if let Some(before) = before
        && let Some(fault) = crate::pair::soundness::fault(a, b, pose, outcome)
    {
        panic!("{fault}: {outcome:?}\n{}", replay(a, b, pose, before.clone(), accuracy));
    }
}

impl Replay {
    /// Returns a tracker with the recorded start.
    #[must_use]
    pub fn tracker(&self) -> Tracker {
        let start = self.start.map(|pair| Tracker::starting_from(pair, &self.a, &self.b));
        Tracker {
            memory: self.surface.clone(),
            ..start.unwrap_or_default()
        }
    }
}

/// Returns whether the bounding balls alone prove the bodies more than `d` apart.
#[inline]
pub(crate) fn clear_of(a: &ConvexPolyhedron, b: &ConvexPolyhedron, pose: &RelativePose, d: f64) -> bool {
    if !a.is_unscaled || !b.is_unscaled {
        return false;
    }
    let reach = a.radius + b.radius + d;
    // One part in 2^20 is far more than the rounding of both sides, and LEAST_SQUARE more than the
    // loss of squares below the normal numbers.
    pose.translation().norm_squared() > reach * reach * (1.0 + 1.0 / 1_048_576.0) + LEAST_SQUARE
}

/// Returns whether a pair of different units is computed in the unit of `x`: true if `x` has the
/// larger unit, or `y` is a point, which has no size of its own.
#[cold]
fn has_the_unit(x: &ConvexPolyhedron, y: &ConvexPolyhedron) -> bool {
    y.radius == 0.0 || x.exponent > y.exponent && x.radius > 0.0
}

/// Converts a draft from stored units and frames to the caller's.
#[cold]
fn to_user_units(a: &ConvexPolyhedron, b: &ConvexPolyhedron, draft: &mut Draft) {
    let unit = if has_the_unit(b, a) { b.unit() } else { a.unit() };
    draft.scale(unit, a, b);
}
