//! Promise: the balls of links contain their bodies, and files with balls hold what was computed.

use std::path::{Path, PathBuf};
use std::process::Command;

use lin_canny_robot::lin_canny::cover::{Ball, CoverGoal};
use lin_canny_robot::lin_canny::nalgebra::Point3;
use lin_canny_robot::lin_canny::{Geometry, PointQuery};
use lin_canny_robot::{LinkCover, LoadOptions, MeshUse, Packages, Robot, cover_links, json_of_balls, urdf_of_balls};
use truth::covers::contain;

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../robot/examples")
}

fn gripper(meshes: MeshUse) -> Robot {
    let options = LoadOptions::default().meshes(meshes);
    Robot::load_with(examples().join("gripper.urdf"), &Packages::default(), &options).expect("a robot")
}

fn plain(balls: &[Ball]) -> Vec<([f64; 3], f64)> {
    balls.iter().map(|ball| (ball.center.into(), ball.radius)).collect()
}

/// Checks the triangles of hulls and meshes in the frame of the link, exactly but for their poses.
fn check(robot: &Robot, covers: &[LinkCover]) -> usize {
    let mut triangles = 0;
    for cover in covers {
        let link = &robot.links()[robot.link(&cover.link).expect("a link")];
        let balls = plain(&cover.outside.balls);
        for body in &link.bodies {
            let place = |p: Point3<f64>| -> [f64; 3] { (body.origin * p).into() };
            let mut judge = |corners: [[f64; 3]; 3]| {
                triangles += 1;
                assert!(contain(&balls, &corners), "{}: {corners:?}", cover.link);
            };
            match &body.geometry {
                Geometry::Polyhedron(hull) => {
                    let corner = |v| place(hull.vertex(v).expect("a vertex"));
                    hull.triangles().for_each(|t| judge(t.map(corner)));
                }
                Geometry::Mesh(mesh) => {
                    mesh.triangles().for_each(|(_, t)| judge(t.map(place)));
                }
                _ => {}
            }
        }
        for ball in cover.inside.iter().flat_map(|inside| &inside.balls) {
            let is_inside = |body: &lin_canny_robot::LinkBody| {
                let p = body.origin.inverse_transform_point(&ball.center);
                let found = PointQuery::new(&body.geometry).signed_distance(&p).expect("a point");
                found.lower <= 1e-12 - ball.radius
            };
            assert!(link.bodies.iter().any(is_inside), "{}: {ball:?}", cover.link);
        }
    }
    triangles
}

#[test]
fn balls_contain_the_links_of_a_robot() {
    for meshes in [MeshUse::Hull, MeshUse::Mesh] {
        let robot = gripper(meshes);
        let covers = cover_links(&robot, CoverGoal::Balls(4), 2).expect("covers");
        let with_bodies = robot.links().iter().filter(|link| !link.bodies.is_empty());
        assert_eq!(covers.len(), with_bodies.count());
        assert!(check(&robot, &covers) > 40);
    }
}

#[test]
fn files_hold_the_balls() {
    let robot = gripper(MeshUse::Hull);
    let covers = cover_links(&robot, CoverGoal::Gap(0.03), 2).expect("covers");
    assert!(covers.iter().all(|cover| cover.outside.gap <= 0.03 + 1e-11));
    let file = examples().join("gripper.urdf");
    let text = urdf_of_balls(&file, &covers).expect("a URDF");
    let read = Robot::parse(&text, &file, &Packages::default(), &LoadOptions::default()).expect("a robot");
    assert_eq!(read.coordinates(), robot.coordinates());
    for (link, before) in read.links().iter().zip(robot.links()) {
        assert_eq!(link.name, before.name);
        let Some(cover) = covers.iter().find(|cover| cover.link == link.name) else {
            assert!(link.bodies.is_empty());
            continue;
        };
        assert_eq!(link.bodies.len(), cover.outside.balls.len(), "{}", link.name);
        for (body, ball) in link.bodies.iter().zip(&cover.outside.balls) {
            assert_eq!(body.origin.translation.vector, ball.center.coords);
            let shape = body.geometry.as_convex().expect("a ball");
            assert_eq!(shape.rounding_radius(), ball.radius);
        }
    }
    let json: serde_json::Value = serde_json::from_str(&json_of_balls(&robot, &covers)).expect("JSON");
    for cover in &covers {
        let first = &json["collision_spheres"][&cover.link][0];
        assert_eq!(first["radius"].as_f64(), Some(cover.outside.balls[0].radius));
        assert_eq!(first["center"][1].as_f64(), Some(cover.outside.balls[0].center.y));
        assert_eq!(json["gaps"][&cover.link].as_f64(), Some(cover.outside.gap));
        let inner = json["inner_spheres"][&cover.link].as_array().map(Vec::len);
        assert_eq!(inner, cover.inside.as_ref().map(|inside| inside.balls.len()));
    }
}

fn tool(arguments: &[&str]) -> (i32, String) {
    let mut tool = Command::new(env!("CARGO_BIN_EXE_lin-canny"));
    let out = tool
        .current_dir(examples())
        .arg("cover")
        .args(arguments)
        .output()
        .expect("the tool runs");
    let text = String::from_utf8_lossy(&out.stdout).into_owned() + &String::from_utf8_lossy(&out.stderr);
    (out.status.code().expect("an exit code"), text)
}

#[test]
fn the_tool_writes_balls_and_names_what_is_wrong() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("covers");
    std::fs::create_dir_all(&folder).expect("a folder");
    let [urdf, json] = ["out.urdf", "out.json"].map(|name| folder.join(name).to_string_lossy().into_owned());
    let (code, text) = tool(&[
        "gripper.urdf",
        "--balls",
        "4",
        "--inner",
        "2",
        "--out",
        &urdf,
        "--out",
        &json,
    ]);
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("balls around it stick out at most"), "{text}");
    let read = Robot::load(&urdf, &Packages::default()).expect("a robot");
    assert!(read.links().iter().all(|link| link.bodies.len() <= 8));
    assert!(
        std::fs::read_to_string(&json)
            .expect("a file")
            .contains("inner_spheres")
    );
    for (arguments, code, part) in [
        (
            vec!["gripper.urdf", "--balls", "0"],
            3,
            "link \"base\", body 0: number of balls is out of range: 0",
        ),
        (vec!["gripper.urdf", "--gap", "-1"], 2, ""),
        (
            vec!["gripper.urdf", "--gap=-1"],
            2,
            "expected a finite number, at least 0",
        ),
        (
            vec!["gripper.urdf", "--out", "x.txt"],
            2,
            "expected a name that ends with .urdf or .json",
        ),
        (vec!["bench.sdf", "--out", &urdf], 3, "unknown root element: \"sdf\""),
    ] {
        let (found, text) = tool(&arguments);
        assert!(found == code && text.contains(part), "{arguments:?}: {found}, {text}");
    }
}
