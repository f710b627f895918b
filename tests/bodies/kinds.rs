//! Bodies from faces, flat bodies and solids: the body equals the input, files included, and each
//! rejection names the fault.

use lin_canny::polyhedron::{BuildError, ConvexPolyhedron, FaceId, solids};
use nalgebra::{Point3, Rotation3, Vector3};

type Points = Vec<Point3<f64>>;

fn cube() -> (Points, Vec<Vec<u32>>) {
    let corner = |k: usize| Point3::new((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2) as f64);
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    ((0..8).map(corner).collect(), faces.map(Vec::from).to_vec())
}

fn refused(points: &[Point3<f64>], faces: &[Vec<u32>]) -> BuildError {
    ConvexPolyhedron::from_faces(points, faces).unwrap_err()
}

#[test]
fn faces_of_the_caller_are_found_again() {
    let (mut points, faces) = cube();
    points.push(Point3::new(9.0, 9.0, 9.0));
    let body = ConvexPolyhedron::from_faces(&points, &faces).unwrap();
    assert_eq!((body.vertex_count(), body.face_count(), body.edge_count()), (8, 6, 12));
    assert_eq!(body.report().unused, [8]);
    for f in body.faces() {
        let mut mine: Vec<u32> = body
            .face_vertices(f)
            .map(|v| body.source_vertex(v).unwrap() as u32)
            .collect();
        let mut theirs = faces[body.source_face(f).unwrap()].clone();
        mine.sort();
        theirs.sort();
        assert_eq!(mine, theirs);
    }
    // each face is cut around a point in its middle: no piece has three vertices of the face
    let mut pieces = Vec::new();
    for f in &faces {
        let middle = f.iter().fold(Vector3::zeros(), |s, &i| s + points[i as usize].coords) / 4.0;
        points.push(Point3::from(middle));
        let m = points.len() as u32 - 1;
        pieces.extend((0..4).map(|k| [f[k], f[(k + 1) % 4], m]));
    }
    let body = ConvexPolyhedron::from_faces(&points, &pieces).unwrap();
    assert_eq!((body.face_count(), body.report().on_faces.len()), (6, 6));
    for f in body.faces() {
        let piece = pieces[body.source_face(f).unwrap()];
        let n = body.face_plane(f).unwrap().0;
        let [a, b, c] = piece.map(|i| points[i as usize]);
        assert!((b - a).cross(&(c - a)).normalize().dot(&n) > 0.99);
    }
}

#[test]
fn turned_faces_are_accepted_and_split() {
    let (points, faces) = cube();
    let turn = Rotation3::from_euler_angles(0.3, 0.7, 1.1);
    let turned: Points = points.iter().map(|p| turn * p + Vector3::new(0.1, 0.2, 0.3)).collect();
    let body = ConvexPolyhedron::from_faces(&turned, &faces).unwrap();
    assert!(body.face_count() > 6, "rounding breaks most squares");
    assert!(body.report().non_planarity > 0.0 && body.report().non_planarity < 1e-15);
    let mut seen: Vec<usize> = body.faces().map(|f| body.source_face(f).unwrap()).collect();
    for (f, g) in body.faces().zip(&seen) {
        let outward = body.face_plane(f).unwrap().0;
        let centre = faces[*g]
            .iter()
            .fold(Vector3::zeros(), |s, &i| s + turned[i as usize].coords)
            / 4.0;
        assert!((centre - body.centroid().coords).dot(&outward) > 0.4);
    }
    seen.dedup();
    seen.sort();
    seen.dedup();
    assert_eq!(seen, [0, 1, 2, 3, 4, 5]);
    let single: Points = turned.iter().map(|p| p.map(|x| x as f32 as f64)).collect();
    assert!(matches!(
        refused(&single, &faces),
        BuildError::FaceNotPlanar { .. } | BuildError::NotConvex { .. }
    ));
    assert!(ConvexPolyhedron::from_faces_within(&single, &faces, 1e-6).is_ok());
    let bad = ConvexPolyhedron::from_faces_within(&single, &faces, f64::NAN);
    assert!(matches!(bad, Err(BuildError::BadBound { .. })));
}

#[test]
fn faults_of_faces_are_named() {
    let (points, faces) = cube();
    let with = |k: usize, face: &[u32]| {
        let mut faces = faces.clone();
        faces[k] = face.to_vec();
        refused(&points, &faces)
    };
    assert_eq!(with(2, &[0, 1, 8]), BuildError::IndexOutOfRange { face: 2, index: 8 });
    assert_eq!(with(3, &[2, 6]), BuildError::FaceTooSmall { face: 3 });
    let found = with(1, &[4, 5, 7, 5]);
    assert_eq!(found, BuildError::RepeatedVertex { face: 1, vertex: 5 });
    assert_eq!(with(4, &[2, 6, 4, 0]), BuildError::WrongOrientation { face: 4 });
    assert!(matches!(
        with(0, &[0, 2, 3]),
        BuildError::NotClosed {
            edge: [0, 1] | [1, 3] | [3, 0] | [0, 3]
        }
    ));
    assert!(matches!(refused(&points, &faces[..5]), BuildError::NotClosed { .. }));
    let inward: Vec<Vec<u32>> = faces.iter().map(|f| f.iter().rev().copied().collect()).collect();
    assert_eq!(refused(&points, &inward), BuildError::WrongOrientation { face: 0 });
    let mut twice = faces.clone();
    twice.push(faces[0].clone());
    assert!(matches!(refused(&points, &twice), BuildError::EdgeUsedTwice { .. }));
    // moving a vertex makes its faces nonplanar
    let mut bent = points.clone();
    bent[7] = Point3::new(1.0, 1.0, 1.25);
    assert!(matches!(
        refused(&bent, &faces),
        BuildError::FaceNotPlanar { face: 1, .. }
    ));
    // a pyramid pressed into the top
    let mut dented = points.clone();
    dented.push(Point3::new(0.5, 0.5, 0.75));
    let mut pieces = faces.clone();
    pieces.remove(1);
    pieces.extend([[4, 5, 8], [5, 7, 8], [7, 6, 8], [6, 4, 8]].map(Vec::from));
    match refused(&dented, &pieces) {
        BuildError::NotConvex { face, vertex, by } => {
            assert!(face >= 5 && vertex < 8 && by > 0.2 && by < 1.0, "{face} {vertex} {by}");
        }
        other => panic!("{other}"),
    }
    dented[8].z = 1.5;
    assert_eq!(ConvexPolyhedron::from_faces(&dented, &pieces).unwrap().face_count(), 9);
    let line = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0], [0.0, 1.0, 0.0]].map(Point3::from);
    let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]].map(Vec::from);
    assert_eq!(refused(&line, &faces), BuildError::FaceWithoutArea { face: 0 });
    assert!(matches!(
        refused(&points, &[]),
        BuildError::TooFewPoints { count: 0, .. }
    ));
}

#[test]
fn points_and_segments() {
    let p = Point3::new(1e9, 2.0, -3.0);
    let point = ConvexPolyhedron::point(p).unwrap();
    assert_eq!(point.vertex_count(), 1);
    assert_eq!(point.edge_count(), 0);
    assert_eq!(point.face_count(), 0);
    assert_eq!(point.centroid(), p);
    assert_eq!(point.volume(), 0.0);
    assert_eq!(point.bounding_ball(), (p, 0.0));
    assert_eq!(point.closest_point(&Point3::origin()), Some(p));
    assert!(point.contains(&p) && !point.contains(&Point3::origin()));
    let q = p + Vector3::new(0.5, 1.0, 2.0);
    let segment = ConvexPolyhedron::segment(p, q).unwrap();
    assert_eq!(segment.vertex_count(), 2);
    assert_eq!(segment.edge_count(), 1);
    assert_eq!(segment.face_count(), 0);
    assert!(segment.contains(&nalgebra::center(&p, &q)) && !segment.contains(&Point3::new(p.x, p.y, q.z)));
    assert_eq!(segment.centroid(), nalgebra::center(&p, &q));
    assert!(
        segment
            .edges()
            .all(|e| segment.edge_vertices(e).is_some() && segment.edge_faces(e).is_none())
    );
    assert_eq!(
        ConvexPolyhedron::segment(p, p).unwrap_err(),
        BuildError::Flat {
            dimension: 0,
            span: vec![0]
        }
    );
}

#[test]
fn polygons() {
    let corners: Points = [
        [0.0, 0.0],
        [2.0, 0.0],
        [1.0, 0.0],
        [2.0, 1.0],
        [0.5, 0.5],
        [0.0, 1.0],
        [0.0, 0.5],
        [2.0, 1.0],
    ]
    .map(|[x, y]| Point3::new(x, y, x + y))
    .to_vec();
    for (scale, shift) in [(1.0, 0.0), (2f64.powi(-300), 0.0), (1.0, 4096.0)] {
        let placed: Points = corners.iter().map(|p| (p * scale) + Vector3::repeat(shift)).collect();
        let polygon = ConvexPolyhedron::polygon(&placed).unwrap();
        assert_eq!(polygon.vertex_count(), 4);
        assert_eq!(polygon.edge_count(), 4);
        assert_eq!(polygon.face_count(), 2);
        let report = polygon.report();
        assert_eq!(report.on_edges.len(), 2);
        assert_eq!(&report.on_faces[..], &[4u32][..]);
        assert_eq!(report.duplicates.len(), 1);
        let front = polygon
            .face_plane(FaceId::clone(&polygon.faces().next().unwrap()))
            .unwrap()
            .0;
        assert!(front.z > 0.0, "the first corners turn counter-clockwise");
        let backward: Points = placed.iter().rev().copied().collect();
        let turned = ConvexPolyhedron::polygon(&backward).unwrap();
        assert!(turned.face_plane(turned.faces().next().unwrap()).unwrap().0.z < 0.0);
        let centre = Point3::from(Vector3::new(1.0, 0.5, 1.5) * scale + Vector3::repeat(shift));
        assert!((polygon.centroid() - centre).norm() <= 1e-15 * (scale + shift));
        assert!(placed.iter().all(|p| polygon.contains(p)));
        assert!(!polygon.contains(&(centre + Vector3::z() * scale * 1e-3)) && polygon.contains(&centre));
        let above = polygon
            .closest_point(&(centre + Vector3::new(-scale, -scale, scale) * 0.1))
            .unwrap();
        assert!((above - centre).norm() <= 1e-12 * scale + 1e-15 * shift);
    }
}

#[test]
fn polygons_that_are_none_are_refused() {
    let line: Points = (0..4).map(|k| Point3::new(k as f64, 2.0 * k as f64, 0.1)).collect();
    assert!(matches!(
        ConvexPolyhedron::polygon(&line),
        Err(BuildError::Flat { dimension: 1, .. })
    ));
    let turn = Rotation3::from_euler_angles(0.3, 0.7, 1.1);
    let hexagon: Points = (0..6)
        .map(|k| turn * Point3::new((k as f64).cos(), (k as f64).sin(), 0.0))
        .collect();
    let sliver = ConvexPolyhedron::polygon(&hexagon).unwrap();
    assert!(sliver.vertex_count() == 6 && sliver.report().thickness_ratio < 1e-14);
    let mut warped = hexagon.clone();
    warped[3] += Vector3::repeat(1e-9);
    assert!(matches!(
        ConvexPolyhedron::polygon(&warped),
        Err(BuildError::PolygonNotPlanar { .. })
    ));
}

#[test]
fn solids_have_their_features_and_sizes() {
    let features = |b: &ConvexPolyhedron| (b.vertex_count(), b.edge_count(), b.face_count());
    let radii_agree = |b: &ConvexPolyhedron, r: f64, tolerance: f64| {
        b.vertex_points()
            .all(|p| (p.coords.norm() / r - 1.0).abs() <= tolerance)
    };
    for r in [1.0, 0.3, 7e40, 3e-90] {
        for (body, expected, tolerance) in [
            (solids::tetrahedron(r), (4, 6, 4), 1e-15),
            (solids::octahedron(r), (6, 12, 8), 0.0),
            (solids::icosahedron(r), (12, 30, 20), 1e-15),
            (solids::dodecahedron(r), (20, 30, 12), 3e-8),
            (solids::geodesic_sphere(2, r), (162, 480, 320), 1e-15),
        ] {
            let body = body.unwrap();
            assert_eq!(features(&body), expected, "radius {r}");
            assert!(radii_agree(&body, r, tolerance), "radius {r} of {:?}", features(&body));
        }
    }
    let answer = features(&solids::cuboid(Vector3::new(1.0, 2.0, 3.0)).unwrap());
    assert_eq!(answer, (8, 12, 6));
    assert_eq!(features(&solids::prism(7, 2.0, 1.0).unwrap()), (14, 21, 9));
    assert_eq!(features(&solids::cone(100, 1.0, 1.0).unwrap()), (101, 200, 101));
    let found = solids::random_hull(50, Vector3::repeat(1.0), 3).unwrap().vertex_count();
    assert_eq!(found, 50);
    let a = solids::random_hull(9, Vector3::repeat(1.0), 4);
    let b = solids::random_hull(9, Vector3::repeat(1.0), 5);
    assert_ne!(a.unwrap(), b.unwrap());
    for bad in [
        solids::cuboid(Vector3::new(1.0, 0.0, 1.0)),
        solids::prism(2, 1.0, 1.0),
        solids::cone(8, 1.0, f64::NAN),
        solids::icosahedron(-1.0),
        solids::geodesic_sphere(40, 1.0),
        solids::random_hull(3, Vector3::repeat(1.0), 0),
    ] {
        assert!(matches!(
            bad,
            Err(BuildError::BadSize { .. } | BuildError::BadCount { .. })
        ));
    }
}

/// Bodies as thin as one unit in the last place, which reveal a careless sign or a missing
/// candidate.
#[test]
fn slivers_at_rounding_level_behave() {
    let cluster = [
        [0.6000000000000002, 0.4, 0.5000000000000001],
        [0.2, 0.3, 0.1],
        [0.7000000000000001, 0.09999999999999999, 0.7000000000000001],
        [0.3000000000000001, 0.5, 0.6000000000000002],
        [0.5000000000000001, 0.5, 0.4000000000000001],
        [0.3, 0.39999999999999997, 0.10000000000000002],
        [0.39999999999999997, 0.4000000000000001, 0.7],
        [0.10000000000000002, 0.3000000000000001, 0.7000000000000002],
        [0.7, 0.10000000000000002, 0.7000000000000001],
    ]
    .map(Point3::from);
    let sliver = [
        [0.2335088557185494, -0.8379976706381789, -0.5165457127311603],
        [-0.7008580241691877, -0.5400168053869379, -0.5882691710216128],
        [0.6008952052941783, -0.7540565813188926, -0.34757104533497135],
        [0.7262029563273924, 0.76964580718209, 0.7566129519256808],
    ]
    .map(Point3::from);
    for points in [&cluster[..], &sliver] {
        let body = ConvexPolyhedron::from_points(points).unwrap();
        let rim = |f| {
            body.face_vertices(f)
                .map(|v| body.source_vertex(v).unwrap() as u32)
                .collect::<Vec<_>>()
        };
        let faces: Vec<Vec<u32>> = body.faces().map(rim).collect();
        let back = ConvexPolyhedron::from_faces(points, &faces).unwrap();
        assert!(back == body && back.faces().all(|f| back.source_face(f) == Some(f.index())));
        let centre = Point3::from(points.iter().fold(Vector3::zeros(), |s, p| s + p.coords) / points.len() as f64);
        assert!((body.closest_point(&centre).unwrap() - centre).norm() < 1e-15);
    }
    // coordinates far below the flush limit are still the caller's points
    let mut corners = cube().0;
    corners[7].x += 1.0;
    corners[0].x = 5e-316;
    let body = ConvexPolyhedron::from_points(&corners).unwrap();
    assert!(body.report().flushed_coordinates == 1 && corners.iter().all(|p| body.contains(p)));
}

#[cfg(feature = "serde")]
#[test]
fn stored_bodies_come_back_bit_for_bit() {
    let (points, faces) = cube();
    let far: Points = points
        .iter()
        .map(|p| p * 1e-60 + Vector3::new(3e-50, 0.0, 7e-60))
        .collect();
    let bodies = [
        ConvexPolyhedron::from_faces(&points, &faces).unwrap(),
        ConvexPolyhedron::from_points(&far).unwrap(),
        solids::random_hull(200, Vector3::new(1.0, 1e-3, 1e50), 1).unwrap(),
        ConvexPolyhedron::point(points[3]).unwrap(),
        ConvexPolyhedron::segment(points[7], points[0]).unwrap(),
        ConvexPolyhedron::polygon(&points[..4]).unwrap(),
        ConvexPolyhedron::polygon(&[points[2], points[1], points[0]]).unwrap(),
    ];
    for body in &bodies {
        let text = serde_json::to_string(body).unwrap();
        let back: ConvexPolyhedron = serde_json::from_str(&text).unwrap();
        assert_eq!(format!("{body:?}"), format!("{back:?}"));
    }
    let text = serde_json::to_string(&bodies[0]).unwrap();
    for (from, to) in [
        ("[0.0,0.0,0.0],", ""),
        ("[0.0,0.0,0.0]", "[0.5,0.5,0.5]"),
        ("[0.0,0.0,0.0]", "[1e300,0.0,0.0]"),
        ("\"source\":[0,", "\"source\":["),
        ("\"polygon\":[]", "\"polygon\":[0,1,99]"),
        ("\"polygon\":[]", "\"polygon\":[0,1,2]"),
    ] {
        assert!(text.contains(from), "{text}");
        assert!(
            serde_json::from_str::<ConvexPolyhedron>(&text.replacen(from, to, 1)).is_err(),
            "{to}"
        );
    }
}

/// An exactly planar face is accepted at bound zero although its normal is rounded; a face off by
/// the last bit is rejected.
#[test]
fn exactly_planar_faces_need_no_room() {
    let mut rng = truth::rng::Rng::new(909);
    let (mut polygons, mut refused) = (0, 0);
    for _ in 0..200 {
        let points: Vec<_> = (0..30)
            .map(|_| Point3::from([0; 3].map(|_| rng.below(5) as f64)))
            .collect();
        let Ok(body) = ConvexPolyhedron::from_points(&points) else {
            continue;
        };
        let (vertices, faces) = truth::contacts::plain(&body);
        let mut vertices: Vec<_> = vertices.into_iter().map(Point3::from).collect();
        let again = ConvexPolyhedron::from_faces_within(&vertices, &faces, 0.0).unwrap();
        assert_eq!(again.face_count(), body.face_count());
        assert_eq!(again.report().non_planarity, 0.0);
        let Some(large) = faces.iter().find(|f| f.len() > 3) else {
            continue;
        };
        polygons += 1;
        let corner = &mut vertices[large[0] as usize];
        *corner = corner.map(|x| x * (1.0 + 3.0 * f64::EPSILON) + f64::EPSILON);
        refused += usize::from(ConvexPolyhedron::from_faces_within(&vertices, &faces, 0.0).is_err());
    }
    assert!(polygons > 100 && refused > polygons / 2, "{polygons} {refused}");
}
