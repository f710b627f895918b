//! Promise: the balls and hulls of links contain their bodies, and files with them hold what was
//! computed.

use std::path::{Path, PathBuf};

use lin_canny_robot::lin_canny::cover::{Ball, CoverGoal};
use lin_canny_robot::lin_canny::nalgebra::Point3;
use lin_canny_robot::lin_canny::{ConvexPolyhedron, Geometry, PointQuery};
use lin_canny_robot::{
    LinkCover, LoadOptions, MeshUse, Packages, Robot, cover_links, hull_links, json_of_balls, json_of_hulls,
    urdf_of_balls, urdf_of_hulls,
};
use truth::covers::{contain, is_inside};

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
            let answer = found["triangles"].as_array().map(Vec::len);
            assert_eq!(answer, Some(cover.hull.triangles().count()));
        }
    }
}
