//! Bodies from points: the hull is correct for every hard family, judged by brute force with exact
//! signs.

use lin_canny::polyhedron::{BuildError, ConvexPolyhedron, solids};
use nalgebra::{Point3, Vector3};
use robust::{Coord3D, orient3d};
use truth::rng::Rng;

type Points = Vec<Point3<f64>>;

/// Positive above the plane of a, b, c.
fn side(a: &Point3<f64>, b: &Point3<f64>, c: &Point3<f64>, p: &Point3<f64>) -> f64 {
    let [a, b, c, p] = [a, b, c, p].map(|p| Coord3D { x: p.x, y: p.y, z: p.z });
    -orient3d(a, b, c, p)
}

/// Returns a point in a box about the origin.
fn point(rng: &mut Rng, x: f64, y: f64, z: f64) -> Point3<f64> {
    Point3::from([x, y, z].map(|reach| rng.range(-reach, reach)))
}

/// Returns the extreme points by definition, for small clouds only.
///
/// A supporting plane through three points has all points on one side. A point on such a plane is
/// extreme in the plane if it is extreme in the body. The cost is cubic in the number of planes.
fn brute_force_planes(points: &[Point3<f64>]) -> Vec<Vec<usize>> {
    let n = points.len();
    let mut planes = Vec::new();
    for i in 0..n {
        for j in 0..n {
            for k in 0..n {
                if i >= j || i >= k || j == k {
                    continue;
                }
                let signs: Vec<f64> = (0..n)
                    .map(|p| side(&points[i], &points[j], &points[k], &points[p]))
                    .collect();
                if signs.iter().all(|s| *s <= 0.0) && signs.iter().any(|s| *s < 0.0) {
                    planes.push((0..n).filter(|&p| signs[p] == 0.0).collect::<Vec<_>>());
                }
            }
        }
    }
    planes.sort();
    planes.dedup();
    planes
}

/// Asserts every property of a hull by exact signs.
fn check(points: &[Point3<f64>], name: &str) -> ConvexPolyhedron {
    let body = ConvexPolyhedron::from_points(points).unwrap_or_else(|e| panic!("{name}: {e}"));
    let report = body.report();
    assert_eq!(body.vertex_count() + body.face_count(), body.edge_count() + 2, "{name}");
    assert_eq!(report.euler_characteristic, 2);
    let vertex: Points = body.vertices().map(|v| body.vertex(v).unwrap()).collect();
    for v in body.vertices() {
        assert_eq!(points[body.source_vertex(v).unwrap()], vertex[v.index()], "{name}");
        assert!(body.vertex_faces(v).count() >= 3, "{name}");
    }
    for f in body.faces() {
        let rim: Vec<usize> = body.face_vertices(f).map(|v| v.index()).collect();
        let [a, b, c] = [rim[0], rim[1], rim[2]].map(|v| &vertex[v]);
        let on: usize = vertex
            .iter()
            .map(|p| side(a, b, c, p))
            .inspect(|s| assert!(*s <= 0.0, "{name}: a vertex above face {f}"))
            .filter(|s| *s == 0.0)
            .count();
        assert_eq!(on, rim.len(), "{name}: coplanar vertices beside face {f}");
        assert!(
            points.iter().all(|p| side(a, b, c, p) <= 0.0),
            "{name}: a point above face {f}"
        );
    }
    let dropped = [&report.interior, &report.on_faces, &report.on_edges]
        .map(Vec::len)
        .iter()
        .sum::<usize>();
    let found = dropped + report.duplicates.len() + report.vertices;
    assert_eq!(found, points.len(), "{name}: {report}");
    assert!(points.iter().all(|p| body.contains(p)), "{name}");
    body
}

fn families() -> Vec<(String, Points)> {
    let mut all = Vec::new();
    let mut rng = Rng::new(1);
    for (x, y, z) in [
        (1., 1., 1.),
        (1., 1., 1e-3),
        (1., 1e-6, 1e-6),
        (1e-9, 1., 1e-15),
        (1e5, 1., 1e-5),
    ] {
        for n in [4, 5, 8, 14, 200] {
            let cloud: Points = (0..n).map(|_| point(&mut rng, x, y, z)).collect();
            all.push((format!("cloud {n} of {x}:{y}:{z}"), cloud));
        }
    }
    for height in [1.0, 1e-3, 1e-9, 1e-15, 1e-30] {
        // points on a paraboloid: all extreme, nearly coplanar; the lid closes it
        let dome = |k: usize| (k as f64 * 0.37).sin_cos();
        let mut points: Points = (0..12)
            .map(|k| (k, dome(k)))
            .map(|(k, (s, c))| {
                let r = (1.0 + k as f64) / 12.0;
                Point3::new(r * s, r * c, height * r * r)
            })
            .collect();
        points.push(Point3::new(0.1, 0.2, 3.0));
        all.push((format!("dome {height}"), points));
    }
    let lattice = |n: i32, scale: f64| -> Points {
        let range = || 0..n;
        range()
            .flat_map(|x| range().flat_map(move |y| range().map(move |z| Point3::new(x, y, z).cast() * scale)))
            .collect()
    };
    all.push(("lattice".into(), lattice(3, 1.0)));
    all.push(("lattice 6".into(), lattice(6, 0.1)));
    let ball: Points = lattice(7, 1.0)
        .into_iter()
        .filter(|p| (p - Point3::new(3., 3., 3.)).norm() < 3.1)
        .collect();
    all.push(("lattice ball".into(), ball));
    let mut dirty: Points = lattice(2, 1.0);
    dirty.extend(dirty.clone());
    dirty.extend(
        [
            [0.5, 0.0, 0.0],
            [0.5, 0.5, 0.0],
            [0.5, 0.5, 0.5],
            [1.0, 0.25, 1.0],
            [1.0, 0.25, 0.75],
        ]
        .map(Point3::from),
    );
    all.push(("dirty cube".into(), dirty));
    for n in [3usize, 64, 512] {
        let cone: Points = solids::cone(n, 1.0, 1.0).unwrap().vertex_points().collect();
        all.push((format!("cone {n}"), cone));
        let prism: Points = solids::prism(n, 1e-4, 1.0).unwrap().vertex_points().collect();
        all.push((format!("prism {n}"), prism));
    }
    all
}

#[test]
fn hulls_of_hard_families_are_right() {
    let families = families();
    assert!(families.len() > 35);
    for (name, points) in &families {
        let body = check(points, name);
        if points.len() <= 30 {
            let planes = brute_force_planes(points);
            assert_eq!(planes.len(), body.face_count(), "{name}");
            // a vertex lies on three planes that have no other point in common
            let distinct = |i: usize| points[..i].iter().all(|q| *q != points[i]);
            let extreme = (0..points.len()).filter(|&i| distinct(i)).filter(|&i| {
                let through: Vec<_> = planes.iter().filter(|p| p.contains(&i)).collect();
                !through.is_empty()
                    && (0..points.len()).all(|j| points[j] == points[i] || !through.iter().all(|p| p.contains(&j)))
            });
            let mut kept: Vec<usize> = body.vertices().map(|v| body.source_vertex(v).unwrap()).collect();
            kept.sort();
            assert_eq!(extreme.collect::<Vec<_>>(), kept, "{name}");
        }
    }
}

/// Small integer coordinates: many triples are collinear and many quadruples coplanar.
#[test]
fn degenerate_clouds_match_brute_force() {
    let mut rng = Rng::new(11);
    let (mut solid, mut dropped) = (0, [0; 4]);
    for round in 0..1500 {
        let n = 4 + round % 10;
        let size = [1.0, 1.5, 2.0, 4.0][round % 4];
        let points: Points = (0..n)
            .map(|_| point(&mut rng, size, size, size).map(|x| x.round() + 0.0))
            .collect();
        match ConvexPolyhedron::from_points(&points) {
            Err(BuildError::Flat { dimension, span }) => {
                assert_eq!(span.len(), dimension + 1);
                assert!(brute_force_planes(&points).is_empty());
            }
            Err(e) => panic!("{e}"),
            Ok(_) => {
                solid += 1;
                let body = check(&points, &format!("round {round}: {points:?}"));
                let planes = brute_force_planes(&points);
                assert_eq!(planes.len(), body.face_count(), "{points:?}");
                let report = body.report();
                let through = |i: &u32| planes.iter().filter(|p| p.contains(&(*i as usize))).count();
                assert!(report.interior.iter().all(|i| through(i) == 0), "{points:?}");
                assert!(report.on_faces.iter().all(|i| through(i) == 1), "{points:?}");
                assert!(report.on_edges.iter().all(|i| through(i) == 2), "{points:?}");
                assert!(
                    body.vertices()
                        .all(|v| through(&(body.source_vertex(v).unwrap() as u32)) >= 3)
                );
                let lists = [&report.interior, &report.on_faces, &report.on_edges].map(Vec::len);
                let counts = [lists[0], lists[1], lists[2], report.duplicates.len()];
                counts.iter().zip(&mut dropped).for_each(|(c, d)| *d += c);
            }
        }
    }
    assert!(solid > 800 && dropped.iter().all(|&d| d > 50), "{solid} {dropped:?}");
}

#[test]
fn the_report_sorts_what_was_dropped() {
    let (_, dirty) = families().into_iter().find(|f| f.0 == "dirty cube").unwrap();
    let body = check(&dirty, "dirty cube");
    let report = body.report();
    assert_eq!((report.vertices, report.edges, report.faces), (8, 12, 6));
    assert_eq!(report.duplicates.len(), 8);
    assert!(
        report
            .duplicates
            .iter()
            .all(|&(dropped, kept)| dropped == kept + 8 && kept < 8)
    );
    assert_eq!(report.interior, [18]);
    let sorted = |list: &[u32]| {
        let mut list = list.to_vec();
        list.sort();
        list
    };
    assert_eq!(sorted(&report.on_edges), [16, 19]);
    assert_eq!(sorted(&report.on_faces), [17, 20]);
    assert_eq!(report.thickness_ratio, 1.0);
    assert!(report.to_string().contains("8 duplicates dropped"));
}

#[test]
fn scaling_by_a_power_of_two_scales_the_body() {
    let mut rng = Rng::new(5);
    let points: Points = (0..60).map(|_| point(&mut rng, 1.0, 0.1, 1e-4)).collect();
    let body = check(&points, "unscaled");
    for k in [-300, -60, -30, 3, 50, 300] {
        let scale = 2f64.powi(k);
        let scaled = ConvexPolyhedron::from_points(&points.iter().map(|p| p * scale).collect::<Points>()).unwrap();
        assert!(
            scaled.vertex_points().eq(body.vertex_points().map(|p| p * scale)),
            "2^{k}"
        );
        for f in body.faces() {
            assert!(scaled.face_vertices(f).eq(body.face_vertices(f)));
            let (a, b) = (body.face_plane(f).unwrap(), scaled.face_plane(f).unwrap());
            assert_eq!((a.0, a.1 * scale), b, "2^{k}");
        }
        assert!((scaled.volume() / body.volume() / scale.powi(3) - 1.0).abs() < 1e-15);
    }
}

#[test]
fn extents_reach_from_1e_minus_100_to_1e100() {
    for extent in [1e-100, 1e-80, 1e-13, 1e13, 1e80, 1e100] {
        let mut rng = Rng::new(6);
        let points: Points = (0..50)
            .map(|_| point(&mut rng, extent / 2.1, extent / 1e7, extent / 3.0))
            .collect();
        let mut points = points;
        points.extend([
            Point3::new(extent / 2.0, 0.0, 0.0),
            Point3::new(-extent / 2.0, 0.0, 0.0),
        ]);
        let body = ConvexPolyhedron::from_points(&points).unwrap();
        assert!(body.volume() > 0.0 && body.volume().is_finite());
        assert!(points.iter().all(|p| body.contains(p)));
        let too_large: Points = points
            .iter()
            .map(|p| p * if extent < 1.0 { 1e-99 } else { 1e99 })
            .collect();
        if extent == 1e-100 || extent == 1e100 {
            let error = ConvexPolyhedron::from_points(&too_large).unwrap_err();
            assert!(matches!(error, BuildError::OutOfRange { index: 50, .. }), "{error}");
        }
    }
}

#[test]
fn bodies_far_from_the_origin_lose_nothing() {
    let mut rng = Rng::new(7);
    let step = 2f64.powi(-20);
    let snapped = |p: Point3<f64>| p.map(|x| (x / step).round() * step);
    let points: Points = (0..80).map(|_| snapped(point(&mut rng, 1.0, 2.0, 0.5))).collect();
    let offset = Vector3::new(1073741824.0, -3e9, 0.0);
    let far: Points = points.iter().map(|p| p + offset).collect();
    let (near, far_body) = (check(&points, "near"), check(&far, "far"));
    assert_eq!(near.vertex_count(), far_body.vertex_count());
    assert!((far_body.volume() / near.volume() - 1.0).abs() < 1e-15);
    assert!((far_body.inertia() - near.inertia()).norm() < 1e-14 * near.inertia().norm());
    assert!((far_body.centroid() - offset - near.centroid()).norm() < 1e-6);
    let (centre, radius) = far_body.bounding_ball();
    assert!(far.iter().all(|p| (p - centre).norm() <= radius) && radius < 2.5);
    for v in far_body.vertices() {
        assert_eq!(far_body.vertex(v).unwrap(), far[far_body.source_vertex(v).unwrap()]);
    }
    let inside = far_body.centroid();
    assert!(far_body.contains(&inside) && !far_body.contains(&(inside - offset)));
}

#[test]
fn the_order_of_the_input_changes_names_only() {
    for (name, mut points) in families() {
        let body = ConvexPolyhedron::from_points(&points).unwrap();
        let mut rng = Rng::new(8);
        rng.shuffle(&mut points);
        assert_eq!(ConvexPolyhedron::from_points(&points).unwrap(), body, "{name}");
    }
}

#[test]
fn refused_points_are_named() {
    let build = |points: &[[f64; 3]]| {
        let points: Points = points.iter().map(|p| Point3::from(*p)).collect();
        ConvexPolyhedron::from_points(&points).unwrap_err()
    };
    let o = [0.0; 3];
    assert_eq!(build(&[o, o, o]), BuildError::TooFewPoints { count: 3, needed: 4 });
    let answer = build(&[o, o, [0.0, f64::NAN, 0.0], o]);
    assert_eq!(answer, BuildError::NotFinite { index: 2 });
    let found = build(&[o, [f64::INFINITY, 0.0, 0.0], o, o]);
    assert_eq!(found, BuildError::NotFinite { index: 1 });
    assert_eq!(
        build(&[o, o, o, o]),
        BuildError::Flat {
            dimension: 0,
            span: vec![0]
        }
    );
    let line = build(&[o, [0.1, 0.1, 0.1], [0.2, 0.2, 0.2], [0.4, 0.4, 0.4], o]);
    assert!(
        matches!(&line, BuildError::Flat { dimension: 1, span } if span.len() == 2),
        "{line}"
    );
    let plane = build(&[o, [1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 2.0], [0.25, 0.5, 0.75]]);
    assert!(
        matches!(&plane, BuildError::Flat { dimension: 2, span } if span.len() == 3),
        "{plane}"
    );
    // one unit in the last place off the plane makes a body
    let sliver = [o, [1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 2.0f64.next_up()]].map(Point3::from);
    assert!(check(&sliver, "sliver").report().thickness_ratio < 1e-15);
}

#[test]
fn random_bits_never_panic() {
    let mut rng = Rng::new(9);
    let mut bits = || rng.bits();
    let mut built = 0;
    for round in 0..3000 {
        let n = 1 + bits() % 12;
        let mut coordinate = || {
            let raw = f64::from_bits(bits());
            match (round % 3, bits() % 4) {
                (0, _) => raw,
                (_, 0) => (bits() % 3) as f64,
                (1, _) => f64::from_bits(raw.to_bits() & 0xbfff_ffff_ffff_ffff | 0x3c00_0000_0000_0000),
                _ => (bits() % 1000) as f64 * 1e-200,
            }
        };
        let points: Points = (0..n)
            .map(|_| Point3::new(coordinate(), coordinate(), coordinate()))
            .collect();
        for body in [
            ConvexPolyhedron::from_points(&points),
            ConvexPolyhedron::polygon(&points),
        ]
        .into_iter()
        .flatten()
        {
            built += 1;
            assert!(body.vertices().all(|v| body.vertex(v).is_some()));
            let _ = (body.volume(), body.centroid(), body.inertia(), body.bounding_ball());
            for p in &points {
                let _ = (body.contains(p), body.extreme_vertex(&p.coords));
                assert!(body.closest_point(p).is_some_and(|q| q.iter().all(|x| x.is_finite())));
            }
        }
    }
    assert!(built > 500, "{built}");
}

/// Clouds large enough that interior points are removed before the hull.
///
/// Every point reported as interior is strictly inside, and the body is that of its vertices alone.
#[test]
fn points_left_out_first_change_nothing() {
    let mut rng = Rng::new(5);
    let lattice = |sides: [usize; 3], step: f64| -> Points {
        let [a, b, c] = sides;
        let at = |i: usize| [i % a, i / a % b, i / (a * b)].map(|k| k as f64 * step);
        (0..a * b * c).map(|i| Point3::from(at(i))).collect()
    };
    let mut clouds: Vec<(&str, Points)> = vec![
        ("box", (0..5000).map(|_| point(&mut rng, 1.0, 1.0, 1.0)).collect()),
        ("plate", (0..5000).map(|_| point(&mut rng, 1.0, 1.0, 1e-9)).collect()),
        ("needle", (0..5000).map(|_| point(&mut rng, 1e-12, 1.0, 1e-9)).collect()),
        (
            "far",
            (0..5000)
                .map(|_| point(&mut rng, 1.0, 1.0, 1.0) + Vector3::repeat(1e6))
                .collect(),
        ),
        (
            "small",
            (0..5000).map(|_| point(&mut rng, 1e-80, 1e-80, 1e-80)).collect(),
        ),
        ("large", (0..5000).map(|_| point(&mut rng, 1e80, 1e80, 1e60)).collect()),
        ("lattice", lattice([15, 16, 17], 1.0)),
        ("rounded lattice", lattice([15, 16, 17], 0.1)),
    ];
    let turned: Points = clouds[0]
        .1
        .iter()
        .map(|p| Point3::from([p.x + p.y, p.y - p.x, 3e-16 * p.z + p.x]))
        .collect();
    clouds.push(("turned and flat to rounding", turned));
    let twice: Points = clouds[0]
        .1
        .iter()
        .chain(&clouds[6].1)
        .chain(&clouds[0].1)
        .copied()
        .collect();
    clouds.push(("two clouds with copies", twice));
    for (name, points) in clouds {
        let body = check(&points, name);
        let alone: Points = body.vertex_points().collect();
        let again = ConvexPolyhedron::from_points(&alone).unwrap();
        assert_eq!(body.face_count(), again.face_count(), "{name}");
        assert!(body.vertex_points().eq(again.vertex_points()), "{name}");
        let inside = &body.report().interior;
        assert!(inside.is_sorted(), "{name}");
        for f in body.faces() {
            let rim: Points = body.face_vertices(f).take(3).map(|v| body.vertex(v).unwrap()).collect();
            let on = |&i: &u32| side(&rim[0], &rim[1], &rim[2], &points[i as usize]) >= 0.0;
            assert!(!inside.iter().any(on), "{name}");
        }
    }
}
