//! Start of a walk without a cached pair: two vertices that face each other.

use crate::base::pose::Operand;
use crate::body::polyhedron::FeaturePair;
use crate::convex::walk::ellipsoid;
use crate::pair::outcome::Work;
use crate::pair::posed::PosedPair;

/// Returns the cold start: the support vertices (cube map and hill climb) along the line of
/// centres, on round bodies a few steps from the closest features. If a body is flat, the direction
/// is the normal of two touching ellipsoids instead ([`ellipsoid`]).
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
