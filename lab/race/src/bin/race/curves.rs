//! Races proofs of curves: random Bezier curves of several degrees of robots with six to fourteen
//! joints. With `--data FOLDER` the robots that are in this folder race, too: those of the source
//! package vamp-planner (`resources`) or of the package example-robot-data (`robots`).
//!
//! `ours` certifies the curve, `straight` the straight segment with the same ends, and `bisect`
//! tests configurations of the curve: halving after halving, down to the step of MoveIt's default,
//! 0.5 % of the extent of the space. The predicates of `bisect` are those of the checker. A curve is
//! wrong if `bisect` reports it free and the checker finds it blocked or undecided. The columns `/m`
//! are times of `ours` and `bisect` for each metre of the path of the body that moves farthest, on
//! average over the free curves.

use std::hint::black_box;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use cpu_time::ThreadTime;
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny_plan::{
    Cell, Checker, ConfigurationSpace, Drive, JointCurve, JointKind, JointMotion, JointTree, TreeJoint, Verdict,
};
use lin_canny_robot::{ExcludeReason, RobotFiles, Srdf, find_excluded};
use race::common::{Options, Rows, median};
use truth::arm::chain::chain;
use truth::arm::{self, Trouble, robot};
use truth::rng::Rng;

pub(crate) const SCENES: [&str; 1] = ["certify"];

const DEGREES: [usize; 4] = [1, 3, 5, 7];

/// Number of places of a curve at which the path of a body is measured.
const PLACES: u32 = 64;

/// Random configurations of a robot of a folder; pairs that meet at all of them are not checked.
const SAMPLES: u64 = 1000;

/// How curves of a robot are drawn.
#[derive(Clone, Copy)]
struct Draw {
    /// Limit of a coordinate at which curves start.
    start: f64,
    /// Largest way of a joint in radians.
    way: f64,
}

/// Largest way as a part of the range of a joint: less than half of it, deviations included.
const SHARE: f64 = 0.3;

const DRAW: Draw = Draw { start: 1.5, way: 0.5 };

/// With more joints, of which some are always near their limits, most curves would be blocked.
const DRAW_BODY: Draw = Draw { start: 0.3, way: 0.1 };

/// Largest deviation of an inner control point from the straight segment, as a part of the way.
const WILD: f64 = 0.3;

/// Part of the extent of the space that `bisect` steps.
const STEP: f64 = 0.005;

/// Half the range of a joint of the built-in robots.
const LIMIT: f64 = 3.2;

/// A robot of a folder.
struct FolderRobot {
    name: &'static str,
    /// Paths below the folder, of which the first is taken that exists.
    files: [&'static str; 2],
    /// Path of an SRDF below the folder, whose pairs are excluded; else those that 1,000 samples find.
    srdf: Option<&'static str>,
    /// Distance of the twelve posts around it in metres, if it has posts.
    posts: Option<f64>,
    draw: Draw,
}

const FILES: [FolderRobot; 4] = [
    FolderRobot {
        name: "ur5",
        files: ["ur5/ur5.urdf", "ur_description/urdf/ur5_robot.urdf"],
        srdf: None,
        posts: Some(0.75),
        draw: DRAW,
    },
    FolderRobot {
        name: "panda",
        files: ["panda/panda.urdf", "panda_description/urdf/panda.urdf"],
        srdf: None,
        posts: Some(0.75),
        draw: DRAW,
    },
    FolderRobot {
        name: "solo12",
        files: ["solo12/solo12.urdf", "solo_description/robots/solo12.urdf"],
        srdf: None,
        posts: None,
        draw: DRAW,
    },
    FolderRobot {
        name: "talos",
        files: ["talos/talos.urdf", "talos_data/robots/talos_reduced.urdf"],
        // Samples exclude too few: its legs meet near the configuration of zeros.
        srdf: Some("talos_data/srdf/talos.srdf"),
        posts: Some(1.0),
        draw: DRAW_BODY,
    },
];

/// The joints of the arm, from a link and a coordinate on.
fn arm_joints(base: usize, first: usize) -> impl Iterator<Item = TreeJoint> {
    let joints = robot::JOINTS.into_iter().enumerate();
    joints.map(move |(k, (height, axis, _))| TreeJoint {
        parent: base + k,
        kind: JointKind::Revolute,
        origin: Isometry3::translation(0.0, 0.0, height),
        axis,
        drive: Some(Drive::by(first + k)),
    })
}

/// Two six-axis arms side by side, as one robot of twelve joints, without other obstacles.
fn two_arms() -> Result<(JointTree, Cell), Trouble> {
    let mut cell = Cell::new();
    let (mut joints, mut links) = (Vec::new(), Vec::new());
    for (side, x) in [("left", -0.35), ("right", 0.35)] {
        let base = joints.len() + 1;
        joints.push(TreeJoint::fixed(0, Isometry3::translation(x, 0.0, 0.0)));
        joints.extend(arm_joints(base, 6 * (base / 7)));
        for (name, link, shape) in robot::pieces()? {
            cell.robot_body(format!("{side} {name}"), shape);
            links.push(base + link);
        }
        for (k, name) in robot::NAMES.iter().enumerate() {
            for other in robot::NAMES.iter().skip(k + 1).take(2) {
                cell.exclude(&format!("{side} {name}"), &format!("{side} {other}"))?;
            }
        }
    }
    let radii = vec![0.15; joints.len() + 1];
    let space = JointTree::new(Isometry3::identity(), joints, vec![[-LIMIT, LIMIT]; 12], links, radii)?;
    Ok((space, cell))
}

/// The arm of the example `arm` in its cell.
pub(crate) fn arm_in_cell() -> Result<(JointTree, Cell), Trouble> {
    let (_, cell) = arm::in_cell()?;
    let links = robot::pieces()?.iter().map(|piece| piece.1).collect();
    let joints = arm_joints(0, 0).collect();
    let radii = vec![0.15; 7];
    let space = JointTree::new(Isometry3::identity(), joints, vec![[-LIMIT, LIMIT]; 6], links, radii)?;
    Ok((space, cell))
}

/// A curve with its verdict.
struct Proven {
    curve: JointCurve,
    verdict: Verdict,
}

fn random_curve(rng: &mut Rng, from: &[f64], degree: usize, most: &[f64]) -> JointCurve {
    let way: Vec<f64> = most.iter().map(|most| rng.range(-most, *most)).collect();
    let mut points = Vec::new();
    for j in 0..=degree {
        let x = j as f64 / degree as f64;
        let wild = if j == 0 || j == degree { 0.0 } else { WILD };
        let each = from.iter().zip(&way);
        let point: Vec<f64> = each.map(|(a, w)| a + w * (x + wild * rng.range(-1.0, 1.0))).collect();
        points.push(point);
    }
    JointCurve::bezier(&points).expect("a curve")
}

/// Returns whether all configurations of a curve at equal steps are free, the middle first.
fn bisect(checker: &mut Checker<JointTree>, curve: &JointCurve) -> bool {
    let points: Vec<Vec<f64>> = (0..=curve.degree()).map(|j| curve.control_point(j)).collect();
    let step = |ends: &[Vec<f64>]| -> f64 { ends[0].iter().zip(&ends[1]).map(|(a, b)| (b - a).abs()).sum() };
    let length: f64 = points.windows(2).map(step).sum();
    let extent: f64 = checker.space().bounds().iter().map(|[low, high]| high - low).sum();
    let mut count = 1u32;
    let mut is_free = |t: f64| checker.is_free_at(&curve.at(t)).expect("within limits");
    if !is_free(0.0) || !is_free(1.0) {
        return false;
    }
    while f64::from(count) * STEP * extent < length {
        count *= 2;
        if !(0..count / 2).all(|k| is_free(f64::from(2 * k + 1) / f64::from(count))) {
            return false;
        }
    }
    true
}

/// Returns the least of some times of each item, in nanoseconds.
fn times<T>(items: &[T], passes: usize, mut work: impl FnMut(&T)) -> Vec<f64> {
    let mut least = vec![f64::INFINITY; items.len()];
    for _ in 0..passes {
        for (item, least) in items.iter().zip(&mut least) {
            let began = ThreadTime::now();
            work(black_box(item));
            *least = least.min(began.elapsed().as_nanos() as f64);
        }
    }
    least
}

fn middle(mut times: Vec<f64>) -> f64 {
    if times.is_empty() { 0.0 } else { median(&mut times) }
}

/// Loads a robot, with posts around it.
fn from_file(robot: PathBuf, srdf: Option<PathBuf>, posts: Option<f64>) -> Result<(JointTree, Cell), Trouble> {
    let mut files = RobotFiles::new(robot);
    files.srdf = srdf;
    let mut cell = files.load()?.cell;
    if files.srdf.is_none() {
        let mut counts = find_excluded(&cell, SAMPLES, 1, &mut |_| ControlFlow::Continue(()))?;
        counts.retain(|pair| pair.reason != Some(ExcludeReason::Never));
        Srdf::from_counts(&counts).exclude_in(&mut cell, "")?;
    }
    if let Some(posts) = posts {
        truth::arm::chain::posts(&mut cell, posts)?;
    }
    Ok((cell.space()?, cell))
}

/// Returns the length of the path of the body that moves farthest along a curve.
fn path_length(space: &JointTree, curve: &JointCurve) -> f64 {
    let (mut poses, mut before): (_, Vec<Vector3<f64>>) = (Vec::new(), Vec::new());
    let mut lengths = vec![0.0; space.bodies()];
    for k in 0..=PLACES {
        space.place(&curve.at(f64::from(k) / f64::from(PLACES)), &mut poses);
        let places: Vec<Vector3<f64>> = poses.iter().map(|pose| pose.translation.vector).collect();
        for (length, (now, before)) in lengths.iter_mut().zip(places.iter().zip(&before)) {
            *length += (now - before).norm();
        }
        before = places;
    }
    lengths.into_iter().fold(0.0, f64::max)
}

pub(crate) fn run(o: &Options, data: Option<&Path>) -> Result<Rows, String> {
    let mut rows = Rows::default();
    let mut robots = vec![
        ("six-axes", arm_in_cell(), DRAW),
        ("chain-6", chain(6, [-LIMIT, LIMIT]), DRAW),
        ("chain-14", chain(14, [-LIMIT, LIMIT]), DRAW),
        ("two-arms", two_arms(), DRAW),
    ];
    if let Some(folder) = data {
        let of_folder = FILES.iter().filter_map(|robot| {
            let file = robot
                .files
                .iter()
                .map(|file| folder.join(file))
                .find(|file| file.is_file())?;
            let srdf = robot.srdf.map(|srdf| folder.join(srdf)).filter(|file| file.is_file());
            Some((robot.name, from_file(file, srdf, robot.posts), robot.draw))
        });
        let before = robots.len();
        robots.extend(of_folder);
        if robots.len() == before {
            return Err(format!("--data: no robot in {}", folder.display()));
        }
    }
    println!("median us of free curves, queries of one on average; curves that `bisect` wrongly reports free");
    println!("  robot      degree  free  ours  queries  straight  queries  bisect  wrong  ours/m  bisect/m");
    for (name, robot, draw) in robots {
        let (space, cell) = robot.map_err(|error| format!("robot {name}: {error}"))?;
        let mut checker = Checker::new(space, cell).map_err(|error| format!("robot {name}: {error}"))?;
        for degree in DEGREES {
            certify(o, (name, degree), draw, &mut checker, &mut rows);
        }
    }
    Ok(rows)
}

/// Returns the ends between which the coordinate of a curve starts, so that the curve keeps its
/// limits.
fn starts([low, high]: [f64; 2], start: f64, way: f64) -> [f64; 2] {
    let reach = (1.0 + WILD) * way;
    let ends = [(low + reach).max(-start), (high - reach).min(start)];
    // Limits beyond the usual starts, as those of an elbow that bends to one side.
    if ends[0] <= ends[1] {
        ends
    } else {
        [0.5 * (low + high); 2]
    }
}

fn certify(o: &Options, (name, degree): (&str, usize), draw: Draw, checker: &mut Checker<JointTree>, rows: &mut Rows) {
    let (count, passes) = if o.quick { (60, 2) } else { (1000, 3) };
    let limits = checker.space().bounds();
    // Fingers slide by less than the way of a joint.
    let share = |[low, high]: &[f64; 2]| draw.way.min(SHARE * (high - low));
    let ways: Vec<f64> = limits.iter().map(share).collect();
    let each = limits.iter().zip(&ways);
    let ends: Vec<[f64; 2]> = each.map(|(limits, way)| starts(*limits, draw.start, *way)).collect();
    let mut rng = Rng::new(1);
    let mut all = Vec::new();
    while all.len() < count {
        let from: Vec<f64> = ends.iter().map(|[low, high]| rng.range(*low, *high)).collect();
        if checker.is_free_at(&from).expect("within limits") {
            let curve = random_curve(&mut rng, &from, degree, &ways);
            let verdict = checker.certify(&JointMotion::curve(&curve)).expect("within limits");
            all.push(Proven { curve, verdict });
        }
    }
    let wrong = all.iter().filter(|one| !one.verdict.is_free());
    let wrong = wrong.filter(|one| bisect(checker, &one.curve)).count();
    all.retain(|one| one.verdict.is_free());
    let ends = |one: &Proven| [0, degree].map(|j| one.curve.control_point(j));
    let segments: Vec<[Vec<f64>; 2]> = all.iter().map(ends).collect();
    let mut queries = |work: &mut dyn FnMut(&mut Checker<JointTree>)| {
        let before = checker.work().queries;
        work(checker);
        (checker.work().queries - before) as f64 / all.len().max(1) as f64
    };
    let of_curves = queries(&mut |checker| {
        for one in &all {
            let _ = black_box(checker.certify(&JointMotion::curve(&one.curve)));
        }
    });
    let of_segments = queries(&mut |checker| {
        for [from, to] in &segments {
            let _ = black_box(checker.certify(&JointMotion::segment(from, to)));
        }
    });
    let metres: f64 = all.iter().map(|one| path_length(checker.space(), &one.curve)).sum();
    let ours = times(&all, passes, |one| {
        _ = black_box(checker.certify(&JointMotion::curve(&one.curve)))
    });
    let straight = times(&segments, passes, |[from, to]| {
        _ = black_box(checker.certify(&JointMotion::segment(from, to)))
    });
    let bisected = times(&all, passes, |one| _ = black_box(bisect(checker, &one.curve)));
    let by_metre = |times: &[f64]| times.iter().sum::<f64>() / metres / 1e3;
    let by_metre = [&ours, &bisected].map(|times| by_metre(times));
    let [ours, straight, bisected] = [ours, straight, bisected].map(middle);
    println!(
        "  {name:<10}{degree:>7}{:>6}{:>6.0}{of_curves:>9.2}{:>10.0}{of_segments:>9.2}{:>8.0}{wrong:>7}{:>8.0}{:>10.0}",
        all.len(),
        ours / 1e3,
        straight / 1e3,
        bisected / 1e3,
        by_metre[0],
        by_metre[1],
    );
    for (engine, ns) in [("ours", ours), ("straight", straight), ("bisect", bisected)] {
        rows.push((SCENES[0], name, degree), engine, ns, 0);
    }
}
