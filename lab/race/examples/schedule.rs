//! Schedules the pairs of a swarm of spinning hulls: each pair sleeps until its certificate
//! expires.
//!
//! ```text
//! cargo run --release -p race --example schedule -- [--bodies N] [--ticks N] [--rate HZ] [--out FILE.svg]
//! ```
//!
//! Bodies fly straight through each other and bounce off the walls of a cube. A pair is queried
//! only when it is due. Brute force queries every pair at every tick for comparison: the overlaps
//! that start and end must be the same. The picture has a dot for every query of a separated pair:
//! the ticks until the next query against the ticks until the pair overlaps. A dot above the
//! diagonal would be a missed overlap.

use clap::Parser;
use lin_canny::impact::free_until;
use lin_canny::motion::Steady;
use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::schedule::{Schedule, ticks};
use lin_canny::{ConvexPolyhedron, RelativePose, Tracker, Velocity};
use race::plot::Chart;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::process::ExitCode;
use truth::command::{count, file, number};
use truth::rng::Rng;

type Trouble = Box<dyn std::error::Error>;

/// Largest number of ticks that one query proves.
const AHEAD: f64 = 64.0;

/// Bound on the difference between poses advanced tick by tick and the poses of one motion, far
/// more than 64 roundings.
const DRIFT: f64 = 1e-10;

/// Count the queries of a swarm of spinning hulls, where each pair sleeps until its certificate
/// expires
///
/// Compares the count with brute force at every tick, and draws each query.
#[derive(Parser)]
struct Options {
    /// Number of hulls, of 32 vertices each
    #[arg(long, value_name = "N", default_value_t = 40, value_parser = count(2))]
    bodies: usize,
    /// Length of the run in ticks
    #[arg(long, value_name = "N", default_value_t = 600, value_parser = clap::value_parser!(u64).range(1..))]
    ticks: u64,
    /// Ticks per second
    #[arg(long, value_name = "HZ", default_value_t = 60.0, value_parser = number(1e-3))]
    rate: f64,
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/schedule.svg", value_parser = file("svg"))]
    out: PathBuf,
}

fn main() -> ExitCode {
    truth::command::main(run)
}

struct Swarm {
    shapes: Vec<ConvexPolyhedron>,
    poses: Vec<Isometry3<f64>>,
    velocities: Vec<Velocity>,
    /// Half the edge length of the cube.
    half: f64,
}

impl Swarm {
    fn new(count: usize) -> Result<Self, Trouble> {
        let mut rng = Rng::new(19);
        // Balls of radius 1 fill 2 % of the cube.
        let half = 0.5 * (count as f64 * 4.19 / 0.02).cbrt();
        let mut swarm = Self {
            shapes: vec![],
            poses: vec![],
            velocities: vec![],
            half,
        };
        for k in 0..count {
            swarm
                .shapes
                .push(solids::random_hull(32, Vector3::repeat(1.0), k as u64)?);
            let place = Vector3::from_fn(|_, _| rng.range(-half, half));
            swarm
                .poses
                .push(Isometry3::from_parts(place.into(), truth::casts::rotation(&mut rng)));
            let linear = Vector3::from(rng.in_ball()) * 8.0;
            swarm
                .velocities
                .push(Velocity::new(linear, Vector3::from(rng.in_ball()) * 6.0));
        }
        Ok(swarm)
    }

    /// Moves all bodies, and returns the bodies that bounced.
    fn advance(&mut self, dt: f64) -> Vec<u32> {
        let mut bounced = vec![];
        for (k, (pose, velocity)) in self.poses.iter_mut().zip(&mut self.velocities).enumerate() {
            *pose = velocity.applied(pose, dt);
            let (at, linear) = (pose.translation.vector, &mut velocity.linear);
            let out = (0..3).filter(|&i| at[i].abs() > self.half && at[i] * linear[i] > 0.0);
            let out: Vec<usize> = out.collect();
            out.iter().for_each(|&i| linear[i] = -linear[i]);
            if !out.is_empty() {
                bounced.push(k as u32);
            }
        }
        bounced
    }

    fn overlap(&self, tracker: &mut Tracker, (a, b): (u32, u32)) -> Result<bool, Trouble> {
        let (a, b) = (a as usize, b as usize);
        let relative = RelativePose::new(&self.poses[a], &self.poses[b])?;
        Ok(tracker.intersects(&self.shapes[a], &self.shapes[b], &relative))
    }

    /// Returns the number of ticks for which a pair is proven separated.
    fn free(&self, (a, b): (u32, u32), dt: f64) -> Result<u64, Trouble> {
        let (a, b) = (a as usize, b as usize);
        let motion = |k: usize| Steady::new(&self.poses[k], self.velocities[k]);
        let mut tracker = Tracker::new();
        let mut pair = tracker.pair(&self.shapes[a], &self.shapes[b]);
        let proof = free_until(&mut pair, &motion(a)?, &motion(b)?, 0.0..AHEAD * dt, DRIFT)?;
        Ok(ticks(proof.until, dt))
    }
}

fn run(options: &Options) -> Result<(), Trouble> {
    let dt = 1.0 / options.rate;
    let mut swarm = Swarm::new(options.bodies)?;
    let all = |n: u32| (0..n).flat_map(move |a| (a + 1..n).map(move |b| (a, b)));
    let n = options.bodies as u32;
    let mut schedule = Schedule::new();
    all(n).for_each(|(a, b)| assert!(schedule.insert(a, b)));
    let (mut looks, mut total) = (vec![], 0u64);
    let (mut now, mut truth) = (BTreeSet::new(), BTreeSet::new());
    let mut trackers: BTreeMap<(u32, u32), Tracker> = BTreeMap::new();
    // Ticks at which each pair overlaps by brute force, and ticks at which it was queried.
    let mut ends: BTreeMap<(u32, u32), Vec<u64>> = BTreeMap::new();
    let mut looked: BTreeMap<(u32, u32), Vec<u64>> = BTreeMap::new();
    let (mut events, mut differences) = (0, 0);
    for tick in 0..options.ticks {
        schedule.advance(tick);
        while let Some(due) = schedule.due() {
            total += 1;
            looked.entry(due.pair).or_default().push(tick);
            let overlap = swarm.overlap(trackers.entry(due.pair).or_default(), due.pair)?;
            if overlap {
                events += u32::from(now.insert(due.pair));
                continue;
            }
            events += u32::from(now.remove(&due.pair));
            let slept = swarm.free(due.pair, dt)?;
            schedule.sleep(&due, slept);
            looks.push((due.pair, tick));
        }
        let mut present = BTreeSet::new();
        for pair in all(n) {
            if swarm.overlap(&mut Tracker::new(), pair)? {
                present.insert(pair);
                ends.entry(pair).or_default().push(tick);
            }
        }
        truth = present;
        differences += usize::from(truth != now);
        for body in swarm.advance(dt) {
            schedule.disturb(body);
        }
    }
    let pairs = u64::from(n) * u64::from(n - 1) / 2;
    println!(
        "{} bodies, {} ticks at {} Hz: {events} overlaps began or ended",
        n, options.ticks, options.rate
    );
    println!(
        "looks: {total} of {} (every pair, every tick); of pairs apart {}",
        pairs * options.ticks,
        looks.len()
    );
    println!(
        "ticks at which the overlaps differ from brute force: {differences}; overlapping at the end: {}",
        truth.len()
    );
    let dots = looks.iter().filter_map(|(pair, tick)| {
        let after = |list: &BTreeMap<(u32, u32), Vec<u64>>| {
            let next = list.get(pair)?.iter().find(|t| *t > tick)?;
            Some((next - tick) as f64)
        };
        Some((after(&ends)?, after(&looked)?))
    });
    let dots: Vec<(f64, f64)> = dots.collect();
    let late = dots.iter().filter(|(meets, looks)| looks > meets).count();
    println!("overlaps slept through: {late} of {}", dots.len());
    let diagonal = [(1.0, 1.0), (AHEAD, AHEAD)];
    if let Some(folder) = options.out.parent() {
        std::fs::create_dir_all(folder)?;
    }
    Chart::new("Every look at a pair apart: the sleep it earned, and when the pair truly met")
        .axes("ticks until the pair overlaps", "ticks until the next look")
        .log_x()
        .log_y()
        .dots("a look", dots)
        .line("the moment of impact", diagonal)
        .save(&options.out)?;
    println!("wrote {}", options.out.display());
    Ok(())
}
