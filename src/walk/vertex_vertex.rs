//! A vertex beside a vertex: each must be the lowest of its body towards the other.

use crate::num::scalar::sqrt;
use crate::pair::outcome::Outcome;
use crate::pair::posed::Placed;
use crate::polyhedron::FeaturePair;
use crate::pose::Which;
use crate::tolerance::{DIFFERENCE, ON_BOUNDARY};
use crate::walk::step::Step;

// Not inlined: the walk's loop would hoist the loads of every kind of pair and spill them.
#[inline(never)]
pub(crate) fn look<const CERTIFY: bool>(placed: &Placed, a: u32, b: u32, outcome: &mut Outcome) -> Step {
    let (p, q) = (placed.a.points[a as usize], placed.b.points[b as usize]);
    let to_b = placed.point_in_a(&q) - p;
    let noise = DIFFERENCE * placed.size();
    let from_b = -to_b;
    let fan_a = placed.a.fan_minimum(a, &from_b);
    if let Some(h) = placed.a.descent(a, &fan_a, noise) {
        let edge = placed.a.topology.edge(h);
        return outcome.go(FeaturePair::vertex_edge(Which::B, b, edge));
    }
    let to_b_in_b = placed.direction_in_b(&to_b);
    let fan_b = placed.b.fan_minimum(b, &to_b_in_b);
    if let Some(h) = placed.b.descent(b, &fan_b, noise) {
        let edge = placed.b.topology.edge(h);
        return outcome.go(FeaturePair::vertex_edge(Which::A, a, edge));
    }
    let distance = sqrt(to_b.norm_squared());
    if distance <= ON_BOUNDARY * placed.size() {
        return Step::Lost;
    }
    let proven = CERTIFY && placed.a.proves_lowest(&fan_a, &from_b) && placed.b.proves_lowest(&fan_b, &to_b_in_b);
    // Both are extreme along the line that joins them, so the supporting planes are as far apart as they are.
    let lower = if proven { distance } else { f64::NEG_INFINITY };
    outcome.end(to_b / distance, (p, q), distance, lower)
}
