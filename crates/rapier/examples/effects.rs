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
use common::effects::{sets, simulation};
use cpu_time::ThreadTime;
use lin_canny_rapier::lin_canny_parry::lin_canny::scene;
use lin_canny_rapier::{Effects, Report};
use lin_canny_record::svg::{BLUE, SKY, Svg};
use truth::command::{count, file, write};

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
