//! Closest points, distances and proposals of two convex polyhedra, and the tracker as a text.

use alloc::string::String;
use alloc::vec::Vec;

use super::counts::{Starts, Totals};
use super::{Tracker, debug_check, replay};
use crate::base::pose::RelativePose;
use crate::body::polyhedron::{ConvexPolyhedron, FeaturePair};
use crate::convex::depth::Memory;
use crate::convex::replay::Replay;
use crate::convex::solve::out_of_range;
use crate::convex::walk::trace::trace;
use crate::pair::outcome::{Accuracy, Ask, Class, Distance, Outcome, Proposal, Until};
use crate::pair::posed::PosedPair;

impl Tracker {
    /// Returns a tracker without a start: the first query begins at the support vertices along the
    /// line of centres.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the closest features, their witnesses and bounds of the distance, certified:
    /// separated bodies get bounds no wider than `1e-13 L`, with `L` the size of the pair ([front
    /// page](crate#guarantees)). Overlapping bodies get their depth as a negative distance, bounded
    /// as well. Queries of separated bodies allocate nothing, unless exact arithmetic is needed;
    /// the depth of an overlap takes memory that the tracker keeps, or has allocated before
    /// ([`reserve`](Self::reserve)).
    ///
    /// A query tests a few vertices, even if faces or fans of thousands of edges lie flush. Only
    /// one query takes time in proportion to the number of such edges: the depth of an overlap
    /// whose centre is equally deep under all of them, as of two cones with coaxial apexes. Each
    /// may be the deepest, and is tested, in some 3 to 7 us.
    #[inline]
    pub fn closest(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose) -> Outcome {
        self.checked(a, b, a_from_b, Until::Depth)
    }

    /// Returns the closest features as [`closest`](Self::closest) does, with the distance of
    /// separated bodies within one unit in the last place of the truth. Costs some ten times
    /// `closest`: features that are the closest beyond doubt have a distance in closed form, in
    /// double-double arithmetic; other pairs, as of parallel faces, are solved in that arithmetic
    /// or in exact integers, in microseconds. The depth of an overlap keeps the bounds of
    /// [`closest`](Self::closest) unless its facets are decided over integers
    /// ([`Solver::Exact`](crate::Solver)).
    #[cfg(feature = "exact")]
    pub fn closest_exact(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose) -> Outcome {
        let before = self.before(a, b);
        let mut outcome = self.answer(
            a,
            b,
            a_from_b,
            Ask {
                accuracy: Accuracy::Exact,
                until: Until::Depth,
            },
        );
        // Second case: a distance that f64 holds in the caller's unit only, below the normal
        // numbers in the stored unit.
        if outcome.solver == crate::pair::outcome::Solver::Far
            || outcome.class == Class::Separated && !outcome.is_tight()
        {
            outcome = out_of_range::exactly(a, b, a_from_b, outcome);
        }
        debug_check(a, b, a_from_b, &before, Accuracy::Exact, &outcome);
        outcome
    }

    /// Returns the closest points of bodies apart, and of an overlap the class without its depth.
    pub(crate) fn closest_or_class(
        &mut self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
    ) -> Outcome {
        self.measure(a, b, a_from_b, Until::Class)
    }

    /// Returns the distance and its bounds without the witnesses.
    pub fn distance(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose) -> Distance {
        self.bounds(a, b, a_from_b, Until::Depth)
    }

    /// Returns the closest features as the walk proposes, without bounds. If the walk does not end,
    /// the minimum-norm solver in f64 is used.
    #[inline]
    pub fn propose(&mut self, a: &ConvexPolyhedron, b: &ConvexPolyhedron, a_from_b: &RelativePose) -> Proposal {
        let o = self.answer(
            a,
            b,
            a_from_b,
            Ask {
                accuracy: Accuracy::Walk,
                until: Until::Class,
            },
        );
        Proposal {
            distance: (o.class != Class::Overlapping).then_some(o.distance),
            features: o.features,
            point_on_a: o.point_on_a,
            point_on_b: o.point_on_b,
            normal: o.normal,
            solver: o.solver,
            work: o.work,
        }
    }

    /// Returns a tracker that starts from the given features; features that the bodies do not have
    /// are ignored.
    #[must_use]
    pub fn starting_from(features: FeaturePair, a: &ConvexPolyhedron, b: &ConvexPolyhedron) -> Self {
        let features = features.is_of(a, b).then(|| features.walkable(a, b));
        Self {
            last: features,
            next: features,
            starts: Starts::default(),
            totals: Totals::default(),
            memory: Memory::default(),
            overlap_proof: None,
        }
    }

    /// Allocates all the memory that overlaps may need later (some 50 kB): afterwards no query
    /// allocates if the walk or its solvers in f64 suffice, as long as surfaces have no more than
    /// 256 triangles. Only round bodies deep in each other need more.
    pub fn reserve(&mut self) {
        self.memory.reserve();
    }

    /// Returns the features of the last answer.
    #[must_use]
    pub fn features(&self) -> Option<FeaturePair> {
        self.last
    }

    /// Returns the pairs of features that the walk of the next query would test, in order, and
    /// whether the walk ends on the last pair rather than handing over there. Nothing is changed or
    /// counted. Empty for bodies on which no walk is tried: too far apart, or of sizes too
    /// different.
    #[must_use]
    pub fn trace(
        &self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
    ) -> (Vec<FeaturePair>, bool) {
        match PosedPair::new(a, b, a_from_b) {
            Ok(posed) => trace(&posed, self.start(a, b)),
            Err(_) => (Vec::new(), false),
        }
    }

    /// Returns the query as a text that rebuilds the query bit for bit: call this before the query,
    /// or the recorded start is the start of the next query.
    #[must_use]
    pub fn replay(
        &self,
        a: &ConvexPolyhedron,
        b: &ConvexPolyhedron,
        a_from_b: &RelativePose,
        accuracy: Accuracy,
    ) -> Replay {
        replay(a, b, a_from_b, (self.start(a, b), self.memory.clone()), accuracy)
    }

    /// Returns the first broken invariant of the cached state: a tool of tests and fuzzing.
    ///
    /// # Errors
    /// A text that names the broken invariant.
    pub fn check(&self) -> Result<(), String> {
        self.memory.check()
    }

    /// Returns the counters since the tracker was made or reset.
    #[must_use]
    pub fn work(&self) -> Totals {
        self.totals
    }

    /// Forgets features and counters.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
}
