//! Vertex-vertex test: each vertex must be the support vertex of its body towards the opposite
//! vertex.

use crate::base::num::scalar::sqrt;
use crate::base::pose::Operand;
use crate::base::tolerance::{DIFFERENCE, ON_BOUNDARY};
use crate::body::polyhedron::{FeaturePair, VertexId};
use crate::convex::walk::Step;
use crate::pair::draft::Draft;
use crate::pair::posed::PosedPair;

/// Tests a vertex of A against a vertex of B.
// Not inlined: otherwise the loop of the walk would hoist the loads of every kind of pair and spill
// them.
#[inline(never)]
pub(crate) fn test<const CERTIFY: bool>(posed: &PosedPair, a: VertexId, b: VertexId, draft: &mut Draft) -> Step {
    let (p, q) = (posed.a.points[a.index()], posed.b.points[b.index()]);
    let to_b = posed.point_in_a(&q) - p;
    let noise = DIFFERENCE * posed.size();
    let from_b = -to_b;
    let fan_a = posed.a.fan_minimum(a, &from_b);
    if let Some(h) = posed.a.descending_edge(a, &fan_a, noise) {
        let edge = posed.a.topology.edge(h);
        return draft.move_to(FeaturePair::vertex_edge(Operand::B, b, edge));
    }
    let to_b_in_b = posed.direction_in_b(&to_b);
    let fan_b = posed.b.fan_minimum(b, &to_b_in_b);
    if let Some(h) = posed.b.descending_edge(b, &fan_b, noise) {
        let edge = posed.b.topology.edge(h);
        return draft.move_to(FeaturePair::vertex_edge(Operand::A, a, edge));
    }
    let distance = sqrt(to_b.norm_squared());
    if distance <= ON_BOUNDARY * posed.size() {
        return Step::Lost;
    }
    let proven = CERTIFY && posed.a.proves_lowest(&fan_a, &from_b) && posed.b.proves_lowest(&fan_b, &to_b_in_b);
    // Both vertices are extreme along the line between them, so the supporting planes are as far
    // apart as the vertices.
    let lower = if proven { distance } else { f64::NEG_INFINITY };
    draft.accept(to_b / distance, (p, q), distance, lower)
}
