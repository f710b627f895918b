//! The clearance of a robot: a six-joint arm of convex links moves through a cell; for every frame the least distance of any link
//! from anything in the cell, and which pair it is.
//!
//! `cargo run --release --example clearance -- [--links A.stl .. F.stl] [--cell X.obj ..] [--frames N] [--out FILE.svg]`
//!
//! Own meshes are taken by their convex hulls: up to six links, in the frames of their joints (a link reaches along z), and any
//! number of bodies of the cell, in the frame of the world.

use lab::command::Arguments;
use lab::meshes;
use lab::plot::Chart;
use lab::progress::Progress;
use lin_canny::nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, Effects, Group, Report, Scene};
use lin_canny::{ConvexPolyhedron, Outcome};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

type Trouble = Box<dyn std::error::Error>;

const ARM: Group = Group::new(1).unwrap();
const CELL: Group = Group::new(2).unwrap();

/// Lengths of the links of the built-in arm.
const LENGTHS: [f64; 6] = [0.40, 0.55, 0.35, 0.30, 0.15, 0.12];

struct Options {
    links: Vec<String>,
    cell: Vec<String>,
    frames: usize,
    out: PathBuf,
}

const USAGE: &str = "\
usage: clearance [--links A.stl .. F.stl] [--cell X.obj ..] [--frames N] [--out FILE.svg]

A six-joint arm of convex links moves through a cell: the least distance per frame, and of which pair.

  --links FILES  up to six meshes instead of the built-in links, by their hulls, in the frames of the joints (a link reaches along z)
  --cell FILES   meshes instead of the built-in cell, by their hulls, in the frame of the world
  --frames N     frames of the motion (default: 1200)
  --out FILE     where to draw (default: target/clearance.svg)";

fn parse(arguments: Option<Arguments>) -> Result<Option<Options>, String> {
    let Some(mut arguments) = arguments else {
        return Ok(None);
    };
    let mut options = Options {
        links: vec![],
        cell: vec![],
        frames: arguments.number("--frames", 1, 1200)?,
        out: arguments
            .value("--out")?
            .unwrap_or("target/clearance.svg".into())
            .into(),
    };
    let mut list = None;
    for word in arguments.rest() {
        match (word.as_str(), &mut list) {
            ("--links", _) => list = Some(true),
            ("--cell", _) => list = Some(false),
            (word, _) if word.starts_with('-') => return Err(format!("{word} is not an option")),
            (_, Some(true)) => options.links.push(word),
            (_, Some(false)) => options.cell.push(word),
            (word, None) => return Err(format!("{word}: is it one of the --links or of the --cell?")),
        }
    }
    if options.links.len() > LENGTHS.len() {
        return Err("the arm has six links".into());
    }
    Ok(Some(options))
}

fn hull(file: &str) -> Result<ConvexPolyhedron, Trouble> {
    let mesh = meshes::load(file).map_err(|e| e.to_string())?;
    let points: Vec<_> = mesh.points.iter().copied().map(Point3::from).collect();
    ConvexPolyhedron::from_points(&points).map_err(|e| format!("{file}: {e}").into())
}

/// The links: own ones first, the rest built in.
fn links(files: &[String]) -> Result<Vec<ConvexPolyhedron>, Trouble> {
    let mut links = Vec::new();
    for (k, length) in LENGTHS.iter().enumerate() {
        links.push(match files.get(k) {
            Some(file) => hull(file)?,
            None => {
                // A tapered octagonal rod from the joint to the next.
                let wide = 0.09 - 0.01 * k as f64;
                let ring = |z: f64, r: f64| {
                    (0..8).map(move |i| {
                        let angle = f64::from(i) * std::f64::consts::FRAC_PI_4;
                        Point3::new(r * angle.cos(), r * angle.sin(), z)
                    })
                };
                let points: Vec<_> = ring(-0.04, wide).chain(ring(length + 0.04, 0.8 * wide)).collect();
                ConvexPolyhedron::from_points(&points)?
            }
        });
    }
    Ok(links)
}

/// What stands in the cell, by name.
fn cell(files: &[String]) -> Result<Vec<(String, ConvexPolyhedron, Isometry3<f64>)>, Trouble> {
    if !files.is_empty() {
        let load = |file: &String| Ok((file.clone(), hull(file)?, Isometry3::identity()));
        return files.iter().map(load).collect();
    }
    let cuboid = |x: f64, y: f64, z: f64| solids::cuboid(Vector3::new(x, y, z));
    let at = Isometry3::translation;
    Ok(vec![
        ("table".into(), cuboid(0.6, 0.4, 0.03)?, at(0.8, 0.0, 0.15)),
        ("bin".into(), cuboid(0.15, 0.2, 0.12)?, at(0.75, 0.35, 0.3)),
        ("post".into(), solids::prism(24, 0.06, 0.8)?, at(0.35, -0.55, 0.8)),
        ("beam".into(), cuboid(0.05, 0.8, 0.05)?, at(0.5, 0.0, 1.45)),
        ("ball".into(), solids::geodesic_sphere(3, 0.12)?, at(0.75, -0.2, 0.45)),
        ("fence".into(), cuboid(0.02, 1.0, 0.9)?, at(-0.6, 0.0, 0.9)),
    ])
}

/// Poses of the links for joint angles that swing with time.
fn arm(time: f64) -> [Isometry3<f64>; 6] {
    let swing = |amplitude: f64, rate: f64, middle: f64| middle + amplitude * (rate * time).sin();
    let angles = [
        swing(2.2, 1.0, 0.0),
        swing(0.5, 1.7, 0.5),
        swing(0.7, 2.3, 0.9),
        swing(1.5, 0.9, 0.0),
        swing(0.9, 2.9, 0.5),
        swing(3.0, 1.3, 0.0),
    ];
    let mut at = Isometry3::identity();
    core::array::from_fn(|k| {
        let axis = if matches!(k, 0 | 3 | 5) {
            Vector3::z_axis()
        } else {
            Vector3::y_axis()
        };
        at *= UnitQuaternion::from_axis_angle(&axis, angles[k]);
        let joint = at;
        at *= Translation3::new(0.0, 0.0, LENGTHS[k]);
        joint
    })
}

/// The scene, its joints, and what its bodies are called.
struct Stage {
    scene: Scene,
    joints: Vec<BodyId>,
    names: BTreeMap<BodyId, String>,
}

impl Stage {
    fn new(options: &Options) -> Result<Self, Trouble> {
        let mut scene = Scene::new();
        let clearance = Effects {
            distance: Some(f64::INFINITY),
            features: true,
            depth: true,
            ..Effects::none()
        };
        scene.call_for(ARM, CELL, clearance)?;
        let mut names = BTreeMap::new();
        let mut joints = Vec::new();
        for (k, (link, pose)) in links(&options.links)?.into_iter().zip(arm(0.0)).enumerate() {
            let id = scene.insert(Body::moving(link).group(ARM), pose)?;
            names.insert(id, format!("link {}", k + 1));
            joints.push(id);
        }
        for (name, shape, pose) in cell(&options.cell)? {
            names.insert(scene.insert(Body::fixed(shape).group(CELL), pose)?, name);
        }
        Ok(Self { scene, joints, names })
    }

    /// Moves the arm; what the step did.
    fn step(&mut self, time: f64) -> Result<Report, Trouble> {
        for (id, pose) in self.joints.iter().zip(arm(time)) {
            self.scene.set_pose(*id, pose)?;
        }
        Ok(*self.scene.step())
    }

    /// The pair that is nearest, by name.
    fn nearest(&self) -> Option<(String, &Outcome)> {
        let answers = self.scene.pairs().filter_map(|p| Some((p, p.outcome?)));
        let (pair, outcome) = answers.min_by(|x, y| x.1.distance.total_cmp(&y.1.distance))?;
        let name = format!("{} - {}", self.names[&pair.a], self.names[&pair.b]);
        Some((name, outcome))
    }
}

/// A line for a pair that has become the nearest.
fn tell(frame: usize, name: &str, outcome: &Outcome) {
    println!(
        "{frame:>5}  {name:<18} {:>10.6} +- {:.0e}  {}",
        outcome.distance,
        (outcome.upper - outcome.lower) / 2.0,
        outcome.features
    );
}

/// The least distance over time, and where it was that of the pairs most often nearest.
fn draw(nearest: &[(f64, String)], out: &Path) -> Result<(), Trouble> {
    let curve = |pick: &dyn Fn(&str) -> bool| {
        let of = nearest.iter().enumerate().filter(|(_, (_, name))| pick(name));
        of.map(|(k, (d, _))| (k as f64, *d)).collect::<Vec<_>>()
    };
    let mut chart = Chart::new("clearance of the arm, by the nearest pair; below zero it collides")
        .axes("frame", "least signed distance, in the unit of the meshes")
        .legend_beside()
        .line("other pairs", curve(&|_| true));
    let mut shares: BTreeMap<&str, usize> = BTreeMap::new();
    nearest
        .iter()
        .for_each(|(_, name)| *shares.entry(name).or_default() += 1);
    let mut shares: Vec<_> = shares.into_iter().collect();
    shares.sort_by_key(|(name, count)| (std::cmp::Reverse(*count), *name));
    for (name, _) in shares.iter().take(5) {
        chart = chart.dots(*name, curve(&|n| n == *name));
    }
    chart.save(out)?;
    Ok(())
}

fn main() -> ExitCode {
    lab::command::main("clearance", USAGE, parse(Arguments::of_process()), run)
}

fn run(options: &Options) -> Result<(), Trouble> {
    println!("drawing to {}", options.out.display());
    let mut stage = Stage::new(options)?;
    let progress = Progress::new("frames", options.frames as u64);
    let mut nearest: Vec<(f64, String)> = Vec::new();
    let mut report = Report::default();
    println!("Where another pair becomes the nearest; a distance below zero is minus the depth of an overlap.\n");
    println!("frame  {:<18} {:>10}           features", "nearest pair", "distance");
    for frame in 0..options.frames {
        report += stage.step(6.3 * frame as f64 / options.frames as f64)?;
        if let Some((name, outcome)) = stage.nearest() {
            if nearest.last().is_none_or(|(_, last)| *last != name) {
                tell(frame, &name, outcome);
            }
            nearest.push((outcome.distance, name));
        }
        progress.step();
    }
    drop(progress);
    println!(
        "\n{} frames, {} pairs followed:\n{report}",
        options.frames,
        stage.scene.pair_count()
    );
    draw(&nearest, &options.out)
}
