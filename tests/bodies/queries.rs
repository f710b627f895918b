//! Queries of one body: mass, closest points, neighbours.

use lin_canny::Feature;
use lin_canny::polyhedron::{ConvexPolyhedron, solids};
use nalgebra::{Matrix3, Point3, Rotation3, Vector3};
use truth::rng::Rng;

#[test]
fn mass_properties_match_closed_forms() {
    let h = Vector3::new(0.5, 1.0, 2.0);
    let moved = |body: &ConvexPolyhedron, by: Vector3<f64>| {
        ConvexPolyhedron::from_points(&body.vertex_points().map(|p| p + by).collect::<Vec<_>>()).unwrap()
    };
    let shift = Vector3::new(1e6, -3.0, 0.25);
    for by in [Vector3::zeros(), shift] {
        let cuboid = moved(&solids::cuboid(h).unwrap(), by);
        assert_eq!((cuboid.volume(), cuboid.centroid()), (8.0, Point3::from(by)));
        let expected = Matrix3::from_diagonal(&Vector3::new(5.0, 4.25, 1.25)) * (8.0 / 3.0);
        assert!((cuboid.inertia() - expected).norm() < 1e-14);
    }
    let corner = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 4.0]].map(Point3::from);
    let tetrahedron = ConvexPolyhedron::from_points(&corner).unwrap();
    assert!((tetrahedron.volume() - 4.0).abs() < 1e-15);
    assert!((tetrahedron.centroid() - Point3::new(0.5, 0.75, 1.0)).norm() < 1e-15);
    // tetrahedron at a vertex with legs a, b, c: xx = 3 V (b^2 + c^2) / 80, xy = V a b / 80
    let i = tetrahedron.inertia();
    assert!((i[(0, 0)] - 4.0 * 3.0 * 25.0 / 80.0).abs() < 1e-14, "{i}");
    assert!((i[(0, 1)] - 4.0 * 6.0 / 80.0).abs() < 1e-14, "{i}");
    let sphere = solids::geodesic_sphere(5, 1.0).unwrap();
    assert!((sphere.volume() / (4.0 / 3.0 * std::f64::consts::PI) - 1.0).abs() < 1e-3);
    assert!((sphere.inertia()[(1, 1)] / (0.4 * sphere.volume()) - 1.0).abs() < 1e-3);
    // a needle in a general direction loses no digits
    let turn = Rotation3::from_euler_angles(0.3, 0.7, 1.1);
    let e = [
        Vector3::new(1.0, 0.0, 0.0),
        Vector3::new(0.0, 1e-7, 0.0),
        Vector3::new(0.0, 0.0, 1e-7),
    ]
    .map(|v| turn * v);
    let needle = [Vector3::zeros(), e[0], e[0] + e[1], e[0] + e[2]].map(Point3::from);
    let body = ConvexPolyhedron::from_points(&needle).unwrap();
    assert!((body.volume() / (1e-14 / 6.0) - 1.0).abs() < 1e-8);
    assert!(body.inertia().iter().all(|x| x.is_finite()));
}

#[test]
fn closest_points_are_optimal() {
    let mut rng = Rng::new(3);
    let bodies = [
        solids::cuboid(Vector3::new(0.4, 0.7, 0.2)).unwrap(),
        solids::random_hull(60, Vector3::new(1.0, 0.5, 1e-3), 1).unwrap(),
        solids::cone(32, 0.5, 0.5).unwrap(),
    ];
    let (mut inside, mut outside) = (0, 0);
    for body in &bodies {
        for _ in 0..400 {
            let p = Point3::from([1.0, 1.0, 0.3].map(|reach| rng.range(-reach, reach)));
            let q = body.closest_point(&p).unwrap();
            if body.contains(&p) {
                inside += 1;
                assert_eq!(p, q);
                continue;
            }
            outside += 1;
            let (d, v) = ((p - q).norm(), body.extreme_vertex(&(p - q)));
            let beyond = (p - q).dot(&(body.vertex(v).unwrap() - q)) / d;
            assert!(beyond < 1e-14, "{p} {q} {beyond:e}");
            assert!(body.faces().all(|f| {
                let (n, offset) = body.face_plane(f).unwrap();
                n.dot(&q.coords) <= offset + 1e-15
            }));
        }
        let v = body.vertices().next().unwrap();
        let far = body.closest_point(&Point3::new(1e300, -1e299, 1e298)).unwrap();
        assert!(body.contains(&far) || far.coords.norm() < 2.0);
        assert_eq!(body.closest_point(&body.vertex(v).unwrap()), body.vertex(v));
        assert_eq!(body.closest_point(&Point3::new(f64::NAN, 0.0, 0.0)), None);
        assert!(!body.contains(&Point3::new(f64::NAN, 0.0, 0.0)));
    }
    assert!(inside > 50 && outside > 500, "{inside} {outside}");
}

/// Beyond the end of a face that is nearly a line, only rounding makes every side test say
/// "inside".
#[test]
fn closest_points_beyond_faces_that_are_nearly_lines() {
    use lin_canny::{RelativePose, Tracker, nalgebra::Isometry3};
    let mut rng = Rng::new(77);
    let (mut apart, mut thin) = (0, 0);
    for k in 0..2000 {
        let mut whole = || Vector3::from_fn(|_, _| rng.int(-4, 4) as f64);
        let (start, along, aside) = (whole(), whole(), whole());
        // Decimal fractions: collinear points that rounding puts off the line.
        let at = |t: i32, s: f64| Point3::from((start + along * f64::from(t) + aside * s) * 0.85);
        let flat = [at(-2, 0.0), at(0, 0.0), at(1, 0.0)];
        let body = if k % 2 == 0 {
            ConvexPolyhedron::polygon(&flat)
        } else {
            ConvexPolyhedron::from_points(&[flat[0], flat[1], flat[2], at(-1, 1e-15), at(0, -1e-15)])
        };
        let Ok(body) = body else { continue };
        thin += 1;
        for p in [at(3, 0.0), at(-6, 0.0), at(4, 1e-3), at(2, 1.0)] {
            let point = ConvexPolyhedron::point(p).unwrap();
            let here = RelativePose::from_isometry(&Isometry3::identity()).unwrap();
            let o = Tracker::new().closest(&body, &point, &here);
            let distance = (body.closest_point(&p).unwrap() - p).norm();
            let size = 40.0;
            assert!(
                (distance - o.distance.max(0.0)).abs() <= 1e-14 * size,
                "{flat:?} {p}: {distance:e} {o:?}"
            );
            apart += usize::from(o.distance > 0.1);
        }
    }
    assert!(thin > 300 && apart > 600, "{thin} {apart}");
}

#[test]
fn links_agree_and_foreign_ids_are_refused() {
    let large = solids::random_hull(40, Vector3::repeat(1.0), 2).unwrap();
    let small = solids::tetrahedron(1.0).unwrap();
    assert_eq!(large.edges().count(), large.edge_count());
    for e in large.edges() {
        let [a, b] = large.edge_vertices(e).unwrap();
        let [left, right] = large.edge_faces(e).unwrap();
        assert!(large.vertex_neighbours(a).any(|v| v == b) && large.vertex_edges(b).any(|x| x == e));
        for (face, from, to) in [(left, a, b), (right, b, a)] {
            let rim: Vec<_> = large.face_vertices(face).collect();
            let k = rim.iter().position(|v| *v == from).unwrap();
            assert_eq!(rim[(k + 1) % rim.len()], to);
            assert_eq!(large.face_edges(face).nth(k), Some(e));
            assert!(large.vertex_faces(a).any(|f| f == face));
        }
    }
    let v = large.vertices().last().unwrap();
    let e = large.edges().last().unwrap();
    let f = large.faces().last().unwrap();
    assert!(small.vertex(v).is_none() && small.source_vertex(v).is_none());
    assert!(small.edge_vertices(e).is_none() && small.edge_faces(e).is_none());
    assert!(small.face_plane(f).is_none() && small.source_face(f).is_none());
    assert_eq!(small.face_vertices(f).count() + small.vertex_neighbours(v).count(), 0);
    fn shared<T: Send + Sync>(_: &T) {}
    shared(&small);
}

/// A point is its own centre: its position in its frame costs no digit, and its box is finite at
/// any position.
#[test]
fn a_point_is_as_exact_far_from_its_own_origin_as_in_it() {
    use lin_canny::nalgebra::{Isometry3, UnitQuaternion};
    use lin_canny::{BoxHint, RelativePose, Tracker};
    let body = solids::octahedron(1.0).unwrap();
    for (k, away) in [0.3, 1e3, 2e6, 1e12, 1e30].into_iter().enumerate() {
        let p = Point3::new(-0.497, 0.466, 2.165) * away;
        let point = ConvexPolyhedron::point(p).unwrap();
        assert_eq!(point.vertex_points().collect::<Vec<_>>(), [p]);
        assert!(point.contains(&p) && !point.contains(&(p * 1.5)));
        let turn = UnitQuaternion::from_euler_angles(0.3, 0.1 * k as f64, -1.1);
        let pose = Isometry3::from_parts((Vector3::new(1.0, 1.0, 0.5) - turn * p.coords).into(), turn);
        let pose = RelativePose::from_isometry(&pose).unwrap();
        let o = Tracker::new().closest(&body, &point, &pose);
        let back = Tracker::new().closest(&point, &body, &pose.swapped());
        for o in [o, back] {
            // The rounding of the position in the body's frame, and the promised width.
            let size = 2.0 + o.upper.abs() + away * 2f64.powi(-49);
            assert!(o.upper - o.lower <= 1e-13 * size, "{away:e}: {o:?}");
            assert!((o.distance - back.distance).abs() <= 1e-13 * size, "{o:?}");
        }
    }
    for far in [1e30, 1e49, 1e110] {
        let point = ConvexPolyhedron::point(Point3::new(far, -far, far)).unwrap();
        let (low, high) = point.aabb_at(
            &Isometry3::rotation(Vector3::new(0.1, 0.2, 0.3)),
            &mut BoxHint::default(),
        );
        assert!(low.iter().chain(high.iter()).all(|x| x.is_finite()), "{low} {high}");
        assert!((high - low).amax() <= 1e-13 * far, "{low} {high}");
    }
}

/// Kind and index identify a feature of the body, and nothing else.
#[test]
fn features_are_named_by_kind_and_index() {
    let body = solids::prism(5, 0.5, 1.0).unwrap();
    let all = body.vertices().map(Feature::Vertex);
    let all = all
        .chain(body.edges().map(Feature::Edge))
        .chain(body.faces().map(Feature::Face));
    let all: Vec<Feature> = all.collect();
    assert_eq!(all.len(), 10 + 15 + 7);
    for &f in &all {
        assert_eq!(body.feature(f.dimension(), f.index()), Some(f));
    }
    let found = (0..5).flat_map(|d| (0..100).map(move |k| (d, k)));
    let found = found.filter_map(|(d, k)| body.feature(d, k)).count();
    assert_eq!(found, all.len());
    assert_eq!(body.feature(0, usize::MAX), None);
}
