//! The clearance of an arm that moves through a cell: the closest pair of each frame.
//!
//! `cargo run --release -p lin-canny-robot --example clearance -- [--urdf FILE] [--cell X.obj ..] [--frames N] [--out FILE.svg]`

mod common;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use lin_canny::ConvexPolyhedron;
use lin_canny::nalgebra::Isometry3;
use lin_canny_robot::plan::{Cell, Checker, ConfigurationSpace, JointTree, NearPair};
use lin_canny_robot::{LoadOptions, Packages, Robot};
use race::plot::Chart;
use race::progress::Progress;
use truth::arm::{Trouble, cell, motion};
use truth::command::{count, file};

/// Find the closest pair per frame while an arm moves through a cell
///
/// Pairs are a link and the cell, or two links. Draws the frame of least clearance in three
/// dimensions, and the clearance over time. Ignores links that one or two joints connect, and pairs
/// that share a point in the first frame.
#[derive(Parser)]
struct Options {
    /// URDF of a robot that replaces the built-in arm, with the convex hulls of its collision
    /// geometry
    ///
    /// Every joint swings around the middle of its limits. `package://` paths are searched in
    /// ROS_PACKAGE_PATH.
    #[arg(long, value_name = "FILE")]
    urdf: Option<PathBuf>,
    /// Mesh files that replace the built-in cell by their hulls, in the world frame
    #[arg(long, value_name = "FILE", num_args = 1..)]
    cell: Vec<String>,
    /// Number of frames of the motion
    #[arg(long, value_name = "N", default_value_t = 1200, value_parser = count(1))]
    frames: usize,
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/clearance.svg", value_parser = file("svg"))]
    out: PathBuf,
}

/// The checker of the robot in its cell, without the pairs that share a point at a configuration.
fn checker(robot: &Robot, things: &[cell::Thing], start: &[f64]) -> Result<Checker<JointTree>, Trouble> {
    let mut setup = Cell::new();
    setup.add_robot("", robot, Isometry3::identity())?;
    setup.exclude_adjacent();
    for (name, shape, pose) in things {
        setup.add_obstacle(name, shape.clone(), *pose)?;
    }
    // Slender links reach over the next but one.
    for joint in robot.joints() {
        for next in robot.joints().iter().filter(|next| next.parent == joint.child) {
            setup.exclude(&robot.links()[joint.parent].name, &robot.links()[next.child].name)?;
        }
    }
    let mut all = Checker::of_robots(setup.clone())?;
    for near in all.nearest(start, f64::INFINITY)? {
        if near.lower <= 0.0 {
            println!("ignored, in contact from the start: {}", name(&all, &near));
            setup.exclude(all.name(near.pair.a), all.name(near.pair.b))?;
        }
    }
    Ok(Checker::of_robots(setup.clone())?)
}

fn name(checker: &Checker<JointTree>, near: &NearPair) -> String {
    format!("{} - {}", checker.name(near.pair.a), checker.name(near.pair.b))
}

/// A line for a pair that has become the closest.
fn tell(frame: usize, name: &str, near: &NearPair) {
    let error = 0.5 * (near.upper - near.lower);
    println!("{frame:>5}  {name:<24} {:>10.6} +- {error:.0e}", near.distance);
}

/// The clearance over time, and the pairs most often closest.
fn chart(closest: &[(f64, String)], title: &str) -> Chart {
    let curve = |pick: &dyn Fn(&str) -> bool| {
        let of = closest.iter().enumerate().filter(|(_, (_, name))| pick(name));
        of.map(|(k, (d, _))| (k as f64, *d)).collect::<Vec<_>>()
    };
    let mut chart = Chart::new(format!("{title}: distance of the closest pair"))
        .axes("frame", "distance, in the unit of the robot")
        .legend_beside()
        .from_zero()
        .size(860, 340)
        .line("other pairs", curve(&|_| true));
    let mut shares: BTreeMap<&str, usize> = BTreeMap::new();
    closest
        .iter()
        .for_each(|(_, name)| *shares.entry(name).or_default() += 1);
    let mut shares: Vec<_> = shares.into_iter().collect();
    shares.sort_by_key(|(name, count)| (std::cmp::Reverse(*count), *name));
    for (name, _) in shares.iter().take(5) {
        chart = chart.dots(*name, curve(&|n| n == *name));
    }
    chart
}

/// The robot and the cell at a configuration, the closest points of a pair joined.
fn picture(
    checker: &Checker<JointTree>,
    q: &[f64],
    near: &NearPair,
    caption: String,
    chart: &str,
) -> Result<String, Trouble> {
    let mut poses = vec![];
    checker.space().place(q, &mut poses);
    let cell = checker.cell();
    // Frames without bodies come last.
    poses.truncate(cell.robot_bodies().len());
    let links = cell
        .robot_bodies()
        .map(|(_, shape)| Ok((common::outline(shape)?, true)));
    let things = cell
        .obstacles()
        .map(|(_, shape, _)| Ok((common::outline(shape)?, false)));
    let shapes: Vec<(ConvexPolyhedron, bool)> = links.chain(things).collect::<Result<_, Trouble>>()?;
    poses.extend(cell.obstacles().map(|(_, _, pose)| *pose));
    let picture = common::Picture {
        caption,
        bodies: shapes.iter().map(|(shape, is_robot)| (shape, *is_robot)).collect(),
        poses,
        points: near.witnesses,
        cloud: vec![],
    };
    Ok(picture.above(chart))
}

fn main() -> ExitCode {
    truth::command::main(run)
}

fn run(options: &Options) -> Result<(), Trouble> {
    println!("drawing to {}", options.out.display());
    let (robot, title) = match &options.urdf {
        None => {
            let (text, load) = (include_str!("arm.urdf"), LoadOptions::default());
            let robot = Robot::parse(text, "arm.urdf", &Packages::default(), &load)?;
            (robot, "built-in arm".into())
        }
        Some(file) => {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            (
                Robot::load(file, &Packages::default().with_environment())?,
                name.into_owned(),
            )
        }
    };
    let limits: Vec<_> = robot.coordinates().iter().map(|c| c.limits).collect();
    let joints = |frame: usize| {
        let time = frame as f64 / options.frames.max(2) as f64;
        match options.urdf {
            None => motion::carry(time),
            Some(_) => motion::swing(&limits, time),
        }
    };
    let mut checker = checker(&robot, &cell::things(&options.cell)?, &joints(0))?;
    let bodies = checker.cell().robot_bodies().len() + checker.cell().obstacles().len();
    println!("{} joints, {bodies} bodies\n", limits.len());
    println!(
        "Frames in which another pair becomes the closest; a distance below zero is minus the depth of an overlap.\n"
    );
    println!("frame  {:<24} {:>10}", "closest pair", "distance");
    let progress = Progress::new("frames", options.frames as u64);
    let mut closest: Vec<(f64, String)> = Vec::new();
    let mut least: Option<(usize, NearPair)> = None;
    for frame in 0..options.frames {
        let near = checker
            .clearance(&joints(frame))?
            .ok_or("there is no pair to measure")?;
        let name = name(&checker, &near);
        if closest.last().is_none_or(|(_, last)| *last != name) {
            tell(frame, &name, &near);
        }
        closest.push((near.distance, name));
        if least.as_ref().is_none_or(|(_, l)| near.distance < l.distance) {
            least = Some((frame, near));
        }
        progress.step();
    }
    drop(progress);
    let (frame, near) = least.ok_or("there are no frames")?;
    let name = name(&checker, &near);
    println!("\nleast clearance:");
    tell(frame, &name, &near);
    let caption = format!("{title}, frame {frame}: {:.4}, {name}", near.distance);
    let chart = chart(&closest, &title).svg()?;
    truth::command::write(
        &options.out,
        &picture(&checker, &joints(frame), &near, caption, &chart)?,
    )?;
    Ok(())
}
