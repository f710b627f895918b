//! A point on the back side of a face: which face does it see?
//!
//! With `c` inside the body, `n . (x - c) / (o - n . c)` over the faces is a linear function over the vertices of the
//! dual polyhedron, so climbing over neighbouring faces ends at the greatest of all, without local maxima: the face by
//! which the ray from `c` to `x` leaves the body. Where that is below one, `x` is inside. (The height `n . x - o` itself,
//! which is what a scan of the faces would compare, has local maxima.)

use nalgebra::Vector3;

use crate::pair::outcome::Outcome;
use crate::pair::posed::Sides;
use crate::polyhedron::unimodal::top_of_ring;
use crate::polyhedron::{ConvexPolyhedron, FeaturePair};
use crate::tolerance::{ON_BOUNDARY, UNIT};
use crate::tuning::polyhedron::LARGE;
use crate::walk::step::Step;

/// The face by which the ray from the mean of the body's vertices to `x` leaves it, if `x` is above it by more than `least`.
#[cold]
pub(crate) fn seen_face(body: &ConvexPolyhedron, x: &Vector3<f64>, least: f64) -> Option<u32> {
    let (t, center) = (&body.topology, body.vertex_mean);
    let way = x - center;
    // The depth of the mean is zero for flat bodies; then the side `x` is on decides. What stands for zero scales with the body.
    let zero = UNIT * UNIT * body.radius;
    let reach = |f: u32| {
        let plane = &body.planes[f as usize];
        plane.normal.dot(&way) / (plane.offset - plane.normal.dot(&center)).max(zero)
    };
    let near = body.support_cold(&way);
    let mut best = t.half_edge(t.fan(near).next()?).face;
    let mut top = reach(best);
    let across = |h: u32| t.half_edge(t.half_edge(h).twin).face;
    // Round a rim or a fan it rises once and falls once, or nearly so: the best of thousands of faces by bisection.
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

/// From behind `face` to the face that `x` sees.
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
