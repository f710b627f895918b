//! Whether bodies are within a sum of numbers of each other: what rounded bodies ask.

use super::{Tracker, clear_of};
use crate::base::pose::RelativePose;
use crate::body::polyhedron::ConvexPolyhedron;
use crate::pair::outcome::{Class, Until};

impl Tracker {
    /// Returns whether the closed bodies are at most the exact sum of three numbers apart, like
    /// [`within`](Self::within); false unless all three numbers are zero or positive.
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
        let outcome = self.measure(a, b, a_from_b, Until::Class);
        if outcome.class == Class::Overlapping || outcome.upper <= least {
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
            .vertices_of(a, b);
        reach.contains(&f64::INFINITY) || crate::convex::exact::compare(a, b, a_from_b, hint, reach).is_le()
    }

    #[cfg(not(feature = "exact"))]
    fn decide_within_reach(&self, _: &ConvexPolyhedron, _: &ConvexPolyhedron, _: &RelativePose, _: &[f64]) -> bool {
        true
    }
}
