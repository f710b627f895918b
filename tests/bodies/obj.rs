//! Promise: a body written as OBJ and read back has the same bits, at any scale.

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{ConvexPolyhedron, Mesh};

/// Returns the vertices and faces of a text.
fn read(text: &str) -> (Vec<Point3<f64>>, Vec<Vec<usize>>) {
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split(' ');
        match words.next() {
            Some("v") => {
                let at: Vec<f64> = words.map(|w| w.parse().expect("a number")).collect();
                points.push(Point3::new(at[0], at[1], at[2]));
            }
            Some("f") => faces.push(words.map(|w| w.parse::<usize>().expect("an index") - 1).collect()),
            other => panic!("{other:?}"),
        }
    }
    (points, faces)
}

#[test]
fn bodies_survive_a_file() {
    for scale in [1.0, 1.0 / 3.0, 2.0_f64.powi(-300), 2.0_f64.powi(300)] {
        for n in [4, 7, 12] {
            let points: Vec<Point3<f64>> = (0..n)
                .flat_map(|k| {
                    let angle = f64::from(k) * std::f64::consts::TAU / f64::from(n);
                    [-0.5, 0.5].map(|z| Point3::from(Vector3::new(angle.cos(), angle.sin(), z) * scale))
                })
                .collect();
            let body = ConvexPolyhedron::from_points(&points).expect("a prism");
            let (vertices, faces) = read(&body.to_obj());
            assert!(vertices.iter().eq(body.vertex_points().collect::<Vec<_>>().iter()));
            assert_eq!(faces.len(), body.face_count());
            let again = ConvexPolyhedron::from_points(&vertices).expect("a prism");
            assert_eq!(again.to_obj(), body.to_obj());

            let mesh = Mesh::from_convex(&body).expect("a mesh");
            let (vertices, faces) = read(&mesh.to_obj());
            let triangles: Vec<[u32; 3]> = faces.iter().map(|f| [0, 1, 2].map(|k| f[k] as u32)).collect();
            let again = Mesh::new(&vertices, &triangles).expect("a mesh");
            assert_eq!(again.kind(), mesh.kind());
            assert_eq!(again.triangle_count(), mesh.triangle_count());
            assert_eq!(again.aabb(), mesh.aabb());
        }
    }
    let flat = ConvexPolyhedron::segment(Point3::origin(), Point3::new(1.0, 0.0, 0.0)).expect("a segment");
    assert_eq!(read(&flat.to_obj()).0.len(), 2);
    let (_, sides) = read(&solids::icosahedron(1.0).expect("a body").to_obj());
    assert!(sides.len() == 20 && sides.iter().all(|f| f.len() == 3));
}
