//! The feature that contains a witness, in the body's frame.

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::shape::Core;
use lin_canny::{ConvexPolyhedron, Feature, Geometry};

/// A feature: one point for a vertex, two for an edge, the boundary of a face.
pub(super) struct Lit {
    pub(super) points: Vec<Point3<f64>>,
    /// Unit normals of the faces around it in order, which bound its Voronoi region. Empty for a
    /// triangle of a mesh, whose region is not drawn.
    pub(super) normals: Vec<Vector3<f64>>,
}

/// Returns the feature of a subshape; `None` on curved bodies.
pub(super) fn feature(geometry: &Geometry, part: u32, feature: Feature) -> Option<Lit> {
    if let Geometry::Mesh(mesh) = geometry {
        let (_, corners) = mesh.triangles().find(|(k, _)| *k == part)?;
        return Some(Lit {
            points: corners.to_vec(),
            normals: Vec::new(),
        });
    }
    let (body, pose) = polyhedron(geometry, part)?;
    let point = |v| body.vertex(v).map(|p| pose * p);
    let normal = |f| body.face_plane(f).map(|(n, _)| pose * n.into_inner());
    let (points, normals): (Vec<_>, Vec<_>) = match feature {
        Feature::Vertex(v) => (vec![point(v)?], body.vertex_faces(v).filter_map(normal).collect()),
        Feature::Edge(e) => {
            let [p, q] = body.edge_vertices(e)?;
            let faces = body.edge_faces(e).into_iter().flatten();
            (vec![point(p)?, point(q)?], faces.filter_map(normal).collect())
        }
        Feature::Face(f) => (body.face_vertices(f).filter_map(point).collect(), vec![normal(f)?]),
    };
    Some(Lit { points, normals })
}

/// Returns the polyhedron that has the features of a subshape, and its pose in the body's frame.
fn polyhedron(geometry: &Geometry, part: u32) -> Option<(&ConvexPolyhedron, Isometry3<f64>)> {
    let (core, pose) = match geometry {
        Geometry::Polyhedron(body) => return Some((body, Isometry3::identity())),
        Geometry::Convex(shape) => (shape.core(), Isometry3::identity()),
        Geometry::Compound(body) => {
            let piece = body.pieces().get(part as usize)?;
            (piece.shape.core(), piece.pose)
        }
        _ => return None,
    };
    match core {
        Core::Polyhedron(body) => Some((body, pose)),
        _ => None,
    }
}
