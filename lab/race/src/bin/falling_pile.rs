//! Measures the cost of scene queries: a thousand hulls fall into a pile, for several sets of
//! queries.
//!
//! `cargo run --release -p race --bin falling_pile -- [--csv FILE] [--out FILE.svg] [--bodies N] [--quick]`
//!
//! The sets grow by one query each; then the full set runs with one query removed. The motion is
//! scripted, so every set sees the same poses. Prints the report of a step in the middle of the
//! pile. The file has a line for each set with its counts and times. The picture shows the time per
//! step during the fall.

use clap::Parser;
use lin_canny::nalgebra::Isometry3;
use lin_canny::scene::{Body, Change, Event, Group, PairQueries, Report, Scene};
use lin_canny::{ConvexPolyhedron, ManifoldOptions};
use race::plot::{Chart, save_stack};
use race::progress::Progress;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use truth::command::{count, file};
use truth::crowd::{Crowd, Kind};

type Trouble = Box<dyn std::error::Error>;

/// Measure the cost of the queries of a scene, with the same falling pile for growing sets of
/// queries
#[derive(Parser)]
struct Options {
    /// Output table with counts and times of each set
    #[arg(long, value_name = "FILE.csv", value_parser = file("csv"))]
    csv: Option<PathBuf>,
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/falling_pile.svg", value_parser = file("svg"))]
    out: PathBuf,
    /// Number of hulls in the pile
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = count(2))]
    bodies: usize,
    /// Short run: each set once instead of five times
    #[arg(long)]
    quick: bool,
}

/// Steps of a run, 1/60 s each; the last body comes to rest long before the end.
const STEPS: usize = 240;

/// Steps averaged into one point of the picture.
const SMOOTH: usize = 8;

const NONE: PairQueries = PairQueries::none();

const OVERLAP: PairQueries = NONE.boxes(true).overlap(true);

const WITHIN: PairQueries = OVERLAP.within(0.05);

const DISTANCE: PairQueries = WITHIN.distance(0.1);

const DEPTH: PairQueries = DISTANCE.features(true).depth(true);

fn manifold() -> ManifoldOptions {
    ManifoldOptions::default().prediction(0.02)
}

fn full() -> PairQueries {
    DEPTH.manifold(manifold())
}

/// The queries that a manifold includes.
fn measured() -> PairQueries {
    NONE.features(true).depth(true).manifold(manifold())
}

/// Growing sets, then the full set with one query removed. A manifold includes features and depth,
/// so it is removed together with either.
fn sets() -> [(&'static str, PairQueries); 15] {
    [
        ("none", NONE),
        ("boxes", NONE.boxes(true)),
        ("+overlap", OVERLAP),
        ("+within", WITHIN),
        ("+distance", DISTANCE),
        ("+features", DISTANCE.features(true)),
        ("+depth", DEPTH),
        ("full", full()),
        ("full-boxes", full().boxes(false)),
        ("full-overlap", full().overlap(false)),
        ("full-within", measured().boxes(true).overlap(true).distance(0.1)),
        ("full-distance", measured().boxes(true).overlap(true).within(0.05)),
        ("full-features", DISTANCE.depth(true)),
        ("full-depth", DISTANCE.features(true)),
        ("full-manifold", DEPTH),
    ]
}

/// The sets that are drawn: the growing sets except the first, which costs nothing.
const DRAWN: std::ops::Range<usize> = 1..8;

/// Index of the full set.
const ALL: usize = 7;

/// Returns the poses of every step.
fn motion(crowd: &mut Crowd) -> Vec<Vec<Isometry3<f64>>> {
    let frame = |step: usize| {
        crowd.step();
        let time = step as f64 / 60.0;
        let fallen = 4.905 * time * time;
        let bodies = crowd.poses.iter().enumerate().map(|(k, pose)| {
            // The lower layers start lower. At rest, a body jostles at its position in the pile.
            let start = 3.0 + 3.0 * pose.t[2] + (k % 17) as f64 * 0.2;
            let [x, y, z] = pose.t;
            let t = [x, y, z + (start - fallen).max(0.0)];
            truth::Pose { t, ..*pose }.isometry()
        });
        bodies.collect()
    };
    (0..STEPS).map(frame).collect()
}

/// Report of a step, and its number of box events.
#[derive(Clone, Copy, Default)]
struct Step {
    report: Report,
    met: u64,
}

/// Runs a set of queries and returns the results of each step.
fn run(
    shapes: &[Arc<ConvexPolyhedron>],
    crowd: &Crowd,
    motion: &[Vec<Isometry3<f64>>],
    queries: PairQueries,
    progress: &Progress,
) -> Result<Vec<Step>, Trouble> {
    let mut scene = Scene::new();
    scene.set_queries(Group::default(), Group::default(), queries)?;
    let mut ids = Vec::new();
    for (shape, pose) in crowd.shape_of.iter().zip(&motion[0]) {
        ids.push(scene.insert(Body::moving(shapes[*shape].clone()), *pose)?);
    }
    let mut reports = Vec::new();
    for poses in motion {
        for (id, pose) in ids.iter().zip(poses) {
            scene.set_pose(*id, *pose)?;
        }
        let report = *scene.step();
        let about_boxes = |e: &&Event| matches!(e.change, Change::BoxesMet | Change::BoxesParted);
        let met = scene.events().iter().filter(about_boxes).count() as u64;
        reports.push(Step { report, met });
        progress.step();
    }
    Ok(reports)
}

/// Runs every set several times and keeps the fastest time of each step. The sets alternate, so a
/// busy machine does not affect a single set.
fn fastest(
    shapes: &[Arc<ConvexPolyhedron>],
    crowd: &Crowd,
    motion: &[Vec<Isometry3<f64>>],
    repeats: usize,
) -> Result<Vec<Vec<Step>>, Trouble> {
    let progress = Progress::new("steps", (sets().len() * repeats * STEPS) as u64);
    let mut best: Vec<Option<Vec<Step>>> = vec![None; sets().len()];
    for _ in 0..repeats {
        for ((name, queries), best) in sets().iter().zip(&mut best) {
            progress.say(name);
            let steps = run(shapes, crowd, motion, *queries, &progress)?;
            match best {
                None => *best = Some(steps),
                Some(best) => best.iter_mut().zip(steps).for_each(|(old, new)| {
                    if new.report.times.total() < old.report.times.total() {
                        *old = new;
                    }
                }),
            }
        }
    }
    Ok(best.into_iter().flatten().collect())
}

fn main() -> ExitCode {
    truth::command::main(compare)
}

fn compare(o: &Options) -> Result<(), Trouble> {
    println!("drawing to {}", o.out.display());
    let mut crowd = Crowd::new(Kind::Pile, o.bodies, 32);
    let shapes = crowd.hulls();
    let motion = motion(&mut crowd);
    let runs = fastest(&shapes, &crowd, &motion, if o.quick { 1 } else { 5 })?;
    show(o.bodies, &runs);
    if let Some(file) = &o.csv {
        truth::command::write(file, &table(&runs))?;
    }
    draw(&runs, o.bodies, &o.out)
}

fn total(steps: &[Step]) -> Step {
    steps.iter().fold(Step::default(), |mut sum, s| {
        sum.report += s.report;
        sum.met += s.met;
        sum
    })
}

fn show(bodies: usize, runs: &[Vec<Step>]) {
    println!(
        "{bodies} hulls of 32 vertices, {STEPS} steps; a mean step (us: its time; pairs: of boxes; skipped: by the displacement budget):\n"
    );
    println!(
        "{:<14}{:>9}{:>9}{:>9}{:>10}{:>9}{:>14}{:>11}{:>10}{:>9}{:>11}",
        "effects",
        "us",
        "pairs",
        "asked",
        "skipped",
        "looks",
        "certificates",
        "distances",
        "features",
        "depths",
        "manifolds"
    );
    for ((name, _), reports) in sets().iter().zip(runs) {
        let Step { report, .. } = total(reports);
        let (c, t) = (report.counts, report.times);
        let mean = |v: u64| v as f64 / STEPS as f64;
        println!(
            "{name:<14}{:>9.1}{:>9.0}{:>9.1}{:>10.1}{:>9.1}{:>14.1}{:>11.1}{:>10.1}{:>9.1}{:>11.1}",
            t.total().as_secs_f64() * 1e6 / STEPS as f64,
            mean(c.pairs),
            mean(c.queries),
            mean(c.skipped),
            mean(c.walked),
            mean(c.certificates),
            mean(c.distances),
            mean(c.features),
            mean(c.depths),
            mean(c.manifolds)
        );
    }
    println!("\nthe full set, a step in the pile:\n{}", runs[ALL][STEPS / 2].report);
}

fn table(runs: &[Vec<Step>]) -> String {
    let mut csv = String::from(
        "effects,steps,boxes,pairs,events,box_events,asked,budget,balls,walked,certificates,overlaps,withins,distances,features,depths,manifolds,ns_boxes,ns_pairs,ns_look,ns_events,ns\n",
    );
    for ((name, _), reports) in sets().iter().zip(runs) {
        let Step { report, met } = total(reports);
        let (c, t) = (report.counts, report.times);
        let counts = [
            c.steps,
            c.boxes,
            c.pairs,
            c.events,
            met,
            c.queries,
            c.skipped,
            c.balls,
            c.walked,
            c.certificates,
            c.overlaps,
            c.withins,
            c.distances,
            c.features,
            c.depths,
            c.manifolds,
        ];
        let times = [t.boxes, t.pairs, t.narrow_phase, t.events, t.total()].map(|d| d.as_nanos());
        let cells = counts
            .iter()
            .map(u64::to_string)
            .chain(times.iter().map(u128::to_string));
        let _ = writeln!(csv, "{name},{}", cells.collect::<Vec<_>>().join(","));
    }
    csv
}

fn draw(runs: &[Vec<Step>], bodies: usize, out: &Path) -> Result<(), Trouble> {
    let curve = |steps: &[Step], value: &dyn Fn(&Report) -> f64| {
        let mean = |(k, part): (usize, &[Step])| {
            let sum: f64 = part.iter().map(|s| value(&s.report)).sum();
            ((k * SMOOTH + SMOOTH / 2) as f64, sum / part.len() as f64)
        };
        steps.chunks(SMOOTH).enumerate().map(mean).collect::<Vec<_>>()
    };
    let mut time = Chart::new(format!("{bodies} hulls fall into a pile: what a step costs"))
        .axes("step, a sixtieth of a second each", "microseconds a step")
        .legend_beside()
        .from_zero();
    let mut work = Chart::new("pairs whose trackers are asked")
        .axes("step, a sixtieth of a second each", "pairs")
        .legend_beside()
        .from_zero()
        .size(860, 320);
    for ((name, _), reports) in sets()[DRAWN].iter().zip(&runs[DRAWN]) {
        time = time.line(*name, curve(reports, &|r| r.times.total().as_secs_f64() * 1e6));
        work = work.line(*name, curve(reports, &|r| r.counts.queries as f64));
    }
    let boxes = curve(&runs[ALL], &|r| r.counts.pairs as f64);
    work = work.line("pairs of boxes", boxes);
    Ok(save_stack(&[&time, &work], out)?)
}
