//! Vertex-face test: the vertex must lie over the face, and the plane of the face must support the
//! body of the vertex there.
//!
//! ```text
//!     \   /
//!      \ /  body of the vertex
//!       x             x       the vertex, in the frame of the face's body
//!       | height      height  of x above the plane of the face
//!    ---+------ face  foot    x - normal * height, or on the edge that x grazes
//! ```

use nalgebra::Vector3;

use crate::base::num::extremes::Bounded;
use crate::base::num::packed::PackedVec3;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{DIRECTION, ON_BOUNDARY};
use crate::body::polyhedron::{ConvexPolyhedron, EdgeId, FaceId, FeaturePair, VertexId};
use crate::convex::walk::Step;
use crate::convex::walk::slide::{Slide, jump_to_exit_face, slide};
use crate::pair::draft::Draft;
use crate::pair::face::{Face, FaceLocation};
use crate::pair::posed::OrderedPair;

/// Tests a vertex of the first body against a face of the second.
// Not inlined: otherwise the loop of the walk would hoist the loads of every kind of pair and spill
// them.
#[inline(never)]
pub(crate) fn test<const CERTIFY: bool, S: OrderedPair>(
    pair: &S,
    vertex: VertexId,
    face: FaceId,
    draft: &mut Draft,
) -> Step {
    let (body, other) = (pair.first(), pair.second());
    let vertex_point = body.points[vertex.index()];
    let x = pair.point_in_second(&vertex_point);
    let plane = &other.planes[face.index()];
    let size = pair.size();
    let (location, corner) = Face {
        body: other,
        face,
        normal: &plane.normal,
    }
    .locate(&x, size);
    if let FaceLocation::Outside(edge) = location {
        return draft.move_to(FeaturePair::vertex_edge(S::FIRST, vertex, edge));
    }
    let height = plane.normal.dot(&(x - corner));
    if height <= ON_BOUNDARY * size {
        return jump_to_exit_face(pair, vertex, face, &x, draft);
    }
    let n = pair.direction_in_first(&plane.normal);
    let fan = body.fan_minimum(vertex, &n);
    if let Some(h) = body.descending_edge(vertex, &fan, DIRECTION) {
        return slide(
            pair,
            &Slide {
                half_edge: h,
                start: PackedVec3::new(&x),
                face,
                entry_edge: None,
            },
            draft,
        );
    }
    let lower = if CERTIFY && body.proves_lowest(&fan, &n) {
        plane.normal.dot(&x) - plane.offset
    } else {
        f64::NEG_INFINITY
    };
    let (foot, height) = match location {
        FaceLocation::Grazes(edge) => closest_on_edge(other, edge, &x),
        _ => (x - plane.normal * height, height),
    };
    let normal = pair.normal(&plane.normal);
    draft.accept(normal, S::witnesses(vertex_point, foot), height, lower)
}

/// Returns the point of an edge closest to `x`, and the distance. If `x` grazes the face boundary,
/// the foot of the perpendicular may fall outside the face, and far outside at an acute vertex; the
/// point returned here belongs to the body.
#[cold]
fn closest_on_edge(body: &ConvexPolyhedron, edge: EdgeId, x: &Vector3<f64>) -> (Vector3<f64>, f64) {
    let (p, q) = (
        body.points[body.topology.from(edge.half_edge()).index()],
        body.points[body.topology.half_edge(edge.half_edge()).to.index()],
    );
    let u = q - p;
    let foot = p + u * ((x - p).dot(&u) / u.norm_squared()).clamped(0.0, 1.0);
    (foot, sqrt((x - foot).norm_squared()))
}
