//! Result of the test of a feature pair, and the two ways to write the result into an outcome.

use nalgebra::{Unit, Vector3};

use crate::body::polyhedron::FeaturePair;
use crate::pair::draft::Draft;
use crate::pair::posed::WitnessPair;

/// Result of the test of a feature pair.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step {
    /// An adjacent feature is closer: test the new pair next.
    Move,
    /// A distant face sees the vertex from outside: test that face next. The distance need not be
    /// smaller.
    Jump,
    /// Each witness lies in the Voronoi region of the opposite feature: the pair is accepted.
    Found,
    /// No adjacent feature is closer: the bodies overlap or nearly touch, or rounding hides the
    /// descent.
    Lost,
}

impl Draft {
    /// Moves to a closer pair.
    #[inline(always)]
    pub(crate) fn move_to(&mut self, pair: FeaturePair) -> Step {
        self.features = pair;
        Step::Move
    }

    /// Accepts the current pair: writes the unit direction from A to B in A's frame, the witnesses
    /// in their stored frames, their distance, and a lower bound of the distance before the error
    /// term (minus infinity if the tests do not prove one).
    #[inline(always)]
    pub(crate) fn accept(&mut self, normal: Vector3<f64>, witnesses: WitnessPair, distance: f64, lower: f64) -> Step {
        self.normal = Unit::new_unchecked(normal);
        self.point_on_a = witnesses.0.into();
        self.point_on_b = witnesses.1.into();
        self.distance = distance;
        self.lower = lower;
        Step::Found
    }
}
