//! Where a walk starts without a cached pair: at the vertices that face each other along the line of centres.

use super::placed::Placed;
use crate::polyhedron::FeaturePair;
use crate::pose::Which;

/// The support vertices along the line of centres (cube map and hill climb).
pub(crate) fn facing(placed: &Placed) -> FeaturePair {
    let n = placed.point_in_a(&placed.b.center()) - placed.a.center();
    let a = placed.a.climb_cold(&n);
    let b = placed.b.climb_cold(&-placed.direction_in_b(&n));
    FeaturePair::vertices(Which::A, a, b)
}
