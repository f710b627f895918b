//! Joints, limits, mimics, static links and masks of URDF and SDFormat, beside those of urdfdom and
//! libsdformat.

use std::collections::{BTreeMap, BTreeSet};

use lin_canny::Geometry;
use lin_canny::nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny_plan::{Cell, ConfigurationSpace, Drive};
use lin_canny_robot::{LinkBody, LoadOptions, MotionKind, Packages, Robot, RobotJoint, RobotLink};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// What a library says of a file: words separated by tabs, one list for each link or joint.
#[derive(Default)]
struct Said<'a> {
    has_error: bool,
    links: Vec<Vec<&'a str>>,
    joints: Vec<Vec<&'a str>>,
}

/// Compares with the output of `foreign/values.py` in the file that `FOREIGN_VALUES` names.
#[test]
#[ignore = "needs urdfdom and libsdformat: see tests/foreign/values.py"]
fn rules_are_those_of_the_libraries_of_the_formats() {
    let file = std::env::var("FOREIGN_VALUES").expect("FOREIGN_VALUES names a file");
    let text = std::fs::read_to_string(file).expect("the values");
    let mut files: Vec<(&str, &str, Said)> = Vec::new();
    let mut library = "";
    for line in text.lines() {
        let said = files.last_mut().map(|(_, _, said)| said);
        match (line.split_once(' ').unwrap_or((line, "")), said) {
            (("library", name), _) => library = name,
            (("skipped", what), _) => println!("skipped: {what}"),
            (("file", name), _) => files.push((library, name, Said::default())),
            (("error", _), Some(said)) => said.has_error = true,
            (("link", words), Some(said)) => said.links.push(words.split('\t').collect()),
            (("joint", words), Some(said)) => said.joints.push(words.split('\t').collect()),
            _ => panic!("{line}"),
        }
    }
    let mut counts: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    let (mut reasons, mut wrong) = (BTreeMap::<String, usize>::new(), Vec::new());
    for (library, file, said) in &files {
        let mut count = |what, n| *counts.entry((library, what)).or_default() += n;
        count("files", 1);
        if said.has_error {
            continue;
        }
        count("files that the library loads", 1);
        let options = LoadOptions::default().skip_missing_meshes(true);
        let robot = match Robot::load_with(file, &Packages::default(), &options) {
            Ok(robot) => robot,
            Err(error) => {
                let reason: String = error.reason.to_string().chars().take(70).collect();
                *reasons.entry(reason).or_default() += 1;
                continue;
            }
        };
        count("files that load here", 1);
        count("links", said.links.len());
        count("joints", said.joints.len());
        // One tree of a model that stands alone is fixed, although it is not static.
        let is_alone = !std::fs::read_to_string(file).is_ok_and(|text| text.contains("<world"));
        let mut found = differences(&robot, said, is_alone);
        // libsdformat writes the pose of a merged model with six digits, and reads it again.
        let is_merged = std::fs::read_to_string(file).is_ok_and(|text| text.contains("merge=\"true\""));
        let (poses, far) = moved(&robot, said, if is_merged { 1e-5 } else { 1e-12 });
        count("poses of links", poses);
        found.extend(far);
        wrong.extend(found.into_iter().map(|what| format!("{file}: {what}")));
    }
    for ((library, what), count) in &counts {
        println!("{library}: {count} {what}");
    }
    let mut reasons: Vec<(usize, String)> = reasons.into_iter().map(|(reason, n)| (n, reason)).collect();
    reasons.sort_by(|a, b| b.cmp(a));
    println!("not loaded here: {reasons:#?}");
    assert!(!files.is_empty() || text.contains("skipped"));
    assert!(wrong.is_empty(), "{} differences: {wrong:#?}", wrong.len());
}

/// Returns what differs between a robot and what a library says of its file.
fn differences(robot: &Robot, said: &Said, is_alone: bool) -> Vec<String> {
    let mut wrong = Vec::new();
    let options = LoadOptions::default();
    let mut is_moved = BTreeSet::new();
    let is_static = |name: &str| said.links.iter().any(|words| words[0] == name && words[1] == "static");
    for words in &said.joints {
        let [name, kind, parent, child] = words[..4] else {
            panic!("{words:?}")
        };
        // libsdformat appends a word to the name of a joint that has the name of a link.
        let is_it = |joint: &&RobotJoint| joint.name == name || format!("{}_joint", joint.name) == name;
        let part = |part: &str| robot.joints().iter().find(|j| j.name == format!("{name}/{part}"));
        // A universal joint is two joints, and a screw two that move as one.
        let last = match kind {
            "universal" | "revolute2" => part("axis2"),
            "screw" => part("thread"),
            _ => None,
        };
        // A joint between static links is listed.
        if is_static(child) && (parent == "world" || is_static(parent)) {
            continue;
        }
        let Some(joint) = robot.joints().iter().find(is_it).or_else(|| part("axis")) else {
            wrong.push(format!("{words:?}: no joint"));
            continue;
        };
        let child_here = last.unwrap_or(joint).child;
        is_moved.insert(child_here);
        let ends = [joint.parent, child_here].map(|link| robot.links()[link].name.as_str());
        let expected = match kind {
            "revolute" | "continuous" | "universal" | "revolute2" | "screw" => MotionKind::Revolute,
            "ball" => MotionKind::Ball,
            "prismatic" => MotionKind::Prismatic,
            "fixed" => MotionKind::Fixed,
            "planar" => MotionKind::Planar,
            "floating" => MotionKind::Floating,
            _ => panic!("{words:?}"),
        };
        if ends != [parent, child] || joint.kind != expected {
            wrong.push(format!("{words:?}: {:?} from {ends:?}", joint.kind));
        }
        let after = |key: &str| words.iter().position(|word| *word == key).map(|k| &words[k + 1..]);
        let number = |word: &str| word.parse::<f64>().expect("a number");
        if let Some([leader, factor, offset, ..]) = after("mimic") {
            if kind != "fixed" && joint.mimics.as_deref() != Some(leader) {
                wrong.push(format!("{words:?}: mimics {:?}", joint.mimics));
            }
            // Of a chain of mimics the drive has the product.
            let is_chain = robot
                .joints()
                .iter()
                .any(|other| other.name == *leader && other.mimics.is_some());
            let drive = joint.drive.filter(|_| !is_chain);
            if drive.is_some_and(|drive| [drive.factor, drive.offset] != [number(factor), number(offset)]) {
                wrong.push(format!("{words:?}: {drive:?}"));
            }
        } else if joint.mimics.is_some() {
            // libsdformat 12 does not know mimics.
            wrong.extend(
                said.links
                    .is_empty()
                    .then(|| format!("{words:?}: mimics {:?}", joint.mimics)),
            );
        } else if let (true, Some([lower, upper, ..])) =
            (["revolute", "continuous", "prismatic"].contains(&kind), after("limits"))
        {
            let open = match joint.kind {
                MotionKind::Prismatic => options.floating_limits,
                _ => options.continuous_limits,
            };
            // In SDFormat, a limit of 1e16 is none.
            let most = if said.links.is_empty() { f64::INFINITY } else { 1e16 };
            let limit = |word: &str, open: f64| Some(number(word)).filter(|x| x.abs() < most).unwrap_or(open);
            let expected = match kind {
                "continuous" => open,
                _ => [limit(lower, open[0]), limit(upper, open[1])],
            };
            let found = robot
                .coordinates()
                .iter()
                .find(|c| c.name == joint.name)
                .map(|c| c.limits);
            if found != Some(expected) {
                wrong.push(format!("{words:?}: {found:?}"));
            }
        }
    }
    for words in &said.links {
        let [name, still] = words[..2] else { panic!("{words:?}") };
        let Some(link) = robot.link(name) else {
            wrong.push(format!("{words:?}: no link"));
            continue;
        };
        let kind = robot.joints()[link - 1].kind;
        let is_base = is_alone && kind == MotionKind::Fixed;
        // libsdformat 12 does not know the joints of a world, whose names have no prefix.
        let is_of_world = !is_alone && !robot.joints()[link - 1].name.contains("::");
        let floats = still == "free" && !is_moved.contains(&link) && !is_base && !is_of_world;
        if still == "static" && kind != MotionKind::Fixed || floats && kind != MotionKind::Floating {
            wrong.push(format!("{words:?}: {kind:?}"));
        }
    }
    // Pairs of bodies with masks in the file: 255 is the value without one.
    let masks: BTreeMap<(usize, usize), u32> = (said.links.iter())
        .filter_map(|words| Some((robot.link(words[0])?, words)))
        .filter(|(link, words)| robot.links()[*link].bodies.len() == words.len() - 2)
        .flat_map(|(link, words)| words[2..].iter().enumerate().map(move |(k, mask)| ((link, k), mask)))
        .map(|(body, mask)| (body, mask.parse().expect("a mask")))
        .collect();
    let excluded: BTreeSet<[(usize, usize); 2]> = robot.excluded().into_iter().collect();
    for (a, one) in &masks {
        for (b, other) in masks.range(a..).skip(1) {
            let wide = |mask: u32| if mask == 255 { 0xffff } else { mask };
            if excluded.contains(&[*a, *b]) != (wide(*one) & wide(*other) == 0) {
                wrong.push(format!("masks {one:x} and {other:x} of {a:?} and {b:?}"));
            }
        }
    }
    wrong
}

/// Moves a robot of SDFormat to a thousand random configurations, and computes where its links are
/// from the frames and axes that libsdformat states. Returns how many poses were compared, and
/// what differs.
fn moved(robot: &Robot, said: &Said, tolerance: f64) -> (usize, Vec<String>) {
    let number = |word: &str| word.parse::<f64>().expect("a number");
    let after = |words: &[&str], key: &str, count: usize| -> Option<Vec<f64>> {
        let k = words.iter().position(|word| *word == key)?;
        Some(words[k + 1..k + 1 + count].iter().map(|word| number(word)).collect())
    };
    // Of a screw, libsdformat 12 does not tell in which unit the file states the thread.
    if said.links.is_empty() || said.joints.iter().any(|words| words[1] == "screw") {
        return (0, Vec::new());
    }
    let mut cell = Cell::new();
    cell.add_robot("", robot, Isometry3::identity()).expect("a robot");
    let space = cell.space().expect("a tree");
    let of_robot = |body: &&LinkBody| !matches!(body.geometry, Geometry::HalfSpace(_));
    let names = |link: &'_ RobotLink| vec![link.name.clone(); link.bodies.iter().filter(of_robot).count()];
    let bodies: Vec<String> = robot.links().iter().flat_map(names).collect();
    let placed = |q: &[f64]| {
        let mut poses = Vec::new();
        space.place(q, &mut poses);
        // Frames of links without bodies come last.
        poses
    };
    let drawn = placed(robot.start());
    // For each link that a joint moves: its parent, the frame of the joint, and the motion.
    let drive = |name: &str| {
        robot
            .joints()
            .iter()
            .find(|joint| joint.name == name)
            .and_then(|joint| joint.drive)
    };
    let mut joints = BTreeMap::new();
    for words in &said.joints {
        let p = after(words, "pose", 7).expect("a pose");
        let turn = UnitQuaternion::from_quaternion(Quaternion::new(p[6], p[3], p[4], p[5]));
        let frame = Isometry3::from_parts(Translation3::new(p[0], p[1], p[2]), turn);
        let axis = |k: usize| Vector3::from_vec(after(words, ["axis0", "axis1"][k], 3).expect("an axis")).normalize();
        let name = words[0];
        let parts = match words[1] {
            "revolute" | "continuous" => vec![(true, axis(0), drive(name))],
            "prismatic" => vec![(false, axis(0), drive(name))],
            "universal" | "revolute2" => (0..2)
                .map(|k| (true, axis(k), drive(&format!("{name}/{}", ["axis", "axis2"][k]))))
                .collect(),
            "ball" => (0..3)
                .map(|k| {
                    let after = |drive: Drive| Drive {
                        coordinate: drive.coordinate + 2 - k,
                        ..drive
                    };
                    (true, Vector3::ith(2 - k, 1.0), drive(name).map(after))
                })
                .collect(),
            _ => Vec::new(),
        };
        joints.insert(words[3], (words[2], frame, parts));
    }
    let floats = robot.joints().iter().filter(|joint| joint.kind == MotionKind::Floating);
    let floats: BTreeSet<usize> = floats
        .filter_map(|joint| joint.drive)
        .flat_map(|drive| drive.coordinate..drive.coordinate + 6)
        .collect();
    let (mut rng, mut wrong, mut count) = (ChaCha8Rng::seed_from_u64(7), Vec::new(), 0);
    for _ in 0..1_000 {
        let mut q = robot.start().to_vec();
        for (k, coordinate) in robot
            .coordinates()
            .iter()
            .enumerate()
            .filter(|(k, _)| !floats.contains(k))
        {
            q[k] = rng.random_range(coordinate.limits[0].max(-1e3)..=coordinate.limits[1].min(1e3));
        }
        let found = placed(&q);
        for ((link, found), drawn) in bodies.iter().zip(&found).zip(&drawn) {
            // How the link moved from where the file draws it.
            let (mut moved, mut at) = (Isometry3::identity(), link.as_str());
            while let Some((parent, frame, parts)) = joints.get(at) {
                let mut motion = Isometry3::identity();
                for (turns, axis, drive) in parts {
                    let value = drive.map_or(0.0, |drive: Drive| drive.factor * q[drive.coordinate] + drive.offset);
                    motion *= match turns {
                        true => Isometry3::new(Vector3::zeros(), axis * value),
                        false => Isometry3::new(axis * value, Vector3::zeros()),
                    };
                }
                moved = frame * motion * frame.inverse() * moved;
                at = parent;
            }
            let expected = moved * drawn;
            let far = (found.to_homogeneous() - expected.to_homogeneous()).amax();
            count += 1;
            if !(far <= tolerance * (1.0 + expected.translation.vector.amax()) || wrong.len() > 3) {
                wrong.push(format!("{link} at {q:?}: {far:e} apart"));
            }
        }
    }
    (count, wrong)
}
