//! `race scene`: whole steps of moving hulls, in nanoseconds of thread CPU time per step.
//!
//! The timed part sets the pose of every body and runs a step. Afterwards every engine knows which
//! bodies are near each other, but the engines compute different results:
//!
//! - `ours`: overlap events; certified closest features, witnesses and bounds of every pair within
//!   0.02; overlaps by contact state.
//! - `ours-depth`: the same with the proven depth of every overlap.
//! - `ours-manifold`: the same, and contact manifolds within 0.02: everything that rapier computes,
//!   and more.
//! - `parry-parts`: an engine built from parry's public parts: its box of each hull, its tree, and
//!   its `distance` for each pair of boxes, cold. No events, no features, overlaps by contact
//!   state.
//!
//! The benchmark `race` of `lin-canny-rapier` is the race with rapier's `CollisionPipeline`.
//!
//! parry and rapier compute in `f32`, ours in `f64`. Sparse: 16 cubic units per body of size about
//! one; pile: four layers of such bodies.

pub mod engines;

use super::{Options, Rows};
use crate::progress::Progress;
use cpu_time::ThreadTime;
use engines::{ENGINES, Engine, Make, RANGE};
use std::time::{Duration, Instant};
use truth::crowd::{Crowd, Kind};

/// Warm-up steps, timed steps, and time limit of an engine.
const WARM: usize = 60;
const STEPS: usize = 60;
const LIMIT: Duration = Duration::from_secs(12);

/// Returns the mean nanoseconds per step, and the number of near pairs after the last step.
fn measure(engine: &mut dyn Engine, mut crowd: Crowd, progress: &Progress) -> (f64, usize) {
    let (mut spent, mut steps, begun) = (Duration::ZERO, 0, Instant::now());
    let mut warm = WARM;
    for step in 0..WARM + STEPS {
        crowd.step();
        engine.prepare(&crowd.poses);
        if step == warm {
            engine.warmed_up();
        }
        let start = ThreadTime::now();
        engine.step();
        let time = start.elapsed();
        if step >= warm {
            spent += time;
            steps += 1;
        } else if begun.elapsed() > LIMIT / 3 {
            // A slow engine gets fewer warm-up steps.
            warm = step + 1;
        }
        progress.step();
        if begun.elapsed() > LIMIT && steps >= 5 {
            break;
        }
    }
    (spent.as_nanos() as f64 / f64::from(steps), engine.pairs())
}

/// Scenes of the race: name, crowd, vertices of a hull.
pub const SCENES: [(&str, Kind, usize); 4] = [
    ("sparse-32", Kind::Sparse, 32),
    ("sparse-256", Kind::Sparse, 256),
    ("pile-32", Kind::Pile, 32),
    ("pile-256", Kind::Pile, 256),
];

/// Races all engines on one crowd.
fn race(scene: &str, n: usize, crowd: &Crowd, engines: &[(&str, Make)], csv: &mut Rows) {
    let mut ours = f64::NAN;
    for (name, make) in engines {
        let progress = Progress::new(&format!("{scene} {n} {name}"), (WARM + STEPS) as u64);
        let mut racer = make(crowd);
        let (ns, near) = measure(racer.as_mut(), crowd.clone(), &progress);
        drop(progress);
        if *name == "ours" {
            ours = ns;
        }
        println!(
            "{scene:<12}{n:>7} {:<17}{:>12.0}{:>10.0}{:>8.2}{near:>8}",
            racer.name(),
            ns / 1e3,
            ns / n as f64,
            ns / ours
        );
        let remarks = racer.remarks();
        if !remarks.is_empty() {
            println!("{remarks}");
        }
        csv.push((scene, "hull", n), racer.name(), ns, 0);
    }
}

/// Races our engines and parry's parts with `rivals`.
pub fn run(o: &Options, rivals: &[(&str, Make)]) -> Rows {
    let mut csv = Rows::default();
    let engines = [&ENGINES[..], rivals].concat();
    println!("us a step of n hulls, thread CPU time; near: pairs within {RANGE} as the engine sees them\n");
    println!(
        "{:<12}{:>7} {:<17}{:>12}{:>10}{:>8}{:>8}",
        "scene", "n", "engine", "us a step", "ns/body", "/ours", "near"
    );
    for (scene, kind, vertices) in SCENES.into_iter().filter(|s| o.wants(s.0)) {
        for n in o.sizes([1_000, 10_000]) {
            race(scene, n, &Crowd::new(kind, n, vertices), &engines, &mut csv);
        }
    }
    csv
}
