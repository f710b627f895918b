//! Where a walk starts without a cached pair: at vertices that face each other.

use crate::pair::outcome::Work;
use crate::pair::posed::Placed;
use crate::polyhedron::FeaturePair;
use crate::pose::Which;
use crate::walk::ellipsoid;

/// Cold: the support vertices (cube map and hill climb) along the line of centres, which on round bodies are a few steps from
/// the closest features; on flat ones, along the direction in which their ellipsoids face each other.
pub(crate) fn cold(placed: &Placed, work: &mut Work) -> FeaturePair {
    let n = if placed.a.is_flat || placed.b.is_flat {
        work.ellipsoids += 1;
        ellipsoid::direction(placed)
    } else {
        placed.point_in_a(&placed.b.center()) - placed.a.center()
    };
    let a = placed.a.climb_cold(&n);
    let b = placed.b.climb_cold(&-placed.direction_in_b(&n));
    FeaturePair::vertices(Which::A, a, b)
}
