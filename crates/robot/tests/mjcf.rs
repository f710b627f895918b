//! MJCF: the rules of MuJoCo in small files, and its own results for files of public packages.

use std::collections::{BTreeSet, HashMap};
use std::ops::ControlFlow;

use lin_canny::Geometry;
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::BoxHint;
use lin_canny_robot::plan::{Cell, CellBody, Checker, RangeOptions};
use lin_canny_robot::{AuditVerdict, Coordinate, LoadOptions, MotionKind, Packages, Robot, audit};

fn parse(text: &str) -> Result<Robot, lin_canny_robot::FileError> {
    Robot::parse(text, "r.xml", &Packages::default(), &LoadOptions::default())
}

/// The rows of a section of the cases.
fn cases<const N: usize>(section: &str) -> Vec<[String; N]> {
    truth::rows::rows(include_str!("mujoco/rows.txt"), section)
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
    assert_eq!(compare(&expected, folder), (18, Vec::new()));
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
    let (mut poses, mut worst, mut replaced, mut pairs, mut limits) = (0, 0.0_f64, 0, 0, 0);
    for line in std::fs::read_to_string(file).expect("results").lines() {
        let model: serde_json::Value = serde_json::from_str(line).expect("JSON");
        if let Some(what) = model["skipped"].as_str() {
            println!("skipped: {what}");
            continue;
        }
        let name = model["file"].as_str().expect("a name");
        let name = std::path::Path::new(folder).join(name).display().to_string();
        let robot = match model["text"].as_str() {
            Some(text) => parse(text),
            None => Robot::load(&name, &Packages::default()),
        };
        if model["text"].is_string() {
            let found = robot.as_ref().map(|robot| robot.links().len());
            assert_eq!(found.is_err(), model["error"].is_string(), "{found:?} {model}");
        }
        if let Some(error) = model["error"].as_str().filter(|_| model["text"].is_null()) {
            let here = robot.map(|r| r.links().len()).map_err(|e| e.to_string());
            println!("MuJoCo does not load {name}: {error}; here: {here:?}");
            continue;
        }
        let robot = match robot {
            Ok(robot) => robot,
            Err(_) if model["error"].is_string() => continue,
            Err(error) => {
                not_loaded.push(error.to_string());
                continue;
            }
        };
        let expected = model["limits"].as_object().expect("limits");
        for (joint, range) in expected {
            let found = robot.coordinates().iter().find(|c| c.name == *joint);
            let found = found.unwrap_or_else(|| panic!("{name}: {joint}")).limits;
            let kind = robot.joints().iter().find(|j| j.name == *joint).map(|j| j.kind);
            let range = match (range.as_array(), kind) {
                (Some(_), _) => numbers(range),
                (None, Some(MotionKind::Revolute)) => LoadOptions::default().continuous_limits.to_vec(),
                (None, _) => LoadOptions::default().floating_limits.to_vec(),
            };
            assert_eq!(found.to_vec(), range, "{name}: {joint}");
            limits += 1;
        }
        let single = robot
            .coordinates()
            .iter()
            .filter(|c| !c.name.contains('/') || expected.contains_key(&c.name));
        assert_eq!(single.count(), expected.len(), "{name}");
        let mut setup = Cell::new();
        setup.add_robot("", &robot, Isometry3::identity()).expect("a robot");
        setup.exclude_adjacent();
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
        let checker = Checker::of_robots(setup.clone()).expect("a checker");
        // A plane is an obstacle.
        let obstacles: Vec<Isometry3<f64>> = checker.cell().obstacles().map(|o| *o.2).collect();
        let (mut of_robot, mut of_obstacles) = (0.., 0..);
        let ids: Vec<CellBody> = (order.iter())
            .map(|&geom| match geoms[geom]["type"].as_i64() {
                Some(0) => of_obstacles.next().map(CellBody::Obstacle).expect("an obstacle"),
                _ => of_robot.next().map(CellBody::Robot).expect("a body"),
            })
            .collect();
        assert_eq!(of_obstacles.next(), Some(obstacles.len()), "{name}");
        let shapes: Vec<_> = robot.links().iter().flat_map(|link| &link.bodies).collect();
        let mut turns: Vec<Vec<Isometry3<f64>>> = vec![Vec::new(); order.len()];
        for configuration in model["configurations"].as_array().expect("configurations") {
            let names: Vec<&str> = setup.coordinates().iter().map(|c| c.name.as_str()).collect();
            // The first configuration is the one that the file draws.
            let mut q = robot.start().to_vec();
            if let Some(values) = configuration["values"].as_object() {
                let expected: BTreeSet<&str> = values.keys().map(String::as_str).collect();
                assert_eq!(names.iter().copied().collect::<BTreeSet<_>>(), expected, "{name}");
                q = names.iter().map(|n| values[*n].as_f64().expect("a value")).collect();
            }
            if model["text"].is_null() {
                check_qpos(
                    &robot,
                    &q,
                    &numbers(&configuration["qpos"]),
                    &numbers(&model["widths"]),
                    &name,
                );
            }
            let is_within = |(q, c): (&f64, &Coordinate)| (c.limits[0]..=c.limits[1]).contains(q);
            if !q.iter().zip(setup.coordinates()).all(is_within) {
                continue;
            }
            for (k, &geom) in order.iter().enumerate() {
                let found = match ids[k] {
                    CellBody::Robot(body) => space.link_pose(&q, space.links()[body]).expect("a pose"),
                    CellBody::Obstacle(obstacle) => obstacles[obstacle],
                    CellBody::Attached(_) => unreachable!("nothing is attached"),
                };
                let geom = &geoms[geom];
                let body = geom["body"].as_u64().expect("an index") as usize;
                let cell = pose(&numbers(&configuration["poses"][body]));
                let (kind, expected) = (geom["type"].as_i64(), cell * pose(&numbers(&geom["pose"])));
                poses += 1;
                // The frame of a height field is at its first corner.
                let corner = match kind {
                    Some(1) => Vector3::new(numbers(&geom["size"])[0], numbers(&geom["size"])[1], 0.0),
                    _ => Vector3::zeros(),
                };
                // MuJoCo moves meshes to their centre: their points are compared below.
                let place = if kind == Some(7) {
                    0.0
                } else {
                    ((found * Point3::from(corner)).coords - expected.translation.vector).amax()
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
        let excluded: BTreeSet<[CellBody; 2]> = checker.cell().excluded().collect();
        for a in 0..order.len() {
            for b in a + 1..order.len() {
                let (x, y) = (order[a].min(order[b]), order[a].max(order[b]));
                let relative = |k: usize| turns[a][k].inverse() * turns[b][k];
                let is_rigid = (1..turns[a].len()).all(|k| {
                    let (p, q) = (relative(0), relative(k));
                    (p.translation.vector - q.translation.vector).norm() + p.rotation.angle_to(&q.rotation) < 1e-6
                });
                let here = !excluded.contains(&[ids[a].min(ids[b]), ids[a].max(ids[b])]) && !is_rigid;
                // Links of a joint that an equality holds are rigid here; an explicit pair of rigid links is listed.
                let is_listed = robot.skipped().iter().any(|s| s.reason.contains("never move relative"));
                let is_listed = is_rigid && (is_listed || model["holds"] == true);
                let there = checked.contains(&(x, y)) && !is_listed;
                assert_eq!(here, there, "{name}: {} {}", geoms[x], geoms[y]);
                pairs += 1;
            }
        }
        same += 1;
    }
    println!(
        "{same} models; {limits} limits; {pairs} pairs; {poses} poses, worst {worst:e}, {replaced} that MuJoCo replaced by those of the inertia"
    );
    (same, not_loaded)
}

/// Compares a configuration with MuJoCo's `qpos`, whose quaternions may have the opposite sign.
/// `widths` are the counts of the values of each joint.
fn check_qpos(robot: &Robot, q: &[f64], expected: &[f64], widths: &[f64], name: &str) {
    let found = robot.qpos_of_configuration(q).expect("values of qpos");
    let again = robot
        .qpos_of_configuration(&robot.configuration_of_qpos(expected).expect("a configuration"))
        .expect("values of qpos");
    assert_eq!(found.len(), expected.len(), "{name}");
    let mut first = 0;
    for width in widths.iter().map(|width| *width as usize) {
        for found in [&found, &again] {
            let [found, expected] = [&found[first..first + width], &expected[first..first + width]];
            // The position of a free joint comes before its quaternion.
            let turn = if width >= 4 { width - 4 } else { width };
            let is_near = |range: std::ops::Range<usize>, sign: f64| {
                range
                    .into_iter()
                    .all(|k| (sign * found[k] - expected[k]).abs() < 1e-12 * (1.0 + expected[k].abs()))
            };
            let is_right = is_near(0..turn, 1.0) && (is_near(turn..width, 1.0) || is_near(turn..width, -1.0));
            assert!(is_right, "{name}: qpos {first}: {found:?} {expected:?}");
        }
        first += width;
    }
}

/// A body with a geom around text.
fn with(inside: &str) -> String {
    format!(
        "<mujoco>\n<worldbody>\n<body name=\"b\">\n<joint name=\"j\"/><geom size=\"1\"/>\n{inside}\n</body>\n</worldbody>\n</mujoco>"
    )
}

#[test]
fn faults_are_named_with_line_and_element() {
    let mut wrong = Vec::new();
    let inside = cases("faults below a body").into_iter();
    let inside = inside.map(|[element, line, words]| [with(&element), line, words]);
    for [text, line, words] in inside.chain(cases("faults of a file")) {
        match parse(&text) {
            Ok(_) => wrong.push(format!("no error: {text}")),
            Err(error) => {
                let is_right = error.to_string().contains(&words) && error.line == line.parse().ok();
                if !is_right || error.reason.to_string().len() > 160 {
                    wrong.push(format!("{error} (expected {words:?} at line {line})"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn geoms_that_exclude_each_other_are_bounded() {
    let balls = |count: usize| {
        let ball = "<body><freejoint/><geom size='1' conaffinity='0'/></body>";
        parse(&format!(
            "<mujoco><worldbody><replicate count='{count}'>{ball}</replicate></worldbody></mujoco>"
        ))
    };
    let robot = balls(1_000).expect("a robot");
    assert_eq!(robot.excluded().len(), 1_000 * 999 / 2);
    let error = balls(1_500).expect_err("too many pairs").to_string();
    assert!(error.contains("too many excluded pairs: 100"), "{error}");
    assert!(error.contains("(expected at most 1000000)"), "{error}");
}

#[test]
fn a_height_field_without_heights_is_a_box() {
    let field = "<asset><hfield name='h' nrow='1000000' ncol='1000000' size='1 2 3 4'/></asset>";
    let geom = "<worldbody><geom type='hfield' hfield='h'/></worldbody>";
    let robot = parse(&format!("<mujoco>{field}{geom}</mujoco>")).expect("a robot");
    let body = &robot.links()[0].bodies[0];
    let Geometry::Mesh(mesh) = &body.geometry else {
        panic!("a mesh");
    };
    // Two above, eight of the walls, and four of the base.
    assert_eq!(mesh.triangle_count(), 14);
    let (centre, radius) = body.geometry.bounding_ball();
    assert!((body.origin * centre - Point3::new(0.0, 0.0, -2.0)).norm() < 0.5 && (2.9..3.5).contains(&radius));
}

/// A hinge with attributes, in a file with a section before the world.
fn hinge(attributes: &str, before: &str) -> Robot {
    let joint = format!("<joint name='j' {attributes}/><geom size='1'/>");
    let text = format!("<mujoco>{before}<worldbody><body name='b'>{joint}</body></worldbody></mujoco>");
    parse(&text).unwrap_or_else(|e| panic!("{text}: {e}"))
}

#[test]
fn a_range_limits_a_joint_where_it_does_in_mujoco() {
    let open = LoadOptions::default().continuous_limits;
    let one = [0.0, 10.0 * (std::f64::consts::PI / 180.0)];
    for [attributes, before, limits] in cases("limits of a hinge") {
        let limits = if limits == "one" { one } else { open };
        let found = hinge(&attributes, &before).coordinates()[0].limits;
        assert_eq!(found, limits, "{attributes} {before}");
    }
}

/// A class has the values that the class above had when it was made.
#[test]
fn a_later_section_of_defaults_leaves_the_classes_of_an_earlier_one() {
    let sections = "<default><joint range='0 1'/><default class='a'/></default><default><joint range='0 2'/><default class='b'/></default>";
    let text = format!(
        "<mujoco><compiler angle='radian'/>{sections}<worldbody><body><joint class='a'/><joint class='b'/><joint/></body></worldbody></mujoco>"
    );
    let robot = parse(&text).expect("a robot");
    let upper: Vec<f64> = robot.coordinates().iter().map(|c| c.limits[1]).collect();
    assert_eq!(upper, [1.0, 2.0, 2.0]);
}

/// MuJoCo takes a range of 0 to 0 for no limit: the arm reaches the post.
#[test]
fn an_audit_does_not_hold_a_joint_without_limits() {
    let post = "<geom type='box' size='.1 .1 .1' pos='0 1 0'/>";
    let arm = "<geom type='capsule' size='.05' fromto='0.3 0 0 1 0 0'/>";
    let followed = "<equality><joint joint1='j' polycoef='0'/></equality>";
    let disabled = |flag: &str| format!("<option><flag {flag}='disable'/></option>");
    for (joint, rest) in [
        ("range='0 0'", String::new()),
        ("range='1 -1'", String::new()),
        ("range='0 10'", disabled("limit")),
        ("", followed.to_owned() + &disabled("equality")),
        ("", followed.to_owned() + &disabled("constraint")),
    ] {
        let text = format!(
            "<mujoco><worldbody>{post}<body name='arm'><joint name='j' {joint}/>{arm}</body></worldbody>{rest}</mujoco>"
        );
        let robot = parse(&text).unwrap_or_else(|e| panic!("{text}: {e}"));
        let mut setup = Cell::new();
        setup.add_robot("", &robot, Isometry3::identity()).expect("a robot");
        let mut checker = Checker::of_robots(setup.clone()).expect("a checker");
        let found = audit(&mut checker, &RangeOptions::default(), &[], &mut |_| {
            ControlFlow::Continue(())
        });
        let verdicts: Vec<AuditVerdict> = found.expect("an audit").iter().map(|one| one.verdict).collect();
        assert_eq!(verdicts, [AuditVerdict::Both], "{text}");
    }
}

#[test]
fn a_free_joint_takes_nothing_but_its_name() {
    let class = "<default><joint limited='true' range='1 -1' pos='1 0 0' ref='3' axis='0 0 0'/></default>";
    let text = |joint: &str| {
        format!(
            "<mujoco>{class}<worldbody><body name='b' pos='0 2 0'>{joint}<geom size='1'/></body></worldbody></mujoco>"
        )
    };
    let plain = parse(&text("<freejoint name='j'/>")).expect("a robot");
    for joint in [
        "<joint name='j' type='free'/>",
        "<joint name='j' type='free' limited='auto' range='0 1' axis='1 0 0'/>",
    ] {
        let robot = parse(&text(joint)).unwrap_or_else(|e| panic!("{joint}: {e}"));
        assert_eq!(robot.coordinates(), plain.coordinates(), "{joint}");
        assert_eq!(robot.start(), plain.start(), "{joint}");
        assert_eq!(robot.links().len(), plain.links().len(), "{joint}");
    }
    assert_eq!(plain.start(), [0.0, 2.0, 0.0, 0.0, 0.0, 0.0]);
}

#[test]
fn a_mocap_body_moves_if_it_collides() {
    let marker = "<body name='marker' mocap='true'><geom size='1' contype='0' conaffinity='0'/></body>";
    let below = "<body name='finger'><joint name='f'/><geom size='1'/></body>";
    let hand = format!("<body name='hand' mocap='true' pos='1 2 3'>{below}</body>");
    let robot = parse(&format!("<mujoco><worldbody>{marker}{hand}</worldbody></mujoco>")).expect("a robot");
    let names: Vec<&str> = robot.coordinates().iter().map(|c| c.name.as_str()).collect();
    let of_hand = ["x", "y", "z", "roll", "pitch", "yaw"].map(|part| format!("hand:mocap/{part}"));
    let expected = of_hand.iter().map(String::as_str).chain(["f"]).collect::<Vec<_>>();
    assert_eq!(names, expected);
    assert_eq!(robot.start(), [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.0]);
    // As in MuJoCo, two bodies that no joint moves are not checked: no force can act.
    let boxes =
        "<body name='a' mocap='true'><geom size='1'/></body><body name='b' mocap='true'><geom size='1'/></body>";
    let free = "<body name='c'><freejoint/><geom size='1'/></body>";
    let robot = parse(&format!(
        "<mujoco><worldbody><geom size='1'/>{boxes}{free}</worldbody></mujoco>"
    ));
    let excluded = robot.expect("a robot").excluded();
    assert_eq!(excluded, [[(0, 0), (1, 0)], [(0, 0), (2, 0)], [(1, 0), (2, 0)]]);
}

#[test]
fn contacts_that_a_flag_switches_off_are_checked_and_listed() {
    for flag in ["contact", "constraint"] {
        let robot = hinge("", &format!("<option>\n<flag {flag}='disable'/></option>"));
        let skipped: Vec<String> = robot.skipped().iter().map(ToString::to_string).collect();
        let expected = [format!(
            "r.xml:2: option flag: {flag}=\"disable\" is passed over: pairs are checked"
        )];
        assert_eq!(skipped, expected);
    }
    assert!(
        hinge("", "<option><flag limit='disable' multiccd='disable'/></option>")
            .skipped()
            .is_empty()
    );
}

#[test]
fn what_is_left_out_is_listed_with_its_line() {
    let text = with("text").replace(
        "</mujoco>",
        "<equality>\n<weld body1=\"b\"/>\n<joint joint1=\"j\"/></equality></mujoco>",
    );
    let robot = parse(&text).expect("a robot");
    let skipped: Vec<String> = robot.skipped().iter().map(ToString::to_string).collect();
    assert_eq!(skipped.len(), 2, "{skipped:?}");
    assert!(
        skipped[0].contains("text between elements")
            && skipped[1].contains("r.xml:9: equality weld: the equality weld"),
        "{skipped:?}"
    );
    // An equality that is not in force is none.
    for (from, to) in [
        ("b\"/>", "b\" active=\"false\"/>"),
        ("<equality>", "<option><flag equality=\"disable\"/></option><equality>"),
    ] {
        let found = parse(&text.replace(from, to)).expect("a robot").skipped().len();
        assert_eq!(found, 1, "{to}");
    }
    // Without a second joint, the joint is held.
    assert!(robot.coordinates().is_empty());
    assert_eq!(robot.joints()[0].kind, MotionKind::Fixed);
}

/// MuJoCo reads its files by tinyxml, and passes over what is no element of it.
#[test]
fn what_tinyxml_takes_is_listed() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let part = "<mujocoinclude><!-- --- -->\n<geom size=\".1\"/>\n<y:geom/></mujocoinclude>";
    std::fs::write(folder.join("tinyxml_part.xml"), part).expect("a file");
    let text = "\n<?xml version=\"1.0\"?>\n<mujoco><!-- ---- -->\n<worldbody><![CDATA[x]]>\n<include file=\"tinyxml_part.xml\"/>\n\
                <y:geom a=\"1\"/></worldbody></mujoco>";
    let robot = Robot::parse(
        text,
        folder.join("r.xml"),
        &Packages::default(),
        &LoadOptions::default(),
    )
    .expect("a robot");
    assert_eq!(robot.links()[0].bodies.len(), 1);
    let skipped: Vec<_> = robot
        .skipped()
        .iter()
        .map(|s| (s.line.expect("a line"), s.reason.as_str()))
        .collect();
    let expected = [
        (2, "XML declaration"),
        (3, "comment"),
        (4, "text between"),
        (6, "undeclared"),
        (3, "element geom of"),
        (1, "comment"),
        (3, "undeclared"),
        (6, "element geom of"),
    ];
    assert_eq!(skipped.len(), expected.len(), "{skipped:?}");
    for (skipped, (line, words)) in skipped.iter().zip(expected) {
        assert!(skipped.0 == line, "{skipped:?}, expected {line} {words}");
        assert!(skipped.1.contains(words), "{skipped:?}, expected {line} {words}");
    }
}

#[test]
fn limits_that_the_file_does_not_state_contain_where_it_draws() {
    let text = "<mujoco><worldbody><body pos=\"0 -12 11\"><freejoint name=\"f\"/><geom size=\".1\"/></body>\
                <body><joint name=\"s\" type=\"slide\" ref=\"20\"/><joint name=\"t\" type=\"slide\" ref=\"20\" range=\"1 2\" limited=\"true\"/>\
                <geom size=\".1\"/></body></worldbody></mujoco>";
    let robot = parse(text).expect("a robot");
    let limits = |k: usize| robot.coordinates()[k].limits;
    assert_eq!(
        [limits(0), limits(1), limits(2)],
        [[-10.0, 10.0], [-12.0, 10.0], [-10.0, 11.0]]
    );
    assert_eq!([limits(6), limits(7)], [[-10.0, 20.0], [1.0, 2.0]]);
    assert_eq!(robot.start()[..3], [0.0, -12.0, 11.0]);
}

#[test]
fn names_that_the_file_leaves_out_are_numbers() {
    let text = "<mujoco><worldbody><body><joint/><geom size=\"1\"/><body name=\"x\"><joint type=\"slide\"/></body></body></worldbody></mujoco>";
    let robot = parse(text).expect("a robot");
    let links: Vec<&str> = robot.links().iter().map(|link| link.name.as_str()).collect();
    assert_eq!(links, ["world", "body1", "x"]);
    let names: Vec<&str> = robot.coordinates().iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["joint0", "joint1"]);
    let options = LoadOptions::default();
    assert_eq!(robot.coordinates()[0].limits, options.continuous_limits);
    assert_eq!(robot.coordinates()[1].limits, options.floating_limits);
}
