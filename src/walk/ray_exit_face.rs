//! Exit face of a ray: the next face to test for a point behind the current face.
//!
//! With `c` inside the body, `n . (x - c) / (o - n . c)` over the faces (normal `n`, offset `o`) is
//! a linear function over the vertices of the dual polyhedron. Hill climbing over adjacent faces
//! therefore ends at the greatest value, without local maxima: the face by which the ray from `c`
//! to `x` leaves the body. If the value is below 1, `x` is inside. (The height `n . x - o`, which a
//! scan of the faces would compare, has local maxima.)

use nalgebra::Vector3;

use crate::pair::outcome::Outcome;
use crate::pair::posed::Sides;
use crate::polyhedron::fans::top_of_ring;
use crate::polyhedron::topology::LARGE;
use crate::polyhedron::{ConvexPolyhedron, FeaturePair};
use crate::tolerance::{ON_BOUNDARY, UNIT};
use crate::walk::step::Step;

/// Returns the exit face of the ray from the vertex mean of the body to `x`, if `x` is above the
/// face by more than `least`.
#[cold]
pub(crate) fn seen_face(body: &ConvexPolyhedron, x: &Vector3<f64>, least: f64) -> Option<u32> {
    let (t, center) = (&body.topology, body.vertex_mean);
    let way = x - center;
    // The depth of the mean is zero for flat bodies; then the side of `x` decides. The substitute
    // for zero scales with the body.
    let zero = UNIT * UNIT * body.radius;
    let reach = |f: u32| {
        let plane = &body.planes[f as usize];
        plane.normal.dot(&way) / (plane.offset - plane.normal.dot(&center)).max(zero)
    };
    let near = body.support_cold(&way);
    let mut best = t.half_edge(t.fan(near).next()?).face;
    let mut top = reach(best);
    let across = |h: u32| t.half_edge(t.half_edge(h).twin).face;
    // Round a face boundary or a fan the ratio is unimodal, or nearly so: bisection finds the best
    // of thousands of faces.
    let beyond = |ring: &[u32]| across(ring[top_of_ring(ring.len(), |k| reach(across(ring[k])))]);
    let around = |v: u32| {
        let face = |k: usize| t.half_edge(t.fan(v).start + k as u32).face;
        face(top_of_ring(t.fan(v).len(), |k| reach(face(k))))
    };
    loop {
        let from = best;
        let mut take = |f: u32| {
            let up = reach(f);
            if up > top {
                (best, top) = (f, up);
            }
        };
        if let Some(ring) = t.ring(from) {
            take(beyond(ring));
        } else {
            for h in t.rim(from) {
                take(across(h));
                if let Some(ring) = t.ring(across(h)) {
                    take(beyond(ring));
                }
                if t.fan(t.from(h)).len() > LARGE {
                    take(around(t.from(h)));
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
pub(crate) fn jump<S: Sides>(sides: &S, vertex: u32, face: u32, x: &Vector3<f64>, outcome: &mut Outcome) -> Step {
    match seen_face(sides.y(), x, ON_BOUNDARY * sides.size()) {
        Some(seen) if seen != face => {
            outcome.features = FeaturePair::vertex_face(S::OF, vertex, seen);
            Step::Jump
        }
        _ => Step::Lost,
    }
}
