//! The state of a pair in a table: a [`Tracker`] for two polyhedra, a [`TrackedPair`] for all
//! others.

use alloc::boxed::Box;
#[cfg(feature = "serde")]
use core::mem::discriminant;

use crate::base::pose::RelativePose;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::convex::contact::{Manifold, ManifoldOptions, Query};
use crate::convex::tracker::{Tracker, Workspace};
#[cfg(feature = "meshes")]
use crate::nonconvex::contact::{ContactGroup, ConvexPatches};
use crate::pair::options::QueryOptions;
use crate::pair::outcome::{DepthMode, Outcome};
#[cfg(feature = "meshes")]
use crate::pair_tracker::PairContacts;
#[cfg(feature = "serde")]
use crate::pair_tracker::StoredEngine;
use crate::pair_tracker::geometry::{Geometry, GeometryRef};
use crate::pair_tracker::{BorrowedPair, Engine, TrackedPair};
use crate::time::separation::{Measurement, PolyhedronPair, Separation, ShapePair};

/// Input of the contact stage: the last outcome, the options, and the patches of bodies that are
/// not convex.
pub(super) struct ContactAsk<'a> {
    pub(super) outcome: &'a Outcome,
    pub(super) options: &'a ManifoldOptions,
    #[cfg(feature = "meshes")]
    pub(super) patches: [Option<&'a ConvexPatches>; 2],
}

/// Result of an update of contact points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Contacted {
    /// No contact points can be found for the pair.
    Nothing,
    /// The points were measured again.
    Kept,
    /// The manifold was computed again.
    Renewed,
}

/// State of a pair between steps. Two types implement it, so that pairs of polyhedra do not pay for
/// the other kinds.
pub(super) trait PairEngine: Clone + Send + Sync {
    /// The two geometries in the form in which they are measured.
    type Shapes<'a>: Copy;

    /// Returns the geometries of a pair of this type; `None` for another pair.
    fn shapes<'a>(a: &'a Geometry, b: &'a Geometry) -> Option<Self::Shapes<'a>>;

    /// Returns the signed distance with bounds and features. An overlap has no depth if `until` is
    /// [`DepthMode::None`].
    fn measure(&mut self, shapes: Self::Shapes<'_>, pose: &RelativePose, until: DepthMode) -> Outcome;

    /// Exchanges the working memory of measurements for another. It contains nothing between two
    /// measurements.
    fn exchange(&mut self, _: &mut Workspace) {}

    /// Returns whether the geometries are at most `d` apart, from the outcome of the last
    /// measurement.
    fn decides_within(&mut self, shapes: Self::Shapes<'_>, pose: &RelativePose, outcome: &Outcome, d: f64) -> bool;

    /// Returns the pair in the form that can be measured over time, with the last outcome as a
    /// measurement.
    fn over_time<R>(
        &mut self,
        shapes: Self::Shapes<'_>,
        seen: Option<&Outcome>,
        ask: impl FnOnce(&mut dyn Separation, Option<Measurement>) -> R,
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
    fn contacts(&self) -> Option<&[ContactGroup]> {
        None
    }

    /// Forgets the contacts of a pair that is beyond the prediction.
    fn drop_contacts(&mut self) {}

    /// Returns the subshapes of the last measurement; zero for geometries with one piece.
    fn pieces(&self) -> [u32; 2] {
        [0; 2]
    }

    /// Returns the number of triangles of the cached polytope of an overlap.
    fn facets(&self) -> usize {
        0
    }

    /// Drops the cached polytope of an overlap.
    fn free_memory(&mut self) {}

    /// Returns the bytes on the heap.
    fn memory_usage(&self) -> usize;

    /// Returns an engine that starts with this state, for the two bodies in the order of the pair
    /// or in the opposite order.
    fn started(&self, a: &Geometry, b: &Geometry, is_in_order: bool) -> Option<Engine>;
}

impl PairEngine for Tracker {
    type Shapes<'a> = (&'a ConvexPolyhedron, &'a ConvexPolyhedron);

    #[inline]
    fn shapes<'a>(a: &'a Geometry, b: &'a Geometry) -> Option<Self::Shapes<'a>> {
        a.as_polyhedron().zip(b.as_polyhedron())
    }

    #[inline]
    fn measure(&mut self, (a, b): Self::Shapes<'_>, pose: &RelativePose, until: DepthMode) -> Outcome {
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
        ask: impl FnOnce(&mut dyn Separation, Option<Measurement>) -> R,
    ) -> R {
        let mut pair = PolyhedronPair::new(a, b, self);
        let seen = seen.map(|outcome| pair.seen(outcome));
        ask(&mut pair, seen)
    }

    /// If the bodies have hardly moved since the manifold was computed, its points are measured
    /// again. Otherwise it is rebuilt from the outcome.
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

    #[inline]
    fn facets(&self) -> usize {
        Self::facets(self)
    }

    fn free_memory(&mut self) {
        Self::free_memory(self);
    }

    fn memory_usage(&self) -> usize {
        Self::memory_usage(self)
    }

    fn started(&self, a: &Geometry, b: &Geometry, is_in_order: bool) -> Option<Engine> {
        let features = self.features()?;
        let features = if is_in_order { features } else { features.swapped() };
        let (a, b) = <Self as PairEngine>::shapes(a, b)?;
        Some(Engine::of_polyhedra(Self::with_features(features, a, b)))
    }
}

/// A pair that is not of two polyhedra.
impl PairEngine for Box<TrackedPair> {
    type Shapes<'a> = [GeometryRef<'a>; 2];

    fn shapes<'a>(a: &'a Geometry, b: &'a Geometry) -> Option<Self::Shapes<'a>> {
        Some([a.into(), b.into()])
    }

    fn measure(&mut self, shapes: Self::Shapes<'_>, pose: &RelativePose, until: DepthMode) -> Outcome {
        let answer = self
            .engine
            .borrow(shapes)
            .closest_with(pose, &QueryOptions::default().depth(until));
        self.parts = answer.parts();
        answer.outcome
    }

    fn decides_within(&mut self, shapes: Self::Shapes<'_>, pose: &RelativePose, outcome: &Outcome, d: f64) -> bool {
        self.engine.borrow(shapes).decides_within(pose, outcome, d)
    }

    fn over_time<R>(
        &mut self,
        shapes: Self::Shapes<'_>,
        seen: Option<&Outcome>,
        ask: impl FnOnce(&mut dyn Separation, Option<Measurement>) -> R,
    ) -> R {
        ask(&mut self.engine.borrow(shapes).over_time(), seen.map(ShapePair::seen))
    }

    /// Convex shapes have a manifold; compounds and meshes have contacts by convex patches.
    fn update_manifold(
        &mut self,
        shapes: Self::Shapes<'_>,
        pose: &RelativePose,
        ask: ContactAsk<'_>,
        stored: &mut Option<Box<Manifold>>,
    ) -> Contacted {
        if let BorrowedPair::Shapes(mut pair) = self.engine.borrow(shapes) {
            let (a, b, tracker) = pair.sides();
            let queries = tracker.work().queries;
            tracker.manifold(a, b, pose, ask.options, stored.get_or_insert_default());
            // A manifold is rebuilt from a query.
            return if tracker.work().queries > queries {
                Contacted::Renewed
            } else {
                Contacted::Kept
            };
        }
        #[cfg(feature = "meshes")]
        if let PairContacts::Patches(kept) = self.contacts.get_or_insert_with(PairContacts::of_patches)
            && kept.find(shapes, ask.patches, pose, ask.options).is_some()
        {
            return Contacted::Kept;
        }
        Contacted::Nothing
    }

    #[cfg(feature = "meshes")]
    fn contacts(&self) -> Option<&[ContactGroup]> {
        match self.contacts.as_ref()? {
            PairContacts::Patches(kept) => Some(kept.found()),
            PairContacts::Convex(_) => None,
        }
    }

    #[cfg(feature = "meshes")]
    fn drop_contacts(&mut self) {
        self.contacts = None;
    }

    fn pieces(&self) -> [u32; 2] {
        self.parts
    }

    fn memory_usage(&self) -> usize {
        size_of::<TrackedPair>() + self.engine.memory_usage()
    }

    fn started(&self, _: &Geometry, _: &Geometry, is_in_order: bool) -> Option<Engine> {
        is_in_order.then(|| self.engine.clone())
    }
}

/// Returns the state of a pair that is written to a file.
#[cfg(feature = "serde")]
pub(super) fn stored(pair: &TrackedPair) -> StoredEngine {
    pair.engine.stored(pair.parts)
}

/// Returns the state of two bodies from a file; `None` if it is of other kinds.
#[cfg(feature = "serde")]
pub(super) fn restored(stored: StoredEngine, a: &Geometry, b: &Geometry) -> Option<Box<TrackedPair>> {
    let mut pair = Box::new(TrackedPair::from(Engine::new([a.into(), b.into()])));
    if discriminant(&pair.engine.stored(pair.parts)) != discriminant(&stored) {
        return None;
    }
    match stored {
        StoredEngine::Polyhedra(tracker) => pair.engine = Engine::of_polyhedra(*tracker),
        StoredEngine::Convex(tracker) => {
            if let Engine::Shapes(engine) = &mut pair.engine {
                engine.tracker = *tracker;
            }
        }
        StoredEngine::Pieces(parts)
        | StoredEngine::Triangles(parts)
        | StoredEngine::Patches(parts)
        | StoredEngine::HalfSpace(parts) => {
            pair.parts = parts;
        }
    }
    Some(pair)
}
