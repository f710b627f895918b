//! Start of a walk without a cached pair: a face and a vertex that face each other.

use nalgebra::Vector3;

use crate::pair::outcome::Work;
use crate::pair::posed::PosedPair;
use crate::polyhedron::{ConvexPolyhedron, FaceId, FeaturePair, VertexId};
use crate::pose::Operand;
use crate::tuning::walk::FACING;
use crate::walk::ellipsoid;

/// Returns the cold start: the support vertices (cube map and hill climb) along the line of
/// centres, and of all faces at either the one most perpendicular to the line, on round bodies a
/// few steps from the closest features. If a body is flat, the direction is the normal of two
/// touching ellipsoids instead ([`ellipsoid`]).
pub(crate) fn cold(posed: &PosedPair, work: &mut Work) -> FeaturePair {
    let n = if posed.a.is_flat || posed.b.is_flat {
        work.ellipsoids += 1;
        ellipsoid::direction(posed)
    } else {
        posed.point_in_a(&posed.b.center()) - posed.a.center()
    };
    let m = -posed.direction_in_b(&n);
    let (a, b) = (posed.a.support_cold(&n), posed.b.support_cold(&m));
    match (facing(posed.a, a, &n), facing(posed.b, b, &m)) {
        (Some((x, face)), Some((y, _))) if x >= y => FeaturePair::vertex_face(Operand::B, b, face),
        (Some(_), Some((_, face))) => FeaturePair::vertex_face(Operand::A, a, face),
        _ => FeaturePair::vertices(Operand::A, a, b),
    }
}

/// Returns the face at a vertex whose normal is closest to a direction, and the component of the
/// normal along the direction. `None` for a body without faces, and for a vertex of many.
fn facing(body: &ConvexPolyhedron, vertex: VertexId, n: &Vector3<f64>) -> Option<(f64, FaceId)> {
    let fan = body.topology.fan(vertex);
    if body.face_count() == 0 || fan.len() > FACING {
        return None;
    }
    let faces = fan.iter().map(|h| body.topology.half_edge(h).face);
    let along = faces.map(|face| (body.planes[face.index()].normal.dot(n), face));
    along.reduce(|best, one| if one.0 > best.0 { one } else { best })
}
