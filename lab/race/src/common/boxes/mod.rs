//! `race boxes`: broad phases on moving boxes, in nanoseconds of thread CPU time per body and step.
//!
//! The timed part stores the new boxes of a step and computes the pairs. `ours` also reports the
//! pairs that started and ended. `parry-bvh` lists all pairs and keeps no pairs between steps,
//! which is less work. Boxes are tight, except in scenes in which most boxes rest or move slowly:
//! there `ours` uses the margin that rapier always uses (0.04). The benchmark `race` of
//! `lin-canny-rapier` is the race with rapier's broad phase.

pub mod engines;

use super::hulls;
use super::{Options, Rows};
use cpu_time::ThreadTime;
use engines::{ENGINES, Engine, Make};
use std::time::{Duration, Instant};
use truth::boxes::{Kind, Scene};

/// Measurements of one engine on one scene, in nanoseconds per body and step.
struct Row {
    mean: f64,
    median: f64,
    /// 99th percentile.
    high: f64,
    pairs: Option<usize>,
    bytes: Option<usize>,
}

/// Returns the thread CPU time of reading the clock, which is subtracted.
fn clock_cost() -> Duration {
    let mut costs: Vec<Duration> = (0..1000).map(|_| timed(|| ())).collect();
    costs.sort_unstable();
    costs[costs.len() / 2]
}

fn timed(work: impl FnOnce()) -> Duration {
    let start = ThreadTime::now();
    work();
    start.elapsed()
}

fn measure(engine: &mut dyn Engine, mut scene: Scene, steps: usize, warm: usize, limit: Duration) -> Row {
    let clock = clock_cost();
    let n = scene.boxes.len() as f64;
    let mut times = Vec::new();
    let begun = Instant::now();
    for step in 0..warm + steps {
        scene.step();
        engine.prepare(&scene);
        let time = timed(|| engine.step()).saturating_sub(clock);
        if step >= warm {
            times.push(time.as_nanos() as f64 / n);
        }
        if begun.elapsed() > limit && times.len() >= 5 {
            break;
        }
    }
    let mean = times.iter().sum::<f64>() / times.len() as f64;
    times.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| times[((times.len() - 1) as f64 * share).round() as usize];
    Row {
        mean,
        median: at(0.5),
        high: at(0.99),
        pairs: engine.pairs(),
        bytes: engine.bytes(),
    }
}

/// Returns whether a case is skipped because it takes too long.
fn skipped(name: &str, kind: Kind, n: usize) -> bool {
    let tree = name == "rapier" || name == "parry-bvh";
    tree && kind == Kind::Teleport && n > 10_000
}

/// Scenes of the race, in the order of the tables.
pub const RACED: [Kind; 7] = [
    Kind::Uniform,
    Kind::UniformSlow,
    Kind::Pile,
    Kind::Movers,
    Kind::Teleport,
    Kind::Mixed,
    Kind::Clusters,
];

/// Returns the number of timed steps and of warm-up steps, by the number of bodies.
fn steps(n: usize) -> (usize, usize) {
    match n {
        1_000 => (1000, 100),
        10_000 => (200, 60),
        100_000 => (50, 25),
        _ => (20, 6),
    }
}

/// Formats a number of a table, or a dash if the engine does not report it.
fn cell(value: Option<f64>, digits: usize) -> String {
    value.map_or("-".into(), |v| format!("{v:.digits$}"))
}

const HEAD: &str = "scene               n engine          mean   median      p99   /ours  B/body  B/pair  pairs/n";

fn print_row(scene: &str, n: usize, engine: &str, row: &Row, ours: f64) {
    let (bodies, bytes) = (n as f64, row.bytes.map(|b| b as f64));
    let pairs = row.pairs.map(|p| p as f64);
    println!(
        "{scene:<13}{n:>8} {engine:<11}{:>9.2}{:>9.2}{:>9.2}{:>8.2}{:>8}{:>8}{:>9}",
        row.mean,
        row.median,
        row.high,
        row.mean / ours,
        cell(bytes.map(|b| b / bodies), 0),
        cell(bytes.zip(pairs.filter(|p| *p > 0.0)).map(|(b, p)| b / p), 0),
        cell(pairs.map(|p| p / bodies), 2)
    );
}

/// Races all engines on one scene. Returns the means by engine.
fn race(kind: Kind, n: usize, engines: &[(&str, Make)], csv: &mut Rows) -> Vec<(String, f64)> {
    let scene = Scene::new(kind, n);
    let (steps, warm) = steps(n);
    let (mut ours, mut means) = (f64::NAN, Vec::new());
    for (name, make) in engines.iter().filter(|(name, _)| !skipped(name, kind, n)) {
        let mut racer = make(&scene);
        let limit = Duration::from_secs(if *name == "ours" { 30 } else { 5 });
        let row = measure(racer.as_mut(), scene.clone(), steps, warm, limit);
        if *name == "ours" {
            ours = row.mean;
        }
        print_row(kind.name(), n, racer.name(), &row, ours);
        csv.push((kind.name(), "box", n), racer.name(), row.mean, 3);
        means.push((racer.name().to_owned(), row.mean));
    }
    means
}

/// Prints how the cost of a step grows from `low` to `high` bodies: the exponent of n, by engine.
fn print_growth(kind: Kind, (low, at_low): (usize, &[(String, f64)]), (high, at_high): (usize, &[(String, f64)])) {
    let decades = (high as f64 / low as f64).log10();
    let exponent = |(name, mean): &(String, f64)| {
        let (_, before) = at_low.iter().find(|(other, _)| other == name)?;
        Some(format!("{name} n^{:.2}", 1.0 + (mean / before).log10() / decades))
    };
    let list: Vec<String> = at_high.iter().filter_map(exponent).collect();
    println!(
        "{}: cost of a step grows from {low} to {high} bodies as {}",
        kind.name(),
        list.join(", ")
    );
}

/// Measures the cost of overlaps: the uniform scene with larger boxes.
fn race_overlaps() {
    let n = 10_000;
    println!("\nuniform with larger boxes, ours: what overlaps cost\n{HEAD}");
    let mut points = Vec::new();
    for factor in [1.0, 1.5, 2.0, 3.0] {
        let scene = Scene::new(Kind::Uniform, n).grown(factor);
        let mut racer = ENGINES[0].1(&scene);
        let row = measure(racer.as_mut(), scene, 60, 30, Duration::from_secs(10));
        print_row(&format!("boxes x {factor}"), n, racer.name(), &row, row.mean);
        points.push((row.pairs.unwrap_or(0) as f64 / n as f64, row.mean));
    }
    let (first, last) = (points[0], points[points.len() - 1]);
    let each = (last.1 - first.1) / (last.0 - first.0);
    println!("a pair more costs {each:.1} ns a step");
}

/// Races our engines and parry's tree with `rivals`.
pub fn run(o: &Options, rivals: &[(&str, Make)]) -> Rows {
    let mut csv = Rows::default();
    let engines = [&ENGINES[..], rivals].concat();
    println!("ns a body and step, thread CPU time; p99 and median over the steps; bytes a body and a pair\n\n{HEAD}");
    for kind in RACED.into_iter().filter(|kind| o.wants(kind.name())) {
        let sizes = o.sizes([1_000, 10_000, 100_000, 1_000_000]);
        let raced: Vec<_> = sizes.map(|n| (n, race(kind, n, &engines, &mut csv))).collect();
        let at = |n: usize| raced.iter().find(|r| r.0 == n).map(|(n, means)| (*n, &means[..]));
        if let (Some(low), Some(high)) = (at(1_000), at(100_000)) {
            print_growth(kind, low, high);
        }
    }
    if o.wants_all() {
        race_overlaps();
        hulls::run(&mut csv);
    }
    csv
}
