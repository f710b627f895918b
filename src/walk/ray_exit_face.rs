//! Exit face of a ray: the next face to test for a point behind the current face.
//!
//! With `c` inside the body, `n . (x - c) / (o - n . c)` over the faces (normal `n`, offset `o`) is
//! a linear function over the vertices of the dual polyhedron. Hill climbing over adjacent faces
//! therefore ends at the greatest value, without local maxima: the face by which the ray from `c`
//! to `x` leaves the body. If the value is below 1, `x` is inside. (The height `n . x - o`, which a
//! scan of the faces would compare, has local maxima.)

use nalgebra::Vector3;

use crate::pair::draft::Draft;
use crate::pair::posed::OrderedPair;
use crate::polyhedron::unimodal::top_of_ring;
use crate::polyhedron::{ConvexPolyhedron, FeaturePair};
use crate::tolerance::{ON_BOUNDARY, UNIT};
use crate::tuning::polyhedron::LARGE;
use crate::walk::step::Step;

/// Returns the exit face of the ray from the vertex mean of the body to `x`, if `x` is above the
/// face by more than `least`.
#[cold]
pub(crate) fn exit_face(body: &ConvexPolyhedron, x: &Vector3<f64>, least: f64) -> Option<u32> {
    let (t, center) = (&body.topology, body.vertex_mean);
    let ray = x - center;
    // The depth of the mean is zero for flat bodies; then the side of `x` decides. The substitute
    // for zero scales with the body.
    let zero = UNIT * UNIT * body.radius;
    let ratio = |f: u32| {
        let plane = &body.planes[f as usize];
        plane.normal.dot(&ray) / (plane.offset - plane.normal.dot(&center)).max(zero)
    };
    let start = body.support_cold(&ray);
    let mut best = t.half_edge(t.fan(start).next()?).face;
    let mut top = ratio(best);
    let across = |h: u32| t.half_edge(t.half_edge(h).twin).face;
    // Round a face boundary or a fan the ratio is unimodal, or nearly so: bisection finds the best
    // of thousands of faces.
    let best_across_ring = |ring: &[u32]| across(ring[top_of_ring(ring.len(), |k| ratio(across(ring[k])))]);
    let best_of_fan = |v: u32| {
        let face = |k: usize| t.half_edge(t.fan(v).start + k as u32).face;
        face(top_of_ring(t.fan(v).len(), |k| ratio(face(k))))
    };
    loop {
        let from = best;
        let mut consider = |f: u32| {
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
    let plane = &body.planes[best as usize];
    (plane.normal.dot(x) - plane.offset > least).then_some(best)
}

/// Jumps from behind `face` to the exit face of `x`, or gives up if there is none.
#[cold]
pub(crate) fn jump_to_exit_face<S: OrderedPair>(
    pair: &S,
    vertex: u32,
    face: u32,
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
