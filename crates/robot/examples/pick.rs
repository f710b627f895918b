//! A six-axis arm takes a part from a tray under a scanned hood, carries it past a post, and puts it down.
//!
//! `cargo run --release -p lin-canny-robot --example pick -- [--points N] [--seed N] [--out FILE.jsonl] [--picture FILE.svg]`

mod common;

use std::f64::consts::{FRAC_PI_2, PI};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Parser;
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Cloud, CloudElement, Geometry, HalfSpace, Mesh, Progress, Shape};
use lin_canny_robot::plan::{
    Checker, ConfigurationSpace, JointMotion, JointTree, NearPair, PlanOptions, RrtConnect, Shortcuts, Verdict, widen,
};
use lin_canny_robot::{LoadedCell, RobotFiles, RobotRecorder, record};
use truth::arm::Trouble;
use truth::command::{count, file};
use truth::rng::Rng;

/// Plan how a six-axis arm takes a part from a tray and puts it down behind a post
///
/// A hood over the tray is known only as a cloud of points with noise. Every motion is proven free:
/// of the arm, and of the part in its gripper. Writes a recording, and draws the arm
/// where the part is closest to the post.
#[derive(Parser)]
struct Options {
    /// Number of points of the cloud
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = count(1))]
    points: usize,
    /// Random seed
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Output recording
    #[arg(long, value_name = "FILE.jsonl", default_value = "target/pick.jsonl", value_parser = file("jsonl"))]
    out: PathBuf,
    /// Output page: the recording as one HTML file, for any browser with WebGL 2
    #[arg(long, value_name = "FILE.html", value_parser = file("html"))]
    page: Option<PathBuf>,
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/pick.svg", value_parser = file("svg"))]
    picture: PathBuf,
}

/// Half the size of the part in metres.
const PART: [f64; 3] = [0.03, 0.03, 0.06];

/// Where the part is on the bottom of the tray, and where it is put on the table.
const TAKEN: [f64; 3] = [0.6, 0.35, 0.31];
const PUT: [f64; 3] = [0.6, -0.35, 0.3];

/// How far the part is lifted.
const LIFT: f64 = 0.1;

/// Pairs in contact at the start of a motion, such as part and tray, are accepted within this
/// distance.
const START: f64 = 0.002;

/// Half the extent of noise of the scan, and the radius of its points.
const NOISE: f64 = 0.0015;
const RADIUS: f64 = 0.004;

fn main() -> ExitCode {
    truth::command::main(run)
}

fn run(options: &Options) -> Result<(), Trouble> {
    let began = Instant::now();
    let hood = scan(options.points, options.seed)?;
    println!(
        "hood: {} points of radius {RADIUS} m, scanned and built in {:.1?}",
        options.points,
        began.elapsed()
    );
    let mut checker = cell(hood)?;
    checker.cell_mut().pad("post", 0.01)?;

    let home = [-0.6, -0.6, 2.2, 0.0, PI - 1.6, 0.0];
    let taken = upwards(TAKEN);
    let put = upwards(PUT);
    truth::command::writable(&options.out)?;
    let mut film = Film {
        to: RobotRecorder::create(&options.out, &checker, &home)?,
        last: None,
    };

    let reach = planned(&mut checker, "reach", &home, &taken[LAST], options.seed)?;
    film.show(&mut checker, "reach", &reach)?;
    // The gripper meets the part at the end of its way down, so the proof is that of the way up.
    proven(&mut checker, "lower", &taken)?;
    film.show(&mut checker, "lower", &reversed(&taken))?;

    let part = checker.cell().select("part")?[0];
    let pose = *checker.cell().obstacle_pose(part).ok_or("no part")?;
    let shape = checker.cell().geometry(part).ok_or("no part")?.clone();
    let grip = checker.link_pose("gripper", &taken[0])?.inverse() * pose;
    checker.cell_mut().remove_obstacle(part)?;
    checker
        .cell_mut()
        .attach("gripper", "part", shape, grip, &["gripper"])?;

    proven(&mut checker, "lift", &taken)?;
    film.show(&mut checker, "lift", &taken)?;
    let straight = checker.certify(&JointMotion::segment(&taken[LAST], &put[LAST]))?;
    if let Verdict::Blocked {
        contact_at: t, pair, ..
    } = &straight
    {
        println!(
            "straight from tray to table: {} meet at {t:.3} of the way",
            checker.show(pair)
        );
    }
    let carry = planned(&mut checker, "carry", &taken[LAST], &put[LAST], options.seed)?;
    film.show(&mut checker, "carry", &carry)?;
    let svg = picture(&mut checker, &carry)?;
    truth::command::write(&options.picture, &svg)?;
    proven(&mut checker, "put down", &put)?;
    film.show(&mut checker, "put down", &reversed(&put))?;

    checker.detach_at("part", &put[0])?;
    proven(&mut checker, "leave", &put)?;
    film.show(&mut checker, "leave", &put)?;
    film.to.finish()?;
    if let Some(page) = &options.page {
        let recording = record::Recording::open(&options.out)?;
        truth::command::write(page, &record::page(&recording, &record::PageOptions::default()))?;
    }
    println!(
        "recorded to {}, drawn to {}, in {:.1?}",
        options.out.display(),
        options.picture.display(),
        began.elapsed()
    );
    Ok(())
}

/// The arm in its cell: a floor, a table, a tray with the part, a post, and the hood.
fn cell(hood: Cloud) -> Result<Checker<JointTree>, Trouble> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/examples");
    let mut files = RobotFiles::new(format!("{folder}/six_axis.urdf"));
    files.srdf = Some(format!("{folder}/six_axis.srdf").into());
    let LoadedCell { cell: mut setup, .. } = files.load()?;
    let mut block = |name: &str, [x, y, z]: [f64; 3], at: [f64; 3]| -> Result<(), Trouble> {
        let body = solids::cuboid(Vector3::new(x, y, z) * 0.5)?;
        setup.add_obstacle(name, body, Isometry3::translation(at[0], at[1], at[2]))?;
        Ok(())
    };
    block("table", [0.5, 1.2, 0.04], [0.65, 0.0, 0.28])?;
    let [x, y, bottom] = TAKEN;
    block("tray", [0.24, 0.24, 0.01], [x, y, bottom - 0.005])?;
    for (side, walls) in [(-0.115, ["near", "right"]), (0.115, ["far", "left"])] {
        let [across, along] = walls.map(|wall| format!("{wall} wall of the tray"));
        block(&across, [0.01, 0.24, 0.05], [x + side, y, bottom + 0.025])?;
        block(&along, [0.22, 0.01, 0.05], [x, y + side, bottom + 0.025])?;
    }
    block("part", PART.map(|half| 2.0 * half), [x, y, bottom + PART[2]])?;
    setup.add_obstacle(
        "post",
        Shape::cylinder(0.22, 0.025)?,
        Isometry3::translation(0.66, 0.0, 0.52),
    )?;
    setup.add_obstacle("floor", HalfSpace::new(Vector3::z(), 0.0)?, Isometry3::identity())?;
    setup.add_obstacle("hood", Geometry::from(hood), Isometry3::identity())?;
    // The arm is mounted on the floor.
    setup.exclude("base", "floor")?;
    Ok(Checker::of_robots(setup.clone())?)
}

/// Points on the surface of a hood over the tray, with noise, as a depth camera measures them.
fn scan(count: usize, seed: u64) -> Result<Cloud, Trouble> {
    const CELLS: usize = 32;
    let [width, depth] = [0.56, 0.6];
    let spacing = [width, depth].map(|length| length / CELLS as f64);
    let height = |k: usize| {
        let [x, y] = [k % (CELLS + 1), k / (CELLS + 1)].map(|n| n as f64 / CELLS as f64);
        // Level over the tray, and round down to the table behind it.
        let round = ((y - 0.55) / 0.45).max(0.0);
        let ripple = 0.012 * (PI * 5.0 * x).sin() * (PI * 4.0 * y).cos();
        0.36 + 0.56 * (1.0 - round * round).sqrt() + ripple
    };
    let heights: Vec<f64> = (0..(CELLS + 1) * (CELLS + 1)).map(height).collect();
    let hood = Mesh::from_heights(CELLS + 1, CELLS + 1, spacing, &heights, None)?;
    let triangles: Vec<[Point3<f64>; 3]> = hood.triangles().map(|(_, corners)| corners).collect();
    // Evenly in area.
    let mut areas = Vec::new();
    let mut whole = 0.0;
    for [p, q, r] in &triangles {
        whole += (q - p).cross(&(r - p)).norm();
        areas.push(whole);
    }
    let (mut rng, corner) = (Rng::new(seed), Vector3::new(0.34, 0.06, 0.0));
    let mut point = || {
        let area = rng.range(0.0, whole);
        let [p, q, r] = triangles[areas.partition_point(|sum| *sum < area).min(areas.len() - 1)];
        let [mut u, mut v] = [rng.range(0.0, 1.0), rng.range(0.0, 1.0)];
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let noise = Vector3::from_fn(|_, _| rng.range(-NOISE, NOISE));
        let place = p + (q - p) * u + (r - p) * v + corner + noise;
        // The camera counts tenths of a millimetre.
        [place.x, place.y, place.z].map(|x| ((x * 1e4).round() / 1e4) as f32)
    };
    let points: Vec<[f32; 3]> = (0..count).map(|_| point()).collect();
    Ok(Cloud::from_f32(&points, CloudElement::Ball(RADIUS))?)
}

/// Number of segments of a way up, and the index of its end.
const LAST: usize = 6;

/// Configurations that lift the gripper straight up from the top of a part at a position.
fn upwards([x, y, z]: [f64; 3]) -> Vec<Vec<f64>> {
    let top = z + 2.0 * PART[2];
    (0..=LAST)
        .map(|k| over([x, y, top + LIFT * k as f64 / LAST as f64]))
        .collect()
}

/// The configuration in which the gripper points down and its tip is at a place: elbow above.
fn over([x, y, z]: [f64; 3]) -> Vec<f64> {
    // Of the arm: the height of the shoulder, both links, and the gripper below the bend.
    let (shoulder, upper, fore, hand) = (0.32, 0.45, 0.55, 0.23);
    let (far, high) = (x.hypot(y), z + hand - shoulder);
    let way = far.hypot(high);
    let inner = ((upper * upper + way * way - fore * fore) / (2.0 * upper * way)).acos();
    let lift = FRAC_PI_2 - high.atan2(far) - inner;
    let elbow = PI - ((upper * upper + fore * fore - way * way) / (2.0 * upper * fore)).acos();
    vec![y.atan2(x), lift, elbow, 0.0, PI - lift - elbow, 0.0]
}

fn reversed(path: &[Vec<f64>]) -> Vec<Vec<f64>> {
    path.iter().rev().cloned().collect()
}

/// Proves a way up, which starts in contact.
fn proven(checker: &mut Checker<JointTree>, what: &str, path: &[Vec<f64>]) -> Result<(), Trouble> {
    let began = Instant::now();
    checker.set_start_contact_margin(Some(START))?;
    let mut touching = Vec::new();
    for ends in path.windows(2) {
        let verdict = checker.certify(&JointMotion::segment(&ends[0], &ends[1]))?;
        let Verdict::Free { start_contacts, .. } = &verdict else {
            return Err(format!("{what}: {}", checker.show(&verdict)).into());
        };
        touching.extend(
            start_contacts
                .iter()
                .map(|leaving| checker.show(&leaving.pair).to_string()),
        );
    }
    checker.set_start_contact_margin(None)?;
    touching.dedup();
    println!(
        "{what}: proven free in {:.1?}; in contact at its low end: {}",
        began.elapsed(),
        touching.join(", ")
    );
    Ok(())
}

/// Searches for a path, of which the shortest is taken: random trees find any of the ways around.
const SEARCHES: u64 = 8;

/// Plans a path, shortens it and moves it away from the cell; every segment is proven free.
fn planned(
    checker: &mut Checker<JointTree>,
    what: &str,
    from: &[f64],
    to: &[f64],
    seed: u64,
) -> Result<Vec<Vec<f64>>, Trouble> {
    let began = Instant::now();
    let limit = Duration::from_secs(40);
    let mut shortest: Option<(f64, Vec<Vec<f64>>)> = None;
    for seed in (0..SEARCHES).map(|k| seed.wrapping_add(k)) {
        let options = PlanOptions::default().seed(seed).unlimited();
        let plan = RrtConnect::new(&options)
            .progress(&mut |_| Progress::stop_if(began.elapsed() > limit))
            .plan(checker, from, to)?;
        let Some(path) = plan.path else { break };
        let path = Shortcuts::new(200, seed).shorten(checker, &path)?;
        let length = checker.space().path_length(&path);
        if shortest.as_ref().is_none_or(|(least, _)| length < *least) {
            shortest = Some((length, path));
        }
    }
    let (_, path) = shortest.ok_or(format!("{what}: no path found in {limit:.0?}"))?;
    let path = widen(checker, &path, 0.03, 0.2, 4)?;
    let motion = JointMotion::path(&path)?;
    let verdict = checker.certify(&motion)?;
    if !verdict.is_free() {
        return Err(format!("{what}: {}", checker.show(&verdict)).into());
    }
    let least = checker.clearance_along(&motion, 0.05)?.lower;
    let length = checker.space().path_length(&path);
    println!(
        "{what}: {} segments, {length:.2} rad, proven free in {:.1?}; all pairs at least {least:.4} m apart",
        path.len() - 1,
        began.elapsed()
    );
    Ok(path)
}

/// Points of the cloud that the picture shows.
const DOTS: usize = 6000;

/// The arm in its cell where the part is closest to the post, and the part at both ends of the path.
fn picture(checker: &mut Checker<JointTree>, path: &[Vec<f64>]) -> Result<String, Trouble> {
    let names = [checker.cell().select("part")?[0], checker.cell().select("post")?[0]];
    let mut nearest: Option<(NearPair, Vec<f64>)> = None;
    for ends in path.windows(2) {
        for k in 0..=40 {
            let q = checker.space().between(&ends[0], &ends[1], f64::from(k) / 40.0);
            let all = checker.nearest(&q, f64::INFINITY)?;
            let near = all.into_iter().find(|near| [near.pair.a, near.pair.b] == names);
            let near = near.ok_or("part and post are no pair")?;
            if nearest.as_ref().is_none_or(|(least, _)| near.distance < least.distance) {
                nearest = Some((near, q));
            }
        }
    }
    let (near, q) = nearest.ok_or("the path is empty")?;
    let (mut shapes, mut poses, mut cloud) = (vec![], vec![], vec![]);
    let cell = checker.cell();
    for (id, name) in cell.bodies() {
        match cell.geometry(id).ok_or("no geometry")? {
            Geometry::Cloud(hood) => cloud = hood.points(),
            Geometry::HalfSpace(_) => {}
            geometry => {
                let is_moving = cell.obstacle_pose(id).is_none();
                let outline = common::outline(geometry)?;
                if name == "part" {
                    for end in [&path[0], &path[path.len() - 1]] {
                        shapes.push((outline.clone(), false));
                        poses.push(checker.pose(id, end)?);
                    }
                }
                shapes.push((outline, is_moving));
                poses.push(checker.pose(id, &q)?);
            }
        }
    }
    let step = cloud.len().div_ceil(DOTS).max(1);
    let picture = common::Picture {
        caption: format!(
            "A part is carried from a tray to the table: {:.3} m from the post",
            near.distance
        ),
        bodies: shapes.iter().map(|(shape, is_moving)| (shape, *is_moving)).collect(),
        poses,
        points: near.witnesses,
        cloud: cloud.into_iter().step_by(step).collect(),
    };
    Ok(picture.alone())
}

/// Radians between two frames.
const STEP: f64 = 0.04;

/// The recording, and the last configuration that it shows.
struct Film {
    to: RobotRecorder,
    last: Option<Vec<f64>>,
}

impl Film {
    fn show(&mut self, checker: &mut Checker<JointTree>, what: &str, path: &[Vec<f64>]) -> Result<(), Trouble> {
        for ends in path.windows(2) {
            let steps = (checker.space().distance(&ends[0], &ends[1]) / STEP).ceil().max(1.0);
            for k in 0..=steps as usize {
                let q = checker.space().between(&ends[0], &ends[1], k as f64 / steps);
                if self.last.as_ref() == Some(&q) {
                    continue;
                }
                let near = checker.clearance(&q)?.ok_or("there is no pair to measure")?;
                self.to.frame(checker, &q, what, &near)?;
                self.last = Some(q);
            }
        }
        Ok(())
    }
}
