//! The clearance of a robot: an arm of convex links moves through a cell; for every frame the closest pair, of the arm with
//! the cell and of the arm with itself.
//!
//! `cargo run --release -p lin-canny-robot --example clearance -- [--urdf FILE] [--cell X.obj ..] [--frames N] [--out FILE.svg]`

mod robot;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use lab::arm::{Trouble, cell, draw, motion};
use lab::command::{count, file};
use lab::plot::Chart;
use lab::progress::Progress;
use lin_canny::ConvexPolyhedron;
use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::scene::{Body, BodyId, ClosestPair, Effects, Group, Scene};
use robot::Robot;

const ARM: Group = Group::new(1).unwrap();
const CELL: Group = Group::new(2).unwrap();

/// An arm moves through a cell: the closest pair per frame, of the arm with the cell and of the arm with
/// itself
///
/// Draws the frame of least clearance in three dimensions, and the clearance over time. Links that one
/// or two joints connect, and pairs that share a point in the first frame, are ignored.
#[derive(Parser)]
struct Options {
    /// A robot instead of the built-in arm: its joints, and the convex hulls of its collision geometry
    ///
    /// Every joint swings about the middle of its limits. Meshes must be OBJ or STL files.
    #[arg(long, value_name = "FILE")]
    urdf: Option<PathBuf>,
    /// Meshes instead of the built-in cell, by their hulls, in the frame of the world
    #[arg(long, value_name = "FILE", num_args = 1..)]
    cell: Vec<String>,
    /// Frames of the motion
    #[arg(long, value_name = "N", default_value_t = 1200, value_parser = count(1))]
    frames: usize,
    /// Where to draw
    #[arg(long, value_name = "FILE.svg", default_value = "target/clearance.svg", value_parser = file("svg"))]
    out: PathBuf,
}

/// A body to draw: its name, its shape, and the link that moves it.
struct Part {
    id: BodyId,
    name: String,
    shape: ConvexPolyhedron,
    link: Option<usize>,
}

/// The scene, the robot, and what the bodies are; the user data of a body is its number among the parts.
struct Stage {
    scene: Scene,
    robot: Robot,
    parts: Vec<Part>,
}

impl Stage {
    fn new(robot: Robot, cell: Vec<cell::Thing>, start: &[f64]) -> Result<Self, Trouble> {
        let mut scene = Scene::new();
        // Boxes alone: the closest pair is asked for in each frame, nothing else is computed.
        let boxes = Effects::none().boxes(true);
        scene.call_for(ARM, CELL, boxes)?;
        scene.call_for(ARM, ARM, boxes)?;
        let mut parts = Vec::new();
        let mut add = |scene: &mut Scene, name: &str, shape: ConvexPolyhedron, pose, link: Option<usize>| {
            let body = match link {
                Some(_) => Body::moving(shape.clone()).group(ARM),
                None => Body::fixed(shape.clone()).group(CELL),
            };
            let id = scene.insert(body.user_data(parts.len() as u64), pose)?;
            let name = name.to_owned();
            parts.push(Part { id, name, shape, link });
            Ok::<(), Trouble>(())
        };
        let poses = robot.poses(start);
        for (k, link) in robot.links.iter().enumerate() {
            for piece in &link.pieces {
                add(&mut scene, &link.name, piece.clone(), poses[k], Some(k))?;
            }
        }
        for (name, shape, pose) in cell {
            add(&mut scene, &name, shape, pose, None)?;
        }
        let mut stage = Self { scene, robot, parts };
        stage.ignore_what_touches()?;
        Ok(stage)
    }

    /// Ignores pieces of one link, of links that one or two joints connect, and all pairs that share a point in the first frame.
    fn ignore_what_touches(&mut self) -> Result<(), Trouble> {
        for (k, p) in self.parts.iter().enumerate() {
            for q in &self.parts[..k] {
                let (Some(i), Some(j)) = (p.link, q.link) else { continue };
                if i == j || self.robot.are_close(i, j) {
                    self.scene.ignore_pair(p.id, q.id)?;
                }
            }
        }
        self.scene.step();
        let mut touching = self.scene.pairs_within(ARM, CELL, 0.0)?;
        touching.extend(self.scene.pairs_within(ARM, ARM, 0.0)?);
        for near in &touching {
            println!("ignored, in contact from the start: {}", self.name(near));
            self.scene.ignore_pair(near.a, near.b)?;
        }
        Ok(())
    }

    /// Moves the arm, and returns the closest pair.
    fn step(&mut self, joints: &[f64]) -> Result<Option<ClosestPair>, Trouble> {
        let poses = self.robot.poses(joints);
        for part in &self.parts {
            if let Some(link) = part.link {
                self.scene.set_pose(part.id, poses[link])?;
            }
        }
        self.scene.step();
        let both = [self.scene.closest_pair(ARM, CELL)?, self.scene.closest_pair(ARM, ARM)?];
        let found = both.into_iter().flatten();
        Ok(found.min_by(|x, y| x.outcome.distance.total_cmp(&y.outcome.distance)))
    }

    fn name(&self, near: &ClosestPair) -> String {
        let part = |id| self.scene.user_data(id).and_then(|k| self.parts.get(k as usize));
        let [a, b] = [near.a, near.b].map(|id| part(id).map_or("?", |p| &p.name));
        format!("{a} - {b}")
    }

    /// The bodies at their poses, and the witness points of a pair in the world.
    fn snapshot(&self, near: &ClosestPair) -> (Vec<Isometry3<f64>>, [Point3<f64>; 2]) {
        let pose = |id| self.scene.pose(id).copied().unwrap_or_default();
        let points = [
            pose(near.a) * near.outcome.point_on_a,
            pose(near.b) * near.outcome.point_on_b,
        ];
        (self.parts.iter().map(|p| pose(p.id)).collect(), points)
    }
}

/// A line for a pair that has become the closest.
fn tell(frame: usize, name: &str, near: &ClosestPair) {
    let outcome = &near.outcome;
    println!(
        "{frame:>5}  {name:<24} {:>10.6} +- {:.0e}  {}",
        outcome.distance,
        (outcome.upper - outcome.lower) / 2.0,
        outcome.features
    );
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

fn main() -> ExitCode {
    lab::command::main(run)
}

fn run(options: &Options) -> Result<(), Trouble> {
    println!("drawing to {}", options.out.display());
    let (robot, title) = match &options.urdf {
        None => (
            Robot::read(include_str!("arm.urdf"), Path::new("."))?,
            "built-in arm".into(),
        ),
        Some(file) => {
            let text = std::fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))?;
            let folder = file.parent().unwrap_or(Path::new("."));
            let robot = Robot::read(&text, folder).map_err(|e| format!("{}: {e}", file.display()))?;
            let name = file.file_name().unwrap_or_default();
            (robot, name.to_string_lossy().into_owned())
        }
    };
    let limits = robot.limits();
    let joints = |frame: usize| {
        let time = frame as f64 / options.frames.max(2) as f64;
        match options.urdf {
            None => motion::carry(time),
            Some(_) => motion::swing(&limits, time),
        }
    };
    let mut stage = Stage::new(robot, cell::things(&options.cell)?, &joints(0))?;
    println!("{} joints, {} bodies\n", limits.len(), stage.parts.len());
    println!(
        "Frames in which another pair becomes the closest; a distance below zero is minus the depth of an overlap.\n"
    );
    println!("frame  {:<24} {:>10}           features", "closest pair", "distance");
    let progress = Progress::new("frames", options.frames as u64);
    let mut closest: Vec<(f64, String)> = Vec::new();
    let mut least: Option<(usize, ClosestPair, String)> = None;
    let mut view = None;
    for frame in 0..options.frames {
        let near = stage.step(&joints(frame))?.ok_or("there is no pair to measure")?;
        let name = stage.name(&near);
        if closest.last().is_none_or(|(_, last)| *last != name) {
            tell(frame, &name, &near);
        }
        if least
            .as_ref()
            .is_none_or(|(_, l, _)| near.outcome.distance < l.outcome.distance)
        {
            view = Some(stage.snapshot(&near));
            least = Some((frame, near, name.clone()));
        }
        closest.push((near.outcome.distance, name));
        progress.step();
    }
    drop(progress);
    let (Some((frame, near, name)), Some((poses, points))) = (least, view) else {
        return Ok(());
    };
    println!("\nleast clearance:");
    tell(frame, &name, &near);
    let caption = format!("{title}, frame {frame}: {:.4}, {name}", near.outcome.distance);
    let picture = draw::Picture {
        caption,
        bodies: stage.parts.iter().map(|p| (&p.shape, p.link.is_some())).collect(),
        poses,
        points,
    };
    let chart = chart(&closest, &title).svg()?;
    lab::command::write(&options.out, &picture.above(&chart))?;
    Ok(())
}
