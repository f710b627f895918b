//! The state of a pair of geometries: [`Tracker`] for two polyhedra, [`MixedTracker`] for every
//! other pair of kinds.

use alloc::boxed::Box;

use nalgebra::Vector3;

use super::mixed::MixedTracker;
use super::over::{Kinds, OverTime};
use super::pair::{Asked, BallPair};
#[cfg(feature = "meshes")]
use super::tracked::AnyKinds;
use super::work::PairWork;
use crate::base::pose::RelativePose;
use crate::body::polyhedron::{ConvexPolyhedron, FeaturePair};
#[cfg(feature = "meshes")]
use crate::composite::contact::{ContactPatches, PatchContacts};
use crate::convex::contact::{Manifold, ManifoldOptions, Query};
use crate::convex::replay::Replay;
use crate::convex::tracker::{Tracker, Workspace};
use crate::pair::outcome::{Accuracy, Decision, Outcome, Until};
use crate::pair::question::Question;
use crate::pair::spot::Answer;
use crate::pair_tracker::geometry::{Geometry, GeometryRef, Lent};
use crate::time::separation::{Measure, PolyhedronPair, Separation, ShapePair};

/// What a contact stage starts from: the last outcome, the options, and the patches of bodies that
/// are not convex.
pub(crate) struct ContactAsk<'a> {
    pub(crate) outcome: &'a Outcome,
    pub(crate) options: &'a ManifoldOptions,
    #[cfg(feature = "meshes")]
    pub(crate) patches: [Option<&'a ContactPatches>; 2],
}

/// What an update of contact points did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Contacted {
    /// The pair has no contact points that can be found.
    Nothing,
    /// The points were measured again.
    Kept,
    /// The manifold was made anew.
    Renewed,
}

/// State of a pair between queries. Implemented by two types, so that pairs of polyhedra pay
/// nothing for the other kinds.
pub(crate) trait PairEngine: Clone + Send + Sync {
    /// The two shapes in the form in which the tracker takes them.
    type Shapes<'a>: Copy;

    /// Returns the shapes of a pair of this tracker; `None` for another pair.
    fn shapes<'a>(a: &'a Geometry, b: &'a Geometry) -> Option<Self::Shapes<'a>>;

    /// Returns the signed distance with bounds and features; an overlap without a depth if `until`
    /// is [`Until::Class`].
    fn measure(&mut self, shapes: Self::Shapes<'_>, pose: &RelativePose, until: Until) -> Outcome;

    /// Exchanges the working memory of measurements, which holds nothing between two, for another.
    fn exchange(&mut self, _: &mut Workspace) {}

    /// Returns whether the shapes are at most `d` apart, from the outcome of the last measurement.
    fn decides_within(&mut self, shapes: Self::Shapes<'_>, pose: &RelativePose, outcome: &Outcome, d: f64) -> bool;

    /// Asks the pair in the form that can be measured over time, with the last outcome as a
    /// measure.
    fn over_time<R>(
        &mut self,
        shapes: Self::Shapes<'_>,
        seen: Option<&Outcome>,
        ask: impl FnOnce(&mut dyn Separation, Option<Measure>) -> R,
    ) -> R;

    /// Updates the contact points of a pair within the prediction.
    fn update_manifold(
        &mut self,
        shapes: Self::Shapes<'_>,
        pose: &RelativePose,
        ask: ContactAsk<'_>,
        stored: &mut Option<Box<Manifold>>,
    ) -> Contacted;

    /// Returns the contacts of a pair with a body that is not convex.
    #[cfg(feature = "meshes")]
    fn contacts(&self) -> Option<&[PatchContacts]> {
        None
    }

    /// Forgets the contacts of a pair that is beyond the prediction.
    fn drop_contacts(&mut self) {}

    /// Returns the pieces or triangles of the last measurement; zero for shapes of one piece.
    fn pieces(&self) -> [u32; 2];

    /// Returns the number of triangles of the cached surface of an overlap.
    fn facets(&self) -> usize;

    /// Drops the cached surface of an overlap.
    fn shed(&mut self);

    /// Returns the bytes on the heap.
    fn heap_bytes(&self) -> usize;
}

impl PairEngine for Tracker {
    type Shapes<'a> = (&'a ConvexPolyhedron, &'a ConvexPolyhedron);

    #[inline]
    fn shapes<'a>(a: &'a Geometry, b: &'a Geometry) -> Option<Self::Shapes<'a>> {
        a.as_polyhedron().zip(b.as_polyhedron())
    }

    #[inline]
    fn measure(&mut self, (a, b): Self::Shapes<'_>, pose: &RelativePose, until: Until) -> Outcome {
        Self::measure(self, a, b, pose, until)
    }

    #[inline]
    fn exchange(&mut self, workspace: &mut Workspace) {
        Self::exchange(self, workspace);
    }

    #[inline]
    fn decides_within(&mut self, (a, b): Self::Shapes<'_>, pose: &RelativePose, outcome: &Outcome, d: f64) -> bool {
        Self::decides_within(self, a, b, pose, outcome, d)
    }

    fn over_time<R>(
        &mut self,
        (a, b): Self::Shapes<'_>,
        seen: Option<&Outcome>,
        ask: impl FnOnce(&mut dyn Separation, Option<Measure>) -> R,
    ) -> R {
        let mut pair = PolyhedronPair::new(a, b, self);
        let seen = seen.map(|outcome| pair.seen(outcome));
        ask(&mut pair, seen)
    }

    /// If the bodies have hardly moved since the manifold was made, the points are measured again,
    /// else the manifold is rebuilt from the outcome.
    fn update_manifold(
        &mut self,
        (a, b): Self::Shapes<'_>,
        pose: &RelativePose,
        ContactAsk { outcome, options, .. }: ContactAsk<'_>,
        stored: &mut Option<Box<Manifold>>,
    ) -> Contacted {
        let query = Query::new(a, b, pose, options);
        let manifold = stored.get_or_insert_default();
        let Err(moved) = manifold.refresh(&query) else {
            return Contacted::Kept;
        };
        manifold.renew(&query, outcome, moved);
        Contacted::Renewed
    }

    fn pieces(&self) -> [u32; 2] {
        [0; 2]
    }

    #[inline]
    fn facets(&self) -> usize {
        Self::facets(self)
    }

    fn shed(&mut self) {
        Self::shed(self);
    }

    fn heap_bytes(&self) -> usize {
        Self::heap_bytes(self)
    }
}

/// The shapes of A and B.
pub(crate) type BodyShapes<'a> = (GeometryRef<'a>, GeometryRef<'a>);

/// The tracker of a pair of any kinds: of a planner's pair, or on the way from one table of a scene
/// to another, since tables of scenes store the variants apart.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "polyhedra, the usual pair, stay in place")]
pub(crate) enum AnyTracker {
    Polyhedra(Tracker),
    Mixed(MixedTracker),
}

impl AnyTracker {
    /// Returns a tracker without a start.
    pub(crate) fn new((a, b): BodyShapes<'_>) -> Self {
        match (a.0, b.0) {
            (Lent::Polyhedron(_), Lent::Polyhedron(_)) => Self::Polyhedra(Tracker::new()),
            _ => Self::Mixed(MixedTracker::new((a, b))),
        }
    }

    /// Returns a tracker of two bodies of parts of which a composite stays one.
    #[cfg(feature = "meshes")]
    pub(super) fn of_pieces(bodies: BodyShapes<'_>) -> Self {
        Self::Mixed(MixedTracker::of_pieces(bodies))
    }

    /// Starts the next query of two convex bodies, one of them curved, along a direction from A to
    /// B, as after an answer of a class.
    pub(super) fn begin_along(&mut self, n: &Vector3<f64>) {
        if let Self::Mixed(tracker) = self {
            tracker.begin_along(n);
        }
    }

    /// Takes the recorded start of a query of two convex bodies.
    pub(super) fn begin_as(&mut self, replay: &Replay) {
        match self {
            Self::Polyhedra(tracker) => *tracker = replay.tracker(),
            Self::Mixed(tracker) => tracker.begin_as(replay),
        }
    }

    /// Returns the signed distance with bounds and features of the shapes for which the tracker was
    /// made.
    pub(crate) fn measure(&mut self, (a, b): BodyShapes<'_>, pose: &RelativePose, until: Until) -> Outcome {
        match self {
            Self::Polyhedra(tracker) => match polyhedra(a, b) {
                Some((a, b)) => tracker.measure(a, b, pose, until),
                None => Outcome::starting_at(FeaturePair::FIRST),
            },
            Self::Mixed(tracker) => tracker.measure((a, b), pose, until),
        }
    }

    /// Returns whether the shapes are at most `d` apart, from the outcome of the last measurement.
    pub(crate) fn decides_within(
        &mut self,
        (a, b): BodyShapes<'_>,
        pose: &RelativePose,
        outcome: &Outcome,
        d: f64,
    ) -> bool {
        match self {
            Self::Polyhedra(tracker) => {
                polyhedra(a, b).is_some_and(|shapes| PairEngine::decides_within(tracker, shapes, pose, outcome, d))
            }
            Self::Mixed(tracker) => tracker.decides_within((a, b), pose, outcome, d),
        }
    }

    /// Returns the closest points. Convex pairs are asked directly, without what a cast needs.
    #[inline]
    pub(super) fn answer(&mut self, bodies: BodyShapes<'_>, pose: &RelativePose, question: &Question) -> Answer {
        if let Self::Mixed(tracker) = self
            && let Some((tracker, [a, b])) = tracker.convex(bodies)
        {
            return ShapePair::new(a, b, tracker).ask(pose, question);
        }
        self.over(bodies).answer(pose, question)
    }

    /// Returns whether the geometries are at most `d` apart.
    #[inline]
    pub(super) fn within(
        &mut self,
        bodies: BodyShapes<'_>,
        pose: &RelativePose,
        d: f64,
        question: &Question,
    ) -> Decision {
        if let Self::Mixed(tracker) = self
            && let Some((tracker, [a, b])) = tracker.convex(bodies)
        {
            return ShapePair::new(a, b, tracker).ask_within(pose, d, question);
        }
        self.over(bodies).within(pose, d, question)
    }

    /// Returns the pair and the tracker.
    pub(crate) fn over<'p>(&'p mut self, (a, b): BodyShapes<'p>) -> OverTime<'p> {
        match self {
            Self::Polyhedra(tracker) => OverTime(match polyhedra(a, b) {
                Some((x, y)) => Kinds::Polyhedra(PolyhedronPair::new(x, y, tracker)),
                None => Kinds::Balls(BallPair::new((a, b))),
            }),
            Self::Mixed(tracker) => tracker.over((a, b)),
        }
    }

    /// Returns whether both bodies are convex.
    #[cfg(feature = "meshes")]
    pub(super) fn is_convex(&self) -> bool {
        match self {
            Self::Polyhedra(_) => true,
            Self::Mixed(tracker) => tracker.is_convex(),
        }
    }

    /// Computes the manifold of two convex bodies; returns whether both are.
    pub(super) fn manifold(
        &mut self,
        (a, b): BodyShapes<'_>,
        pose: &RelativePose,
        options: &ManifoldOptions,
        manifold: &mut Manifold,
    ) -> bool {
        match self {
            Self::Polyhedra(tracker) => match polyhedra(a, b) {
                Some((a, b)) => tracker.manifold(a, b, pose, options, manifold),
                None => return false,
            },
            Self::Mixed(tracker) => match tracker.convex((a, b)) {
                Some((tracker, [a, b])) => tracker.manifold(a, b, pose, options, manifold),
                None => return false,
            },
        }
        true
    }

    /// Returns the contacts of two bodies that are not both convex; `None` if one bears none.
    #[cfg(feature = "meshes")]
    pub(super) fn contacts(
        &mut self,
        bodies: BodyShapes<'_>,
        pose: &RelativePose,
        options: &ManifoldOptions,
    ) -> Option<&[PatchContacts]> {
        match self {
            Self::Polyhedra(_) => None,
            Self::Mixed(tracker) => tracker.find_contacts(bodies, [None; 2], pose, options),
        }
    }

    /// Returns a query of two polyhedra, rounded or not, as a text.
    pub(super) fn replay(&mut self, (a, b): BodyShapes<'_>, pose: &RelativePose) -> Option<Replay> {
        match self {
            Self::Polyhedra(tracker) => polyhedra(a, b).map(|(a, b)| tracker.replay(a, b, pose, Accuracy::Certified)),
            Self::Mixed(tracker) => {
                let (tracker, [a, b]) = tracker.convex((a, b))?;
                tracker.replay(a, b, pose)
            }
        }
    }

    /// Returns the work of all queries so far.
    pub(super) fn work(&self) -> PairWork {
        match self {
            Self::Polyhedra(tracker) => PairWork::of_convex(tracker.work()),
            Self::Mixed(tracker) => tracker.work(),
        }
    }

    /// Returns the number of entries of the front that is kept.
    pub(super) fn front_len(&self) -> usize {
        match self {
            Self::Polyhedra(_) => 0,
            Self::Mixed(tracker) => tracker.front_len(),
        }
    }

    /// Returns the tracker of a pair that is not of two polyhedra, if it is of type `K`.
    #[cfg(feature = "meshes")]
    pub(super) fn of_kinds<K: AnyKinds>(&self) -> Option<&K> {
        match self {
            Self::Polyhedra(_) => None,
            Self::Mixed(tracker) => tracker.of_kinds(),
        }
    }

    /// Returns the bytes on the heap.
    pub(super) fn heap_bytes(&self) -> usize {
        match self {
            Self::Polyhedra(tracker) => tracker.heap_bytes(),
            Self::Mixed(tracker) => PairEngine::heap_bytes(tracker),
        }
    }

    /// Returns the parts of the last measurement.
    pub(crate) fn pieces(&self) -> [u32; 2] {
        match self {
            Self::Polyhedra(_) => [0; 2],
            Self::Mixed(tracker) => tracker.pieces(),
        }
    }
}

/// Returns the polyhedra of a pair of two.
#[inline]
fn polyhedra<'a>(a: GeometryRef<'a>, b: GeometryRef<'a>) -> Option<(&'a ConvexPolyhedron, &'a ConvexPolyhedron)> {
    a.polyhedron().zip(b.polyhedron())
}

/// The stored tracker of a pair.
#[derive(Clone, Copy)]
pub(crate) enum TrackerRef<'a> {
    Polyhedra(&'a Tracker),
    Mixed(&'a MixedTracker),
}

impl TrackerRef<'_> {
    /// Returns a tracker that begins with the state of this one, for the two bodies in the order of
    /// the pair or in the other.
    pub(crate) fn started(self, a: &Geometry, b: &Geometry, is_in_order: bool) -> Option<AnyTracker> {
        match self {
            Self::Polyhedra(tracker) => {
                let features = tracker.features()?;
                let features = if is_in_order { features } else { features.swapped() };
                let (a, b) = Tracker::shapes(a, b)?;
                Some(AnyTracker::Polyhedra(Tracker::starting_from(features, a, b)))
            }
            Self::Mixed(tracker) => is_in_order.then(|| AnyTracker::Mixed(tracker.clone())),
        }
    }
}
