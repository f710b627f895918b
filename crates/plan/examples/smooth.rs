//! Smooths a planned path of a plank around walls, and draws the path, the motion and its speeds.
//!
//! `cargo run --release -p lin-canny-plan --example smooth -- --out FILE.svg`

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny_plan::{
    Cell, Checker, JointMotion, PlanOptions, PlanarSpace, RrtConnect, Shortcuts, SmoothOptions, SmoothPath, Smoother,
};
use lin_canny_record::svg::{BLUE, GREY, INK, ORANGE, Place, SKY, Svg};

/// Smooth a planned path of a plank around walls, within limits of velocity and acceleration
#[derive(Parser)]
struct Options {
    /// Random seed of the search
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Greatest acceleration, in units of the picture and radians per second squared
    #[arg(long, default_value_t = 2.0, value_parser = truth::command::number(1e-3))]
    acceleration: f64,
    /// Output file
    #[arg(long, default_value = "target/smooth.svg", value_parser = truth::command::file("svg"))]
    out: PathBuf,
}

/// Half sizes of the plank.
const PLANK: [f64; 2] = [0.25, 0.05];

/// Centre and half sizes of each wall.
const WALLS: [[[f64; 2]; 2]; 4] = [
    [[-0.8, -0.35], [0.06, 0.65]],
    [[0.0, 0.4], [0.06, 0.6]],
    [[0.0, -0.9], [0.06, 0.1]],
    [[0.8, -0.35], [0.06, 0.65]],
];

/// Largest velocities: x, y and the angle.
const VELOCITY: [f64; 3] = [1.0, 1.0, 2.0];

fn main() -> ExitCode {
    truth::command::main(run)
}

fn run(options: &Options) -> Result<(), Box<dyn Error>> {
    let mut cell = Cell::new();
    cell.robot_body("plank", solids::cuboid(Vector3::new(PLANK[0], PLANK[1], 0.1))?);
    for [[x, y], [a, b]] in WALLS {
        let wall = solids::cuboid(Vector3::new(a, b, 0.1))?;
        cell.add_obstacle(cell.free_name("wall"), wall, Isometry3::translation(x, y, 0.0))?;
    }
    let space = PlanarSpace::new([[-1.4, 1.4], [-0.95, 0.95]], 0.25, 1)?;
    let mut checker = Checker::new(space, cell)?;
    let search = PlanOptions::default().seed(options.seed);
    let plan = RrtConnect::new(&search).plan(&mut checker, &[-1.2, -0.6, 0.0], &[1.2, -0.6, 0.0])?;
    let path = plan.path.ok_or("no path found")?;
    let path = Shortcuts::new(300, options.seed).shorten(&mut checker, &path)?;

    let mut motions = Vec::new();
    for (name, deviation, is_continuous) in [
        ("stops at corners", 0.0, false),
        ("continuous velocity", f64::INFINITY, false),
        ("continuous acceleration", f64::INFINITY, true),
    ] {
        let limits = SmoothOptions::new(VELOCITY, [options.acceleration; 3])
            .deviation(deviation)
            .continuous_acceleration(is_continuous);
        let motion = Smoother::new(&limits).smooth(&mut checker, &path)?;
        let is_free = checker.certify(&JointMotion::spline(&motion.curves)?)?.is_free();
        println!(
            "{name}: {:.3} s, {} curves, stops at {} of {} corners, free = {is_free}",
            motion.duration(),
            motion.curves.len(),
            motion.stops.len(),
            path.len() - 2
        );
        motions.push((name, motion));
    }
    truth::command::write(&options.out, &draw(&path, &motions))?;
    println!("drawn to {}", options.out.display());
    Ok(())
}

const SCALE: f64 = 280.0;

fn at(x: f64, y: f64) -> Place {
    [430.0 + SCALE * x, 300.0 - SCALE * y]
}

/// Corners of a rectangle about the origin, moved to a configuration.
fn corners([a, b]: [f64; 2], q: &[f64]) -> Vec<Place> {
    let (sine, cosine) = q[2].sin_cos();
    let corner = |(s, t): (f64, f64)| {
        at(
            q[0] + cosine * s * a - sine * t * b,
            q[1] + sine * s * a + cosine * t * b,
        )
    };
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(corner)
        .to_vec()
}

/// Configurations of a motion at equal times.
fn frames(motion: &SmoothPath, count: usize) -> Vec<(f64, Vec<f64>, f64)> {
    let frame = |i: usize| {
        let time = motion.duration() * i as f64 / count as f64;
        let k = motion
            .times
            .partition_point(|t| *t < time)
            .clamp(1, motion.curves.len())
            - 1;
        let length = motion.times[k + 1] - motion.times[k];
        let x = (time - motion.times[k]) / length;
        let velocity = motion.curves[k].velocity(x);
        let parts = velocity.iter().zip(VELOCITY).map(|(v, most)| (v / length / most).abs());
        (time, motion.curves[k].at(x), parts.fold(0.0, f64::max))
    };
    (0..=count).map(frame).collect()
}

fn draw(path: &[Vec<f64>], motions: &[(&str, SmoothPath)]) -> String {
    let mut svg = Svg::new(860, 790, "A planned path, and smooth motions along it");
    for [[x, y], half] in WALLS {
        svg.polygon(&corners(half, &[x, y, 0.0]), &format!("fill=\"{GREY}\""));
    }
    let styles = [(INK, "stroke-dasharray=\"5 4\""), (ORANGE, ""), (BLUE, "")];
    for (_, q, _) in frames(&motions[1].1, 24) {
        svg.polygon(
            &corners(PLANK, &q),
            &format!("fill=\"{SKY}\" fill-opacity=\"0.12\" stroke=\"{SKY}\" stroke-width=\"0.8\""),
        );
    }
    let longest = motions.iter().map(|(_, m)| m.duration()).fold(0.0, f64::max);
    let graph = |time: f64, part: f64| [60.0 + 740.0 * time / longest, 760.0 - 110.0 * part];
    svg.line(graph(0.0, 0.0), graph(longest, 0.0), &format!("stroke=\"{INK}\""));
    svg.line(
        graph(0.0, 1.0),
        graph(longest, 1.0),
        &format!("stroke=\"{GREY}\" stroke-dasharray=\"2 3\""),
    );
    svg.words(
        [60.0, 640.0],
        13,
        "start",
        "largest velocity of a coordinate, as a part of its limit, over time",
    );
    for (time, anchor) in [(0.0, "start"), (longest, "end")] {
        let [x, y] = graph(time, 0.0);
        svg.words([x, y + 18.0], 13, anchor, &format!("{time:.1} s"));
    }
    for ((name, motion), (color, dashes)) in motions.iter().zip(styles) {
        let style = format!("stroke=\"{color}\" stroke-width=\"1.8\" {dashes}");
        let frames = frames(motion, 800);
        let way: Vec<Place> = frames.iter().map(|(_, q, _)| at(q[0], q[1])).collect();
        svg.polyline(&way, &style);
        let speeds: Vec<Place> = frames.iter().map(|(time, _, part)| graph(*time, *part)).collect();
        svg.polyline(&speeds, &style);
        let row = 28.0 + 20.0 * motions.iter().position(|m| m.0 == *name).unwrap_or(0) as f64;
        svg.line([40.0, row - 4.0], [80.0, row - 4.0], &style);
        svg.words([90.0, row], 14, "start", &format!("{name}, {:.2} s", motion.duration()));
    }
    for q in path {
        svg.dot(at(q[0], q[1]), 3.5, &format!("fill=\"{INK}\""));
    }
    svg.finish()
}
