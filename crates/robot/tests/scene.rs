//! Promise: clouds, voxels, half-spaces and height fields of a cell are what its file says, objects are attached, padded and
//! excluded by name, and every wrong number is named.

use lin_canny_robot::plan::Checker;
use std::path::{Path, PathBuf};

use lin_canny::nalgebra::Isometry3;
use lin_canny::{Geometry, GeometryKind, MeshKind, PairTracker, RelativePose, Shape};
use lin_canny_robot::{AttachedBody, CellFile, LoadOptions, LoadedCell, Packages, RobotFiles};
use truth::errors::says;
use truth::plans::Furnish;

fn folder() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("scene");
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn write(name: &str, text: &str) -> PathBuf {
    let file = folder().join(name);
    std::fs::write(&file, text).expect("a file");
    file
}

/// Returns an array of numpy in double precision and C order.
fn npy(shape: &str, values: &[f64]) -> Vec<u8> {
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}}}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(values.iter().flat_map(|x| x.to_le_bytes()));
    bytes
}

/// Returns the cell with one body, or the text of the error.
fn cell(body: &str) -> Result<CellFile, String> {
    let text = format!("{{\"bodies\": [{{\"name\": \"x\", {body}}}]}}");
    let found = CellFile::parse(
        &text,
        folder().join("cell.json"),
        &Packages::default(),
        &LoadOptions::default(),
    );
    found.map_err(|error| error.to_string())
}

/// Returns the only geometry of a cell with one body.
fn body(text: &str) -> Geometry {
    cell(text).expect("a cell").obstacles[0].geometry.clone()
}

/// Returns the distance of a ball of radius 0.1 at a point.
fn distance(geometry: &Geometry, at: [f64; 3]) -> f64 {
    let pose = RelativePose::from_isometry(&Isometry3::translation(at[0], at[1], at[2])).expect("a pose");
    let ball = Shape::ball(0.1).expect("a ball");
    PairTracker::new().closest(geometry, &ball, &pose).distance
}

#[track_caller]
fn is(value: f64, expected: f64) {
    assert!((value - expected).abs() < 1e-12, "{value}, not {expected}");
}

#[test]
fn clouds_are_points_of_a_file_or_a_list() {
    write("row.xyz", "0 0 0\n1000 0 0\nnan nan nan\n2000 0 0\n");
    let list = body(r#""cloud": {"points": [[0, 0, 0], [1, 0, 0], [2, 0, 0]], "radius": 0.2}"#);
    assert_eq!(list.kind(), GeometryKind::Cloud);
    let file = cell(r#""cloud": {"file": "row.xyz", "scale": 0.001, "radius": 0.2}"#).expect("a cell");
    assert_eq!(file.skipped.len(), 1, "{:?}", file.skipped);
    assert!(
        file.skipped[0]
            .to_string()
            .ends_with("row.xyz: 1 points without a return")
    );
    for geometry in [&list, &file.obstacles[0].geometry] {
        is(distance(geometry, [2.0, 1.0, 0.0]), 0.7);
        is(distance(geometry, [3.0, 0.0, 0.0]), 0.7);
    }
    let boxes = body(r#""cloud": {"points": [[0, 0, 0], [1, 0, 0]], "box": {"size": [0.2, 0.4, 0.6]}}"#);
    is(distance(&boxes, [1.0, 1.0, 0.0]), 0.7);
    is(distance(&boxes, [1.0, 0.0, 1.0]), 0.6);
    let kept = CellFile::parse(
        r#"{"bodies": [{"name": "x", "cloud": {"file": "row.xyz", "radius": 0.1}}]}"#,
        folder().join("cell.json"),
        &Packages::default(),
        &LoadOptions::default().keep_invalid(true),
    );
    says(kept, "row.xyz");
}

#[test]
fn voxels_half_spaces_and_heights_are_where_the_file_says() {
    let voxels = body(r#""voxels": {"indices": [[0, 0, 0], [3, 0, 0]], "size": 0.5, "origin": [1, 0, 0]}"#);
    is(distance(&voxels, [1.25, 1.0, 0.25]), 0.4);
    is(distance(&voxels, [3.5, 0.25, 0.25]), 0.4);
    write("grid.xyz", "0 0 0\n3 0 0\n");
    let file = body(r#""voxels": {"file": "grid.xyz", "size": [0.5, 0.5, 0.5], "origin": [1, 0, 0]}"#);
    is(distance(&file, [3.5, 0.25, 0.25]), 0.4);

    let floor = body(r#""half_space": {"normal": [0, 0, 2], "offset": 1.0}"#);
    assert_eq!(floor.kind(), GeometryKind::HalfSpace);
    is(distance(&floor, [1e3, 1e3, 1.0]), 0.4);
    is(distance(&floor, [0.0, 0.0, 0.5]), -0.1);

    let values = r#""values": [[0, 0, 0], [0, 0.5, 0]], "spacing": [1, 2]"#;
    let open = body(&format!("\"heights\": {{{values}}}"));
    let Geometry::Mesh(mesh) = &open else {
        panic!("{open:?}")
    };
    assert_eq!(mesh.kind(), MeshKind::Open);
    is(distance(&open, [1.0, 2.0, 1.0]), 0.4);
    let Geometry::Mesh(solid) = body(&format!("\"heights\": {{{values}, \"base\": -1}}")) else {
        panic!()
    };
    assert_eq!(solid.kind(), MeshKind::Solid);
    write("heights.txt", "0 0 0\n0, 0.5, 0\n\n");
    let array = npy("(2, 3)", &[0.0, 0.0, 0.0, 0.0, 0.5, 0.0]);
    std::fs::write(folder().join("heights.npy"), array).expect("a file");
    for name in ["heights.txt", "heights.npy"] {
        let file = body(&format!("\"heights\": {{\"file\": \"{name}\", \"spacing\": [1, 2]}}"));
        is(distance(&file, [1.0, 2.0, 1.0]), 0.4);
    }
}

#[test]
fn wrong_bodies_are_named() {
    write("bad.txt", "0 0\n0 x\n");
    std::fs::write(folder().join("bad.npy"), npy("(2, 1, 2)", &[0.0; 4])).expect("a file");
    for [text, expected] in truth::rows::rows(include_str!("scene/rows.txt"), "wrong bodies") {
        let error = cell(&text).expect_err(&text);
        assert!(error.contains(&expected), "{text}: {error}");
        assert!(error.len() < 300, "{text}: {error}");
    }
}

#[test]
fn objects_are_attached_padded_and_excluded_by_name() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let files = RobotFiles::new(examples.join("gripper.urdf"));
    let LoadedCell { robot, cell: plain, .. } = files.load().expect("a robot");
    let link = &robot.links()[robot.links().len() - 1].name;
    let text = r#"{"name": "rod", "capsule": {"radius": 0.01, "length": 2.0}, "xyz": [0, 0, 1.2]}"#;
    let rod = AttachedBody::load(write("rod.json", text), &Packages::default(), &LoadOptions::default());
    let rod = rod.expect("a rod");
    let home = vec![0.0; plain.coordinates().len()];

    let mut setup = plain.clone();
    rod.clone().attach_to(&mut setup, link).expect("a link");
    setup.put(
        "ball",
        Shape::ball(0.1).expect("a ball"),
        Isometry3::translation(5.0, 5.0, 5.0),
    );
    let mut checker = Checker::of_robots(setup.clone()).expect("a checker");
    let near = checker.nearest(&home, f64::INFINITY).expect("pairs");
    let names = |pair: &lin_canny_robot::plan::CellPair| [pair.a, pair.b].map(|id| checker.name(id).to_owned());
    let before = near
        .iter()
        .find(|n| names(&n.pair).contains(&"rod".into()) && names(&n.pair).contains(&"ball".into()));
    let before = before.expect("the pair of the rod and the ball").clone();
    is(before.excess, before.distance);

    setup.pad("rod", 0.02).expect("a padding");
    setup.pad("ball", 0.01).expect("a padding");
    let mut padded = Checker::of_robots(setup.clone()).expect("a checker");
    let near = padded.nearest(&home, f64::INFINITY).expect("pairs");
    let after = near.iter().find(|n| n.pair == before.pair).expect("the pair");
    is(after.distance, before.distance);
    is(after.excess, before.distance - 0.03);

    setup.exclude("rod", "ball").expect("names");
    let mut excluded = Checker::of_robots(setup.clone()).expect("a checker");
    let near = excluded.nearest(&home, f64::INFINITY).expect("pairs");
    assert!(near.iter().all(|n| n.pair != before.pair));

    says(setup.pad("rood", 0.1), "rood");
    says(setup.pad("rod", -0.1), "-0.1");
    says(rod.attach_to(&mut setup, "hnad"), "hnad");
    says(rod.attach_to(&mut setup, link), "taken");
}
