//! Promise: the hulls of links contain their bodies exactly, and files with hulls hold what was
//! computed.

use std::path::{Path, PathBuf};
use std::process::Command;

use lin_canny_robot::lin_canny::{ConvexPolyhedron, Geometry};
use lin_canny_robot::{LoadOptions, MeshUse, Packages, Robot, hull_links, json_of_hulls, urdf_of_hulls};
use truth::covers::is_inside;

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../robot/examples")
}

fn gripper(meshes: MeshUse) -> Robot {
    let options = LoadOptions::default().meshes(meshes);
    Robot::load_with(examples().join("gripper.urdf"), &Packages::default(), &options).expect("a robot")
}

/// The balls of which a body is the hull: corners, or the centre of a ball.
fn balls(geometry: &Geometry) -> Vec<([f64; 3], f64)> {
    match geometry {
        Geometry::Polyhedron(hull) => hull.vertex_points().map(|p| (p.into(), 0.0)).collect(),
        Geometry::Mesh(mesh) => mesh.vertices().into_iter().map(|p| (p.into(), 0.0)).collect(),
        _ => vec![],
    }
}

fn faces_of(hull: &ConvexPolyhedron) -> Vec<[[f64; 3]; 3]> {
    let at = |v| -> [f64; 3] { hull.vertex(v).expect("a vertex").into() };
    hull.triangles().map(|t| t.map(at)).collect()
}

#[test]
fn hulls_contain_the_bodies_of_a_robot() {
    for meshes in [MeshUse::Hull, MeshUse::Mesh] {
        let robot = gripper(meshes);
        let mut judged = 0;
        for faces in [4, 6, 16, 40] {
            for row in hull_links(&robot, faces).expect("hulls") {
                let link = &robot.links()[robot.link(&row.link).expect("a link")];
                assert_eq!(link.bodies.len(), row.hulls.len());
                for (body, cover) in link.bodies.iter().zip(&row.hulls) {
                    assert!(cover.planes.len() <= faces);
                    let sides = faces_of(&cover.hull);
                    for ball in balls(&body.geometry) {
                        judged += 1;
                        assert!(is_inside(&ball, &sides), "{}, {faces}: {ball:?}", row.link);
                    }
                }
            }
        }
        assert!(judged > 100, "{judged}");
    }
}

#[test]
fn files_hold_the_hulls() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hull_files");
    std::fs::create_dir_all(&folder).expect("a folder");
    let robot = gripper(MeshUse::Hull);
    let rows = hull_links(&robot, 12).expect("hulls");
    let name = |row: usize, k: usize| format!("part-{row}-{k}.obj");
    let text = urdf_of_hulls(examples().join("gripper.urdf"), &rows, name).expect("a URDF");
    for (i, row) in rows.iter().enumerate() {
        for (k, cover) in row.hulls.iter().enumerate() {
            std::fs::write(folder.join(name(i, k)), cover.hull.to_obj()).expect("a file");
        }
    }
    let file = folder.join("out.urdf");
    std::fs::write(&file, text).expect("a file");
    let read = Robot::load_with(&file, &Packages::default(), &LoadOptions::default()).expect("a robot");
    assert_eq!(read.coordinates(), robot.coordinates());
    for row in &rows {
        let [after, before] = [&read, &robot].map(|r| &r.links()[r.link(&row.link).expect("a link")].bodies);
        assert_eq!(after.len(), before.len());
        for ((after, before), cover) in after.iter().zip(before).zip(&row.hulls) {
            assert_eq!(after.origin, before.origin);
            let hull = after.geometry.as_polyhedron().expect("a hull");
            assert!(hull.vertex_points().eq(cover.hull.vertex_points()), "{}", row.link);
        }
    }
    let json: serde_json::Value = serde_json::from_str(&json_of_hulls(&robot, &rows)).expect("JSON");
    for row in &rows {
        for (k, cover) in row.hulls.iter().enumerate() {
            let found = &json["hulls"][&row.link][k];
            assert_eq!(found["gap"].as_f64(), Some(cover.gap));
            let first = cover.hull.vertex_points().next().expect("a vertex");
            assert_eq!(found["vertices"][0][1].as_f64(), Some(first.y));
            assert_eq!(found["offsets"][0].as_f64(), Some(cover.planes[0].offset()));
            assert_eq!(found["normals"].as_array().map(Vec::len), Some(cover.planes.len()));
            assert_eq!(
                found["triangles"].as_array().map(Vec::len),
                Some(cover.hull.triangles().count())
            );
        }
    }
}

#[test]
fn the_tool_writes_hulls_and_names_what_is_wrong() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hulls");
    std::fs::create_dir_all(&folder).expect("a folder");
    let [urdf, json] = ["out.urdf", "out.json"].map(|name| folder.join(name).to_string_lossy().into_owned());
    let tool = |arguments: &[&str]| {
        let mut tool = Command::new(env!("CARGO_BIN_EXE_lin-canny"));
        let out = tool
            .current_dir(examples())
            .arg("cover")
            .args(arguments)
            .output()
            .expect("the tool runs");
        let text = String::from_utf8_lossy(&out.stdout).into_owned() + &String::from_utf8_lossy(&out.stderr);
        (out.status.code().expect("an exit code"), text)
    };
    let (code, text) = tool(&["gripper.urdf", "--faces", "8", "--out", &urdf, "--out", &json]);
    assert_eq!(code, 0, "{text}");
    assert!(
        text.contains("of up to 8 faces around it, which stick out at most"),
        "{text}"
    );
    let read = Robot::load(&urdf, &Packages::default()).expect("a robot");
    let robot = gripper(MeshUse::Hull);
    for (after, before) in read.links().iter().zip(robot.links()) {
        assert_eq!(after.bodies.len(), before.bodies.len());
        assert!(after.bodies.iter().all(|body| body.geometry.as_polyhedron().is_some()));
    }
    assert!(std::fs::read_to_string(&json).expect("a file").contains("offsets"));
    for (arguments, code, part) in [
        (
            vec!["gripper.urdf", "--faces", "3"],
            3,
            "link \"base\", body 0: number of faces is out of range: 3",
        ),
        (
            vec!["gripper.urdf", "--faces", "8", "--balls", "4"],
            2,
            "cannot be used with",
        ),
        (
            vec!["bench.sdf", "--faces", "8", "--out", &urdf],
            3,
            "unknown root element: \"sdf\"",
        ),
    ] {
        let (found, text) = tool(&arguments);
        assert!(found == code && text.contains(part), "{arguments:?}: {found}, {text}");
    }
}
