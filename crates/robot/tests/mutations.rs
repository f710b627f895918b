//! Files changed at random: read or refused by an error, without a panic, and what is read makes a space.

use std::path::{Path, PathBuf};

use lin_canny::nalgebra::Isometry3;
use lin_canny_plan::{Cell, ConfigurationSpace};
use lin_canny_robot::{CellFile, LoadOptions, Packages, Robot, Srdf, Trajectory};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")
}

/// Words that change what a file says.
const WORDS: [&str; 18] = [
    "NaN",
    "inf",
    "-1",
    "0",
    "1e308",
    "1e-308",
    "\"",
    "<",
    "/>",
    "&",
    "mimic joint=\"left\"",
    "gripper",
    "base",
    "planar",
    "floating",
    "continuous",
    "sphere",
    "\u{fffd}",
];

/// A text with one or two places changed: what stands between two marks replaced by a word, doubled or cut out, or
/// a few letters anywhere.
fn mutated(text: &str, random: &mut ChaCha8Rng) -> String {
    let mut text = text.to_owned();
    for _ in 0..random.random_range(1..3) {
        let (a, b) = if random.random_bool(0.7) {
            value(&text, random)
        } else {
            letters(&text, random)
        };
        let with = match random.random_range(0..4) {
            0 => String::new(),
            1 => text[a..b].repeat(2),
            _ => WORDS[random.random_range(0..WORDS.len())].to_owned(),
        };
        text.replace_range(a..b, &with);
    }
    text
}

/// The range between two neighbouring quotes, commas or brackets.
fn value(text: &str, random: &mut ChaCha8Rng) -> (usize, usize) {
    let is_mark = |(_, c): &(usize, char)| matches!(c, '"' | ',' | '[' | ']' | '\n');
    let marks: Vec<usize> = text.char_indices().filter(is_mark).map(|(k, _)| k).collect();
    let k = random.random_range(1..marks.len());
    (marks[k - 1] + 1, marks[k])
}

/// A range of up to eight bytes.
fn letters(text: &str, random: &mut ChaCha8Rng) -> (usize, usize) {
    let boundary = |at: usize| {
        (0..=at.min(text.len()))
            .rev()
            .find(|k| text.is_char_boundary(*k))
            .unwrap_or(0)
    };
    let a = boundary(random.random_range(0..text.len()));
    (a, boundary(a + random.random_range(1..9)).max(a))
}

#[test]
fn changed_urdfs_never_panic() {
    let path = examples().join("gripper.urdf");
    let text = std::fs::read_to_string(&path).expect("the example");
    let filter = "<drake:collision_filter_group xmlns:drake=\"http://drake.mit.edu\" name=\"a\" ignore=\"false\">
        <drake:member link=\"base\"/><drake:member link=\"gripper\"/><drake:member_group name=\"a\"/>
        <drake:ignored_collision_filter_group name=\"a\"/></drake:collision_filter_group></robot>";
    let text = text.replace("</robot>", filter);
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let (mut read, mut with_line) = (0, 0);
    let mut poses = Vec::new();
    for _ in 0..3000 {
        let changed = mutated(&text, &mut random);
        match Robot::parse(&changed, &path, &Packages::default(), &LoadOptions::default()) {
            Ok(robot) => {
                read += 1;
                let mut setup = Cell::new();
                setup.add_robot("", &robot, Isometry3::identity()).expect("a robot");
                let Ok(space) = setup.space() else { continue };
                let q = space.sample(&mut || random.random::<f64>());
                space.place(&q, &mut poses);
                let is_finite = |p: &Isometry3<f64>| p.to_homogeneous().iter().all(|x| x.is_finite());
                assert!(poses.iter().all(is_finite), "{changed}");
            }
            Err(error) => {
                assert!(!error.to_string().is_empty());
                with_line += usize::from(error.line.is_some());
            }
        }
    }
    assert!(
        read > 100 && with_line > 1000,
        "{read} read, {with_line} refused with a line"
    );
}

#[test]
fn changed_cells_srdfs_and_trajectories_never_panic() {
    let robot = Robot::load(examples().join("gripper.urdf"), &Packages::default()).expect("the example");
    let text = |name: &str| std::fs::read_to_string(examples().join(name)).expect("the example");
    let (cell, srdf, rows) = (text("cell.json"), text("gripper.srdf"), text("carry.csv"));
    let groups = "<group name=\"hand\"><link name=\"gripper\"/><joint name=\"left\"/></group>
        <group name=\"all\"><group name=\"arm\"/><group name=\"hand\"/></group>
        <group_state name=\"home\" group=\"arm\"><joint name=\"lift\" value=\"0.5\"/><joint name=\"elbow\" value=\"1\"/></group_state>
        <virtual_joint name=\"v\" type=\"planar\" parent_frame=\"w\" child_link=\"base\"/></robot>";
    let srdf = srdf.replace("</robot>", groups);
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let names: Vec<String> = robot.coordinates().iter().map(|c| format!("\"{}\"", c.name)).collect();
    let zeros = vec!["0.01"; names.len()].join(", ");
    let point = |t: u32| format!("{{\"positions\": [{zeros}], \"velocities\": [{zeros}], \"time_from_start\": {t}}}");
    let message = format!(
        "{{\"joint_names\": [{}], \"points\": [{}, {}]}}",
        names.join(", "),
        point(0),
        point(1)
    );
    let block = format!(
        "joint_names:\n- {}\npoints:\n- {}\n- {}\n",
        names.join("\n- "),
        point(0),
        point(1)
    );
    let mut read = [0; 5];
    for _ in 0..3000 {
        let path = examples().join("changed");
        for (k, (text, extension)) in [(&message, "json"), (&block, "yaml")].into_iter().enumerate() {
            let (text, path) = (mutated(text, &mut random), path.with_extension(extension));
            if let Ok(trajectory) = Trajectory::parse_timed(&text, &path, robot.coordinates(), &[]) {
                read[3 + k] += 1;
                // An error of the numbers is no panic.
                let _ = trajectory.curves();
            }
        }
        let changed = mutated(&cell, &mut random);
        read[0] += usize::from(CellFile::parse(&changed, &path, &Packages::default(), &LoadOptions::default()).is_ok());
        read[1] += usize::from(Srdf::parse(&mutated(&srdf, &mut random), &path, &robot).is_ok());
        if let Ok(trajectory) = Trajectory::parse(&mutated(&rows, &mut random), &path, robot.coordinates()) {
            read[2] += 1;
            assert!(trajectory.rows.iter().flatten().all(|x| x.is_finite()));
        }
    }
    assert!(read.iter().all(|n| *n > 100), "{read:?}");
}
