//! Vertex-edge test: the foot must lie on the edge, the vertex between the planes of the adjacent
//! faces, and the foot in the Voronoi region of the vertex.
//!
//! ```text
//!        x          x            the vertex, in the frame of the edge's body
//!        | d        u            q - p
//!   p ---+---> q    d            from the foot to x, orthogonal to u
//!                   nL, nR       normals of the left and right face: d = alpha nL + beta nR
//!                   alpha, beta  nR . (u x d) and -nL . (u x d), both >= 0
//! ```

use nalgebra::Vector3;

use crate::base::num::packed::PackedVec3;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{DIFFERENCE, ON_BOUNDARY};
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FeaturePair, VertexId};
use crate::convex::walk::Step;
use crate::pair::draft::Draft;
use crate::pair::posed::OrderedPair;
use crate::pair::star::EdgeSpan;
use crate::pair::star::one_norm;

/// Tests a vertex of the first body against an edge of the second.
// Not inlined: otherwise the loop of the walk would hoist the loads of every kind of pair and spill
// them.
#[inline(never)]
pub(crate) fn test<const CERTIFY: bool, S: OrderedPair>(
    pair: &S,
    vertex: VertexId,
    edge: EdgeId,
    draft: &mut Draft,
) -> Step {
    let (body, other) = (pair.first(), pair.second());
    let e = other.topology.half_edge(edge.half_edge());
    let twin = other.topology.half_edge(e.twin);
    let (p, q) = (other.points[twin.to.index()], other.points[e.to.index()]);
    let vertex_point = body.points[vertex.index()];
    let x = pair.point_in_second(&vertex_point);
    let (u, r) = (q - p, x - p);
    let noise = DIFFERENCE * pair.size();
    let (along, uu) = (r.dot(&u), u.norm_squared());
    let slack = noise * one_norm(&u);
    // Voronoi planes of the endpoints: V(p), V(q).
    if along < -slack {
        return draft.move_to(FeaturePair::vertices(S::FIRST, vertex, twin.to));
    }
    if along > uu + slack {
        return draft.move_to(FeaturePair::vertices(S::FIRST, vertex, e.to));
    }
    let inverse = 1.0 / uu;
    let s = along * inverse;
    let d = r - u * s;
    let correction = d.dot(&u) * inverse;
    let (s, d) = (s + correction, d - u * correction);
    // Voronoi planes of the adjacent faces: F(left), F(right).
    let w = u.cross(&d);
    let (left, right) = (&other.planes[e.face.index()], &other.planes[twin.face.index()]);
    let (alpha, beta) = (right.normal.dot(&w), -left.normal.dot(&w));
    if alpha < -slack || beta < -slack {
        let face = if alpha < beta { twin.face } else { e.face };
        return draft.move_to(FeaturePair::vertex_face(S::FIRST, vertex, face));
    }
    let n = pair.direction_in_first(&d);
    let fan = body.fan_minimum(vertex, &n);
    if let Some(h) = body.descending_edge(vertex, &fan, noise) {
        return draft.move_to(FeaturePair::edges(S::FIRST, body.topology.edge(h), edge));
    }
    // The distance is between points of the bodies: an endpoint if rounding puts the foot beyond
    // the edge.
    let length = sqrt(d.norm_squared());
    let (foot, distance) = if (0.0..=1.0).contains(&s) {
        (p + u * s, length)
    } else {
        let end = if s < 0.5 { p } else { q };
        (end, sqrt((x - end).norm_squared()))
    };
    if distance <= ON_BOUNDARY * pair.size() {
        return Step::Lost;
    }
    let per_length = 1.0 / length;
    let lower = if !(CERTIFY && body.proves_lowest(&fan, &n)) {
        f64::NEG_INFINITY
    } else if alpha > slack && beta > slack {
        // The signs of the weights prove the edge extreme (`FLANK`), so the supporting planes are
        // as far apart as vertex and line.
        length
    } else {
        height_over_planes(other, edge, &d, &x, [alpha, beta]) * per_length
    };
    let normal = pair.normal(&(d * per_length));
    draft.accept(normal, S::witnesses(vertex_point, foot), distance, lower)
}

/// Lower bound of the height of `x` above the body of an edge, in units of `d`, from the planes of
/// the adjacent faces, if signs do not prove the edge extreme.
#[cold]
#[inline(never)]
fn height_over_planes(
    body: &ConvexPolyhedron,
    edge: EdgeId,
    d: &Vector3<f64>,
    x: &Vector3<f64>,
    weights: [f64; 2],
) -> f64 {
    let EdgeSpan { left, right, .. } = EdgeSpan::new(body, edge);
    d.dot(x) - body.edge_bound(PackedVec3::new(d), left, right, weights, d.norm_squared())
}
