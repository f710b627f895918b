//! The simplex from which the minimum-norm solver starts: vertices of the features of a proposal,
//! about its witnesses.
//!
//! ```text
//!   v_k+1 .------. v_k        Face and vertex: of the triangles v_0 v_k v_k+1 of the face, the one
//!         |`.  x |            that holds the witness x, minus the vertex. Two edges: the half of
//!         |   `. |            the parallelogram of their differences that holds the crossing.
//!         '-----`. v_0
//! ```
//!
//! If the features of the proposal are the closest ones, one support more is the proof.

use crate::base::num::each::Each;
use nalgebra::Vector3;

use crate::base::num::scalar::Scalar;
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, HalfEdgeId, VertexId};
use crate::convex::minimum::simplex::Simplex;
use crate::pair::difference::difference_point;
use crate::pair::draft::Draft;
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;

/// Returns the simplex of one vertex of each feature.
pub(crate) fn vertex_of<T: Scalar>(posed: &PosedPair, frame: &Transform<T>, from: FeaturePair) -> Simplex<T> {
    let (a, b) = from.vertices_of(posed.a, posed.b);
    Simplex::vertex(difference_point(posed, frame, a, b))
}

/// Returns the simplex of the features of a draft whose witnesses lie on these features.
pub(crate) fn about_witnesses<T: Scalar>(posed: &PosedPair, frame: &Transform<T>, draft: &Draft) -> Simplex<T> {
    let point = |a, b| difference_point(posed, frame, a, b);
    let (x, y) = (&draft.point_on_a.coords, &draft.point_on_b.coords);
    match (draft.features.a, draft.features.b) {
        (Feature::Edge(e), Feature::Vertex(b)) => Simplex::edge(ends(posed.a, e, x).each(|a| point(a, b))),
        (Feature::Vertex(a), Feature::Edge(g)) => Simplex::edge(ends(posed.b, g, y).each(|b| point(a, b))),
        (Feature::Face(f), Feature::Vertex(b)) => Simplex::triangle(triangle(posed.a, f, x).each(|a| point(a, b))),
        (Feature::Vertex(a), Feature::Face(f)) => Simplex::triangle(triangle(posed.b, f, y).each(|b| point(a, b))),
        (Feature::Edge(e), Feature::Edge(g)) => {
            let ([a, far_a], [b, far_b]) = (ends(posed.a, e, x), ends(posed.b, g, y));
            Simplex::triangle([point(a, b), point(far_a, b), point(a, far_b)])
        }
        _ => vertex_of(posed, frame, draft.features),
    }
}

/// Returns the ends of an edge, the end closer to `x` first.
fn ends(body: &ConvexPolyhedron, edge: EdgeId, x: &Vector3<f64>) -> [VertexId; 2] {
    let (t, h) = (&body.topology, edge.half_edge());
    let (tail, head) = (t.from(h), t.half_edge(h).to);
    let squared = |v: VertexId| (body.points[v.index()] - x).norm_squared();
    if squared(head) < squared(tail) {
        [head, tail]
    } else {
        [tail, head]
    }
}

/// Returns three vertices of a face around `x`: the first vertex, and the ends of the edge by which
/// the ray from the first vertex through `x` leaves the face.
pub(crate) fn triangle(body: &ConvexPolyhedron, face: FaceId, x: &Vector3<f64>) -> [VertexId; 3] {
    let t = &body.topology;
    let first = t.from(t.rim_half_edge(face));
    let origin = body.points[first.index()];
    let left = body.planes[face.index()].normal.cross(&(x - origin));
    let to = |h: HalfEdgeId| t.half_edge(h).to;
    // The vertices turn about the first one, from right of the ray to left of it.
    let ends_right = |h: &HalfEdgeId| left.dot(&(body.points[to(*h).index()] - origin)) < 0.0;
    let exit = if let Some(ring) = t.ring(face) {
        let opposite = &ring[1..ring.len() - 1];
        opposite[opposite.partition_point(ends_right).min(opposite.len() - 1)]
    } else {
        let opposite = t.rim(face).skip(1).take_while(|&h| to(h) != first);
        let mut exit = t.half_edge(t.rim_half_edge(face)).next;
        for h in opposite {
            exit = h;
            if !ends_right(&h) {
                break;
            }
        }
        exit
    };
    [first, t.from(exit), to(exit)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::polyhedron::solids;
    use crate::rng::Rng;

    /// Points of small and of large faces: the triangle holds them.
    #[test]
    fn the_triangle_holds_the_point() {
        let mut rng = Rng::new(7);
        for corners in [3, 4, 5, 9, 40, 400] {
            let body = solids::prism(corners, 1.0, 1.0).expect("a prism");
            for face in body.faces().take(200) {
                let t = &body.topology;
                let rim: alloc::vec::Vec<_> = t.rim(face).map(|h| body.points[t.from(h).index()]).collect();
                for _ in 0..20 {
                    let weights: alloc::vec::Vec<f64> = rim.iter().map(|_| rng.range(0.0, 1.0).powi(9)).collect();
                    let sum: f64 = weights.iter().sum();
                    let x = rim
                        .iter()
                        .zip(&weights)
                        .map(|(v, w)| v * (w / sum))
                        .sum::<Vector3<f64>>();
                    let [p, q, r] = triangle(&body, face, &x).map(|v| body.points[v.index()]);
                    let n = body.planes[face.index()].normal;
                    let height = |p: Vector3<f64>, q: Vector3<f64>| n.dot(&(q - p).cross(&(x - p)));
                    let least = height(p, q).min(height(q, r)).min(height(r, p));
                    assert!(least > -1e-15, "{corners} {face:?}: {least}");
                }
            }
        }
    }
}
