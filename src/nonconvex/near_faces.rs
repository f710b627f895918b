//! A point and the faces of a convex polyhedron, one by one.
//!
//! A face is the fan of triangles at its first vertex. No tree is built: the time is proportional
//! to the number of edges.

use alloc::vec::Vec;

use nalgebra::{Point3, Vector3};

use crate::base::num::sort::sort;
use crate::body::polyhedron::{ConvexPolyhedron, Feature};
use crate::nonconvex::near_parts::order;
use crate::nonconvex::point::StoredPoint;
use crate::nonconvex::query::near::nearest_of_fan;
use crate::pair::location::WitnessLocation;
use crate::pair::point::PointOutcome;
use crate::pair::transform::StoredFrame;

/// Returns the outcomes of the faces of a polyhedron and a point, in rising order of their upper
/// bounds; `None` for a body without faces.
pub(crate) fn outcomes_of_faces(body: &ConvexPolyhedron, point: &Point3<f64>) -> Option<Vec<PointOutcome>> {
    let (frame, size) = (StoredFrame::of(body), body.radius);
    let mut stored = StoredPoint::new(point, frame, &Vector3::zeros(), size);
    stored.flush(body.flush());
    let (mut rim, mut found) = (Vec::new(), Vec::new());
    let mut all = Vec::with_capacity(body.face_count());
    for face in body.faces() {
        let vertices = body.face_vertices(face);
        rim.clear();
        rim.extend(vertices.map(|v| body.points[v.index()]));
        let corners = |k: u32| -> [Vector3<f64>; 3] { [rim[0], rim[k as usize], rim[k as usize + 1]] };
        if rim.len() < 3 {
            continue;
        }
        let near = nearest_of_fan(&stored.place, size, &rim, &mut found);
        let state = stored.state_beside(found.iter(), corners);
        let location = WitnessLocation::new(face.index() as u32, Feature::Face(face));
        all.push(stored.outcome(&near, &corners(near.item), state, || false, |_| location));
    }
    sort(&mut all, order);
    (!all.is_empty()).then_some(all)
}
