//! Pages of recordings: what the script of the page draws is what the recording holds.

use lin_canny::nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Geometry, Mesh, PairTracker, RelativePose};
use lin_canny_record::{Cursor, PageOptions, Recorder, Recording, page};
use serde_json::Value;

/// Returns what the script of a page draws.
fn data_of(page: &str) -> Value {
    let (_, rest) = page.split_once("id=\"data\">").expect("data");
    let (text, _) = rest.split_once("</script>").expect("an end");
    serde_json::from_str(text).expect("JSON")
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().expect("a list").iter();
    list.map(|x| x.as_f64().expect("a number")).collect()
}

fn example(name: &str) -> Recording {
    Recording::open(format!("{}/examples/{name}.jsonl", env!("CARGO_MANIFEST_DIR"))).expect("a recording")
}

#[test]
fn each_frame_has_the_poses_and_closest_points_of_the_recording() {
    for name in ["pair", "kinds", "pile", "cast"] {
        let recording = example(name);
        let data = data_of(&page(&recording, &PageOptions::default()));
        let radius = data["radius"].as_f64().expect("a radius");
        let center = Point3::from(Vector3::from_vec(numbers(&data["center"])));
        let frames = data["frames"].as_array().expect("frames");
        assert_eq!(frames.len(), recording.frames.len(), "{name}");
        let mut poses: Vec<Option<Vec<f64>>> = vec![None; recording.bodies.len()];
        let mut cursor = Cursor::default();
        let near = |p: &[f64], q: &Point3<f64>| {
            let p = center + Vector3::from_row_slice(&p[..3]) * radius;
            (p - q).norm() <= 1e-12 * radius
        };
        for (k, frame) in frames.iter().enumerate() {
            cursor.seek(&recording, k);
            for moved in frame["poses"].as_array().expect("poses") {
                poses[moved[0].as_u64().expect("a number") as usize] = Some(numbers(&moved[1]));
            }
            for (shown, pose) in poses.iter().zip(&cursor.poses) {
                assert_eq!(shown.is_some(), pose.is_some(), "{name} {k}");
                if let (Some(shown), Some(pose)) = (shown, pose) {
                    assert!(near(shown, &Point3::from(pose.translation.vector)), "{name} {k}");
                    assert_eq!(shown[3..], pose.rotation.coords.as_slice()[..], "{name} {k}");
                }
            }
            let pairs = frame["pairs"].as_array().expect("pairs");
            assert_eq!(pairs.len(), recording.frames[k].pairs.len(), "{name} {k}");
            for (shown, pair) in pairs.iter().zip(&recording.frames[k].pairs) {
                let Some(outcome) = &pair.outcome else { continue };
                let a = cursor.poses[pair.a as usize].expect("a pose");
                let ends = &shown["answer"]["points"];
                assert!(near(&numbers(&ends[0]), &(a * outcome.point_on_a)), "{name} {k}");
                assert_eq!(shown["answer"]["distance"], outcome.distance, "{name} {k}");
                assert_eq!(shown["contacts"].as_array().map(Vec::len), Some(pair.contacts.len()));
            }
        }
    }
}

#[test]
fn a_page_loads_nothing_and_no_name_ends_its_script() {
    let mut file = Vec::new();
    let mut recorder = Recorder::new(&mut file, "<a> & </title>").expect("a recording");
    let cube = Geometry::from(solids::cuboid(Vector3::repeat(1.0)).expect("a cube"));
    let body = recorder.body("</script><b>", &cube, &Isometry3::identity());
    body.expect("a body");
    recorder.note("@DATA@ </script>");
    recorder.end_frame().expect("a frame");
    recorder.finish().expect("an end");
    let recording = Recording::read(file.as_slice()).expect("a recording");
    let html = page(&recording, &PageOptions::default());
    assert!(!html.contains("</script><b>") && html.contains("<title>&lt;a&gt; &amp; &lt;/title&gt;</title>"));
    let data = data_of(&html);
    assert_eq!(data["bodies"][0]["name"], "</script><b>");
    assert_eq!(data["frames"][0]["note"], "@DATA@ </script>");
    for word in ["http:", "https:", "src=", "href=", "import ", "fetch("] {
        assert!(!html.contains(word), "{word}");
    }
}

#[test]
fn meshes_that_deform_are_drawn_deformed() {
    let points: Vec<Point3<f64>> = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
        .map(Point3::from)
        .to_vec();
    let mesh = Geometry::from(Mesh::new(&points, &[[0, 1, 2]]).expect("a mesh"));
    let mut file = Vec::new();
    let mut recorder = Recorder::new(&mut file, "").expect("a recording");
    let body = recorder.body("cloth", &mesh, &Isometry3::identity()).expect("a body");
    recorder.end_frame().expect("a frame");
    let bent: Vec<Point3<f64>> = points.iter().map(|p| p + Vector3::new(0.0, 0.0, p.x)).collect();
    recorder.vertices(body, &bent).expect("vertices");
    recorder.end_frame().expect("a frame");
    recorder.remove(body).expect("a body");
    recorder.end_frame().expect("a frame");
    recorder.finish().expect("an end");
    let recording = Recording::read(file.as_slice()).expect("a recording");
    let data = data_of(&page(&recording, &PageOptions::default()));
    let solids = data["solids"].as_array().expect("solids");
    assert_eq!(solids.len(), 2);
    assert_eq!(&data["frames"][1]["solids"], &serde_json::json!([[0, 1]]));
    assert_ne!(solids[0]["triangles"], solids[1]["triangles"]);
    assert_eq!(data["frames"][2]["hidden"], serde_json::json!([0]));
}

#[test]
fn features_are_those_of_the_outcome_and_options_are_kept() {
    let cube = Geometry::from(solids::cuboid(Vector3::repeat(1.0)).expect("a cube"));
    let turn = UnitQuaternion::from_euler_angles(0.4, 0.5, 0.6);
    let pose = Isometry3::from_parts(Translation3::new(5.0, 0.1, 0.2), turn);
    let mut file = Vec::new();
    let mut recorder = Recorder::new(&mut file, "").expect("a recording");
    let a = recorder.body("a", &cube, &Isometry3::identity()).expect("a body");
    let b = recorder.body("b", &cube, &pose).expect("a body");
    let poses = RelativePose::new(&Isometry3::identity(), &pose).expect("poses");
    let answer = PairTracker::new().closest(&cube, &cube, &poses);
    recorder.answer(a, b, &answer).expect("an answer");
    recorder.end_frame().expect("a frame");
    recorder.finish().expect("an end");
    let recording = Recording::read(file.as_slice()).expect("a recording");
    let options = PageOptions::default().frame(7).panel(false).colors(vec![[1, 2, 3]]);
    let data = data_of(&page(&recording, &options));
    assert_eq!((&data["frame"], &data["panel"]), (&0.into(), &false.into()));
    assert_eq!(data["bodies"][0]["color"], serde_json::json!([1, 2, 3]));
    let of = &data["frames"][0]["pairs"][0]["answer"]["features"];
    let counts = [0, 1].map(|k| {
        let lit = &data["features"][of[k].as_u64().expect("a feature") as usize];
        ["points", "normals"].map(|key| lit[key].as_array().map_or(0, Vec::len))
    });
    // A face with its normal against a vertex with three.
    assert_eq!(counts, [[4, 1], [1, 3]], "{}", answer.outcome.features);
}

/// A frame may show bodies of any other size than the first frame does.
#[test]
fn solids_of_any_size_have_coordinates_up_to_one() {
    for size in [1e-90, 1.0, 1e90] {
        let mut file = Vec::new();
        let mut recorder = Recorder::new(&mut file, "").expect("a recording");
        for side in [1.0, size] {
            let cube = Geometry::from(solids::cuboid(Vector3::repeat(side)).expect("a cube"));
            let body = recorder.body("a", &cube, &Isometry3::identity()).expect("a body");
            recorder.end_frame().expect("a frame");
            recorder.remove(body).expect("a body");
        }
        recorder.finish().expect("an end");
        let recording = Recording::read(file.as_slice()).expect("a recording");
        let data = data_of(&page(&recording, &PageOptions::default()));
        let [first, second] = [0, 1].map(|k| &data["solids"][k]);
        assert_eq!(first["triangles"], second["triangles"], "{size}");
        let ratio = second["radius"].as_f64().expect("a radius") / first["radius"].as_f64().expect("a radius");
        assert!((ratio / size - 1.0).abs() < 1e-12, "{size}: {ratio}");
    }
}

/// Frames beyond the numbers of the page, and a recording with bodies alone, are pages too.
#[test]
fn every_recording_has_a_page() {
    let lines = |text: &str| Recording::read(text.as_bytes()).expect("a recording");
    let header = "{\"format\":\"lin-canny recording\",\"version\":2}\n";
    let found = &data_of(&page(&lines(header), &PageOptions::default()))["frames"][0]["poses"];
    assert_eq!(*found, serde_json::json!([]));
    let cube = Geometry::from(solids::cuboid(Vector3::repeat(1.0)).expect("a cube"));
    for far in [0.0, 1e-200, 1e200, f64::MAX] {
        let mut file = Vec::new();
        let mut recorder = Recorder::new(&mut file, "").expect("a recording");
        recorder
            .body("a", &cube, &Isometry3::translation(far, 0.0, -far))
            .expect("a body");
        recorder
            .body("b", &cube, &Isometry3::translation(-far, 0.0, 0.0))
            .expect("a body");
        recorder.finish().expect("an end");
        let data = data_of(&page(
            &lines(&String::from_utf8(file).expect("text")),
            &PageOptions::default(),
        ));
        assert_eq!(data["frames"][0]["poses"].as_array().map(Vec::len), Some(2), "{far}");
    }
}
