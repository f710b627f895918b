//! A query that stops at the class of an overlap, and what is decided from its outcome: what predicates and scenes ask.

use super::{Tracker, give_back};
use crate::closest::hold;
use crate::closest::outcome::{Class, Level, Outcome};
use crate::closest::placed::Placed;
use crate::penetration::Memory;
use crate::polyhedron::ConvexPolyhedron;
use crate::pose::RelativePose;

impl Tracker {
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
}
