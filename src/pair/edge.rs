//! An edge of a polyhedron with the planes of its two adjacent faces.

use nalgebra::Vector3;

use crate::num::packed::PackedVec3;
use crate::polyhedron::{ConvexPolyhedron, Plane};

/// The ends of an edge and the planes of its faces.
#[derive(Clone, Copy)]
pub(crate) struct Edge<'a> {
    pub(crate) tail: u32,
    pub(crate) head: u32,
    pub(crate) p: Vector3<f64>,
    pub(crate) q: Vector3<f64>,
    pub(crate) left: &'a Plane,
    pub(crate) right: &'a Plane,
}

impl<'a> Edge<'a> {
    #[inline(always)]
    pub(crate) fn new(body: &'a ConvexPolyhedron, edge: u32) -> Self {
        let e = body.topology.half_edge(edge);
        let twin = body.topology.half_edge(e.twin);
        Self {
            tail: twin.to,
            head: e.to,
            p: body.points[twin.to as usize],
            q: body.points[e.to as usize],
            left: &body.planes[e.face as usize],
            right: &body.planes[twin.face as usize],
        }
    }

    /// How far `t` leaves the faces on the right and on the left behind, for a normal turned by `sign`: the weights of
    /// the normal over the planes of the left and the right one, not negative inside.
    #[inline(always)]
    pub(crate) fn weights(&self, t: PackedVec3, sign: f64) -> (f64, f64) {
        let along = |plane: &Plane| t.dot(PackedVec3::new(&plane.normal));
        (-sign * along(self.right), sign * along(self.left))
    }
}
