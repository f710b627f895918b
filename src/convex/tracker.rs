//! The state a user keeps per pair: the features of the last answer, from which the next query
//! starts.

use crate::base::pose::RelativePose;
use crate::base::tolerance::LEAST_SQUARE;
use crate::body::polyhedron::{ConvexPolyhedron, FeaturePair};
pub(crate) use crate::convex::depth::Workspace;
use crate::convex::depth::{self, Memory};
use crate::convex::minimum::overlap_proof::OverlapProof;
use crate::convex::replay::Replay;
use crate::convex::solve::{self, out_of_range};
use crate::convex::walk::rings::predict::predict;
use crate::convex::walk::seed;
use crate::pair::draft::Draft;
use crate::pair::outcome::{Accuracy, Ask, Class, Outcome, Until};
use crate::pair::posed::PosedPair;

// First, so that the documentation of `Tracker` begins with `new` and `closest`.
mod queries;

mod contacts;
mod counts;
mod local;
mod look;
mod reach;
mod resume;

use counts::Starts;
pub use counts::Totals;
use resume::{Resumed, enters_overlap};

/// Walks of so many steps were near their end at the start, and extrapolation of the features would
/// gain nothing. Not measured.
const STEADY: u32 = 3;

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
