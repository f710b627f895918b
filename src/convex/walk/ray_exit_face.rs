//! Exit face of a ray: the next face to test for a point behind the current face.
//!
//! With `c` inside the body, `n . (x - c) / (o - n . c)` over the faces (normal `n`, offset `o`) is
//! a linear function over the vertices of the dual polyhedron. Hill climbing over adjacent faces
//! therefore ends at the greatest value, without local maxima: the face by which the ray from `c`
//! to `x` leaves the body. If the value is below 1, `x` is inside. (The height `n . x - o`, which a
//! scan of the faces would compare, has local maxima.)

use crate::body::polyhedron::fans::LARGE;
use nalgebra::Vector3;

use crate::base::num::extremes::Extremes;
use crate::base::tolerance::{ON_BOUNDARY, UNIT};
use crate::body::polyhedron::fans::Cycle;
use crate::body::polyhedron::{ConvexPolyhedron, FaceId, FeaturePair, HalfEdgeId, VertexId};
use crate::convex::walk::step::Step;
use crate::pair::draft::Draft;
use crate::pair::posed::OrderedPair;

/// Returns the exit face of the ray from the vertex mean of the body to `x`, if `x` is above the
/// face by more than `least`.
#[cold]
pub(crate) fn exit_face(body: &ConvexPolyhedron, x: &Vector3<f64>, least: f64) -> Option<FaceId> {
    let (t, center) = (&body.topology, body.vertex_mean);
    let ray = x - center;
    // The depth of the mean is zero for flat bodies; then the side of `x` decides. The substitute
    // for zero scales with the body.
    let zero = UNIT * UNIT * body.radius;
    let ratio = |f: FaceId| {
        let plane = &body.planes[f.index()];
        plane.normal.dot(&ray) / (plane.offset - plane.normal.dot(&center)).larger(zero)
    };
    let start = body.support_cold(&ray);
    let mut best = t.half_edge(t.fan(start).iter().next()?).face;
    let mut top = ratio(best);
    let across = |h: HalfEdgeId| t.half_edge(t.half_edge(h).twin).face;
    // Round a face boundary or a fan the ratio is unimodal, or nearly so: bisection finds the best
    // of thousands of faces.
    let best_across_ring = |ring: &[HalfEdgeId]| across(ring.top(|h| ratio(across(h))));
    let best_of_fan = |v: VertexId| {
        let face = |h| t.half_edge(h).face;
        face(t.fan(v).top(|h| ratio(face(h))))
    };
    loop {
        let from = best;
        let mut consider = |f: FaceId| {
            let value = ratio(f);
            if value > top {
                (best, top) = (f, value);
            }
        };
        if let Some(ring) = t.ring(from) {
            consider(best_across_ring(ring));
        } else {
            for h in t.rim(from) {
                consider(across(h));
                if let Some(ring) = t.ring(across(h)) {
                    consider(best_across_ring(ring));
                }
                if t.fan(t.from(h)).len() > LARGE {
                    consider(best_of_fan(t.from(h)));
                }
            }
        }
        if best == from {
            break;
        }
    }
    let plane = &body.planes[best.index()];
    (plane.normal.dot(x) - plane.offset > least).then_some(best)
}

/// Jumps from behind `face` to the exit face of `x`, or gives up if there is none.
#[cold]
pub(crate) fn jump_to_exit_face<S: OrderedPair>(
    pair: &S,
    vertex: VertexId,
    face: FaceId,
    x: &Vector3<f64>,
    draft: &mut Draft,
) -> Step {
    match exit_face(pair.second(), x, ON_BOUNDARY * pair.size()) {
        Some(exit) if exit != face => {
            draft.features = FeaturePair::vertex_face(S::FIRST, vertex, exit);
            Step::Jump
        }
        _ => Step::Lost,
    }
}
