//! `race -- scenes`: whole steps of scenes like rapier's own examples, in nanoseconds of thread CPU time a step.
//!
//! - `parry`: rapier with parry's shapes and narrow phase, as it comes.
//! - `ours`: the same solver under the dispatcher of `lin-canny-parry`. Column `shape`: `hull` for bodies that are a `Hull` here and
//!   parry's convex polyhedron there; in all other rows the shapes are the same and the dispatcher alone is exchanged.
//!
//! Scenes are the same from run to run, so the least time of several passes is taken for every single step. Passes of the two
//! engines alternate. Piles are chaotic: where a body comes to rest differs, and with it what the solver costs; such scenes are
//! summed over several seeds.

mod built;

use std::time::Duration;

use cpu_time::ThreadTime;
use lin_canny_rapier::single::rapier::pipeline::PhysicsWorld;
use race::common::{Options, Rows};
use race::progress::Progress;

use crate::common::Engine;

/// Passes of an engine over a scene.
const PASSES: usize = 3;

/// A scene of the race.
struct Scene {
    name: &'static str,
    shape: &'static str,
    n: usize,
    steps: usize,
    seeds: u64,
    build: Box<dyn Fn(Engine, u64) -> PhysicsWorld>,
}

/// Returns the names of the scenes.
pub(crate) fn names() -> Vec<&'static str> {
    let mut names: Vec<_> = built::scenes().iter().map(|scene| scene.name).collect();
    names.dedup();
    names
}

/// Sums the least time of every step of a seed, for each engine.
fn pass_over(scene: &Scene, seed: u64, (steps, passes): (usize, usize), progress: &Progress) -> [Duration; 2] {
    let mut least = [vec![Duration::MAX; steps], vec![Duration::MAX; steps]];
    for _ in 0..passes {
        for (engine, least) in Engine::BOTH.into_iter().zip(&mut least) {
            let mut world = (scene.build)(engine, seed);
            for least in least.iter_mut() {
                let start = ThreadTime::now();
                world.step();
                *least = start.elapsed().min(*least);
                progress.step();
            }
        }
    }
    least.map(|list| list.into_iter().sum())
}

/// Returns the mean nanoseconds a step of each engine.
fn measure(scene: &Scene, quick: bool) -> [f64; 2] {
    let (steps, seeds, passes) = match quick {
        true => (scene.steps.min(60), 1, 1),
        false => (scene.steps, scene.seeds, PASSES),
    };
    let title = format!("{} {} {}", scene.name, scene.shape, scene.n);
    let progress = Progress::new(&title, (2 * passes * steps) as u64 * seeds);
    let mut all = [Duration::ZERO; 2];
    for seed in 0..seeds {
        let of = pass_over(scene, seed, (steps, passes), &progress);
        all.iter_mut().zip(of).for_each(|(all, of)| *all += of);
    }
    all.map(|time| time.as_nanos() as f64 / (steps as f64 * seeds as f64))
}

/// Races the two engines on every scene asked for.
pub(crate) fn run(o: &Options) -> Rows {
    let mut csv = Rows::default();
    println!("us a step of n bodies, thread CPU time\n");
    println!(
        "{:<14}{:<11}{:>7}{:>12}{:>12}{:>12}",
        "scene", "shape", "n", "ours", "parry", "ours/parry"
    );
    let wanted = |scene: &Scene| o.wants(scene.name) && o.sizes([scene.n]).next().is_some();
    for scene in built::scenes().into_iter().filter(wanted) {
        let times = measure(&scene, o.quick);
        for (engine, ns) in Engine::BOTH.into_iter().zip(times) {
            csv.push((scene.name, scene.shape, scene.n), engine.name(), ns, 0);
        }
        let [parry, ours] = times;
        println!(
            "{:<14}{:<11}{:>7}{:>12.1}{:>12.1}{:>12.2}",
            scene.name,
            scene.shape,
            scene.n,
            ours / 1e3,
            parry / 1e3,
            ours / parry
        );
    }
    csv
}
