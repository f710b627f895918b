//! Robots in a cell: places, proofs, pairs to ignore.

use std::path::{Path, PathBuf};

use lin_canny::nalgebra::{Isometry3, UnitQuaternion, Vector3};
use lin_canny::{PairTracker, Progress, RelativePose};
use lin_canny_plan::{
    Cell, Checker, ConfigurationSpace, Joint, JointKind, JointMotion, JointTree, SegmentMotion, Verdict,
};
use lin_canny_robot::{
    CellFile, ExcludeReason, LoadOptions, MeshUse, MotionKind, Packages, Robot, Srdf, find_excluded,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use truth::errors::says;
use truth::plans::{Ask, Furnish};

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")
}

fn gripper(usage: MeshUse) -> Robot {
    let options = LoadOptions::default().meshes(usage);
    Robot::load_with(examples().join("gripper.urdf"), &Packages::default(), &options).expect("the example")
}

fn setup(robot: &Robot) -> Cell {
    let mut setup = Cell::new();
    setup.add_robot("", robot, Isometry3::identity()).expect("a robot");
    setup.exclude_adjacent();
    Srdf::load(examples().join("gripper.srdf"), robot)
        .expect("the example")
        .exclude_in(&mut setup, "")
        .expect("links");
    let cell = CellFile::load(
        examples().join("cell.json"),
        &Packages::default(),
        &LoadOptions::default(),
    );
    cell.expect("the example").add_to(&mut setup).expect("a cell");
    setup
}

fn sample<C: ConfigurationSpace>(space: &C, random: &mut ChaCha8Rng) -> Vec<f64> {
    space.sample(&mut || random.random::<f64>())
}

/// Poses of all links by products of matrices along the tree.
fn places(robot: &Robot, base: &Isometry3<f64>, q: &[f64]) -> Vec<Isometry3<f64>> {
    let mut poses = vec![*base];
    for joint in robot.joints() {
        let drive = joint.drive;
        let value = drive.map_or(0.0, |d| d.factor * q[d.coordinate] + d.offset);
        let first = drive.map_or(0, |d| d.coordinate);
        let turn = |axis: Vector3<f64>, angle: f64| {
            Isometry3::from_parts(Default::default(), UnitQuaternion::from_scaled_axis(axis * angle))
        };
        let moved = match joint.kind {
            MotionKind::Fixed => Isometry3::identity(),
            MotionKind::Revolute => turn(joint.axis.into_inner(), value),
            MotionKind::Prismatic => shift(joint.axis.into_inner() * value),
            MotionKind::Planar => shift(Vector3::new(q[first], q[first + 1], 0.0)) * turn(Vector3::z(), q[first + 2]),
            MotionKind::Floating => {
                let angles = UnitQuaternion::from_euler_angles(q[first + 3], q[first + 4], q[first + 5]);
                Isometry3::from_parts(Vector3::new(q[first], q[first + 1], q[first + 2]).into(), angles)
            }
            kind => panic!("no reference for {kind:?}"),
        };
        poses.push(poses[joint.parent] * joint.origin * moved);
    }
    poses
}

fn shift(by: Vector3<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(by.into(), UnitQuaternion::identity())
}

fn off(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    (a.to_homogeneous() - b.to_homogeneous()).norm()
}

#[test]
fn bodies_stand_where_the_joints_put_them() {
    let text = r#"<robot name="all"><link name="root"/><link name="a"/><link name="b"/>
  <link name="c"><collision><origin xyz="1 2 3" rpy="0.1 0.2 0.3"/><geometry><sphere radius="1"/></geometry></collision>
    <collision><geometry><box size="1 2 3"/></geometry></collision></link>
  <link name="d"><collision><geometry><box size="1 2 3"/></geometry></collision></link>
  <joint name="f" type="floating"><parent link="root"/><child link="a"/><origin xyz="1 0 0" rpy="0.4 0 1"/></joint>
  <joint name="p" type="planar"><parent link="a"/><child link="b"/><axis xyz="0 0 2"/></joint>
  <joint name="t" type="continuous"><parent link="b"/><child link="c"/><axis xyz="1 1 0"/></joint>
  <joint name="x" type="fixed"><parent link="c"/><child link="d"/><origin xyz="0 1 0"/></joint></robot>"#;
    let robot = Robot::parse(text, "all.urdf", &Packages::default(), &LoadOptions::default()).expect("a robot");
    let base = Isometry3::from_parts(
        Vector3::new(0.5, 0.25, 0.0).into(),
        UnitQuaternion::from_euler_angles(0.0, 1.0, 0.0),
    );
    let mut setup = Cell::new();
    setup.add_robot("", &robot, base).expect("a robot");
    let space = setup.space().expect("a space");
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut poses = vec![];
    for _ in 0..200 {
        let q = sample(&space, &mut random);
        space.place(&q, &mut poses);
        let links = places(&robot, &base, &q);
        let mut expected = vec![];
        for (link, pose) in robot.links().iter().zip(&links) {
            expected.extend(link.bodies.iter().map(|body| pose * body.origin));
        }
        // Frames of links that are not those of a body come last.
        assert!(poses.len() >= expected.len());
        for (pose, expected) in poses.iter().zip(&expected) {
            assert!(off(pose, expected) < 1e-12, "{:e}", off(pose, expected));
        }
    }
    // A fixed joint and bodies of one link keep their relative pose.
    assert!(space.is_rigid(0, 1) && space.is_rigid(0, 2));
}

/// Without the fingers the example is a chain: the same places and the same proofs as of an arm.
#[test]
fn a_chain_is_a_serial_arm() {
    let robot = gripper(MeshUse::Hull);
    let chain = |k: &usize| robot.joints()[*k].child <= 6;
    let joints = (0..robot.joints().len()).filter(chain).map(|k| {
        let joint = &robot.joints()[k];
        assert_eq!(joint.parent, k);
        let kind = if joint.kind == MotionKind::Prismatic {
            JointKind::Prismatic
        } else {
            JointKind::Revolute
        };
        let mut arm = Joint::revolute(joint.origin, joint.axis, joint.limits);
        arm.kind = kind;
        arm
    });
    let arm = JointTree::serial(Isometry3::identity(), joints.collect(), (0..7).collect(), 0.1).expect("an arm");
    let setup = setup(&robot);
    let space = setup.space().expect("a space");
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let [mut ours, mut theirs] = [vec![], vec![]];
    for _ in 0..1000 {
        let (from, to) = (sample(&space, &mut random), sample(&space, &mut random));
        space.place(&from, &mut ours);
        arm.place(&from[..6], &mut theirs);
        let segment = space.segment(&from, &to).expect("a segment");
        let chain = arm.segment(&from[..6], &to[..6]).expect("a segment");
        let t = random.random::<f64>();
        for (link, place) in theirs.iter().enumerate() {
            let body = robot.links()[..link].iter().map(|l| l.bodies.len()).sum::<usize>();
            let own = robot.links()[link].bodies[0].origin;
            assert!(off(&ours[body], &(place * own)) < 1e-12);
            let pose = chain.pose(link, t) * own;
            assert!(off(&segment.pose(body, t), &pose) < 1e-12);
            let (x, y) = (segment.model(body, t, 1.0), chain.model(link, t, 1.0));
            assert!((x.angular - y.angular).norm() < 1e-12 && (x.turn.at(1.0) - y.turn.at(1.0)).abs() < 1e-9);
        }
    }
}

/// Proven segments by an independent judge: places by matrices, pairs by overlap at 200 times each.
#[test]
fn certified_segments_are_judged_right() {
    let robot = gripper(MeshUse::Mesh);
    let setup = setup(&robot);
    let mut checker = Checker::of_robots(setup.clone()).expect("a checker");
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let (mut free, mut blocked) = (0, 0);
    for _ in 0..1000 {
        let from = sample(checker.space(), &mut random);
        let to: Vec<f64> = sample(checker.space(), &mut random)
            .iter()
            .zip(&from)
            .map(|(x, y)| 0.7 * y + 0.3 * x)
            .collect();
        let verdict = checker.verdict_of(&JointMotion::segment(&from, &to));
        let meets = |t: f64, judge: &mut Judge| {
            let q: Vec<f64> = from.iter().zip(&to).map(|(x, y)| x + (y - x) * t).collect();
            judge.meets(&robot, &q)
        };
        let mut judge = Judge::new(&robot);
        match verdict {
            Verdict::Free { .. } => {
                free += 1;
                assert!(
                    (0..=200).all(|k| !meets(f64::from(k) / 200.0, &mut judge)),
                    "{from:?} {to:?}"
                );
            }
            Verdict::Blocked {
                free_until: safe,
                contact_at: t,
                ..
            } => {
                blocked += 1;
                let before = (0..50).all(|k| !meets(safe * f64::from(k) / 50.0, &mut judge));
                assert!((before || safe == 0.0) && t >= safe, "{from:?} {to:?} {verdict:?}");
                assert!(
                    meets((t + 1e-4).min(1.0), &mut judge) || meets(t, &mut judge),
                    "{verdict:?}"
                );
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(free > 200 && blocked > 200, "{free} free, {blocked} blocked");
}

/// A geometry, the link that moves it, and its pose there or in the world.
type Judged = (lin_canny::Geometry, Option<usize>, Isometry3<f64>);

/// All pairs, by overlap.
struct Judge {
    pairs: Vec<([usize; 2], PairTracker)>,
    shapes: Vec<Judged>,
}

impl Judge {
    fn new(robot: &Robot) -> Self {
        let (mut shapes, mut names) = (vec![], vec![]);
        for (k, link) in robot.links().iter().enumerate() {
            for body in &link.bodies {
                shapes.push((body.geometry.clone(), Some(k), body.origin));
                names.push(link.name.clone());
            }
        }
        let cell = CellFile::load(
            examples().join("cell.json"),
            &Packages::default(),
            &LoadOptions::default(),
        );
        for obstacle in cell.expect("the example").obstacles {
            shapes.push((obstacle.geometry, None, obstacle.pose));
            names.push(obstacle.name);
        }
        let srdf = Srdf::load(examples().join("gripper.srdf"), robot).expect("the example");
        let mut ignored: Vec<[String; 2]> = srdf.excluded.into_iter().map(|p| p.links).collect();
        ignored.push(["base".into(), "table".into()]);
        ignored.extend(
            robot
                .adjacent()
                .iter()
                .map(|p| p.map(|k| robot.links()[k].name.clone())),
        );
        let is_ignored = |a: &String, b: &String| {
            let same = |p: &[String; 2]| (&p[0], &p[1]) == (a, b) || (&p[1], &p[0]) == (a, b);
            a == b || ignored.iter().any(same)
        };
        let mut pairs = vec![];
        for b in 0..shapes.len() {
            for a in (0..b).filter(|&a| shapes[a].1.is_some() && !is_ignored(&names[a], &names[b])) {
                pairs.push(([a, b], PairTracker::new()));
            }
        }
        Self { pairs, shapes }
    }

    fn meets(&mut self, robot: &Robot, q: &[f64]) -> bool {
        let links = places(robot, &Isometry3::identity(), q);
        let at = |k: usize| match self.shapes[k] {
            (_, Some(link), origin) => links[link] * origin,
            (_, None, pose) => pose,
        };
        self.pairs.iter_mut().any(|([a, b], tracker)| {
            let pose = RelativePose::new(
                &lin_canny::normalize_rotation(&at(*a)),
                &lin_canny::normalize_rotation(&at(*b)),
            )
            .expect("poses");
            tracker.intersects(&self.shapes[*a].0, &self.shapes[*b].0, &pose)
        })
    }
}

#[test]
fn two_robots_stand_in_one_cell() {
    let robot = gripper(MeshUse::Hull);
    let mut setup = Cell::new();
    for (prefix, x) in [("left/", 0.0), ("right/", 1.0)] {
        setup
            .add_robot(prefix, &robot, Isometry3::translation(x, 0.0, 0.0))
            .expect("a robot");
    }
    setup.exclude_adjacent();
    let names: Vec<&str> = setup.coordinates().iter().map(|c| c.name.as_str()).collect();
    assert_eq!((names.len(), names[0], names[13]), (14, "left/turn", "right/left"));
    let mut checker = Checker::of_robots(setup.clone()).expect("a checker");
    let mut q = vec![0.0; 14];
    (q[1], q[8]) = (1.5, -1.5);
    let near = checker.clearance(&q).expect("a configuration").expect("a pair");
    let names = [near.pair.a, near.pair.b].map(|part| checker.name(part).to_owned());
    assert!(near.distance <= 0.0, "{names:?}");
    assert!(names[0].starts_with("left/"), "{names:?}");
    assert!(names[1].starts_with("right/"), "{names:?}");
    says(setup.exclude("left/base", "nothing"), "nothing");
}

#[test]
fn excluded_pairs_are_counted_and_written() {
    let text = r#"<robot name="r &amp; d"><link name="a"><collision><geometry><sphere radius="1"/></geometry></collision></link>
  <link name="b"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <link name="c"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <link name="far"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <link name="over"><collision><geometry><sphere radius="0.5"/></geometry></collision></link>
  <joint name="j" type="prismatic"><parent link="a"/><child link="b"/><limit lower="0" upper="2.2" velocity="1"/></joint>
  <joint name="k" type="continuous"><parent link="b"/><child link="c"/><origin xyz="0.1 0 0"/></joint>
  <joint name="l" type="continuous"><parent link="c"/><child link="far"/><origin xyz="9 0 0"/></joint>
  <joint name="m" type="continuous"><parent link="c"/><child link="over"/></joint></robot>"#;
    let robot = Robot::parse(text, "r.urdf", &Packages::default(), &LoadOptions::default()).expect("a robot");
    let mut setup = Cell::new();
    setup.add_robot("", &robot, Isometry3::identity()).expect("a robot");
    let mut calls = 0;
    let counts = find_excluded(&setup, 2000, 7, &mut |progress| {
        calls += 1;
        Progress::stop_if(progress.done != calls)
    });
    let counts = counts.expect("counts");
    assert_eq!(calls, 2000);
    let of = |a: &str, b: &str| {
        let pair = counts
            .iter()
            .find(|p| p.links.contains(&a.to_owned()) && p.links.contains(&b.to_owned()));
        let pair = pair.expect("a pair");
        (pair.overlaps, pair.reason)
    };
    assert_eq!(of("a", "b").1, Some(ExcludeReason::Adjacent));
    assert_eq!(of("a", "far"), (0, Some(ExcludeReason::Never)));
    assert_eq!(of("b", "over"), (2000, Some(ExcludeReason::Always)));
    // Touches from 0.8 to 1.2 of the slide behind, at 1.0 of 2.2 on average.
    let (overlaps, reason) = of("a", "c");
    assert!(reason.is_none(), "{overlaps}");
    assert!((overlaps as f64 / 2000.0 - 1.0 / 2.2).abs() < 0.05, "{overlaps}");
    let few = find_excluded(&setup, 2000, 7, &mut |progress| Progress::stop_if(progress.done >= 10)).expect("counts");
    assert!(few.iter().all(|pair| pair.samples == 10));
    let srdf = Srdf::from_counts(&counts);
    let again = Srdf::parse(&srdf.text(robot.name()), "r.srdf", &robot).expect("our own text");
    assert_eq!(srdf, again);
    assert!(
        again
            .excluded
            .iter()
            .all(|p| ["Adjacent", "Never", "Always"].contains(&p.reason.as_str()))
    );
}

/// The square of a long quaternion overflows.
#[test]
fn obstacles_turn_by_quaternions_of_every_length() {
    let cell = |xyzw: &str| {
        let text = format!("{{\"bodies\": [{{\"name\": \"x\", \"sphere\": {{\"radius\": 1}}, \"xyzw\": {xyzw}}}]}}");
        CellFile::parse(&text, "cell.json", &Packages::default(), &LoadOptions::default())
    };
    for xyzw in ["[0, 0, 1, 1]", "[0, 0, 1e-300, 1e-300]", "[0, 0, 1e200, 1e200]"] {
        let turn = cell(xyzw).expect(xyzw).obstacles[0].pose.rotation;
        assert!((turn.angle() - std::f64::consts::FRAC_PI_2).abs() < 1e-15, "{xyzw}");
    }
    let error = cell("[0, 0, 0, 0]").expect_err("no rotation").to_string();
    assert!(error.contains("bodies[0]"), "{error}");
    assert!(error.contains("length of xyzw"), "{error}");
}

/// Points, segments and rectangles take part in clearances and proofs as other bodies do.
#[test]
fn links_without_size_are_checked() {
    let shapes = [
        "<sphere radius=\"0\"/>",
        "<box size=\"0 0 0\"/>",
        "<box size=\"0 0 1\"/>",
        "<box size=\"1 0 1\"/>",
        "<cylinder radius=\"0\" length=\"1\"/>",
    ];
    for (k, shape) in shapes.into_iter().enumerate() {
        let text = format!(
            "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"><collision><geometry>{shape}</geometry></collision></link>
  <joint name=\"j\" type=\"prismatic\"><parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 1 0\"/>
  <limit lower=\"-9\" upper=\"9\"/></joint></robot>"
        );
        let robot = Robot::parse(&text, "r.urdf", &Packages::default(), &LoadOptions::default()).expect("a robot");
        let mut setup = Cell::new();
        setup.add_robot("", &robot, Isometry3::identity()).expect("a robot");
        setup.put(
            "ball",
            lin_canny::Shape::ball(1.0).expect("a ball"),
            Isometry3::identity(),
        );
        let mut checker = Checker::of_robots(setup.clone()).expect("a checker");
        let near = checker.clearance(&[3.0]).expect("a configuration").expect("a pair");
        assert!((near.distance - 2.0).abs() < 1e-12, "{k}: {near:?}");
        assert!(near.lower <= 2.0, "{k}: {near:?}");
        assert!(near.upper >= 2.0, "{k}: {near:?}");
        let verdict = checker.verdict_of(&JointMotion::segment(&[3.0], &[1.5]));
        assert!(matches!(verdict, Verdict::Free { .. }), "{k}: {verdict:?}");
        let verdict = checker.verdict_of(&JointMotion::segment(&[3.0], &[-3.0]));
        assert!(matches!(verdict, Verdict::Blocked { .. }), "{k}: {verdict:?}");
    }
}

/// A robot of links `base`, `arm`, `hand` and `tool` in a chain, each a ball, and its SRDF.
fn srdf(elements: &str) -> Result<(Robot, Srdf), lin_canny_robot::FileError> {
    let names = ["base", "arm", "hand", "tool"];
    let ball = "<collision><geometry><sphere radius=\"1\"/></geometry></collision>";
    let links = names
        .map(|name| format!("<link name=\"{name}\">{ball}</link>"))
        .concat();
    let joint = |pair: &[&str]| {
        let ends = format!("<parent link=\"{}\"/><child link=\"{}\"/>", pair[0], pair[1]);
        format!("<joint name=\"{}\" type=\"continuous\">{ends}</joint>", pair[1])
    };
    let joints: String = names.windows(2).map(joint).collect();
    let text = format!("<robot name=\"r\">{links}{joints}</robot>");
    let robot = Robot::parse(&text, "r.urdf", &Packages::default(), &LoadOptions::default())?;
    let srdf = Srdf::parse(&format!("<robot name=\"r\">\n{elements}\n</robot>"), "r.srdf", &robot)?;
    Ok((robot, srdf))
}

/// Returns the pairs that an SRDF excludes.
fn pairs(srdf: &Srdf) -> Vec<[&str; 2]> {
    let mut pairs: Vec<[&str; 2]> = srdf
        .excluded
        .iter()
        .map(|pair| pair.links.each_ref().map(|n| &**n))
        .collect();
    pairs.sort_unstable();
    pairs
}

#[test]
fn an_srdf_of_a_larger_robot_is_read_with_its_gaps() {
    let good = "<disable_collisions link1=\"base\" link2=\"hand\" reason=\"Never\"/>";
    for (kind, fields) in [
        ("disable_collisions", &["link1", "link2"][..]),
        ("enable_collisions", &["link1", "link2"]),
        ("disable_default_collisions", &["link"]),
    ] {
        for gone in fields {
            let attribute = |field: &&str| {
                let name = if field == gone { "tol" } else { "arm" };
                format!(" {field}=\"{name}\"")
            };
            let attributes: String = fields.iter().map(attribute).collect();
            let element = format!("<{kind}{attributes}/>");
            for (text, line) in [(format!("{element}\n{good}"), 2), (format!("{good}\n{element}"), 3)] {
                let (_, srdf) = srdf(&text).expect(&text);
                assert_eq!(pairs(&srdf), [["base", "hand"]]);
                let [skipped] = &srdf.skipped[..] else {
                    panic!("{:?}", srdf.skipped)
                };
                assert_eq!(
                    skipped.to_string(),
                    format!("r.srdf:{line}: {kind}: link \"tol\" does not exist; did you mean \"tool\"?")
                );
                assert_eq!(skipped.line, Some(line));
            }
        }
    }
    let (_, both) = srdf("<disable_collisions link1=\"x\" link2=\"y\"/>").expect("an SRDF");
    assert_eq!((both.skipped.len(), both.excluded.len()), (2, 0));
}

/// A link has no pair with itself: the element is listed, and the rest is read.
#[test]
fn a_pair_of_a_link_with_itself_is_skipped() {
    for kind in ["disable_collisions", "enable_collisions"] {
        let text = format!("<{kind} link1=\"arm\" link2=\"arm\"/>");
        let (robot, srdf) = srdf(&text).expect("an SRDF");
        let [skipped] = &srdf.skipped[..] else {
            panic!("{:?}", srdf.skipped)
        };
        let words = format!("r.srdf:2: {kind}: link \"arm\" has no pair with itself (expected two links)");
        assert_eq!(skipped.to_string(), words);
        let mut setup = Cell::new();
        setup.add_robot("", &robot, Isometry3::identity()).expect("a robot");
        srdf.exclude_in(&mut setup, "").expect("links");
        assert_eq!(setup.excluded().len(), 0);
    }
}

/// A group with a link that does not exist changes no pair.
#[test]
fn what_is_skipped_in_groups_is_not_of_the_setup() {
    let text = "<group name=\"g\"><link name=\"x\"/></group>
        <group_state name=\"s\" group=\"x\"><joint name=\"x\" value=\"1\"/></group_state>
        <virtual_joint name=\"v\" type=\"fixed\" parent_frame=\"w\" child_link=\"x\"/>
        <disable_collisions link1=\"base\" link2=\"x\"/>";
    let (robot, srdf) = srdf(text).expect("an SRDF");
    assert_eq!(srdf.skipped.len(), 5);
    let mut setup = Cell::new();
    setup.add_robot("", &robot, Isometry3::identity()).expect("a robot");
    srdf.exclude_in(&mut setup, "").expect("links");
    assert!(srdf.skipped_pairs().eq(&srdf.skipped[4..]));
}

#[test]
fn blanks_around_the_names_of_an_srdf_do_not_count() {
    let (_, srdf) = srdf("<disable_collisions link1=\" base \" link2=\"hand\n\"/>").expect("an SRDF");
    assert_eq!((pairs(&srdf), srdf.skipped.len()), (vec![["base", "hand"]], 0));
}

#[test]
fn links_without_default_collisions_are_checked_only_where_enabled() {
    let alone = "<disable_default_collisions link=\"hand\"/>";
    let (_, all) = srdf(alone).expect("an SRDF");
    assert_eq!(pairs(&all), [["hand", "arm"], ["hand", "base"], ["hand", "tool"]]);
    let enable = "<enable_collisions link1=\"base\" link2=\"hand\"/>";
    for text in [format!("{alone}{enable}"), format!("{enable}{alone}{alone}")] {
        let (_, srdf) = srdf(&text).expect("an SRDF");
        assert_eq!(pairs(&srdf), [["hand", "arm"], ["hand", "tool"]]);
        assert_eq!(srdf.included, [["base", "hand"]]);
    }
    // What is disabled itself stays so.
    let disable = "<disable_collisions link1=\"hand\" link2=\"base\"/>";
    for text in [format!("{disable}{enable}"), format!("{enable}{disable}{alone}")] {
        let (_, srdf) = srdf(&text).expect("an SRDF");
        assert!(pairs(&srdf).contains(&["hand", "base"]) && srdf.included.is_empty());
    }
    // Adjacent links are checked if their pair is enabled.
    let overlaps = |text: &str| {
        let (robot, srdf) = srdf(text).expect("an SRDF");
        let mut setup = Cell::new();
        setup.add_robot("r/", &robot, Isometry3::identity()).expect("a robot");
        setup.exclude_adjacent();
        srdf.exclude_in(&mut setup, "r/").expect("links");
        assert!(srdf.skipped_pairs().eq(&srdf.skipped));
        let mut checker = Checker::of_robots(setup.clone()).expect("a checker");
        checker.clearance(&[0.0; 3]).expect("a configuration").is_some()
    };
    let rest = "<disable_default_collisions link=\"base\"/><disable_collisions link1=\"arm\" link2=\"tool\"/>";
    assert!(!overlaps(rest));
    assert!(overlaps(&format!(
        "{rest}<enable_collisions link1=\"hand\" link2=\"tool\"/>"
    )));
    assert!(overlaps(&format!(
        "{rest}<enable_collisions link1=\"tool\" link2=\"hand\"/>"
    )));
}

#[test]
fn unknown_elements_of_an_srdf_are_errors_with_their_line() {
    let good = "<disable_collisions link1=\"base\" link2=\"hand\"/>\n<group name=\"g\"/>";
    let passed = "<end_effector/><passive_joint><cone/></passive_joint><x:y xmlns:x=\"urn:x\"/><!-- c -->";
    let found = srdf(&format!("{passed}{good}{passed}"))
        .expect("an SRDF")
        .1
        .excluded
        .len();
    assert_eq!(found, 1);
    for [wrong, words] in truth::rows::rows(include_str!("setup/rows.txt"), "faults of an SRDF") {
        for (text, line) in [(format!("{wrong}{good}"), 2), (format!("{good}\n{wrong}"), 4)] {
            let error = says(srdf(&text), &words);
            assert_eq!(error.line, Some(line), "{error}");
        }
    }
}

#[test]
fn objects_are_attached_to_links_whose_bodies_have_other_frames() {
    let robot = gripper(MeshUse::Hull);
    let setup = setup(&robot);
    let mut checker = Checker::of_robots(setup.clone()).expect("a setup");
    assert_eq!(setup.space().expect("a space").bodies(), checker.space().bodies());
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let grip = Isometry3::translation(0.0, 0.0, 0.12);
    let fingers = ["left finger", "right finger"];
    let part = lin_canny::Shape::ball(0.02).expect("a ball");
    let id = checker.cell_mut().carry("gripper", "part", part, grip, &fingers);
    for _ in 0..20 {
        let q = sample(checker.space(), &mut random);
        let link = places(&robot, &Isometry3::identity(), &q)[robot.link("gripper").expect("a link")];
        let at = checker.pose(id, &q).expect("a pose");
        assert!(((link * grip).inverse() * at).translation.vector.norm() < 1e-12);
        let all = checker.nearest(&q, f64::INFINITY).expect("a configuration");
        let partners = all.iter().filter(|near| near.pair.a == id || near.pair.b == id);
        let mut names: Vec<&str> = partners
            .flat_map(|n| [checker.name(n.pair.a), checker.name(n.pair.b)])
            .collect();
        names.retain(|name| fingers.contains(name) || *name == "gripper");
        assert_eq!(names, [""; 0]);
    }
    let error = checker.cell_mut().attach(
        "griper",
        "part",
        lin_canny::Shape::ball(0.1).expect("a ball"),
        grip,
        &[],
    );
    says(error, "gripper");
}

#[test]
fn excluded_pairs_are_written_as_an_srdf_and_read_again() {
    let robot = gripper(MeshUse::Hull);
    let mut before = Cell::new();
    before.add_robot("r/", &robot, Isometry3::identity()).expect("a robot");
    before.exclude_adjacent();
    before.exclude("r/left finger", "r/right finger").expect("names");
    before.include("r/base", "r/shoulder").expect("names");
    let srdf = Srdf::from_cell(&before, "r/", &robot);
    assert_eq!(srdf.excluded.len(), before.excluded().len());
    let read = Srdf::parse(&srdf.text("gripper"), "gripper.srdf", &robot).expect("an SRDF");
    assert_eq!(read.excluded, srdf.excluded);
    let mut after = Cell::new();
    after.add_robot("r/", &robot, Isometry3::identity()).expect("a robot");
    read.exclude_in(&mut after, "r/").expect("links");
    let [a, b] = [before, after].map(|setup| Checker::of_robots(setup.clone()).expect("a setup"));
    assert!(a.cell().excluded().eq(b.cell().excluded()));
    let found = a.cell().excluded_names();
    assert_eq!(found, b.cell().excluded_names(), "the reasons as well");
}

/// A cell is changed at any time, and a copy of it is another cell.
#[test]
fn copies_of_a_cell_are_changed_alone() {
    let robot = gripper(MeshUse::Hull);
    let mut base = Cell::new();
    base.add_robot("", &robot, Isometry3::identity()).expect("a robot");
    base.exclude_adjacent();
    let excluded = |cell: &Cell| {
        let names = cell.excluded_names();
        let names = names.iter().map(|(pair, _)| pair.map(str::to_owned));
        names.collect::<Vec<_>>()
    };
    let adjacent = excluded(&base);
    assert!(!adjacent.is_empty());
    let far = shift(Vector3::new(3.0, 0.0, 0.0));
    let [link, other] = [adjacent[0][0].clone(), adjacent[0][1].clone()];
    // Names are unique, and a failed call changes nothing.
    let before = format!("{base:?}");
    let ball = lin_canny::Shape::ball(0.05).expect("a ball");
    base.add_obstacle(&link, ball, far).expect_err("the name of a link");
    base.add_robot("", &robot, far).expect_err("the names of its links");
    assert_eq!(format!("{base:?}"), before);
    assert_eq!(excluded(&base), adjacent);
    // Changes after the first checker.
    let mut changed = base.clone();
    changed.include(&link, &other).expect("names");
    assert_eq!(excluded(&changed).len(), adjacent.len() - 1);
    changed.exclude(&other, &link).expect("names");
    assert_eq!(excluded(&changed), adjacent);
    let width = |setup: &Cell| {
        let checker = Checker::of_robots(setup.clone()).expect("a setup");
        let [low, high] = checker.space().bounds()[0];
        high - low
    };
    let before = width(&changed);
    changed.widen_limits(0.25);
    assert_eq!(width(&changed), before + 0.5);
    changed.add_robot("b_", &robot, far).expect("a robot");
    assert_eq!(changed.robot_bodies().len(), 2 * base.robot_bodies().len());
}
