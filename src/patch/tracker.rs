//! The state of a pair of surfaces, and the queries.

use nalgebra::{Point3, Unit, Vector3};

use super::closest::Patches;
use super::crossing::crosses;
use super::frame::{NetFrame, far};
use super::gap::{SearchCounts, Trees};
use super::outcome::{Decision, SurfaceOutcome, SurfacePart, SurfaceWork};
use super::search::NetGoal;
use super::state::SurfaceMemory;
use super::surface::{Surface, SurfacePoint};
use super::tree::{Grown, Nodes};
use crate::pair::outcome::{Class, Distance};
use crate::pose::RelativePose;
use crate::tolerance::SURFACE_POINT;
use crate::tuning::patch::KEPT;

/// The front of the last answer for one pair of surfaces, from which the next query starts, the
/// nodes made so far, and counters.
///
/// Owns no surface. State changes time, never which distances an answer allows: bounds are proven
/// anew at every pose. A tracker that comes from another pair, or is out of date, is allowed. Not
/// saved to files: nodes are made again by one query, and a front is much larger than its surfaces.
/// A query allocates where it splits nodes.
///
/// ```
/// use lin_canny::RelativePose;
/// use lin_canny::nalgebra::{Isometry3, Point3};
/// use lin_canny::patch::{Patch, Surface, SurfaceTracker};
///
/// // A quarter of a parabolic roof, and a copy that moves away from it.
/// let at = |k: usize| {
///     let height = if k == 4 { 1.0 } else { 0.0 };
///     Point3::new((k / 3) as f64, (k % 3) as f64, height)
/// };
/// let points: Vec<_> = (0..9).map(at).collect();
/// let roof = Surface::new(vec![Patch::polynomial([2, 2], &points)?])?;
/// let mut pair = SurfaceTracker::new();
/// for k in 0..10 {
///     let pose = Isometry3::translation(0.0, 0.0, 1.0 + 0.1 * k as f64);
///     let a_from_b = RelativePose::from_isometry(&pose)?;
///     let c = pair.closest(&roof, &roof, &a_from_b, 1e-9);
///     assert!(c.is_reached && c.upper - c.lower <= 1e-9 && c.lower > 0.5);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct SurfaceTracker {
    state: SurfaceMemory,
    grown: [Grown; 2],
}

/// What a search found.
struct Found {
    lower: f64,
    upper: f64,
    on: [SurfacePoint; 2],
    points: [Point3<f64>; 2],
    normal: Unit<Vector3<f64>>,
    distance: f64,
    shares: bool,
}

impl SurfaceTracker {
    /// Returns a tracker without a start.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the tracker with another budget: the number of pairs of nodes that one query may
    /// split, 20,000 by default and at most `2^22`. A query that uses up its budget returns wider
    /// bounds; so does one that would need several times its budget by the speed at which its
    /// bounds approach each other.
    #[must_use]
    pub fn with_budget(mut self, splits: usize) -> Self {
        self.state.allow(splits);
        self
    }

    /// Returns the work of all queries so far.
    #[must_use]
    pub fn work(&self) -> SurfaceWork {
        self.state.work
    }

    /// Returns the number of entries of the front that is kept.
    #[must_use]
    pub fn front_len(&self) -> usize {
        self.state.front.entries.len()
    }

    /// Returns the front that is kept for these surfaces: pairs of parts of A and of B that are
    /// proven apart, under which every pair of patches lies. Empty for surfaces other than those of
    /// the last query.
    pub fn front<'t>(&'t self, a: &'t Surface, b: &'t Surface) -> impl Iterator<Item = [SurfacePart; 2]> + 't {
        let entries = self.state.entries([a.fingerprint, b.fingerprint]);
        let part = |s: &Surface, grown: &Grown, id: u32| SurfacePart::of(grown.node(&s.tree, id));
        entries.iter().map(move |e| {
            let [x, y] = e.pair;
            [part(a, &self.grown[0], x), part(b, &self.grown[1], y)]
        })
    }

    /// Returns the bytes kept on the heap.
    #[must_use]
    pub fn heap_bytes(&self) -> usize {
        self.grown.iter().map(Grown::heap_bytes).sum::<usize>() + self.state.heap_bytes()
    }

    /// Forgets everything that is kept, counters too; the budget stays.
    pub fn reset(&mut self) {
        self.state.reset();
        self.grown = Default::default();
    }

    /// Returns the closest points with bounds of the distance that are at most `width` apart, a
    /// length in the caller's unit. A width that is no number, or that is below
    /// [`PATCH_LIMIT`](crate::tolerance::PATCH_LIMIT) times the size L (the farthest control points
    /// of both surfaces from their origins, and the distance of the origins), is taken as that
    /// limit.
    pub fn closest(&mut self, a: &Surface, b: &Surface, a_from_b: &RelativePose, width: f64) -> SurfaceOutcome {
        self.answer(a, b, a_from_b, NetGoal::Width(width))
    }

    /// Returns the closest points with bounds as close as a goal asks for.
    pub(super) fn answer(
        &mut self,
        a: &Surface,
        b: &Surface,
        a_from_b: &RelativePose,
        goal: NetGoal,
    ) -> SurfaceOutcome {
        let found = self.search(a, b, a_from_b, goal);
        let class = if found.lower > 0.0 {
            Class::Separated
        } else if found.shares {
            Class::Touching
        } else {
            Class::Undecided
        };
        SurfaceOutcome {
            class,
            distance: found.distance.clamp(found.lower, found.upper),
            lower: found.lower,
            upper: found.upper,
            is_reached: goal.is_reached(found.lower, found.upper),
            on_a: found.on[0],
            on_b: found.on[1],
            point_on_a: found.points[0],
            point_on_b: found.points[1],
            normal: found.normal,
        }
    }

    /// Returns the distance with bounds that are at most `width` apart, as
    /// [`closest`](Self::closest).
    pub fn distance(&mut self, a: &Surface, b: &Surface, a_from_b: &RelativePose, width: f64) -> Distance {
        Distance::from(&self.closest(a, b, a_from_b, width))
    }

    /// Decides whether the surfaces share a point. Yes is proven where one surface runs through the
    /// other inside two patches, by an existence theorem; surfaces that merely touch stay
    /// undecided, and those that are close all over an area and for which the budget is too small:
    /// a query splits at most 20,000 pairs of nodes, or as many as
    /// [`with_budget`](Self::with_budget) allows, and then returns the bounds that it has proven.
    pub fn intersects(&mut self, a: &Surface, b: &Surface, a_from_b: &RelativePose) -> Decision {
        let found = self.search(a, b, a_from_b, NetGoal::Within(0.0));
        let (lower, upper) = (found.lower, found.upper);
        if lower > 0.0 {
            Decision::No
        } else if found.shares {
            Decision::Yes
        } else {
            Decision::Undecided { lower, upper }
        }
    }

    /// Decides whether the distance of the surfaces is at most `d`, a length in the caller's unit.
    /// Undecided only if `d` is within rounding of the distance, or the budget is too small.
    pub fn within(&mut self, a: &Surface, b: &Surface, a_from_b: &RelativePose, d: f64) -> Decision {
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
        on: [SurfacePoint::default(); 2],
        points: [a, b].map(|s| s.patches()[0].point(0.0, 0.0)),
        normal: Unit::new_unchecked(n),
        distance: 0.5 * lower + 0.5 * upper,
        shares: false,
    }
}
