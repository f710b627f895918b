//! A query that stops at the class of an overlap, and what is decided from its outcome: what predicates and scenes ask.

use super::{Tracker, clear_of, give_back};
use crate::closest::hold::{self, Hold};
use crate::closest::outcome::{Class, Distance, Level, Outcome};
use crate::closest::placed::Placed;
use crate::penetration::Memory;
use crate::polyhedron::ConvexPolyhedron;
use crate::pose::RelativePose;

impl Tracker {
    /// Whether the closed bodies share a point: touching is intersecting.
    ///
    /// With the feature `exact` the answer is that of exact arithmetic on the poses given. Without it, bodies within
    /// `1e-27 L` of touching count as intersecting.
    pub fn intersects(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose) -> bool {
        self.within(a, b, a_from_b, 0.0)
    }

    /// Whether the closed bodies are at most `d` apart, `d` in the caller's units. Never so for a negative or NaN `d`.
    ///
    /// With the feature `exact` the answer is that of exact arithmetic on the poses and the `d` given. Without it, a
    /// distance that the bounds cannot tell from `d` counts as within.
    pub fn within(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose, d: f64) -> bool {
        if !(d >= 0.0) || clear_of(a, b, a_from_b, d) {
            return false;
        }
        let outcome = self.look(a, b, a_from_b, false);
        self.decides_within(a, b, a_from_b, &outcome, d)
    }

    /// As [`distance`](Self::distance); of an overlap only that it is one, unless `deep`.
    #[inline]
    pub(crate) fn bounds(
        &mut self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        deep: bool,
    ) -> Distance {
        Distance::from(&self.answer(a, b, a_from_b, Level::Certified, deep))
    }

    /// As [`closest`](Self::closest), but an overlap gets its depth only if `deep`: else it is known as such and no more.
    #[inline]
    pub(crate) fn look(
        &mut self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        deep: bool,
    ) -> Outcome {
        self.answer(a, b, a_from_b, Level::Certified, deep)
    }

    /// What [`within`](Self::within) answers for a `d` that is not negative, from the outcome of the last query.
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

    /// Lets the next query without depth begin with an expectation of an overlap.
    pub(crate) fn expect(&mut self, hold: Hold) {
        self.hold = Some(hold);
    }

    /// Triangles of what is kept of an overlap.
    pub(crate) fn facets(&self) -> usize {
        if self.hold.is_some() { 4 } else { self.memory.facets() }
    }

    /// Gives up the surface kept of an overlap, and its room.
    pub(crate) fn shed(&mut self) {
        self.memory = Memory::default();
    }

    /// Bytes beside the tracker's own.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.memory.heap_bytes()
    }

    /// The class alone from the proof of the last answer, or from the solver that found it.
    #[inline(never)]
    pub(super) fn still_overlaps(&mut self, placed: &Placed, outcome: &mut Outcome) -> bool {
        let first = *outcome;
        let Some((hold, features)) = self.hold.zip(self.last.filter(|f| f.is_of(placed.a, placed.b))) else {
            return false;
        };
        outcome.features = features;
        if !hold.proves(placed, outcome) {
            self.hold = hold::regain(placed, features, outcome);
            if self.hold.is_none() {
                let work = outcome.work;
                *outcome = Outcome { work, ..first };
                return false;
            }
        }
        self.totals.queries += 1;
        self.totals.warm += 1;
        self.totals.answered[outcome.layer as usize] += 1;
        if !(placed.a.as_given && placed.b.as_given) {
            give_back(placed.a, placed.b, outcome);
        }
        true
    }

    #[cfg(feature = "exact")]
    #[cold]
    fn decide_within(&self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose, d: f64) -> bool {
        let hint = self.last.map_or((0, 0), |s| s.vertices_of(a, b));
        crate::closest::exact::within(a, b, a_from_b, hint, d)
    }

    #[cfg(not(feature = "exact"))]
    fn decide_within(&self, _: &ConvexPolyhedron, _: &ConvexPolyhedron, _: &RelativePose, _: f64) -> bool {
        true
    }
}
