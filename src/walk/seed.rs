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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RelativePose;
    use crate::polyhedron::{Feature, solids};
    use nalgebra::{Isometry3, Point3};

    /// A cube beside a cube: the face that faces the other body, whichever body it belongs to.
    /// Bodies without faces, and apexes of many faces, start at vertices.
    #[test]
    fn a_cold_start_is_the_face_that_faces_the_other_body() {
        let cube = solids::cuboid(Vector3::repeat(0.5)).unwrap();
        let ball = solids::octahedron(0.5).unwrap();
        let segment = ConvexPolyhedron::segment(Point3::origin(), Point3::new(0.0, 1.0, 0.0)).unwrap();
        let start = |a: &ConvexPolyhedron, b: &ConvexPolyhedron, x: f64| {
            let pose = RelativePose::from_isometry(&Isometry3::translation(x, 0.01, 0.02)).unwrap();
            let posed = PosedPair::new(a, b, &pose).ok().unwrap();
            cold(&posed, &mut Work::default())
        };
        for x in [-3.0, 3.0] {
            let (face_of_a, face_of_b) = (start(&cube, &ball, x), start(&ball, &cube, x));
            for (face, vertex, side) in [(face_of_a.a, face_of_a.b, x), (face_of_b.b, face_of_b.a, -x)] {
                let Feature::Face(f) = face else { panic!("{face:?}") };
                assert!(matches!(vertex, Feature::Vertex(_)));
                assert_eq!(cube.planes[f.index()].normal, Vector3::x() * side.signum());
            }
        }
        assert_eq!(start(&segment, &segment, 3.0).a.dimension(), 0);
        let cone = solids::cone(40, 1.0, 1.0).unwrap();
        let above = RelativePose::from_isometry(&Isometry3::translation(0.0, 0.0, 5.0)).unwrap();
        let posed = PosedPair::new(&cone, &cube, &above).ok().unwrap();
        assert_eq!(cold(&posed, &mut Work::default()).a.dimension(), 0);
    }
}
