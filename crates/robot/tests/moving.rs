//! Moving obstacles and several robots on one clock: cells with timed poses, and trajectories of two arms.

use lin_canny_plan::{Cell, JointMotion};
use std::path::{Path, PathBuf};

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny_robot::plan::{CellBody, Checker, JointCurve, JointTree, Verdict};
use lin_canny_robot::{
    CellFile, FileError, LoadOptions, LoadedCell, OtherRobot, Packages, Robot, RobotFiles, RobotRecorder, Trajectory,
};
use truth::errors::says;
use truth::plans::{Ask, bezier, blocked};
use truth::rng::Rng;

/// The rows of a section of the cases.
fn cases<const N: usize>(section: &str) -> Vec<[String; N]> {
    truth::rows::rows(include_str!("moving/rows.txt"), section)
}

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")
}

fn scratch(name: &str, text: &str) -> PathBuf {
    // Each test has a folder.
    let test = std::thread::current().name().unwrap_or("test").to_owned();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("moving").join(test);
    std::fs::create_dir_all(&folder).expect("a folder");
    let file = folder.join(name);
    std::fs::write(&file, text).expect("a file");
    file
}

fn cell(text: &str) -> Result<CellFile, FileError> {
    let path = scratch("cell.json", text);
    CellFile::load(path, &Packages::default(), &LoadOptions::default())
}

/// A cell with a box whose poses are these.
fn with_poses(poses: &str) -> Result<CellFile, FileError> {
    cell(&format!(
        r#"{{"bodies": [{{"name": "cart", "box": {{"size": [1, 1, 1]}}, {poses}}}]}}"#
    ))
}

fn checker(cell: &CellFile) -> Checker<JointTree> {
    let robot = Robot::load(examples().join("gripper.urdf"), &Packages::default()).expect("a robot");
    let mut setup = Cell::new();
    setup.add_robot("", &robot, Isometry3::identity()).expect("a robot");
    setup.exclude_adjacent();
    setup.exclude("left finger", "right finger").expect("names");
    cell.add_to(&mut setup).expect("a cell");
    Checker::of_robots(setup.clone()).expect("a checker")
}

#[test]
fn poses_are_read_from_a_file() {
    let rows = "# in any order\nqw,qx,qy,qz,time,z,y,x\n1,0,0,0,0.5,3,2,1\n\n0,0,0,-2, 1.5 ,-3,0.25,1e-3\n";
    scratch("poses.csv", rows);
    let found = with_poses(r#""poses": {"file": "poses.csv"}"#).expect("a cell");
    let obstacle = &found.obstacles[0];
    let poses = obstacle.poses.as_ref().expect("poses");
    assert_eq!(poses.times(), [0.5, 1.5]);
    assert_eq!(poses.poses()[0], Isometry3::translation(1.0, 2.0, 3.0));
    assert_eq!(poses.poses()[1].translation.vector, Vector3::new(1e-3, 0.25, -3.0));
    // A quaternion of any length is normalised and keeps its sign.
    assert_eq!(poses.poses()[1].rotation.coords.as_slice(), [0.0, 0.0, -1.0, 0.0]);
    assert_eq!(obstacle.pose, poses.poses()[0]);
    let in_rows = r#""poses": {"rows": [[0.5, 1, 2, 3, 0, 0, 0, 1], [1.5, 1e-3, 0.25, -3, 0, 0, -1, 0]]}"#;
    assert_eq!(with_poses(in_rows).expect("a cell").obstacles[0].poses, obstacle.poses);
}

#[test]
fn errors_of_poses_name_file_line_and_column() {
    for [text, expected] in cases("faults of files of poses") {
        scratch("poses.csv", &text);
        let error = with_poses(r#""poses": {"file": "poses.csv"}"#).expect_err("an error");
        let error = error.to_string();
        assert!(error.contains(&expected), "{text:?}: {error} (expected {expected})");
    }
    for [poses, expected] in cases("faults of poses") {
        let error = with_poses(&poses).expect_err("an error").to_string();
        assert!(error.contains(&expected), "{poses}: {error}");
    }
    let attached = r#"{"bodies": [], "attached": [{"link": "hand", "body": {"name": "part", "sphere": {"radius": 1},
        "poses": {"file": "poses.csv"}}}]}"#;
    says(cell(attached), "attached[0] \"part\": poses of an attached object");
}

/// The moving obstacles of a saved cell have the same bits, and the checker answers as before.
#[test]
fn cells_with_poses_are_saved_bit_for_bit() {
    let mut rng = Rng::new(3);
    let rows: Vec<String> = (0..6)
        .map(|k| {
            let place = Vector3::from(rng.unit()) * rng.range(0.4, 1.0);
            let [w, x, y, z]: [f64; 4] = std::array::from_fn(|_| rng.range(-1.0, 1.0));
            let row = [f64::from(k) * 0.7 + 0.1, place.x, place.y, place.z, x, y, z, w];
            row.map(|x| format!("{x:?}")).join(",")
        })
        .collect();
    let text = "time,x,y,z,qx,qy,qz,qw\n".to_owned() + &rows.join("\n");
    scratch("poses.csv", &text);
    let first = cell(
        r#"{"bodies": [
            {"name": "cart", "box": {"size": [0.5, 0.6, 0.4]}, "poses": {"file": "poses.csv"}},
            {"name": "table", "box": {"size": [1, 1, 0.1]}, "xyz": [0, 0, -1]},
            {"name": "cart", "sphere": {"radius": 0.05}, "poses": {"file": "poses.csv"}}]}"#,
    )
    .expect("a cell");
    let mut one = checker(&first);
    let saved = CellFile::from_cell(one.cell()).to_json().expect("a text");
    let again = cell(&saved).expect("a cell");
    let found = CellFile::from_cell(checker(&again).cell()).to_json().expect("a text");
    assert_eq!(found, saved);
    for (a, b) in first.obstacles.iter().zip(&again.obstacles) {
        assert_eq!(a.poses, b.poses);
        assert!(b.name.starts_with(&a.name), "{}", b.name);
    }
    let mut other = checker(&again);
    let (mut free, mut blocked) = (0, 0);
    for _ in 0..12 {
        let [p, q] = [(); 2].map(|()| {
            let mut q: Vec<f64> = (0..7).map(|_| rng.range(-1.0, 1.0)).collect();
            (q[1], q[2], q[6]) = (0.5 + 0.3 * q[1], 1.0 + 0.3 * q[2], 0.02);
            q
        });
        let begin = rng.range(0.1, 3.0);
        let curve = bezier(&[p, q]);
        let curve = curve.with_times([begin, begin + 0.5]).expect("times");
        let verdicts = [&mut one, &mut other].map(|checker| {
            checker.reset();
            checker.verdict_of(&JointMotion::curve(&curve))
        });
        assert_eq!(verdicts[0], verdicts[1]);
        free += u32::from(verdicts[0].is_free());
        blocked += u32::from(!verdicts[0].is_free());
    }
    assert!(free > 1 && blocked > 1, "{free} {blocked}");
}

/// A world with a moving obstacle is recorded where the obstacle is.
#[test]
fn recordings_show_moving_obstacles() {
    scratch(
        "poses.csv",
        "time,x,y,z,qx,qy,qz,qw\n0,3,0,0,0,0,0,1\n1,4,0,0,0,0,0,1\n",
    );
    let found = with_poses(r#""poses": {"file": "poses.csv"}"#).expect("a cell");
    let mut checker = checker(&found);
    let q = [0.0, 0.6, 1.0, 0.0, 0.5, 0.0, 0.02];
    let file = scratch("moving.jsonl", "");
    checker.set_time(0.0).expect("a pose");
    let mut recorder = RobotRecorder::create(&file, &checker, &q).expect("a file");
    for time in [0.0, 0.5, 1.0] {
        checker.set_time(time).expect("a pose");
        let near = checker.clearance(&q).expect("a pose").expect("a pair");
        recorder.frame(&checker, &q, "here", &near).expect("a file");
    }
    recorder.finish().expect("a file");
    let text = std::fs::read_to_string(&file).expect("a file");
    assert!(text.contains("3.5") && text.contains('4'), "{text}");
}

/// A trolley on a rail along x, and a box on it that slides along y.
fn trolley() -> &'static str {
    r#"<robot name="trolley"><link name="rail"/>
    <link name="base"><collision><geometry><box size="0.4 0.4 0.4"/></geometry></collision></link>
    <link name="top"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
    <joint name="x" type="prismatic"><parent link="rail"/><child link="base"/><axis xyz="1 0 0"/>
      <limit lower="-5" upper="5" effort="1" velocity="1"/></joint>
    <joint name="y" type="prismatic"><parent link="base"/><child link="top"/><origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>
      <limit lower="-5" upper="5" effort="1" velocity="1"/></joint></robot>"#
}

fn two_trolleys(pose: Isometry3<f64>) -> Cell {
    let file = scratch("trolley.urdf", trolley());
    let mut files = RobotFiles::new(&file);
    files.others = vec![OtherRobot {
        pose,
        ..OtherRobot::new("b_", &file)
    }];
    files.load().expect("two robots").cell
}

#[test]
fn two_robots_exchange_places() {
    let setup = two_trolleys(Isometry3::identity());
    let names: Vec<&str> = setup.coordinates().iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["x", "y", "b_x", "b_y"]);
    let mut checker = Checker::of_robots(setup.clone()).expect("a checker");
    let names: Vec<&str> = checker.cell().bodies().map(|b| b.1).collect();
    assert_eq!(names, ["base", "top", "b_base", "b_top"]);
    // Adjacent links of each robot are excluded; four pairs of both robots are left.
    assert_eq!(checker.work().pairs_made, 4);
    let certify = |checker: &mut Checker<JointTree>, text: &str| {
        let path = Trajectory::parse_timed(text, "two.csv", setup.coordinates(), &[]).expect("a trajectory");
        checker.verdict_of(&JointMotion::spline(&path.curves().expect("curves")).expect("a motion"))
    };
    // On one rail they meet in the middle.
    let same = "time,x,y,b_x,b_y\n0,-2,0,2,0\n4,2,0,-2,0\n";
    let verdict = certify(&mut checker, same);
    assert!(matches!(verdict, Verdict::Blocked { piece: 0, .. }));
    let ([safe, t], pair) = blocked(&verdict).expect("they meet");
    assert_eq!(checker.show(&pair).to_string(), "base and b_base");
    assert!(safe <= 0.45 && t >= 0.45 && t - safe < 1e-5, "{safe} {t}");
    // One of them waits: they meet where it is, or not at all.
    let fast = "time,x,y,b_x,b_y\n0,-2,0,2,0\n1,-2,0,-1.9,0\n";
    let Verdict::Blocked { contact_at: t, .. } = certify(&mut checker, fast) else {
        panic!("they meet")
    };
    assert!((t - 3.6 / 3.9).abs() < 1e-5, "{t}");
    let aside = "time,x,y,b_x,b_y\n0,-2,0,2,0\n1,-2,0,-1.5999,0\n";
    assert!(certify(&mut checker, aside).is_free());
    // On two rails 0.5 apart the trolleys pass, the boxes on top only if they are drawn in.
    let setup_of_two = two_trolleys(Isometry3::translation(0.0, 0.5, 0.0));
    let mut checker = Checker::of_robots(setup_of_two).expect("a checker");
    assert!(certify(&mut checker, same).is_free());
    let verdict = certify(&mut checker, "time,x,y,b_x,b_y\n0,-2,0.2,2,-0.2\n4,2,0.2,-2,-0.2\n");
    assert!(matches!(verdict, Verdict::Blocked { pair, .. }
        if checker.show(&pair).to_string() == "top and b_top"));
    // With speeds: from rest to rest, the box is drawn in in time.
    let cubic = "time,x,x.velocity,y,y.velocity,b_x,b_x.velocity,b_y,b_y.velocity\n\
                 0,-2,0,0.3,0,2,0,0,0\n2,0,2,0,0,0,-2,0,0\n4,2,0,0.3,0,-2,0,0,0\n";
    assert!(certify(&mut checker, cubic).is_free());
    // They arrive in contact at the end.
    let mut checker = Checker::of_robots(setup.clone()).expect("a checker");
    let end = "time,x,y,b_x,b_y\n0,-2,0,2,0\n1,-1,0,1,0\n2,-0.2,0,0.2,0\n";
    let verdict = certify(&mut checker, end);
    let is_late = matches!(verdict, Verdict::Blocked { contact_at: t, piece: 1, .. } if t > 0.999);
    assert!(is_late, "they meet in the second piece: {verdict:?}");
}

#[test]
fn robots_of_equal_names_and_columns_are_errors() {
    let file = scratch("trolley.urdf", trolley());
    let load = |others: &[&str]| {
        let mut files = RobotFiles::new(&file);
        files.others = others.iter().map(|prefix| OtherRobot::new(*prefix, &file)).collect();
        files.load().map(|loaded| loaded.cell)
    };
    for others in [&["a", "a"][..], &["a", "b", "a"], &[""]] {
        let error = load(others).expect_err("an error").to_string();
        assert!(error.contains("link"), "{error}");
        assert!(error.contains("name is already in use"), "{error}");
    }
    let setup = load(&["a_", "b_"]).expect("three robots");
    assert_eq!(setup.coordinates().len(), 6);
    let read = |text: &str| Trajectory::parse_timed(text, "two.csv", setup.coordinates(), &[]);
    says(
        read("time,x,y,a_x,a_y,b_x\n0,0,0,0,0,0\n"),
        "two.csv:1: column \"b_y\" is missing",
    );
    says(
        read("time,x,y,a_x,a_y,b_x,c_y\n"),
        "column \"c_y\": coordinate \"c_y\" does not exist",
    );
    says(
        read("time,x,y,a_x,a_y,b_x,b_y\n0,0,0,0,0,0,9\n"),
        "two.csv:2: column \"b_y\": b_y (limits -5 and 5)",
    );
    let error = RobotFiles {
        others: vec![OtherRobot::new("b_", "none.urdf")],
        ..RobotFiles::new(&file)
    };
    says(error.load(), "none.urdf");
}

#[derive(Debug, Default)]
struct Counts {
    free: u32,
    blocked: u32,
    at_start: u32,
}

/// Two six-axis arms that reach into the same space, and a box that moves between them: random trajectories of two
/// pieces with speeds, judged at `places` times each.
fn judged(count: usize, places: u32, seed: u64) -> Counts {
    let mut files = RobotFiles::new(examples().join("arm.urdf"));
    files.others = vec![OtherRobot {
        pose: Isometry3::new(Vector3::new(0.6, 0.0, 0.0), Vector3::z() * 3.0),
        ..OtherRobot::new("b_", examples().join("arm.urdf"))
    }];
    let LoadedCell { cell: mut setup, .. } = files.load().expect("two arms");
    let rows = "time,x,y,z,qx,qy,qz,qw\n0,0.3,-0.8,0.6,0,0,0,1\n2,0.3,0.1,0.8,0,0,1,0\n3,0.3,0.8,0.9,0,0.6,0.8,0\n";
    scratch(&format!("between{seed}.csv"), rows);
    let poses = format!(r#""poses": {{"file": "between{seed}.csv"}}"#);
    let text = format!(r#"{{"bodies": [{{"name": "cart", "box": {{"size": [0.3, 0.2, 0.3]}}, {poses}}}]}}"#);
    let path = scratch(&format!("between{seed}.json"), &text);
    CellFile::load(path, &Packages::default(), &LoadOptions::default())
        .expect("a cell")
        .add_to(&mut setup)
        .expect("a cell");
    let (mut checker, mut judge) = (
        Checker::of_robots(setup.clone()).expect("a checker"),
        Checker::of_robots(setup.clone()).expect("a checker"),
    );
    let (mut rng, mut counts) = (Rng::new(seed), Counts::default());
    let size = setup.coordinates().len();
    assert_eq!(size, 12);
    for k in 0..count {
        let mut row = || -> Vec<f64> {
            let each = setup.coordinates().iter();
            each.map(|c| 0.35 * rng.range(c.limits[0].max(-3.0), c.limits[1].min(3.0)))
                .collect()
        };
        let ends = [row(), row(), row()];
        let middle: Vec<f64> = (0..size).map(|k| ends[1][k] * 0.3 + ends[0][k] * 0.7).collect();
        let speed: Vec<f64> = (0..size).map(|k| 0.2 * (ends[2][k] - ends[0][k])).collect();
        let times = [0.2, 1.1, 2.9];
        let zero = vec![0.0; size];
        let pieces = [
            (&ends[0], &middle, &zero, &speed, [times[0], times[1]]),
            (&middle, &ends[2], &speed, &zero, [times[1], times[2]]),
        ];
        for (from, to, v, w, times) in pieces {
            let curve = JointCurve::cubic(from, to, v, w, times[1] - times[0]).expect("a curve");
            let curve = curve.with_times(times).expect("times");
            let Ok(verdict) = checker.certify(&JointMotion::curve(&curve)) else {
                continue; // A limit.
            };
            let mut is_free = |t: f64| {
                let time = times[0] + (times[1] - times[0]) * t;
                judge.set_time(time.clamp(times[0], times[1])).expect("a pose");
                judge.is_free_at(&curve.at(t)).expect("within limits")
            };
            match verdict {
                Verdict::Free { .. } => counts.free += 1,
                Verdict::Blocked { contact_at: 0.0, .. } => {
                    assert!(!is_free(0.0), "{k}: {verdict:?}");
                    counts.at_start += 1;
                    continue;
                }
                Verdict::Blocked { contact_at: t, .. } => {
                    assert!(!is_free(t), "{k}: {verdict:?}");
                    counts.blocked += 1;
                }
                _ => panic!("{k}: {verdict:?}"),
            }
            for i in 0..=places {
                let t = verdict.free_until() * f64::from(i) / f64::from(places);
                assert!(is_free(t), "{k}: {verdict:?} meets at {t}");
            }
        }
    }
    counts
}

#[test]
fn two_arms_and_a_moving_box_are_as_the_verdict_says() {
    let counts = judged(30, 60, 1);
    println!("{counts:?}");
    assert!(counts.free > 3 && counts.blocked > 3, "{counts:?}");
}

#[test]
#[ignore = "300 trajectories at 10,000 places: cargo test --release -p lin-canny-robot --test moving -- --ignored --nocapture"]
fn hundreds_of_trajectories_of_two_arms_are_as_the_verdict_says() {
    println!("{:?}", judged(300, 10_000, 2));
}

#[test]
fn a_cell_of_the_examples_moves() {
    let (packages, options) = (Packages::default(), LoadOptions::default());
    let crossing = CellFile::load(examples().join("crossing.json"), &packages, &options).expect("a cell");
    let checker = checker(&crossing);
    let crate_ = checker.cell().select("crate").expect("a body");
    assert_eq!(crate_, [CellBody::Obstacle(2)]);
    let found = checker.cell().obstacle_motion(crate_[0]).expect("poses").times().len();
    assert_eq!(found, 5);
}
