//! Bodies scaled, moved and random; hulls of meshes and their void fraction.

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::{BuildError, ConvexPolyhedron, solids};
use lin_canny::{HullFit, Mesh, RelativePose, Tracker};
use truth::forms::mesh;
use truth::rng::Rng;
use truth::soups;

fn bodies() -> Vec<ConvexPolyhedron> {
    let square = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]].map(Point3::from);
    vec![
        solids::cuboid(Vector3::new(0.3, 0.2, 0.1)).unwrap(),
        solids::prism(30, 0.2, 1.0).unwrap(),
        solids::random_hull(100, Vector3::new(1.0, 1.0, 0.1), 3).unwrap(),
        ConvexPolyhedron::polygon(&square).unwrap(),
        ConvexPolyhedron::segment(square[0], square[2]).unwrap(),
        ConvexPolyhedron::point(square[1]).unwrap(),
    ]
}

/// Returns vertices by the caller's index.
fn by_source(body: &ConvexPolyhedron) -> Vec<(usize, Point3<f64>)> {
    let vertices = body.vertices();
    let mut named: Vec<_> = vertices
        .map(|v| (body.source_vertex(v).unwrap(), body.vertex(v).unwrap()))
        .collect();
    named.sort_by_key(|x| x.0);
    named
}

#[test]
fn a_scaled_body_is_the_body_in_another_unit() {
    for body in bodies() {
        for factor in [0.25, 1e-3, 39.37] {
            let scaled = body.scaled(factor).unwrap();
            let expected: Vec<_> = by_source(&body).into_iter().map(|(i, p)| (i, p * factor)).collect();
            assert_eq!(by_source(&scaled), expected);
            let faces = (scaled.face_count(), body.face_count());
            assert!(factor != 0.25 || faces.0 == faces.1, "{faces:?}");
        }
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(body.scaled(bad), Err(BuildError::BadFactor { .. })));
        }
    }
    let body = solids::icosahedron(1.0).unwrap();
    assert!(matches!(body.scaled(1e-101), Err(BuildError::OutOfRange { .. })));
}

#[test]
fn a_moved_body_answers_as_the_body_at_the_pose() {
    let mut rng = Rng::new(3);
    let probe = solids::icosahedron(0.3).unwrap();
    for body in bodies() {
        for _ in 0..20 {
            let (q, t) = (rng.quat(), [0; 3].map(|_| rng.range(-2.0, 2.0)));
            let pose = truth::Pose::new(q, t).isometry();
            let moved = body.transformed(&pose).unwrap();
            assert_eq!(by_source(&moved).len(), by_source(&body).len());
            let there = RelativePose::from_isometry(&pose).unwrap();
            let here = RelativePose::from_isometry(&Isometry3::identity()).unwrap();
            let d = Tracker::new().distance(&probe, &body, &there);
            let e = Tracker::new().distance(&probe, &moved, &here);
            assert!((d.value - e.value).abs() < 1e-14, "{d:?} {e:?}");
        }
    }
    let far = Isometry3::translation(f64::NAN, 0.0, 0.0);
    assert!(matches!(probe.transformed(&far), Err(BuildError::NotFinite { .. })));
}

#[test]
fn triangles_close_the_surface() {
    for body in bodies() {
        let at = |v| body.vertex(v).unwrap();
        let mut volume = 0.0;
        let mut edges = std::collections::BTreeMap::new();
        for t in body.triangles() {
            let [a, b, c] = t.map(|v| at(v).coords);
            volume += a.dot(&b.cross(&c)) / 6.0;
            for (v, w) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                *edges.entry((v.min(w), v.max(w))).or_insert(0) += if v < w { 1 } else { -1 };
            }
        }
        assert!((volume - body.volume()).abs() < 1e-14, "{volume} {}", body.volume());
        assert!(edges.values().all(|n| *n == 0));
        let faces = body.faces().map(|f| body.face_vertices(f).count() - 2);
        assert_eq!(body.triangles().count(), faces.sum::<usize>());
    }
}

/// Returns the distance of a point from the nearest triangle, each a separate polygon.
fn gap(triangles: &[ConvexPolyhedron], p: &Point3<f64>) -> f64 {
    let each = triangles.iter().map(|t| (t.closest_point(p).unwrap() - p).norm());
    each.fold(f64::INFINITY, f64::min)
}

#[test]
fn the_largest_gap_is_bracketed() {
    let mut rng = Rng::new(11);
    for soup in [
        soups::torus(24, 12, 0.3),
        soups::gear(12),
        soups::bracket(),
        soups::rock(2, 1),
    ] {
        let mesh = mesh(&soup);
        let hull = mesh.hull().unwrap();
        let fit = mesh.hull_fit(&hull);
        let triangles: Vec<_> = mesh
            .triangles()
            .map(|(_, t)| ConvexPolyhedron::polygon(&t).unwrap())
            .collect();
        let mut found = 0.0f64;
        for t in hull.triangles() {
            let [a, b, c] = t.map(|v| hull.vertex(v).unwrap().coords);
            for _ in 0..8 {
                let (u, v) = (rng.range(0.0, 1.0), rng.range(0.0, 1.0));
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                found = found.max(gap(&triangles, &Point3::from(a + (b - a) * u + (c - a) * v)));
            }
        }
        assert!(found <= fit.gap_upper + 1e-12, "{found} {fit:?}");
        assert!(fit.gap_lower <= fit.gap_upper && fit.gap_upper - fit.gap_lower < 0.007 * soup.radius());
        // Samples come near the largest gap.
        assert!(found > 0.8 * fit.gap_lower, "{found} {fit:?}");
        let void_fraction = fit.void_fraction().unwrap();
        assert!((void_fraction - (1.0 - mesh.volume() / hull.volume())).abs() < 1e-12);
        println!("{fit}");
    }
    // The middle of the disc that closes a torus: a circle of radius 1 in the plane z = 0, less the
    // tube.
    let torus = mesh(&soups::torus(96, 48, 0.3));
    let fit = torus.hull_fit(&torus.hull().unwrap());
    let exact = (1.0f64 + 0.09).sqrt() - 0.3;
    assert!(fit.gap_lower < exact + 0.01, "{exact} {fit:?}");
    assert!(exact - 0.01 < fit.gap_upper, "{exact} {fit:?}");
}

#[test]
fn a_convex_mesh_has_no_air_and_no_gap() {
    for body in bodies().into_iter().filter(|b| b.face_count() > 2) {
        let mesh = Mesh::from_convex(&body).unwrap();
        let fit: HullFit = mesh.hull_fit(&mesh.hull().unwrap());
        assert!(fit.void_fraction().unwrap() < 1e-13, "{fit:?}");
        assert!(fit.gap_upper < 0.004 * body.bounding_ball().1, "{fit:?}");
    }
    let sheet = Mesh::new(
        &[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]].map(Point3::from),
        &[[0, 2, 1], [0, 1, 3]],
    );
    let sheet = sheet.unwrap();
    let fit = sheet.hull_fit(&sheet.hull().unwrap());
    assert_eq!((fit.mesh_volume, fit.void_fraction()), (None, None));
    assert!(fit.to_string().starts_with("the mesh is not closed"));
}
