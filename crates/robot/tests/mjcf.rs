//! MJCF: the rules of MuJoCo in small files, and its own results for files of public packages.

use std::collections::{BTreeSet, HashMap};

use lin_canny::Geometry;
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::BoxHint;
use lin_canny_robot::plan::WorldId;
use lin_canny_robot::{LoadOptions, MotionKind, Packages, Robot, Setup};

fn parse(text: &str) -> Result<Robot, lin_canny_robot::FileError> {
    Robot::parse(text, "r.xml", &Packages::default(), &LoadOptions::default())
}

fn pose(numbers: &[f64]) -> Isometry3<f64> {
    let turn = Quaternion::new(numbers[6], numbers[3], numbers[4], numbers[5]);
    let place = Translation3::new(numbers[0], numbers[1], numbers[2]);
    Isometry3::from_parts(place, UnitQuaternion::from_quaternion(turn))
}

fn numbers(value: &serde_json::Value) -> Vec<f64> {
    let list = value.as_array().expect("a list");
    list.iter().map(|x| x.as_f64().expect("a number")).collect()
}

/// The largest coordinate along a direction of a geom as MuJoCo states it, in its own frame.
fn support(geom: &serde_json::Value, along: &Vector3<f64>) -> f64 {
    let size = numbers(&geom["size"]);
    let points = geom["points"].as_array().expect("points");
    let across = along.x.hypot(along.y);
    match geom["type"].as_i64().expect("a type") {
        1 => {
            let tops = points.iter().map(|p| Vector3::from_vec(numbers(p)));
            let low = |p: &Vector3<f64>| Vector3::new(p.x, p.y, -size[3]);
            let all = tops.flat_map(|p| [p, low(&p)]);
            all.map(|p| p.dot(along)).fold(f64::NEG_INFINITY, f64::max)
        }
        2 => size[0],
        3 => size[0] + size[1] * along.z.abs(),
        4 => Vector3::from_vec(size).component_mul(along).norm(),
        5 => size[0] * across + size[1] * along.z.abs(),
        6 => Vector3::from_vec(size).dot(&along.abs()),
        7 => {
            let all = points.iter().map(|p| Vector3::from_vec(numbers(p)).dot(along));
            all.fold(f64::NEG_INFINITY, f64::max)
        }
        _ => f64::NAN,
    }
}

/// The box of a posed geometry: tight, where that of a mesh is only around its tree.
fn aabb(geometry: &Geometry, pose: &Isometry3<f64>) -> (Point3<f64>, Point3<f64>) {
    let Geometry::Mesh(mesh) = geometry else {
        return geometry.aabb_at(pose, &mut BoxHint::default());
    };
    let empty = (Point3::from([f64::INFINITY; 3]), Point3::from([f64::NEG_INFINITY; 3]));
    let corners = mesh.triangles().flat_map(|(_, corners)| corners).map(|p| pose * p);
    corners.fold(empty, |(low, high), p| (low.inf(&p), high.sup(&p)))
}

/// Compares with the results of `mujoco/poses.py` for the files of `mujoco/models`.
#[test]
fn small_files_are_as_in_mujoco() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/mujoco");
    let expected = format!("{folder}/expected.jsonl");
    assert_eq!(compare(&expected, folder), (5, Vec::new()));
}

/// Compares with the results of `mujoco/poses.py` in the file that the variable `MUJOCO_POSES`
/// names.
#[test]
#[ignore = "needs MuJoCo: see tests/mujoco/poses.py"]
fn files_of_packages_are_as_in_mujoco() {
    let file = std::env::var("MUJOCO_POSES").expect("MUJOCO_POSES names a file");
    let (count, not_loaded) = compare(&file, "");
    println!("{count} models; not supported: {not_loaded:#?}");
    assert!(not_loaded.iter().all(|error| error.contains("is not supported")));
}

/// Returns how many files agree with MuJoCo, and the errors of those that are not loaded here.
fn compare(file: &str, folder: &str) -> (usize, Vec<String>) {
    let (mut same, mut not_loaded) = (0, Vec::new());
    let (mut poses, mut worst, mut replaced, mut pairs) = (0, 0.0_f64, 0, 0);
    for line in std::fs::read_to_string(file).expect("results").lines() {
        let model: serde_json::Value = serde_json::from_str(line).expect("JSON");
        let name = model["file"].as_str().expect("a name");
        let name = std::path::Path::new(folder).join(name).display().to_string();
        let robot = Robot::load(&name, &Packages::default());
        if let Some(error) = model["error"].as_str() {
            let here = robot.map(|r| r.links().len()).map_err(|e| e.to_string());
            println!("MuJoCo does not load {name}: {error}; here: {here:?}");
            continue;
        }
        let robot = match robot {
            Ok(robot) => robot,
            Err(error) => {
                not_loaded.push(error.to_string());
                continue;
            }
        };
        let mut setup = Setup::new();
        setup.robot("", &robot, Isometry3::identity());
        setup.ignore_adjacent();
        let bodies: Vec<&str> = model["bodies"]
            .as_array()
            .expect("bodies")
            .iter()
            .filter_map(|b| b.as_str())
            .collect();
        let geoms = model["geoms"].as_array().expect("geoms");
        // Bodies of links, in the order of the setup, with the geoms of MuJoCo.
        let mut of_link: HashMap<&str, Vec<usize>> = HashMap::new();
        for (k, geom) in geoms.iter().enumerate().filter(|(_, g)| g["collides"] == true) {
            let body = geom["body"].as_u64().expect("an index") as usize;
            of_link.entry(bodies[body]).or_default().push(k);
        }
        let mut order = Vec::new();
        for link in robot.links() {
            let own = of_link.remove(link.name.as_str()).unwrap_or_default();
            assert_eq!(own.len(), link.bodies.len(), "{name}: {}", link.name);
            order.extend(own);
        }
        assert!(of_link.is_empty(), "{name}: {of_link:?}");
        let space = setup.space().expect("a space");
        let shapes: Vec<_> = robot.links().iter().flat_map(|link| &link.bodies).collect();
        let mut turns: Vec<Vec<Isometry3<f64>>> = vec![Vec::new(); order.len()];
        for configuration in model["configurations"].as_array().expect("configurations") {
            let values = configuration["values"].as_object().expect("values");
            let names: Vec<&str> = setup.coordinates().iter().map(|c| c.name.as_str()).collect();
            assert_eq!(
                names.iter().collect::<BTreeSet<_>>(),
                values.keys().map(String::as_str).collect::<Vec<_>>().iter().collect(),
                "{name}"
            );
            let q: Vec<f64> = names.iter().map(|n| values[*n].as_f64().expect("a value")).collect();
            for (k, &geom) in order.iter().enumerate() {
                let found = space.link_pose(&q, space.links()[k]).expect("a pose");
                let geom = &geoms[geom];
                let body = geom["body"].as_u64().expect("an index") as usize;
                let world = pose(&numbers(&configuration["poses"][body]));
                let (kind, expected) = (geom["type"].as_i64(), world * pose(&numbers(&geom["pose"])));
                poses += 1;
                // MuJoCo moves meshes to their centre: their points are compared below.
                let place = if kind == Some(7) {
                    0.0
                } else {
                    (found.translation.vector - expected.translation.vector).amax()
                };
                let turn = if kind == Some(7) {
                    0.0
                } else {
                    found.rotation.angle_to(&expected.rotation)
                };
                let error = place.max(turn);
                assert!(error <= 3e-6, "{name}: {} {error}", geom["name"]);
                // MuJoCo replaces the pose of a geom by that of the inertia where they nearly agree.
                if error > 1e-12 {
                    replaced += 1;
                } else {
                    worst = worst.max(error);
                }
                turns[k].push(found);
                if turns[k].len() == 1 && kind != Some(0) {
                    for angle in 0..7 {
                        let angle = f64::from(angle);
                        let turn = UnitQuaternion::from_euler_angles(angle, -0.7 * angle, 1.1 * angle);
                        let look = Isometry3::from_parts(Translation3::identity(), turn);
                        let aabb = aabb(&shapes[k].geometry, &(look * found));
                        let from = look * expected;
                        let reach = |along: Vector3<f64>| {
                            support(geom, &(from.rotation.inverse() * along)) + along.dot(&from.translation.vector)
                        };
                        let size = (aabb.1 - aabb.0).amax() + from.translation.vector.amax();
                        for axis in 0..3 {
                            let along = Vector3::ith(axis, 1.0);
                            let (low, high) = (-reach(-along), reach(along));
                            let error = (aabb.0[axis] - low).abs().max((aabb.1[axis] - high).abs());
                            assert!(error <= 1e-6 * size, "{name}: {} {error} of {size}", geom["name"]);
                        }
                    }
                }
            }
        }
        let checked: BTreeSet<(usize, usize)> = model["pairs"]
            .as_array()
            .expect("pairs")
            .iter()
            .map(numbers)
            .map(|pair| (pair[0] as usize, pair[1] as usize))
            .collect();
        let checker = setup.checker().expect("a checker");
        let excluded: BTreeSet<(usize, usize)> = checker
            .world()
            .excluded()
            .filter_map(|pair| match pair {
                [WorldId::Robot(a), WorldId::Robot(b)] => Some((a, b)),
                _ => None,
            })
            .collect();
        for a in 0..order.len() {
            for b in a + 1..order.len() {
                let (x, y) = (order[a].min(order[b]), order[a].max(order[b]));
                let relative = |k: usize| turns[a][k].inverse() * turns[b][k];
                let is_rigid = (1..turns[a].len()).all(|k| {
                    let (p, q) = (relative(0), relative(k));
                    (p.translation.vector - q.translation.vector).norm() + p.rotation.angle_to(&q.rotation) < 1e-6
                });
                {
                    let here = !excluded.contains(&(a, b)) && !is_rigid;
                    assert_eq!(here, checked.contains(&(x, y)), "{name}: {} {}", geoms[x], geoms[y]);
                    pairs += 1;
                }
            }
        }
        same += 1;
    }
    println!("{poses} poses, worst {worst:e}, {replaced} that MuJoCo replaced by those of the inertia; {pairs} pairs");
    (same, not_loaded)
}
