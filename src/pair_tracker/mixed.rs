//! The tracker of a pair that is not of two polyhedra: convex shapes, composites, meshes, surfaces
//! of patches.

use alloc::boxed::Box;
use core::any::Any;
#[cfg(feature = "serde")]
use core::mem::discriminant;

use nalgebra::{Point3, Vector3};

#[cfg(feature = "meshes")]
use super::contacts::FoundContacts;
use super::engine::{BodyShapes, ContactAsk, Contacted, PairEngine};
use super::over::{Kinds, OverTime};
use super::pair::{Asked, BallPair};
use super::tracked::{AnyKinds, PairOfKinds, Tracked};
use super::work::PairWork;
use crate::base::pose::{Operand, RelativePose};
use crate::body::shape::Shape;
#[cfg(feature = "meshes")]
use crate::composite::contact::{ContactPatches, PatchContacts};
use crate::convex::contact::{Manifold, ManifoldOptions};
use crate::convex::replay::Replay;
use crate::convex::shape_tracker::ShapeTracker;
use crate::pair::outcome::{Class, Outcome, Until};
use crate::pair::question::Question;
use crate::pair_tracker::geometry::Geometry;
use crate::time::separation::{Measure, Separation, ShapePair, Tangent};

/// The tracker of a pair that is not of two polyhedra, the parts of the last measurement, and the
/// contacts if they are called for.
#[derive(Clone, Debug)]
pub(crate) struct MixedTracker {
    tracker: Box<dyn AnyKinds>,
    parts: [u32; 2],
    #[cfg(feature = "meshes")]
    contacts: Option<Box<FoundContacts>>,
}

/// Two convex shapes.
type TrackedShapes = Tracked<ShapeTracker, Shape>;

impl PairOfKinds for TrackedShapes {
    type Pair<'p> = ShapePair<'p>;

    fn pair<'p>(&'p mut self, (a, b): BodyShapes<'p>) -> Option<ShapePair<'p>> {
        let (tracker, [a, b]) = self.sides([a.shape(), b.shape()])?;
        Some(ShapePair::new(a, b, tracker))
    }

    fn ball(&self, (a, b): BodyShapes<'_>, of: Operand) -> Option<(Point3<f64>, f64)> {
        self.side([a.shape(), b.shape()], of).map(Shape::bounding_ball)
    }

    fn work(&self) -> PairWork {
        PairWork::of_convex(self.tracker.work())
    }

    fn front_len(&self) -> usize {
        0
    }

    fn heap_bytes(&self) -> usize {
        0
    }

    #[cfg(feature = "serde")]
    fn stored(&self, _: [u32; 2]) -> StoredTracker {
        StoredTracker::Convex(Box::new(self.tracker.clone()))
    }
}

/// Returns a tracker without a start.
fn tracker_of((a, b): BodyShapes<'_>) -> Box<dyn AnyKinds> {
    #[cfg(feature = "surfaces")]
    if let Some(tracker) = super::patched::tracker((a, b)) {
        return tracker;
    }
    #[cfg(feature = "meshes")]
    if let Some(tracker) = super::parted::tracker((a, b)) {
        return tracker;
    }
    TrackedShapes::new([a.polyhedron_as_shape(), b.polyhedron_as_shape()])
}

impl From<Box<dyn AnyKinds>> for MixedTracker {
    fn from(tracker: Box<dyn AnyKinds>) -> Self {
        Self {
            tracker,
            parts: [0; 2],
            #[cfg(feature = "meshes")]
            contacts: None,
        }
    }
}

impl MixedTracker {
    /// Returns a tracker without a start.
    pub(super) fn new(bodies: BodyShapes<'_>) -> Self {
        Self::from(tracker_of(bodies))
    }

    /// Returns a tracker of two bodies of parts of which a composite stays one.
    #[cfg(feature = "meshes")]
    pub(super) fn of_pieces(bodies: BodyShapes<'_>) -> Self {
        Self::from(super::parted::of_pieces(bodies))
    }

    /// Starts the next query of two convex bodies along a direction from A to B, as after an answer
    /// of a class.
    pub(super) fn begin_along(&mut self, n: &Vector3<f64>) {
        if let Some(tracked) = self.shapes_mut() {
            tracked.tracker = ShapeTracker::along(n);
        }
    }

    /// Takes the recorded start of a query of two convex bodies.
    pub(super) fn begin_as(&mut self, replay: &Replay) {
        if let Some(tracked) = self.shapes_mut() {
            tracked.tracker = replay.shape_tracker();
        }
    }

    /// Returns the pair and the tracker.
    pub(super) fn over<'p>(&'p mut self, bodies: BodyShapes<'p>) -> OverTime<'p> {
        let tracker = &mut *self.tracker;
        OverTime(if (&*tracker as &dyn Any).is::<TrackedShapes>() {
            // Made once for all questions, as both balls are computed.
            let tracked = (tracker as &mut dyn Any).downcast_mut::<TrackedShapes>();
            match tracked.and_then(|tracked| tracked.pair(bodies)) {
                Some(pair) => Kinds::Convex(pair.with_balls()),
                None => Kinds::Balls(BallPair::new(bodies)),
            }
        } else {
            Kinds::Mixed { bodies, tracker }
        })
    }

    pub(super) fn work(&self) -> PairWork {
        self.tracker.work()
    }

    pub(super) fn front_len(&self) -> usize {
        self.tracker.front_len()
    }

    /// Returns the tracker if it is of type `K`.
    pub(super) fn of_kinds<K: AnyKinds>(&self) -> Option<&K> {
        (&*self.tracker as &dyn Any).downcast_ref()
    }

    #[inline]
    fn shapes_mut(&mut self) -> Option<&mut TrackedShapes> {
        (&mut *self.tracker as &mut dyn Any).downcast_mut()
    }

    /// Returns the tracker of two convex shapes, and the shapes.
    #[inline]
    pub(super) fn convex<'p>(&'p mut self, (a, b): BodyShapes<'p>) -> Option<(&'p mut ShapeTracker, [&'p Shape; 2])> {
        self.shapes_mut()?.sides([a.shape(), b.shape()])
    }

    /// Returns whether both bodies are convex.
    #[cfg(feature = "meshes")]
    pub(super) fn is_convex(&self) -> bool {
        self.of_kinds::<TrackedShapes>().is_some()
    }

    /// Returns the contacts by patches; `None` for bodies without.
    #[cfg(feature = "meshes")]
    pub(super) fn find_contacts(
        &mut self,
        bodies: BodyShapes<'_>,
        patches: [Option<&ContactPatches>; 2],
        pose: &RelativePose,
        options: &ManifoldOptions,
    ) -> Option<&[PatchContacts]> {
        if self.is_convex() {
            return None;
        }
        let contacts = self.contacts.get_or_insert_default();
        contacts.find(bodies, patches, pose, options)
    }
}

/// Returns the measure of an outcome, which proves a distance.
fn measure_of(found: &Outcome) -> Measure {
    Measure {
        by_plane: false,
        ..Measure::new(found, Tangent::Free)
    }
}

impl PairEngine for MixedTracker {
    type Shapes<'a> = BodyShapes<'a>;

    fn shapes<'a>(a: &'a Geometry, b: &'a Geometry) -> Option<Self::Shapes<'a>> {
        Some((a.into(), b.into()))
    }

    fn measure(&mut self, bodies: Self::Shapes<'_>, pose: &RelativePose, until: Until) -> Outcome {
        if let Some((tracker, [x, y])) = self.convex(bodies) {
            return ShapePair::new(x, y, tracker)
                .ask(pose, &Question::new().until(until))
                .outcome;
        }
        let answer = self.over(bodies).answer(pose, &Question::new());
        self.parts = answer.parts();
        answer.outcome
    }

    fn decides_within(&mut self, bodies: Self::Shapes<'_>, pose: &RelativePose, outcome: &Outcome, d: f64) -> bool {
        if outcome.class == Class::Overlapping || outcome.upper <= d {
            return true;
        }
        if outcome.lower > d {
            return false;
        }
        !self.over(bodies).within(pose, d, &Question::new()).is_no()
    }

    fn over_time<R>(
        &mut self,
        bodies: Self::Shapes<'_>,
        seen: Option<&Outcome>,
        ask: impl FnOnce(&mut dyn Separation, Option<Measure>) -> R,
    ) -> R {
        ask(&mut self.over(bodies), seen.map(measure_of))
    }

    /// Convex shapes have a manifold, composites and meshes contacts by patches.
    fn update_manifold(
        &mut self,
        bodies: Self::Shapes<'_>,
        pose: &RelativePose,
        ask: ContactAsk<'_>,
        stored: &mut Option<Box<Manifold>>,
    ) -> Contacted {
        let options = ask.options;
        if let Some((tracker, [x, y])) = self.convex(bodies) {
            let queries = tracker.work().queries;
            tracker.manifold(x, y, pose, options, stored.get_or_insert_default());
            // A manifold is rebuilt from a query.
            return if tracker.work().queries > queries {
                Contacted::Renewed
            } else {
                Contacted::Kept
            };
        }
        #[cfg(feature = "meshes")]
        if self.find_contacts(bodies, ask.patches, pose, options).is_some() {
            return Contacted::Kept;
        }
        Contacted::Nothing
    }

    #[cfg(feature = "meshes")]
    fn contacts(&self) -> Option<&[PatchContacts]> {
        self.contacts.as_deref().map(FoundContacts::found)
    }

    #[cfg(feature = "meshes")]
    fn drop_contacts(&mut self) {
        self.contacts = None;
    }

    fn pieces(&self) -> [u32; 2] {
        self.parts
    }

    fn facets(&self) -> usize {
        0
    }

    fn shed(&mut self) {}

    fn heap_bytes(&self) -> usize {
        self.tracker.heap_bytes()
    }
}

/// The serialized form of a tracker. Fronts of composites, meshes and surfaces are not written:
/// these trackers begin anew.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
pub(crate) enum StoredTracker {
    Convex(Box<ShapeTracker>),
    Pieces([u32; 2]),
    Triangles([u32; 2]),
    Patches([u32; 2]),
}

#[cfg(feature = "serde")]
impl MixedTracker {
    /// Returns the part of the tracker that is written.
    pub(crate) fn stored(&self) -> StoredTracker {
        self.tracker.stored(self.parts)
    }

    /// Returns the tracker of two bodies as written; `None` if the tracker is of other kinds.
    pub(crate) fn restored(stored: StoredTracker, a: &Geometry, b: &Geometry) -> Option<Self> {
        let mut tracker = Self::new((a.into(), b.into()));
        if discriminant(&tracker.stored()) != discriminant(&stored) {
            return None;
        }
        match stored {
            StoredTracker::Convex(known) => tracker.shapes_mut()?.tracker = *known,
            StoredTracker::Pieces(parts) | StoredTracker::Triangles(parts) | StoredTracker::Patches(parts) => {
                tracker.parts = parts;
            }
        }
        Some(tracker)
    }
}
