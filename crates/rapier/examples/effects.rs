//! Cost of each effect: one scene, with effects added one by one.
//!
//! `cargo run --release -p lin-canny-rapier --example effects -- [--csv FILE] [--out FILE.svg] [--bodies N] [--steps N]`
//!
//! Hulls are thrown into a bin. Times are thread CPU time of a whole step, the least of three runs
//! for each step.

mod common;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use common::{bin, pebble, turn};
use cpu_time::ThreadTime;
use lin_canny_rapier::lin_canny_parry::lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny_rapier::lin_canny_parry::lin_canny::polyhedron::solids;
use lin_canny_rapier::lin_canny_parry::lin_canny::{ManifoldOptions, Velocity, scene};
use lin_canny_rapier::lin_canny_parry::single::isometry;
use lin_canny_rapier::single::rapier::prelude::Pose;
use lin_canny_rapier::single::{Hull, Simulation};
use lin_canny_rapier::{Body, Continuous, Effects, FrictionModel, Report, Settings};
use lin_canny_record::svg::{BLUE, SKY, Svg};
use truth::command::{count, file, write};
use truth::rng::Rng;

type Trouble = Box<dyn std::error::Error>;

/// Measure the cost of the effects of a simulation, added one by one
#[derive(Parser)]
struct Options {
    /// Output table with time and counts per step, for each set of effects
    #[arg(long, value_name = "FILE.csv", value_parser = file("csv"))]
    csv: Option<PathBuf>,
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/effects.svg", value_parser = file("svg"))]
    out: PathBuf,
    /// Number of hulls, of 64 vertices each
    #[arg(long, value_name = "N", default_value_t = 300, value_parser = count(1))]
    bodies: usize,
    /// Number of steps of 1/60 s
    #[arg(long, value_name = "N", default_value_t = 300, value_parser = count(1))]
    steps: usize,
}

const NOTHING: scene::PairQueries = scene::PairQueries::none();

/// The sets of effects, each with one more than the one before.
fn sets() -> Vec<(&'static str, Effects, scene::PairQueries)> {
    let near = ManifoldOptions::with_prediction(0.02);
    let overlap = NOTHING.overlap(true);
    let contacts = overlap.manifold(near);
    let mut e = Effects::none();
    let mut list = vec![("motion on lines", e, NOTHING)];
    e.rotation = true;
    list.push(("+ rotation", e, NOTHING));
    e.gravity = Some(Vector3::y() * -9.81);
    list.push(("+ gravity", e, NOTHING));
    list.push(("+ overlaps told", e, overlap));
    list.push(("+ contact points", e, contacts));
    (e.response, e.iterations) = (true, 1);
    list.push(("response, 1 iteration", e, NOTHING));
    e.iterations = 4;
    list.push(("+ 4 iterations", e, NOTHING));
    e.friction = Some(0.5);
    list.push(("+ friction", e, NOTHING));
    e.restitution = Some(0.3);
    list.push(("+ restitution", e, NOTHING));
    e.sleeping = true;
    list.push(("+ sleeping", e, NOTHING));
    e.continuous = Continuous::AgainstFixed;
    list.push(("+ swept against fixed", e, NOTHING));
    e.continuous = Continuous::AgainstAll;
    list.push(("+ swept against all", e, NOTHING));
    e.friction_model = FrictionModel::Coulomb;
    list.push(("+ Coulomb friction", e, NOTHING));
    list
}

fn simulation(effects: Effects, observe: scene::PairQueries, bodies: usize) -> Result<Simulation, Trouble> {
    let settings = Settings::default().queries(observe);
    let mut simulation = Simulation::new(effects, settings)?;
    for (half, center) in bin(4.0, 12.0) {
        let wide = |v: [f32; 3]| Vector3::from(v.map(f64::from));
        let wall = Hull::new(solids::cuboid(wide(half.to_array()))?);
        let pose = Isometry3::from_parts(wide(center.to_array()).into(), Default::default());
        simulation.insert(&wall, Body::fixed(pose))?;
    }
    let mut rng = Rng::new(5);
    for k in 0..bodies {
        let hull = Hull::from_points(&pebble(&mut rng, 64, 0.3, 0.5))?;
        let at = |j: usize| (j as f32 - 3.0) * 1.05;
        let place = [at(k % 7), 1.0 + 1.05 * (k / 49) as f32, at(k / 7 % 7)];
        let pose = isometry(&Pose::from_parts(place.into(), turn(&mut rng)));
        let throw = |rng: &mut Rng| Vector3::from(rng.unit());
        let velocity = Velocity::new(throw(&mut rng), throw(&mut rng) * 2.0);
        simulation.insert(&hull, Body::moving(pose, 1.0).velocity(velocity))?;
    }
    Ok(simulation)
}

/// Returns the time of a step in microseconds, and the report of the last step.
fn cost(effects: Effects, observe: scene::PairQueries, options: &Options) -> Result<(f64, Report), Trouble> {
    let mut least = vec![f64::INFINITY; options.steps];
    let mut report = Report::default();
    for _ in 0..3 {
        let mut simulation = simulation(effects, observe, options.bodies)?;
        for least in &mut least {
            let start = ThreadTime::now();
            simulation.step()?;
            *least = least.min(start.elapsed().as_secs_f64());
        }
        report = simulation.report();
    }
    Ok((1e6 * least.iter().sum::<f64>() / options.steps as f64, report))
}

/// Bars, one for each set.
fn draw(rows: &[(&str, f64)], bodies: usize) -> String {
    let title = format!("A step of {bodies} hulls of 64 vertices, effects added one by one (microseconds)");
    let height = 60 + 26 * rows.len();
    let mut svg = Svg::new(860, height as u32, &title);
    svg.words([430.0, 28.0], 16, "middle", &title);
    let most = rows.iter().map(|r| r.1).fold(1.0, f64::max);
    for (k, (name, time)) in rows.iter().enumerate() {
        let (y, width) = (46.0 + 26.0 * k as f64, 540.0 * time / most);
        let color = if k < 5 { SKY } else { BLUE };
        svg.words([190.0, y + 14.0], 13, "end", name);
        svg.rect([200.0, y], [width, 18.0], &format!("fill=\"{color}\""));
        svg.words([206.0 + width, y + 14.0], 12, "start", &format!("{time:.0}"));
    }
    svg.finish()
}

fn run(options: &Options) -> Result<(), Trouble> {
    let mut csv = String::from("effects,us_step,moved,asleep,touching,iterations,swept\n");
    let mut rows = Vec::new();
    println!(
        "{:24} {:>8}  last step: moved asleep touching swept",
        "effects", "us/step"
    );
    for (name, effects, observe) in sets() {
        let (time, r) = cost(effects, observe, options)?;
        println!(
            "{name:24} {time:8.0} {:17} {:6} {:8} {:5}",
            r.moved, r.asleep, r.touching, r.swept
        );
        let Report {
            moved,
            asleep,
            touching,
            iterations,
            swept,
            ..
        } = r;
        let _ = writeln!(csv, "{name},{time:.1},{moved},{asleep},{touching},{iterations},{swept}");
        rows.push((name, time));
    }
    write(&options.out, &draw(&rows, options.bodies))?;
    if let Some(path) = &options.csv {
        write(path, &csv)?;
    }
    Ok(())
}

fn main() -> ExitCode {
    truth::command::main(run)
}
