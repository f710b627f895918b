//! The state of a pair of surfaces, and the queries.

use crate::patch::state::SPLITS;
use nalgebra::{Point3, Unit, Vector3};

use super::closest::Patches;
use super::crossing::crosses;
use super::frame::NetFrame;
use super::gap::{SearchCounts, Trees};
use super::outcome::{SurfacePart, SurfaceWork};
use super::search::NetGoal;
use super::state::SurfaceMemory;
use super::surface::Surface;
use super::tree::{Grown, Nodes};
use crate::base::num::extremes::Bounded;
use crate::base::pose::RelativePose;
use crate::base::tolerance::SURFACE_POINT;
use crate::pair::answer::far;
use crate::pair::outcome::{Class, Decision, Outcome};
use crate::pair::spot::{Answer, Spot, features_on};

/// Numbers that a tracker keeps for the nets of split nodes, at most: 16 MB.
pub(super) const KEPT: usize = 1 << 21;

/// The front of the last answer for one pair of surfaces, from which the next query starts, the
/// nodes made so far, and counters.
///
/// Owns no surface. State changes time, never which distances an answer allows: bounds are proven
/// anew at every pose. A tracker that comes from another pair, or is out of date, is allowed. Not
/// saved to files: nodes are made again by one query, and a front is much larger than its surfaces.
/// A query allocates where it splits nodes.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceTracker {
    state: SurfaceMemory,
    grown: [Grown; 2],
}

/// What a search found.
struct Found {
    lower: f64,
    upper: f64,
    on: [Spot; 2],
    points: [Point3<f64>; 2],
    normal: Unit<Vector3<f64>>,
    distance: f64,
    shares: bool,
}

impl SurfaceTracker {
    /// Sets the number of pairs of nodes that one query may split; `None` for the usual budget.
    pub(crate) fn allow(&mut self, splits: Option<usize>) {
        self.state.allow(splits.unwrap_or(SPLITS));
    }

    /// Returns the work of all queries so far.
    #[must_use]
    pub(crate) fn work(&self) -> SurfaceWork {
        self.state.work
    }

    /// Returns the number of entries of the front that is kept.
    #[must_use]
    pub(crate) fn front_len(&self) -> usize {
        self.state.front.entries.len()
    }

    /// Returns the front that is kept for these surfaces: pairs of parts of A and of B that are
    /// proven apart, under which every pair of patches lies. Empty for surfaces other than those of
    /// the last query.
    pub(crate) fn front<'t>(&'t self, a: &'t Surface, b: &'t Surface) -> impl Iterator<Item = [SurfacePart; 2]> + 't {
        let entries = self.state.entries([a.fingerprint, b.fingerprint]);
        let part = |s: &Surface, grown: &Grown, id: u32| SurfacePart::of(grown.node(&s.tree, id));
        entries.iter().map(move |e| {
            let [x, y] = e.pair;
            [part(a, &self.grown[0], x), part(b, &self.grown[1], y)]
        })
    }

    /// Returns the bytes kept on the heap.
    #[must_use]
    pub(crate) fn heap_bytes(&self) -> usize {
        self.grown.iter().map(Grown::heap_bytes).sum::<usize>() + self.state.heap_bytes()
    }

    /// Returns the closest points with bounds as close as a goal asks for.
    pub(super) fn answer(&mut self, a: &Surface, b: &Surface, a_from_b: &RelativePose, goal: NetGoal) -> Answer {
        let found = self.search(a, b, a_from_b, goal);
        let class = if found.lower > 0.0 {
            Class::Separated
        } else if found.shares {
            Class::Touching
        } else {
            Class::Undecided
        };
        let outcome = Outcome {
            class,
            distance: found.distance.clamped(found.lower, found.upper),
            lower: found.lower,
            upper: found.upper,
            point_on_a: found.points[0],
            point_on_b: found.points[1],
            normal: found.normal,
            ..Outcome::starting_at(features_on(&found.on))
        };
        Answer {
            outcome,
            on: found.on,
            is_reached: goal.is_reached(found.lower, found.upper),
        }
    }

    /// Decides whether the distance of the surfaces is at most `d`, a length in the caller's unit.
    /// Undecided only if `d` is within rounding of the distance, or the budget is too small.
    ///
    /// That surfaces share a point is proven where one runs through the other inside two patches,
    /// by an existence theorem; for a `d` of zero surfaces that merely touch stay undecided, and
    /// those that are close all over an area and for which the budget is too small.
    pub(crate) fn within(&mut self, a: &Surface, b: &Surface, a_from_b: &RelativePose, d: f64) -> Decision {
        if !(d >= 0.0) {
            return Decision::No;
        }
        let found = self.search(a, b, a_from_b, NetGoal::Within(d));
        let upper = if found.shares { 0.0 } else { found.upper };
        Decision::by(found.lower, upper, d)
    }

    fn search(&mut self, a: &Surface, b: &Surface, a_from_b: &RelativePose, goal: NetGoal) -> Found {
        let is_full = self.grown.iter().any(|g| g.numbers() > KEPT);
        if !self.state.recognises([a.fingerprint, b.fingerprint], is_full) {
            self.grown = Default::default();
        }
        let reach = [a.reach, b.reach];
        let points = reach[0] * SURFACE_POINT + reach[1] * SURFACE_POINT;
        let Some(frame) = NetFrame::new(reach, points, a_from_b) else {
            return apart(a, b, a_from_b);
        };
        let [grown_a, grown_b] = &mut self.grown;
        let mut trees = Trees {
            a: Nodes::new(&a.tree, grown_a),
            b: Nodes::new(&b.tree, grown_b),
            frame: &frame,
            counts: SearchCounts::default(),
        };
        let mut points = Patches {
            a: a.patches(),
            b: b.patches(),
            frame: &frame,
        };
        let Some((lower, best)) = self.state.search(&mut trees, &mut points, goal) else {
            return apart(a, b, a_from_b);
        };
        let shares =
            lower == 0.0 && best.distance <= frame.limit && crosses(&points.pair(best.patches), &best, frame.limit);
        Found {
            lower,
            upper: best.upper,
            on: [0, 1].map(|k| best.place(k)),
            points: [best.on_a.into(), best.on_b.into()],
            normal: Unit::new_unchecked(best.normal.unwrap_or_else(Vector3::x)),
            distance: best.distance,
            shares,
        }
    }
}

/// Surfaces so far apart, or so small beside their distance, that only balls about their origins
/// count.
fn apart(a: &Surface, b: &Surface, a_from_b: &RelativePose) -> Found {
    let (lower, upper, n) = far([a.reach, b.reach], a_from_b);
    Found {
        lower,
        upper,
        on: [Spot::on_patch(0, [0.0; 2]); 2],
        points: [a, b].map(|s| s.patches()[0].point(0.0, 0.0)),
        normal: Unit::new_unchecked(n),
        distance: 0.5 * lower + 0.5 * upper,
        shares: false,
    }
}
