//! Where a walk starts without a cached pair: at vertices that face each other.

use crate::pair::outcome::Work;
use crate::pair::posed::PosedPair;
use crate::polyhedron::FeaturePair;
use crate::pose::Operand;
use crate::walk::ellipsoid;

/// Cold: the support vertices (cube map and hill climb) along the line of centres, which on round bodies are a few steps from
/// the closest features; on flat ones, along the direction in which their ellipsoids face each other.
pub(crate) fn cold(posed: &PosedPair, work: &mut Work) -> FeaturePair {
    let n = if posed.a.is_flat || posed.b.is_flat {
        work.ellipsoids += 1;
        ellipsoid::direction(posed)
    } else {
        posed.point_in_a(&posed.b.center()) - posed.a.center()
    };
    let a = posed.a.support_cold(&n);
    let b = posed.b.support_cold(&-posed.direction_in_b(&n));
    FeaturePair::vertices(Operand::A, a, b)
}
