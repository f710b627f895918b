//! Plans a path of a six-axis arm from bin to bin: proven free, shortened, and widened.
//!
//! `cargo run --release -p lin-canny-robot --example arm -- [--cell X.obj ..] [--seed N] [--out FILE.svg]`

mod common;

use clap::Parser;
use lin_canny::ConvexPolyhedron;
use lin_canny::Progress;
use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny_robot::plan::{
    Cell, Checker, ConfigurationSpace, JointMotion, JointTree, PlanOptions, RrtConnect, Shortcuts, widen,
};
use lin_canny_robot::{LoadOptions, Packages, Robot};
use race::plot::Chart;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use truth::arm::{Trouble, cell, motion};
use truth::command::{file, seconds};

/// Plan how a six-axis arm moves its gripper from the left bin to the right bin
///
/// Searches for a path with RRT-Connect, shortens it and moves it away from the cell.
/// Draws the arm at both ends and at the least clearance, and the clearance along the path.
#[derive(Parser)]
struct Options {
    /// Random seed
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Time limit of the search in seconds
    #[arg(long, value_name = "S", default_value = "10", value_parser = seconds)]
    seconds: Duration,
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/arm.svg", value_parser = file("svg"))]
    out: PathBuf,
    /// Mesh files that replace the built-in cell by their hulls, in the world frame
    #[arg(long, value_name = "FILE", num_args = 1..)]
    cell: Vec<String>,
}

fn main() -> ExitCode {
    truth::command::main(run)
}

/// Times of the built-in motion of `clearance` at which the gripper is in the left and in the right
/// bin.
const BINS: [f64; 2] = [0.2, 0.6];

/// Places measured for the chart.
const PLACES: usize = 400;

fn run(options: &Options) -> Result<(), Trouble> {
    let things = cell::things(&options.cell)?;
    let (text, load) = (include_str!("arm.urdf"), LoadOptions::default());
    let arm = Robot::parse(text, "arm.urdf", &Packages::default(), &load)?;
    let mut setup = Cell::new();
    setup.add_robot("", &arm, Isometry3::identity())?;
    setup.exclude_adjacent();
    for (name, shape, pose) in &things {
        setup.add_obstacle(name, shape.clone(), *pose)?;
    }
    // The arm is mounted on the table, and its slender links extend over the next link but one.
    if things.iter().any(|thing| thing.0 == "table") {
        setup.exclude("base", "table")?;
    }
    for pair in arm.links().windows(3) {
        setup.exclude(&pair[0].name, &pair[2].name)?;
    }
    let mut checker = Checker::of_robots(setup.clone())?;
    let [start, goal] = BINS.map(motion::carry);
    let search = PlanOptions::default().seed(options.seed).unlimited();
    let began = Instant::now();
    let plan = RrtConnect::new(&search)
        .progress(&mut |_| Progress::stop_if(began.elapsed() > options.seconds))
        .plan(&mut checker, &start, &goal)?;
    let (took, work) = (began.elapsed(), plan.work);
    println!(
        "{took:.2?}: {} samples, {} configurations, {} distance queries",
        work.samples,
        plan.roadmap.nodes.len(),
        work.checks.queries + work.checks.measures
    );
    let Some(found) = plan.path else {
        return Err("no path found: there may be one nevertheless".into());
    };
    let short = Shortcuts::new(300, options.seed).shorten(&mut checker, &found)?;
    let wide = widen(&mut checker, &short, 0.05, 0.15, 6)?;
    let least = checker.clearance_along(&JointMotion::path(&wide)?, 0.05)?.lower;
    println!(
        "path: length {:.2}; shortened to {:.2}, widened to {:.2}; proven clearance {least:.4}",
        checker.space().path_length(&found),
        checker.space().path_length(&short),
        checker.space().path_length(&wide)
    );
    let before = clearances(&mut checker, &short)?;
    let after = clearances(&mut checker, &wide)?;
    let chart = Chart::new("Clearance along the path")
        .axes("part of the path", "distance of the closest pair")
        .from_zero()
        .size(860, 320)
        .line("shortened", before)
        .line("widened", after);
    let text = picture(&mut checker, &things, &wide, &chart.svg()?)?;
    truth::command::write(&options.out, &text)?;
    println!("drawn to {}", options.out.display());
    Ok(())
}

/// Configurations along a path, evenly in length.
fn along(checker: &Checker<JointTree>, path: &[Vec<f64>], count: usize) -> Vec<Vec<f64>> {
    let whole = checker.space().path_length(path);
    let (mut list, mut gone) = (vec![], 0.0);
    for ends in path.windows(2) {
        let length = checker.space().distance(&ends[0], &ends[1]);
        while list.len() <= count && whole * list.len() as f64 / count as f64 <= gone + length {
            let t = (whole * list.len() as f64 / count as f64 - gone) / length.max(f64::MIN_POSITIVE);
            list.push(checker.space().between(&ends[0], &ends[1], t.clamp(0.0, 1.0)));
        }
        gone += length;
    }
    list
}

fn clearances(checker: &mut Checker<JointTree>, path: &[Vec<f64>]) -> Result<Vec<(f64, f64)>, Trouble> {
    let places = along(checker, path, PLACES);
    let last = places.len().max(2) as f64 - 1.0;
    let mut curve = vec![];
    for (k, q) in places.iter().enumerate() {
        if let Some(near) = checker.clearance(q)? {
            curve.push((k as f64 / last, near.distance));
        }
    }
    Ok(curve)
}

/// The cell, the arm at both ends and where the clearance is least, and the points that are
/// closest there.
fn picture(
    checker: &mut Checker<JointTree>,
    things: &[cell::Thing],
    path: &[Vec<f64>],
    chart: &str,
) -> Result<String, Trouble> {
    let places = along(checker, path, PLACES);
    let mut nearest: Option<(f64, [Point3<f64>; 2], String, usize)> = None;
    for (k, q) in places.iter().enumerate() {
        let near = checker.clearance(q)?.ok_or("there is no pair to measure")?;
        if nearest.as_ref().is_none_or(|n| near.distance < n.0) {
            let name = format!("{} - {}", checker.name(near.pair.a), checker.name(near.pair.b));
            nearest = Some((near.distance, near.witnesses, name, k));
        }
    }
    let (distance, points, name, at) = nearest.ok_or("the path is empty")?;
    let mut bodies: Vec<_> = things.iter().map(|(_, shape, _)| (shape, false)).collect();
    let mut poses: Vec<_> = things.iter().map(|(_, _, pose)| *pose).collect();
    let links = checker.cell().robot_bodies().map(|(_, shape)| common::outline(shape));
    let shapes: Vec<ConvexPolyhedron> = links.collect::<Result<_, Trouble>>()?;
    let mut placed: Vec<Isometry3<f64>> = vec![];
    for q in [&path[0], &places[at], &path[path.len() - 1]] {
        checker.space().place(q, &mut placed);
        for (shape, pose) in shapes.iter().zip(&placed) {
            bodies.push((shape, true));
            poses.push(*pose);
        }
    }
    let caption = format!("Six axes from bin to bin; at the red line {distance:.4} between {name}");
    let picture = common::Picture {
        caption,
        bodies,
        poses,
        points,
        cloud: vec![],
    };
    Ok(picture.above(chart))
}
