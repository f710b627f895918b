//! An edge of a polyhedron with the planes of the two adjacent faces.

use nalgebra::Vector3;

use crate::base::num::packed::PackedVec3;
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, Plane, VertexId};

/// Endpoints of an edge and the planes of the adjacent faces.
#[derive(Clone, Copy)]
pub(crate) struct EdgeSpan<'a> {
    pub(crate) tail: VertexId,
    pub(crate) head: VertexId,
    pub(crate) p: Vector3<f64>,
    pub(crate) q: Vector3<f64>,
    pub(crate) left: &'a Plane,
    pub(crate) right: &'a Plane,
}

impl<'a> EdgeSpan<'a> {
    #[inline(always)]
    pub(crate) fn new(body: &'a ConvexPolyhedron, edge: EdgeId) -> Self {
        let e = body.topology.half_edge(edge.half_edge());
        let twin = body.topology.half_edge(e.twin);
        Self {
            tail: twin.to,
            head: e.to,
            p: body.points[twin.to.index()],
            q: body.points[e.to.index()],
            left: &body.planes[e.face.index()],
            right: &body.planes[twin.face.index()],
        }
    }

    /// Returns the weights `(alpha, beta)` of a normal over the normals of the left and right face:
    /// up to a positive factor, `sign (e x t)` is `alpha nL + beta nR`, with `e` the edge. Neither
    /// weight is negative if the normal lies between the two face normals.
    #[inline(always)]
    pub(crate) fn weights(&self, t: PackedVec3, sign: f64) -> (f64, f64) {
        let along = |plane: &Plane| t.dot(PackedVec3::new(&plane.normal));
        (-sign * along(self.right), sign * along(self.left))
    }
}
