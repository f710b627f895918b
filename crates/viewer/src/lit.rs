//! The feature that contains a witness, and its Voronoi region, as points in the world frame.

use lin_canny::nalgebra::{Isometry3, Point3, Unit, Vector3};
use lin_canny::shape::Core;
use lin_canny::{ConvexPolyhedron, Feature, Geometry};

/// A feature as points.
pub enum Lit {
    /// A vertex.
    Vertex(Point3<f64>),
    /// An edge.
    Edge([Point3<f64>; 2]),
    /// A face: its boundary and its unit normal.
    Face(Vec<Point3<f64>>, Vector3<f64>),
}

/// Returns the feature of a body at a pose; `None` on curved bodies.
#[must_use]
pub fn feature(geometry: &Geometry, pose: &Isometry3<f64>, part: u32, feature: Feature) -> Option<Lit> {
    if let Geometry::Mesh(mesh) = geometry {
        let (_, corners) = mesh.triangles().find(|(k, _)| *k == part)?;
        let [p, q, r] = corners.map(|p| pose * p);
        let normal = (q - p).cross(&(r - p)).try_normalize(0.0)?;
        return Some(Lit::Face(vec![p, q, r], normal));
    }
    let (body, pose) = polyhedron(geometry, pose, part)?;
    Some(match feature {
        Feature::Vertex(v) => Lit::Vertex(pose * body.vertex(v)?),
        Feature::Edge(e) => {
            let [p, q] = body.edge_vertices(e)?;
            Lit::Edge([pose * body.vertex(p)?, pose * body.vertex(q)?])
        }
        Feature::Face(f) => {
            let rim = body.face_vertices(f).filter_map(|v| body.vertex(v)).map(|p| pose * p);
            Lit::Face(rim.collect(), pose * body.face_plane(f)?.0.into_inner())
        }
    })
}

/// Returns the walls of the Voronoi region of a feature, cut off at a height: polygons of three or
/// four points.
#[must_use]
pub fn region(
    geometry: &Geometry,
    pose: &Isometry3<f64>,
    part: u32,
    at: Feature,
    height: f64,
) -> Vec<Vec<Point3<f64>>> {
    polyhedron(geometry, pose, part)
        .and_then(|(body, pose)| walls(body, &pose, at, height))
        .unwrap_or_default()
}

fn walls(body: &ConvexPolyhedron, pose: &Isometry3<f64>, at: Feature, height: f64) -> Option<Vec<Vec<Point3<f64>>>> {
    let up = |n: Unit<Vector3<f64>>| pose * (n.into_inner() * height);
    let normal = |f| body.face_plane(f).map(|(n, _)| up(n));
    Some(match at {
        Feature::Vertex(v) => {
            let p = pose * body.vertex(v)?;
            let rays: Vec<_> = body.vertex_faces(v).filter_map(normal).map(|n| p + n).collect();
            let next = rays.iter().cycle().skip(1);
            rays.iter().zip(next).map(|(a, b)| vec![p, *a, *b]).collect()
        }
        Feature::Edge(e) => {
            let [v, w] = body.edge_vertices(e)?;
            let [p, q] = [pose * body.vertex(v)?, pose * body.vertex(w)?];
            let [f, g] = body.edge_faces(e)?;
            let [m, n] = [normal(f)?, normal(g)?];
            vec![
                vec![p, q, q + m, p + m],
                vec![p, q, q + n, p + n],
                vec![p, p + m, p + n],
                vec![q, q + m, q + n],
            ]
        }
        Feature::Face(f) => {
            let n = normal(f)?;
            let rim: Vec<_> = body
                .face_vertices(f)
                .filter_map(|v| body.vertex(v))
                .map(|p| pose * p)
                .collect();
            let next = rim.iter().cycle().skip(1);
            rim.iter().zip(next).map(|(p, q)| vec![*p, *q, q + n, p + n]).collect()
        }
    })
}

/// Returns the polyhedron that has the features of a subshape.
fn polyhedron<'g>(
    geometry: &'g Geometry,
    pose: &Isometry3<f64>,
    part: u32,
) -> Option<(&'g ConvexPolyhedron, Isometry3<f64>)> {
    match geometry {
        Geometry::Polyhedron(body) => Some((body, *pose)),
        Geometry::Convex(shape) => match shape.core() {
            Core::Polyhedron(body) => Some((body, *pose)),
            _ => None,
        },
        Geometry::Compound(body) => {
            let piece = body.pieces().get(part as usize)?;
            match piece.shape.core() {
                Core::Polyhedron(core) => Some((core, pose * piece.pose)),
                _ => None,
            }
        }
        _ => None,
    }
}
