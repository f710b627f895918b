//! The result of testing one feature pair.

use nalgebra::{Unit, Vector3};

use crate::pair::outcome::Outcome;
use crate::pair::posed::Witnesses;
use crate::polyhedron::FeaturePair;

/// What the look at one pair says.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step {
    /// A neighbour is closer; it is the pair to look at next.
    Move,
    /// A face elsewhere sees the vertex from outside; the distance need not be smaller.
    Jump,
    /// Each witness lies in the Voronoi region of the other feature.
    Found,
    /// No neighbour helps: the bodies overlap or nearly touch, or rounding hides the way.
    Lost,
}

impl Outcome {
    /// Goes to a closer pair.
    #[inline(always)]
    pub(crate) fn go(&mut self, pair: FeaturePair) -> Step {
        self.features = pair;
        Step::Move
    }

    /// Ends at this pair: the unit direction from A to B in A's frame, the witnesses in their stored frames, their
    /// distance, and a lower bound of it before its error term (minus infinity where the tests do not prove one).
    #[inline(always)]
    pub(crate) fn end(&mut self, normal: Vector3<f64>, witnesses: Witnesses, distance: f64, lower: f64) -> Step {
        self.normal = Unit::new_unchecked(normal);
        self.point_on_a = witnesses.0.into();
        self.point_on_b = witnesses.1.into();
        self.distance = distance;
        self.lower = lower;
        Step::Found
    }
}
