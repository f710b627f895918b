//! Queries that may stop at the class of an overlap, and predicates decided from their outcomes.

use super::{Tracker, clear_of, debug_check, to_user_units};
use crate::base::pose::RelativePose;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::convex::depth::{Memory, Workspace};
use crate::convex::minimum::overlap_proof::OverlapProof;
use crate::pair::draft::Draft;
use crate::pair::outcome::{Accuracy, Ask, Class, Distance, Outcome, Until};
use crate::pair::posed::PosedPair;

impl Tracker {
    /// Returns whether the closed bodies share a point: touching is intersecting.
    ///
    /// With the feature `exact` the answer equals exact arithmetic on the poses given. Without
    /// `exact`, bodies within `1e-27 L` of touching count as intersecting.
    pub fn intersects(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose) -> bool {
        self.within(a, b, a_from_b, 0.0)
    }

    /// Returns whether the closed bodies are at most `d` apart, `d` in the caller's units. Always
    /// false for a negative or NaN `d`.
    ///
    /// With the feature `exact` the answer equals exact arithmetic on the poses and the `d` given.
    /// Without `exact`, a distance that the bounds cannot distinguish from `d` counts as within.
    pub fn within(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose, d: f64) -> bool {
        if !(d >= 0.0) || clear_of(a, b, a_from_b, d) {
            return false;
        }
        let outcome = self.measure(a, b, a_from_b, Until::Class);
        self.decides_within(a, b, a_from_b, &outcome, d)
    }

    /// Returns the signed distance and its bounds; the depth of an overlap stays open if `until` is
    /// [`Until::Class`].
    #[inline]
    pub(crate) fn bounds(
        &mut self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        until: Until,
    ) -> Distance {
        Distance::from(&self.measure(a, b, a_from_b, until))
    }

    /// Returns the certified outcome; of an overlap as much as `until` calls for.
    #[inline]
    pub(crate) fn measure(
        &mut self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        until: Until,
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
        until: Until,
    ) -> Outcome {
        let before = self.before(a, b);
        let outcome = self.measure(a, b, a_from_b, until);
        debug_check(a, b, a_from_b, &before, Accuracy::Certified, &outcome);
        outcome
    }

    /// Returns the answer of [`within`](Self::within) for a `d` that is not negative, from the
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
        if outcome.class == Class::Overlapping || outcome.upper <= d {
            true
        } else if outcome.lower > d {
            false
        } else {
            self.decide_within(a, b, a_from_b, d)
        }
    }

    /// Makes the next query without depth begin with the expectation of an overlap, from this
    /// proof.
    pub(crate) fn expect(&mut self, proof: OverlapProof) {
        self.overlap_proof = Some(proof);
    }

    /// Returns the number of triangles of the cached surface of an overlap.
    pub(crate) fn facets(&self) -> usize {
        if self.overlap_proof.is_some() {
            4
        } else {
            self.memory.facets()
        }
    }

    /// Drops the cached surface of an overlap, and its memory.
    pub(crate) fn shed(&mut self) {
        self.memory = Memory::default();
    }

    /// Exchanges the working memory of searches for a depth for another: a scene lends one to all
    /// its trackers, since one for each would not stay in the cache.
    #[inline]
    pub(crate) fn exchange(&mut self, workspace: &mut Workspace) {
        self.memory.exchange(workspace);
    }

    /// Returns the bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.memory.heap_bytes()
    }

    /// Computes the class alone from the proof of the last answer, or by the solver of this proof.
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
            .vertices_of(a, b);
        crate::convex::exact::within(a, b, a_from_b, hint, d)
    }

    #[cfg(not(feature = "exact"))]
    fn decide_within(&self, _: &ConvexPolyhedron, _: &ConvexPolyhedron, _: &RelativePose, _: f64) -> bool {
        true
    }
}
