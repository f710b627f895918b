//! An edge over a face, which is no state of the walk: the edge descends until it leaves the face
//! or meets the face.
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

use crate::base::num::packed::PackedVec3;
use crate::body::polyhedron::{EdgeId, FaceId, FeaturePair, HalfEdgeId};
use crate::convex::walk::ray_exit_face::jump_to_exit_face;
use crate::convex::walk::step::Step;
use crate::pair::draft::Draft;
use crate::pair::face::Face;
use crate::pair::posed::OrderedPair;

/// A half-edge over a face, descending towards the face.
pub(crate) struct Slide {
    /// The half-edge of the first body, in the descending direction.
    pub(crate) half_edge: HalfEdgeId,
    /// Point at which to begin, in the frame of the face's body.
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
