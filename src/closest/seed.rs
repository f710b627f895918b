//! Where a walk starts without a cached pair: at the vertices that face each other along the line of centres.

use super::fallback::{Minimum, solve_coarsely};
use super::outcome::Work;
use super::placed::Placed;
use super::refine;
use crate::polyhedron::FeaturePair;
use crate::pose::Which;

/// Cold: the support vertices along the line of centres (cube map and hill climb), which on round bodies are a few steps
/// from the closest features; on flat ones of some size, the minimum of their cube maps.
pub(crate) fn cold(placed: &Placed, work: &mut Work) -> FeaturePair {
    let facing = facing(placed);
    if placed.a.is_long_way() || placed.b.is_long_way() {
        work.coarse += 1;
        nearer(placed, facing)
    } else {
        facing
    }
}

/// The support vertices along the line of centres.
fn facing(placed: &Placed) -> FeaturePair {
    let n = placed.point_in_a(&placed.b.center()) - placed.a.center();
    let a = placed.a.climb_cold(&n);
    let b = placed.b.climb_cold(&-placed.direction_in_b(&n));
    FeaturePair::vertices(Which::A, a, b)
}

/// Features near the minimum of the vertices of the cube maps, from a vertex of each of the given ones.
#[cold]
pub(crate) fn nearer(placed: &Placed, from: FeaturePair) -> FeaturePair {
    let (Minimum::Inside { simplex } | Minimum::Outside { simplex, .. }) = solve_coarsely(placed, from);
    refine::features(placed, &simplex)
}
