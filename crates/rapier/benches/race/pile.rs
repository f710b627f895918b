//! Hulls fall into a bin: cost per step and deepest overlap, with parry's contacts and with ours.
//!
//! `cargo bench -p lin-canny-rapier --bench race -- pile [--csv FILE] [--out FILE.svg] [--bodies N] [--steps N] [--seeds N] [--vertices N] [--quick]`
//!
//! Both sides use the same rapier; only shape and dispatcher differ. Times are thread CPU time: the
//! least of the runs for each step, summed, and averaged over the seeds. Depths are in metres, for
//! bodies with radii of 0.3 to 0.5 m. Separate runs measure them at every fourth step by the
//! certified distance.

use std::fmt::Write as _;
use std::path::PathBuf;

use crate::common::picture::{BLUE, Drawn, ORANGE, hulls, view};
use crate::common::{Engine, Scene, Setup, bin, layers, pebble};
use clap::Args;
use cpu_time::ThreadTime;
use lin_canny_rapier::lin_canny_parry::single::isometry;
use lin_canny_rapier::single::rapier::prelude::Vector;
use lin_canny_record::svg::Svg;
use race::progress::Progress;
use truth::command::{count, file, write};
use truth::rng::Rng;

#[derive(Args)]
pub(crate) struct Options {
    /// Output table, one row per engine, number of vertices and skin
    #[arg(long, value_name = "FILE.csv", value_parser = file("csv"))]
    csv: Option<PathBuf>,
    /// Output picture of the end states
    #[arg(long, value_name = "FILE.svg", default_value = "target/pile.svg", value_parser = file("svg"))]
    out: PathBuf,
    /// Number of hulls in the pile
    #[arg(long, value_name = "N", default_value_t = 500, default_value_if("quick", "true", "200"), value_parser = count(1))]
    bodies: usize,
    /// Number of steps of 1/60 s
    #[arg(long, value_name = "N", default_value_t = 300, value_parser = count(1))]
    steps: usize,
    /// Number of piles, with a seed each
    #[arg(long, value_name = "N", default_value_t = 8, default_value_if("quick", "true", "2"), value_parser = clap::value_parser!(u64).range(1..))]
    seeds: u64,
    /// Vertices per hull [default: 8, 64 and 512]
    #[arg(long, value_name = "N", value_parser = count(4))]
    vertices: Option<usize>,
    /// Short run: two piles of 200 hulls, timed once
    #[arg(long)]
    quick: bool,
}

impl Options {
    /// Vertices of the hulls, pile by pile.
    fn sizes(&self) -> Vec<usize> {
        self.vertices.map_or_else(|| vec![8, 64, 512], |n| vec![n])
    }

    /// Timed runs of a pile.
    fn repeats(&self) -> usize {
        if self.quick { 1 } else { 2 }
    }
}

const HALF_WIDTH: f32 = 4.0;

/// One variant of the pile.
#[derive(Clone, Copy)]
struct Way {
    engine: Engine,
    vertices: usize,
    skin: f32,
}

impl Way {
    fn scene(&self, options: &Options, seed: u64) -> Scene {
        let mut rng = Rng::of_case(seed, self.vertices as u64);
        let shapes = (0..options.bodies)
            .map(|_| pebble(&mut rng, self.vertices, 0.3, 0.5))
            .collect();
        let starts = layers(&mut rng, shapes, HALF_WIDTH - 0.5, 1.05);
        let setup = Setup {
            skin: self.skin,
            ..Setup::of(self.engine)
        };
        setup.scene(&bin(HALF_WIDTH, 12.0), &starts)
    }
}

/// Measurements of one variant, over all seeds.
#[derive(Default)]
struct Row {
    step: f64,
    narrow: f64,
    deepest: f64,
    depths: Vec<f64>,
    lost: usize,
    asleep: usize,
}

/// The times of all steps of a run in seconds: the whole step, and its narrow phase.
fn timed(mut scene: Scene, steps: usize) -> Vec<[f64; 2]> {
    let step = |_| {
        let start = ThreadTime::now();
        scene.world.step();
        let whole = start.elapsed().as_secs_f64();
        let counters = &scene.world.physics_pipeline.counters;
        [whole, counters.cd.narrow_phase_time.time_ms() * 1e-3]
    };
    (0..steps).map(step).collect()
}

/// Runs a pile without timing; returns the end state.
fn judged(mut scene: Scene, steps: usize, row: &mut Row) -> Scene {
    let mut deepest = 0.0f64;
    for step in 0..steps {
        scene.world.step();
        if step % 4 == 0 {
            let depths = scene.depths();
            deepest = depths.iter().copied().fold(deepest, f64::max);
            row.depths.extend(depths);
        }
    }
    row.deepest += deepest;
    row.lost += scene.lost(Vector::new(-4.0, 0.0, -4.0), Vector::new(4.0, 30.0, 4.0));
    row.asleep += scene.asleep();
    scene
}

fn quantile(sorted: &[f64], q: f64) -> f64 {
    let at = (sorted.len() as f64 * q) as usize;
    sorted
        .get(at.min(sorted.len().saturating_sub(1)))
        .copied()
        .unwrap_or(0.0)
}

/// Measures both engines in turns; returns their rows and the end states of the first seed.
fn measure(options: &Options, vertices: usize, skin: f32, bar: &Progress) -> (Vec<Row>, Vec<Scene>) {
    let ways = Engine::BOTH.map(|engine| Way { engine, vertices, skin });
    let (mut rows, mut ends) = (vec![Row::default(), Row::default()], Vec::new());
    for seed in 0..options.seeds {
        let mut least = [const { Vec::<[f64; 2]>::new() }; 2];
        for _ in 0..options.repeats() {
            for (way, least) in ways.iter().zip(&mut least) {
                let times = timed(way.scene(options, seed), options.steps);
                least.resize(times.len(), [f64::INFINITY; 2]);
                for (l, t) in least.iter_mut().zip(times) {
                    *l = [l[0].min(t[0]), l[1].min(t[1])];
                }
                bar.step();
            }
        }
        for ((way, least), row) in ways.iter().zip(&least).zip(&mut rows) {
            row.step += least.iter().map(|t| t[0]).sum::<f64>() / options.steps as f64;
            row.narrow += least.iter().map(|t| t[1]).sum::<f64>() / options.steps as f64;
            let end = judged(way.scene(options, seed), options.steps, row);
            bar.step();
            if seed == 0 {
                ends.push(end);
            }
        }
    }
    rows.iter_mut().for_each(|row| row.depths.sort_by(f64::total_cmp));
    (rows, ends)
}

fn line(row: &Row, engine: Engine, vertices: usize, skin: f32, seeds: f64) -> String {
    let name = engine.name();
    let (step, narrow) = (1e9 * row.step / seeds, 1e9 * row.narrow / seeds);
    let (q99, q999) = (quantile(&row.depths, 0.99), quantile(&row.depths, 0.999));
    let (deepest, asleep) = (row.deepest / seeds, row.asleep as f64 / seeds);
    let lost = row.lost;
    format!("{name},{vertices},{skin},{step:.0},{narrow:.0},{deepest:.4},{q99:.5},{q999:.5},{lost},{asleep:.0}")
}

fn draw(options: &Options, ends: &[Scene]) -> String {
    let title = format!("{} hulls after {} steps in rapier", options.bodies, options.steps);
    let mut picture = Svg::new(960, 420, &title);
    picture.words([480.0, 26.0], 17, "middle", &title);
    for (k, (engine, scene)) in Engine::BOTH.iter().zip(ends).enumerate() {
        let center = 240.0 + 480.0 * k as f64;
        let what = format!(
            "contacts of {}",
            if *engine == Engine::Ours { "lin-canny" } else { "parry" }
        );
        picture.words([center, 52.0], 15, "middle", &what);
        let view = view([center, 300.0], 36.0, 0.5, 0.6);
        let color = if *engine == Engine::Ours { BLUE } else { ORANGE };
        let body = |k: usize| {
            let shade = 0.75 + 0.25 * ((k * 7919) % 100) as f64 / 100.0;
            Drawn {
                body: scene.hulls[k].body(),
                pose: isometry(&scene.pose(k)),
                color: color.map(|c| c * shade),
            }
        };
        let bodies: Vec<Drawn> = (0..scene.bodies.len()).map(body).collect();
        hulls(&mut picture, [960.0, 420.0], &view, &bodies);
    }
    picture.finish()
}

pub(crate) fn run(options: &Options) -> Result<(), String> {
    let mut csv = String::from("engine,vertices,skin,ns_step,ns_narrow,deepest,q99,q999,lost,asleep\n");
    print!("{csv}");
    let mut drawn = None;
    let runs = options.sizes().len() * 2 * options.seeds as usize * 2 * (options.repeats() + 1);
    let bar = Progress::new("piles", runs as u64);
    for vertices in options.sizes() {
        for skin in [0.0, 0.005] {
            let (rows, ends) = measure(options, vertices, skin, &bar);
            for (engine, row) in Engine::BOTH.iter().zip(&rows) {
                let line = line(row, *engine, vertices, skin, options.seeds as f64);
                println!("{line}");
                let _ = writeln!(csv, "{line}");
            }
            let step = rows[1].step / rows[0].step;
            println!("# {vertices} vertices, skin {skin}: a step with ours costs {step:.2} of a step with parry's");
            drawn = drawn.or(Some(ends));
        }
    }
    write(&options.out, &draw(options, &drawn.unwrap_or_default()))?;
    options.csv.as_deref().map_or(Ok(()), |path| write(path, &csv))
}
