//! Two steps off a face that are not states of the walk. An edge over a face descends until it
//! leaves the face or meets the face ([`slide`]). From a point behind the face, a ray finds the
//! next face to test ([`jump_to_exit_face`]).
//!
//! ```text
//!      start o                          start         point of the edge over the face
//!            | '. displacement          displacement  from start to the end of the half-edge
//!     height |   '.    |                height        of start above the plane of the face
//!            |     '.  | side plane     fall          change of height along displacement
//!            |       '.|                fraction      of displacement over the face, at most 1
//!     =======+=========+'.
//!       face           |  o end
//! ```
//!
//! With `c` inside the body, `n . (x - c) / (o - n . c)` over the faces (normal `n`, offset `o`) is
//! a linear function over the vertices of the dual polyhedron. Hill climbing over adjacent faces
//! therefore ends at the greatest value, without local maxima: the face by which the ray from `c`
//! to `x` leaves the body. If the value is below 1, `x` is inside. (The height `n . x - o`, which a
//! scan of the faces would compare, has local maxima.)

use nalgebra::Vector3;

use crate::base::num::extremes::Extremes;
use crate::base::num::packed::PackedVec3;
use crate::base::tolerance::{ON_BOUNDARY, UNIT};
use crate::body::polyhedron::fans::{Cycle, LARGE};
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, FeaturePair, HalfEdgeId, VertexId};
use crate::convex::walk::Step;
use crate::pair::draft::Draft;
use crate::pair::face::Face;
use crate::pair::posed::OrderedPair;

/// A half-edge over a face, descending towards the face.
pub(crate) struct Slide {
    /// The half-edge of the first body, in the descending direction.
    pub(crate) half_edge: HalfEdgeId,
    /// Point at which to start, in the frame of the face's body.
    pub(crate) start: PackedVec3,
    /// The face of the second body.
    pub(crate) face: FaceId,
    /// The edge of the face boundary over which the half-edge enters, if any.
    pub(crate) entry_edge: Option<EdgeId>,
}

/// Follows the edge to the first of: a side plane of the face (edge-edge), the end of the edge
/// (vertex-face), the plane of the face (the bodies meet).
pub(crate) fn slide<S: OrderedPair>(pair: &S, s: &Slide, draft: &mut Draft) -> Step {
    let (body, other) = (pair.first(), pair.second());
    let topology = &body.topology;
    let end = topology.half_edge(s.half_edge).to;
    let displacement = PackedVec3::new(&pair.point_in_second(&body.points[end.index()])) - s.start;
    let plane = &other.planes[s.face.index()];
    let face = Face {
        body: other,
        face: s.face,
        normal: &plane.normal,
    };
    let (fraction, next) = match face.exit(s.start, displacement, s.entry_edge) {
        Some((at, edge)) => (at, FeaturePair::edges(S::FIRST, topology.edge(s.half_edge), edge)),
        None => (1.0, FeaturePair::vertex_face(S::FIRST, end, s.face)),
    };
    let normal = PackedVec3::new(&plane.normal);
    let (height, fall) = (normal.dot(s.start) - plane.offset, normal.dot(displacement));
    if height <= 0.0 {
        return jump_to_exit_face(pair, end, s.face, &s.start.vector(), draft);
    }
    if height + fraction * fall <= 0.0 {
        Step::Lost
    } else {
        draft.move_to(next)
    }
}

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
    // Around a face boundary or a fan the ratio is unimodal, or nearly so: bisection finds the best
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

/// Jumps from behind `face` to the exit face of `x`, or stops if there is none.
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
