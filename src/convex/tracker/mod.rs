//! The state that a caller keeps per pair: the features of the last outcome, from which the next
//! query starts.
//!
//! This file holds the [`Tracker`] and all its queries: closest points, distances, proposals,
//! contacts, local depths and predicates. It also holds the comparison of a distance with an exact
//! sum of numbers (for rounded bodies), the trace of a walk for diagnosis, and the tracker as a
//! text. [`mod@resume`] starts from the overlap of the last outcome, [`mod@overlap`] hands out its
//! proof, [`counts`] chooses the start of a walk.

mod counts;
mod overlap;
mod resume;

use alloc::string::String;

use crate::base::pose::RelativePose;
use crate::base::tolerance::LEAST_SQUARE;
use crate::body::polyhedron::{ConvexPolyhedron, FeaturePair};
use crate::convex::contact::{Manifold, ManifoldOptions, Query};
use crate::convex::depth;
use crate::convex::depth::Memory;
use crate::convex::minimum::OverlapProof;
use crate::convex::replay::Replay;
use crate::convex::solve;
use crate::convex::solve::out_of_range;
use crate::convex::tracker::counts::Starts;
use crate::convex::tracker::resume::{Resumed, enters_overlap};
use crate::convex::walk::rings::predict;
use crate::convex::walk::seed;
use crate::pair::draft::Draft;
use crate::pair::outcome::{Accuracy, Ask, ContactState, DepthMode, Distance, Outcome, Proposal};
use crate::pair::posed::PosedPair;

pub(crate) use crate::convex::depth::Workspace;
pub use crate::convex::tracker::counts::TrackerWork;

/// Walks of at most this many steps were near their end at the start, so extrapolation of the
/// features would gain nothing.
const STEADY: u32 = 3;

/// Cached features of one pair, from which the next walk starts, and counters.
///
/// A tracker owns no body. A tracker of another pair, or one that is out of date, costs time and
/// never makes a result wrong. Contact states and predicates are equal for warm and cold trackers,
/// and distances agree within their bounds. If several feature pairs are exactly equally close,
/// features, witnesses and normal may depend on earlier queries.
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
    /// Start of the next walk: the last features, or features extrapolated by the motion of one
    /// step.
    #[cfg_attr(feature = "serde", serde(default))]
    next: Option<FeaturePair>,
    starts: Starts,
    totals: TrackerWork,
    /// The polytope of the last outcome, if it was an overlap.
    #[cfg_attr(feature = "serde", serde(default))]
    memory: Memory,
    /// The proof of the last outcome, if it was an overlap without depth.
    #[cfg_attr(feature = "serde", serde(default))]
    overlap_proof: Option<OverlapProof>,
}

impl Tracker {
    /// Returns a tracker that starts cold.
    ///
    /// The first query starts at the support vertices along the line of centres.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the closest features, their witness points and proven bounds of the distance.
    ///
    /// Separated bodies get bounds at most `1e-13 L` apart, where `L` is the pair size
    /// ([front page](crate#guarantees)). Overlapping bodies get their depth as a negative distance,
    /// with bounds as well. Queries of separated bodies allocate only if they need exact
    /// arithmetic. The depth of an overlap needs memory, which the tracker keeps and can allocate
    /// in advance ([`reserve`](Self::reserve)).
    ///
    /// A query tests a few vertices, even if faces or fans of thousands of edges lie flush. One
    /// query is an exception: the depth of an overlap whose centre is equally deep under all these
    /// edges (two cones with coaxial apexes). Each edge may be the deepest and is tested, in about
    /// 3 to 7 µs.
    #[inline]
    pub fn closest(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose) -> Outcome {
        self.checked(a, b, a_from_b, DepthMode::Full)
    }

    /// Returns the closest features and a distance correct to one unit in the last place.
    ///
    /// The distance of separated bodies differs from the true distance by at most one unit in the
    /// last place. The query costs about ten times as much as [`closest`](Self::closest). Features
    /// that are certainly the closest have a distance in closed form, in double-double arithmetic.
    /// Other pairs, such as parallel faces, are solved in that arithmetic or in exact integers, in
    /// microseconds. The depth of an overlap keeps the bounds of `closest` unless its facets are
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
                until: DepthMode::Full,
            },
        );
        // Second case: a distance that f64 can represent only in the caller's unit, because it is
        // below the normal numbers in the stored unit.
        if outcome.solver == crate::pair::outcome::Solver::Far
            || outcome.state == ContactState::Separated && !outcome.is_tight()
        {
            outcome = out_of_range::exactly(a, b, a_from_b, outcome);
        }
        debug_check(a, b, a_from_b, &before, Accuracy::Exact, &outcome);
        outcome
    }

    /// Returns the closest points of separated bodies, and the contact state of an overlap without
    /// its depth.
    pub(crate) fn closest_or_class(
        &mut self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
    ) -> Outcome {
        self.measure(a, b, a_from_b, DepthMode::None)
    }

    /// Returns the signed distance and its bounds without the witnesses.
    pub fn distance(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose) -> Distance {
        self.bounds(a, b, a_from_b, DepthMode::Full)
    }

    /// Returns the closest features that the walk proposes, without bounds.
    ///
    /// If the walk does not end, the minimum-norm solver in f64 replaces it.
    #[inline]
    pub fn propose(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose) -> Proposal {
        let o = self.answer(
            a,
            b,
            a_from_b,
            Ask {
                accuracy: Accuracy::Walk,
                until: DepthMode::None,
            },
        );
        Proposal {
            distance: (o.state != ContactState::Overlapping).then_some(o.distance),
            features: o.features,
            point_on_a: o.point_on_a,
            point_on_b: o.point_on_b,
            normal: o.normal,
            solver: o.solver,
            work: o.work,
        }
    }

    /// Returns a tracker that starts from the given features.
    ///
    /// It ignores features that the bodies do not have.
    #[must_use]
    pub fn with_features(features: FeaturePair, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> Self {
        let features = features.is_of(a, b).then(|| features.walkable(a, b));
        Self {
            last: features,
            next: features,
            starts: Starts::default(),
            totals: TrackerWork::default(),
            memory: Memory::default(),
            overlap_proof: None,
        }
    }

    /// Returns a tracker that starts as after an outcome with these features and this state.
    ///
    /// Use this if you keep features and contact state yourself and no tracker. After an overlap,
    /// the next query for a depth starts at the facet of the features. After any other contact
    /// state the tracker equals that of [`with_features`](Self::with_features). A wrong hint costs
    /// time and never makes a result wrong.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::{RelativePose, Tracker, polyhedron::solids};
    ///
    /// let a = solids::cuboid(Vector3::new(1.0, 1.0, 1.0))?;
    /// let b = solids::octahedron(0.5)?;
    /// let pose = |x| {
    ///     RelativePose::from_isometry(&Isometry3::translation(x, 0.2, 0.1))
    /// };
    /// let before = Tracker::new().closest(&a, &b, &pose(1.48)?);
    ///
    /// // In the next frame, from what the caller kept:
    /// let mut pair = Tracker::with_previous(before.features, before.state, &a, &b);
    /// let now = pair.closest(&a, &b, &pose(1.49)?);
    /// assert!((now.distance + 0.01).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with_previous(
        features: FeaturePair,
        state: ContactState,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
    ) -> Self {
        let mut tracker = Self::with_features(features, a, b);
        if state == ContactState::Overlapping && features.is_of(a, b) {
            tracker.memory = Memory::after(features);
        }
        tracker
    }

    /// Allocates all the memory that overlaps may need later (about 50 kB).
    ///
    /// Afterwards no query allocates if the walk or its solvers in f64 suffice and polytopes have
    /// at most 256 triangles. Only round bodies deep in each other need more.
    pub fn reserve(&mut self) {
        self.memory.reserve();
    }

    /// Returns the features of the last outcome.
    #[must_use]
    pub fn features(&self) -> Option<FeaturePair> {
        self.last
    }

    /// Returns the query as a text that rebuilds the query bit for bit.
    ///
    /// Call this before the query; after the query the recorded start is the start of the next
    /// query.
    #[must_use]
    pub fn replay(
        &self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        accuracy: Accuracy,
    ) -> Replay {
        replay(a, b, a_from_b, self.start(a, b), self.memory.clone(), accuracy)
    }

    /// Returns the first broken invariant of the cached state: a tool for tests and fuzzing.
    ///
    /// # Errors
    /// Returns an error that names the broken invariant.
    pub fn check(&self) -> Result<(), String> {
        self.memory.check()
    }

    /// Returns the counters since the tracker was made or reset.
    #[must_use]
    pub fn work(&self) -> TrackerWork {
        self.totals
    }

    /// Drops the cached features and resets the counters.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// Computes the contact points of two bodies within `options.prediction`.
    ///
    /// `manifold` keeps the ids and the order of the contacts of the previous query. Keep one
    /// manifold per pair and pass it in every frame.
    ///
    /// If the bodies have moved at most `options.rebuild_motion` since the manifold was made, its
    /// points stay fixed to the bodies, and only their separations, the normal and the bounds are
    /// measured again. Otherwise the manifold is rebuilt from [`closest`](Self::closest), and its
    /// deepest contact is the contact of this outcome.
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::{Manifold, ManifoldOptions, RelativePose, Tracker};
    ///
    /// let floor = solids::cuboid(Vector3::new(5.0, 5.0, 1.0))?;
    /// let part = solids::cuboid(Vector3::new(0.5, 0.5, 0.5))?;
    /// let (mut pair, mut manifold) = (Tracker::new(), Manifold::new());
    /// let options = ManifoldOptions::default().prediction(0.02);
    /// for k in 0..10 {
    ///     let at = Isometry3::translation(0.1 * k as f64, 0.0, 1.49);
    ///     let a_from_b = RelativePose::from_isometry(&at)?;
    ///     pair.manifold(&floor, &part, &a_from_b, &options, &mut manifold);
    ///     assert_eq!(manifold.points().len(), 4);
    ///     for contact in manifold.points() {
    ///         let (id, point) = (contact.id, contact.point_on_a);
    ///         println!("{id}: {:.3} at {point}", contact.separation);
    ///     }
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn manifold(
        &mut self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        options: &ManifoldOptions,
        manifold: &mut Manifold,
    ) {
        let query = Query::new(a, b, a_from_b, options);
        if let Err(moved) = manifold.refresh(&query) {
            let outcome = match options.local_depth {
                false => self.closest(a, b, a_from_b),
                true => self.closest_with_local_depth(a, b, a_from_b),
            };
            manifold.renew(&query, &outcome, moved);
        }
    }

    /// Returns the closest features; an overlap gets a local depth.
    ///
    /// The query costs about three times as much as a walk.
    ///
    /// Separated bodies get the outcome of [`closest`](Self::closest). For an overlap, `normal` and
    /// `distance` belong to a facet of the Minkowski difference that is nearest in its
    /// neighbourhood; a walk finds it from the facet of the last outcome. A translation of B by
    /// `-lower` along the normal is proven to separate the bodies, so `-lower` is an upper bound of
    /// the depth. A shorter translation may suffice.
    ///
    /// `upper` is what the search proves on the way: it equals the distance (within `1e-13 L`) if
    /// the depth is proven to be the least; otherwise it is a bound, and zero if only the overlap
    /// is proven.
    ///
    /// Use this for bodies of 32 vertices or more in shallow contact. Do not use it for bodies of
    /// few vertices or for deep overlaps. Measured on round and flat bodies 1 % deep that rotate by
    /// half a degree per frame:
    ///
    /// * From 32 vertices on, [`closest`](Self::closest) takes 2.5 to 16 times as long, and one
    ///   query in a hundred 16 to 87 times. (Prisms that slide flush on each other: 1.0 to 1.7
    ///   times as long.)
    /// * If `upper` is zero, 25 % (flat bodies) to 80 % of the returned depths exceed the least
    ///   depth; if `upper` is a bound below zero, 2 % to 40 % do.
    /// * From 128 vertices on, such a depth is at most 1.2 times the least depth. At eight vertices
    ///   it is up to 5 times (round bodies) or 33 times (flat bodies) the least depth: the facet is
    ///   nearest only in its neighbourhood, and the next queries start from it.
    ///
    /// A query by [`closest`](Self::closest) of the same tracker returns to the deepest facet:
    ///
    /// ```
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::{RelativePose, Tracker, polyhedron::solids};
    ///
    /// let plate = solids::cuboid(Vector3::new(1.0, 1.0, 0.1))?;
    /// let peg = solids::cuboid(Vector3::new(0.1, 0.1, 0.5))?;
    /// let mut pair = Tracker::new();
    /// for k in 0..20 {
    ///     // The peg comes in over the rim of the plate, up to the centre.
    ///     let at = Isometry3::translation(1.1 - 0.05 * f64::from(k), 0.0, 0.5);
    ///     let pose = RelativePose::from_isometry(&at)?;
    ///     let mut o = pair.closest_with_local_depth(&plate, &peg, &pose);
    ///     if o.upper - o.lower > 0.01 {
    ///         o = pair.closest(&plate, &peg, &pose);
    ///     }
    ///     assert!(-o.distance < 0.11);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest_with_local_depth(
        &mut self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
    ) -> Outcome {
        self.checked(a, b, a_from_b, DepthMode::Local)
    }

    /// Returns whether the closed bodies share a point; touching counts.
    ///
    /// With the feature `exact` the result equals exact arithmetic on the poses given. Without
    /// `exact`, bodies within `1e-27 L` of touching count as intersecting.
    pub fn intersects(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose) -> bool {
        self.within(a, b, a_from_b, 0.0)
    }

    /// Returns whether the closed bodies are at most `d` apart, in the caller's unit.
    ///
    /// Always false for a negative or NaN `d`.
    ///
    /// With the feature `exact` the result equals exact arithmetic on the poses and the `d` given.
    /// Without `exact`, a distance that the bounds cannot distinguish from `d` counts as within.
    pub fn within(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose, d: f64) -> bool {
        if !(d >= 0.0) || clear_of(a, b, a_from_b, d) {
            return false;
        }
        let outcome = self.measure(a, b, a_from_b, DepthMode::None);
        self.decides_within(a, b, a_from_b, &outcome, d)
    }

    /// Returns the signed distance and its bounds; without a depth if `until` is
    /// [`DepthMode::None`].
    #[inline]
    pub(crate) fn bounds(
        &mut self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        until: DepthMode,
    ) -> Distance {
        Distance::from(&self.measure(a, b, a_from_b, until))
    }

    /// Returns the certified outcome; for an overlap, with the depth that `until` requests.
    #[inline]
    pub(crate) fn measure(
        &mut self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        until: DepthMode,
    ) -> Outcome {
        self.answer(a, b, a_from_b, Ask::certified(until))
    }

    /// Returns the outcome of [`measure`](Self::measure), checked in debug builds.
    #[inline]
    pub(crate) fn checked(
        &mut self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        until: DepthMode,
    ) -> Outcome {
        let before = self.before(a, b);
        let outcome = self.measure(a, b, a_from_b, until);
        debug_check(a, b, a_from_b, &before, Accuracy::Certified, &outcome);
        outcome
    }

    /// Returns the result of [`within`](Self::within) for a `d` that is not negative, from the
    /// outcome of the last query.
    #[inline]
    pub(crate) fn decides_within(
        &self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        outcome: &Outcome,
        d: f64,
    ) -> bool {
        if outcome.state == ContactState::Overlapping || outcome.upper <= d {
            true
        } else if outcome.lower > d {
            false
        } else {
            self.decide_within(a, b, a_from_b, d)
        }
    }

    /// Makes the next query without depth start from this proof, in expectation of an overlap.
    pub(crate) fn expect(&mut self, proof: OverlapProof) {
        self.overlap_proof = Some(proof);
    }

    /// Returns the number of triangles of the cached polytope of an overlap.
    pub(crate) fn facets(&self) -> usize {
        if self.overlap_proof.is_some() {
            4
        } else {
            self.memory.facets()
        }
    }

    /// Drops the cached polytope of an overlap, and its memory.
    pub(crate) fn free_memory(&mut self) {
        self.memory = Memory::default();
    }

    /// Exchanges the working memory of depth searches.
    ///
    /// All trackers of a scene share one such memory, because one per tracker would not stay in
    /// the cache.
    #[inline]
    pub(crate) fn exchange(&mut self, workspace: &mut Workspace) {
        self.memory.exchange(workspace);
    }

    /// Returns the bytes on the heap.
    pub(crate) fn memory_usage(&self) -> usize {
        self.memory.memory_usage()
    }

    /// Computes only the contact state, from the proof of the last outcome or by the solver of this
    /// proof.
    #[inline(never)]
    pub(super) fn still_overlaps(&mut self, posed: &PosedPair, draft: &mut Draft) -> bool {
        let first = *draft;
        let Some((hold, features)) = self.overlap_proof.zip(self.last.filter(|f| f.is_of(posed.a, posed.b))) else {
            return false;
        };
        draft.features = features;
        self.overlap_proof = hold.renewed(posed, features, draft);
        if self.overlap_proof.is_none() {
            let work = draft.work;
            *draft = first;
            draft.work = work;
            return false;
        }
        self.totals.note(true, draft.solver, &draft.work);
        if !(posed.a.is_unscaled && posed.b.is_unscaled) {
            to_user_units(posed.a, posed.b, draft);
        }
        true
    }

    #[cfg(feature = "exact")]
    #[cold]
    fn decide_within(&self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose, d: f64) -> bool {
        let hint = self
            .last
            .unwrap_or(crate::body::polyhedron::FeaturePair::FIRST)
            .vertices_of(a, b)
            .into();
        crate::convex::exact::within(a, b, a_from_b, hint, d)
    }

    #[cfg(not(feature = "exact"))]
    fn decide_within(&self, _: &ConvexPolyhedron, _: &ConvexPolyhedron, _: &RelativePose, _: f64) -> bool {
        true
    }

    /// Returns whether the closed bodies are at most the exact sum of three numbers apart.
    ///
    /// Works like [`within`](Self::within); false unless all three numbers are zero or positive.
    pub(crate) fn within_reach(
        &mut self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        reach: [f64; 3],
    ) -> bool {
        if !reach.iter().all(|&x| x >= 0.0) {
            return false;
        }
        let sum = reach[0] + reach[1] + reach[2];
        // Two roundings: within two units in the last place.
        let (least, most) = (sum.next_down().next_down(), sum.next_up().next_up());
        if clear_of(a, b, a_from_b, most) {
            return false;
        }
        let outcome = self.measure(a, b, a_from_b, DepthMode::None);
        if outcome.state == ContactState::Overlapping || outcome.upper <= least {
            return true;
        }
        outcome.lower <= most && self.decide_within_reach(a, b, a_from_b, &reach)
    }

    #[cfg(feature = "exact")]
    #[cold]
    fn decide_within_reach(
        &self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        reach: &[f64],
    ) -> bool {
        let hint = self
            .last
            .unwrap_or(crate::body::polyhedron::FeaturePair::FIRST)
            .vertices_of(a, b)
            .into();
        reach.contains(&f64::INFINITY) || crate::convex::exact::compare(a, b, a_from_b, hint, reach).is_le()
    }

    #[cfg(not(feature = "exact"))]
    fn decide_within_reach(&self, _: &ConvexPolyhedron, _: &ConvexPolyhedron, _: &RelativePose, _: &[f64]) -> bool {
        true
    }

    /// Answers a query at one accuracy; an overlap gets the depth that `ask` requests.
    ///
    /// The draft is written in place: a copy of the whole draft would wait until its fields have
    /// left the store queue.
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
            if ask == Ask::certified(DepthMode::None)
                && self.overlap_proof.is_some()
                && self.still_overlaps(&posed, draft)
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

    /// Computes the depth of an overlap, if requested; otherwise the next query starts in
    /// expectation of another overlap.
    #[inline(always)]
    fn deepen(&mut self, ask: Ask, posed: &PosedPair, draft: &mut Draft) {
        if draft.state == ContactState::Overlapping {
            self.overlap_proof = (ask.until == DepthMode::None).then(OverlapProof::default);
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
        // In the polytope the names of the bodies are exchanged.
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

    /// Returns the start of the next query: the cached pair, if it is usable and has been the
    /// cheaper start of late.
    ///
    /// The cached pair is usable if its features belong to these bodies. A tracker influences a
    /// result only by this start and by its cached overlap, so a replay records these.
    #[inline(always)]
    fn start(&self, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> Option<FeaturePair> {
        self.next.filter(|pair| self.starts.prefer_warm() && pair.is_of(a, b))
    }

    /// Captures the data with which a fault is reported, in builds that check for faults.
    #[inline(always)]
    fn before(&self, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> Option<(Option<FeaturePair>, Memory)> {
        cfg!(debug_assertions).then(|| (self.start(a, b), self.memory.clone()))
    }

    #[inline(always)]
    fn count(&mut self, warm: bool, a: &ConvexPolyhedron, b: &ConvexPolyhedron, draft: &Draft) {
        self.starts.learn(warm, &draft.work);
        self.totals.note(warm, draft.solver, &draft.work);
        // Only for bodies with long face boundaries or large fans, after a longer walk or a walk
        // that started at extrapolated features.
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
    start: Option<FeaturePair>,
    surface: Memory,
    accuracy: Accuracy,
) -> Replay {
    Replay {
        a: a.clone(),
        b: b.clone(),
        rounding_radii: [0.0; 2],
        pose: *pose,
        start,
        surface,
        accuracy,
    }
}

/// In debug builds, ends the program if an outcome contradicts itself, with the text that replays
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
    if let Some((start, surface)) = before
        && let Some(fault) = crate::pair::soundness::fault(a, b, pose, outcome)
    {
        let replay = replay(a, b, pose, *start, surface.clone(), accuracy);
        panic!("{fault}: {outcome:?}\n{replay}");
    }
}

impl Replay {
    /// Returns a tracker with the recorded start.
    #[must_use]
    pub fn tracker(&self) -> Tracker {
        let start = self.start.map(|pair| Tracker::with_features(pair, &self.a, &self.b));
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
    // The factor 1 + 2^-20 covers far more than the rounding of both sides. LEAST_SQUARE covers
    // more than the loss of squares below the normal numbers.
    pose.translation().norm_squared() > reach * reach * (1.0 + 1.0 / 1_048_576.0) + LEAST_SQUARE
}

/// Returns whether a pair with two stored units is computed in the unit of `x`.
///
/// True if `x` has the larger unit, or `y` is a point, which has no size.
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

/// The path of a walk, for display.
#[cfg(feature = "__internals")]
mod path {
    use alloc::vec::Vec;

    use super::{ConvexPolyhedron, Draft, FeaturePair, PosedPair, RelativePose, Tracker, seed};
    use crate::convex::walk::walk_observed;
    use crate::pair::outcome::Work;

    #[doc(hidden)]
    impl Tracker {
        /// Returns the feature pairs that the next walk would test, and whether it ends.
        ///
        /// The pairs are in the order of the walk.
        ///
        /// The flag is true if the walk ends on the last pair, and false if another solver
        /// continues from there. Nothing is changed or counted. The path is empty for bodies on
        /// which no walk is tried, because they are too far apart or their sizes differ too much.
        #[must_use]
        pub fn trace(
            &self,
            a: &ConvexPolyhedron,
            b: &ConvexPolyhedron,
            a_from_b: &RelativePose,
        ) -> (Vec<FeaturePair>, bool) {
            let Ok(posed) = PosedPair::new(a, b, a_from_b) else {
                return (Vec::new(), false);
            };
            let mut path = Vec::new();
            let start = self.start(a, b);
            let mut draft = Draft::starting_at(start.unwrap_or_else(|| seed::cold(&posed, &mut Work::default())));
            let ended = posed.same_scale() && walk_observed::<true>(&posed, &mut draft, |pair| path.push(pair));
            (path, ended)
        }
    }
}
