//! What is written is read back, and what is wrong with a file is named by its line.

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, Group, PairQueries, Scene};
use lin_canny::{Cloud, CloudElement, Geometry, HalfSpace, ManifoldOptions, PairTracker, RelativePose, Shape};
use lin_canny_record::{Cursor, ReadError, Recorder, Recording, RenderMesh, WriteError};

fn cube() -> Geometry {
    solids::cuboid(Vector3::new(0.5, 0.4, 0.3)).unwrap().into()
}

fn place(frame: usize) -> Isometry3<f64> {
    Isometry3::new(
        Vector3::new(2.0 - 0.1 * frame as f64, 0.1, 0.2),
        Vector3::new(0.1, 0.2 * frame as f64, 0.3),
    )
}

/// Two bodies over twenty frames; the second moves in even frames only.
fn pair() -> (String, Vec<lin_canny::Outcome>) {
    let cube = cube();
    let mut recorder = Recorder::new(Vec::new(), "pair").unwrap();
    let a = recorder.body("a", &cube, &Isometry3::identity()).unwrap();
    let b = recorder.body("b", &cube, &place(0)).unwrap();
    let (mut tracker, mut outcomes) = (PairTracker::new(), Vec::new());
    for frame in 0..20 {
        let pose = place(frame / 2 * 2);
        recorder.pose(b, &pose).unwrap();
        let poses = RelativePose::new_normalized(&Isometry3::identity(), &pose).unwrap();
        let answer = tracker.closest(&cube, &cube, &poses);
        recorder.answer(a, b, &answer).unwrap();
        let groups = tracker
            .contacts(&cube, &cube, &poses, &ManifoldOptions::default().prediction(10.0))
            .unwrap();
        recorder.contacts(a, b, groups).unwrap();
        recorder.end_frame().unwrap();
        outcomes.push(answer.outcome);
    }
    (String::from_utf8(recorder.finish().unwrap()).unwrap(), outcomes)
}

#[test]
fn answers_and_poses_come_back_to_the_bit() {
    let (text, outcomes) = pair();
    let recording = Recording::read(text.as_bytes()).unwrap();
    assert_eq!((recording.title.as_str(), recording.geometries.len()), ("pair", 1));
    assert_eq!(recording.frames.len(), outcomes.len());
    let mut cursor = Cursor::default();
    for (k, frame) in recording.frames.iter().enumerate() {
        assert_eq!(frame.pairs[0].outcome.unwrap(), outcomes[k]);
        assert!(!frame.pairs[0].contacts.is_empty());
        cursor.seek(&recording, k);
        assert_eq!(cursor.poses[1], Some(place(k / 2 * 2)));
        // A pose that did not change is not written.
        assert_eq!(frame.poses.len(), usize::from(k > 0 && k % 2 == 0));
    }
    // Back, and past the end.
    cursor.seek(&recording, 3);
    assert_eq!(cursor.poses[1], Some(place(2)));
    cursor.seek(&recording, 1000);
    assert_eq!(cursor.poses[1], Some(place(18)));
}

#[test]
fn a_scene_is_recorded_with_bodies_that_come_and_go() {
    let mut scene = Scene::new();
    let all = Group::default();
    let queries = PairQueries::none().distance(1.0).features(true);
    scene
        .set_queries(all, all, queries.manifold(ManifoldOptions::default().prediction(1.0)))
        .unwrap();
    let body = |k| Body::moving(cube()).user_data(k);
    let first = scene.insert(body(7), Isometry3::identity()).unwrap();
    scene.insert(body(8), Isometry3::translation(1.2, 0.0, 0.0)).unwrap();
    let mut recorder = Recorder::new(Vec::new(), "scene").unwrap();
    scene.step();
    recorder.scene(&scene).unwrap();
    scene.insert(body(9), Isometry3::translation(0.0, 1.0, 0.0)).unwrap();
    scene.step();
    recorder.scene(&scene).unwrap();
    scene.remove(first).unwrap();
    scene.step();
    recorder.scene(&scene).unwrap();
    let file = recorder.finish().unwrap();

    let recording = Recording::read(file.as_slice()).unwrap();
    let names: Vec<&str> = recording.bodies.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names, ["7", "8", "9"]);
    let shown = |frame| {
        let mut cursor = Cursor::default();
        cursor.seek(&recording, frame);
        cursor.poses.iter().map(Option::is_some).collect::<Vec<_>>()
    };
    assert_eq!(shown(0), [true, true, false]);
    assert_eq!(shown(1), [true, true, true]);
    assert_eq!(shown(2), [false, true, true]);
    let pair = &recording.frames[0].pairs[0];
    assert!((pair.outcome.unwrap().distance - 0.2).abs() < 1e-12);
    assert_eq!((pair.contacts.len(), recording.frames[1].boxes.len()), (4, 3));
}

#[test]
fn errors_name_the_line() {
    let (text, _) = pair();
    let with = |line: usize, new: &str| {
        let mut lines: Vec<&str> = text.lines().collect();
        lines[line - 1] = new;
        Recording::read(lines.join("\n").as_bytes()).unwrap_err()
    };
    let wrong = with(6, "{\"frame\":{\"poses\":[[2,[0,0,0,0,0,0,1]]]}}");
    assert!(
        matches!(
            wrong,
            ReadError::Number {
                line: 6,
                number: 2,
                count: 2,
                ..
            }
        ),
        "{wrong}"
    );
    let wrong = with(6, "{\"frame\":{\"poses\":[[1,[0,0,0,0,0,0,2]]]}}");
    assert!(wrong.to_string().starts_with("line 6: "), "{wrong}");
    assert!(wrong.to_string().contains("unit quaternion"), "{wrong}");
    let wrong = with(9, "{\"frame\":");
    assert!(matches!(wrong, ReadError::Line { line: 9, .. }), "{wrong}");
    let wrong = with(1, "{\"format\":\"lin-canny recording\",\"version\":1}");
    assert!(matches!(wrong, ReadError::Version { found: 1 }), "{wrong}");
    let wrong = with(1, "{\"format\":\"other\",\"version\":2}");
    assert!(matches!(wrong, ReadError::Format { .. }), "{wrong}");
    assert!(
        Recording::read(&b""[..])
            .unwrap_err()
            .to_string()
            .starts_with("line 1: ")
    );
}

#[test]
fn a_recorder_refuses_what_a_reader_would() {
    let mut recorder = Recorder::new(Vec::new(), "").unwrap();
    let body = recorder.body("a", &cube(), &Isometry3::identity()).unwrap();
    let lost = Isometry3::translation(f64::NAN, 0.0, 0.0);
    assert!(matches!(recorder.pose(body, &lost), Err(WriteError::Pose(_))));
    let wrong = recorder.pose(1, &Isometry3::identity());
    assert!(matches!(wrong, Err(WriteError::Body { number: 1, count: 1 })));
}

#[test]
fn vertices_of_meshes_that_bend_are_read_back() {
    let die = solids::cuboid(Vector3::new(1.0, 1.0, 1.0)).unwrap();
    let mesh = lin_canny::Mesh::from_convex(&die).unwrap();
    let rest = mesh.vertices();
    let mut file = Vec::new();
    let mut recorder = Recorder::new(&mut file, "a soft die").unwrap();
    let soft = recorder
        .body("soft", &Geometry::from(mesh), &Isometry3::identity())
        .unwrap();
    let hard = recorder
        .body("hard", &Geometry::from(die), &Isometry3::identity())
        .unwrap();
    let bent = |k: u32| rest.iter().map(|p| p * (1.0 + 0.1 * f64::from(k))).collect::<Vec<_>>();
    for k in 0..4 {
        if k != 2 {
            recorder.vertices(soft, &bent(k)).unwrap();
        }
        recorder.end_frame().unwrap();
    }
    assert!(matches!(
        recorder.vertices(hard, &rest),
        Err(WriteError::NotAMesh { body: 1 })
    ));
    assert!(matches!(
        recorder.vertices(soft, &rest[1..]),
        Err(WriteError::Vertices { body: 0, count: 8 })
    ));
    let mut wrong = rest.clone();
    wrong[3].x = f64::NAN;
    assert!(recorder.vertices(soft, &wrong).is_err());
    recorder.finish().unwrap();

    let recording = Recording::read(file.as_slice()).unwrap();
    let mut cursor = Cursor::default();
    for (frame, then) in [(0, 0), (1, 1), (2, 1), (3, 3), (1, 1)] {
        cursor.seek(&recording, frame);
        assert_eq!(cursor.vertices(&recording, soft), Some(&bent(then)[..]));
        assert_eq!(cursor.vertices(&recording, hard), None);
    }
    let text = String::from_utf8(file).unwrap();
    let fewer = text.replacen("[[0,[[", "[[1,[[", 1);
    assert_ne!(fewer, text);
    assert!(matches!(
        Recording::read(fewer.as_bytes()),
        Err(ReadError::Vertices { body: 1, .. })
    ));
}

/// A grid of points 0.1 apart.
fn grid(side: usize) -> Vec<[f32; 3]> {
    let at = |k: usize| [k % side, k / side % side, k / side / side].map(|x| 0.1 * x as f32);
    (0..side.pow(3)).map(at).collect()
}

#[test]
fn a_cloud_is_written_once_and_read_back_to_the_bit() {
    let cloud: Geometry = Cloud::from_f32(&grid(20), CloudElement::Ball(0.02)).unwrap().into();
    let floor: Geometry = HalfSpace::new(Vector3::z(), -1.0).unwrap().into();
    let mut recorder = Recorder::new(Vec::new(), "cloud").unwrap();
    for name in ["a", "b"] {
        recorder.body(name, &cloud, &Isometry3::identity()).unwrap();
        recorder.body(name, &floor, &Isometry3::identity()).unwrap();
    }
    recorder.end_frame().unwrap();
    let text = String::from_utf8(recorder.finish().unwrap()).unwrap();
    let recording = Recording::read(text.as_bytes()).unwrap();
    assert_eq!((recording.geometries.len(), recording.bodies.len()), (2, 4));
    let found = serde_json::to_string(&recording.geometries[0]).unwrap();
    assert_eq!(found, serde_json::to_string(&cloud).unwrap());
    assert!(text.len() < 8000 * 36, "{} bytes", text.len());
}

#[test]
fn clouds_are_drawn_as_their_elements_or_as_a_tetrahedron_per_point() {
    let drawn = |side: usize, element: CloudElement| {
        RenderMesh::from_geometry(&Cloud::from_f32(&grid(side), element).unwrap().into())
    };
    let ball = Shape::ball(0.02).unwrap();
    for (side, element, triangles) in [
        (3, CloudElement::Ball(0.02), 8 * 27),
        (3, CloudElement::Ball(0.0), 8 * 27),
        (
            3,
            CloudElement::Balls((0..27).map(|k| 0.001 * f64::from(k)).collect()),
            8 * 27,
        ),
        (3, CloudElement::Box(Vector3::new(0.01, 0.02, 0.03)), 12 * 27),
        (40, CloudElement::Ball(0.02), 4 * 64_000),
        (40, CloudElement::Box(Vector3::new(0.01, 0.02, 0.03)), 4 * 64_000),
        (20, CloudElement::Shape(ball), 4 * 8000),
    ] {
        let mesh = drawn(side, element.clone());
        assert_eq!(mesh.triangles.len(), triangles, "{side} {element:?}");
        let size = 0.1 * (side - 1) as f64;
        assert!((mesh.radius - size * 3f64.sqrt()).abs() < 0.08, "{}", mesh.radius);
        for (corners, normal) in &mesh.triangles {
            let across = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
            assert!(across.dot(normal) > 0.0);
        }
    }
    // The triangles of a cloud of one point are those of its element.
    let one = RenderMesh::from_geometry(
        &Cloud::from_f32(&[[1.0, 2.0, 3.0]], CloudElement::Ball(0.5))
            .unwrap()
            .into(),
    );
    let corners = one.triangles.iter().flat_map(|(corners, _)| corners);
    let far = corners.map(|p| (p - Vector3::new(1.0, 2.0, 3.0)).coords.norm());
    assert!(far.into_iter().all(|r| (r - 0.5).abs() < 1e-12));
}
