//! Races pairs of bodies: ours against parry.
//!
//! Every engine gets the same frames and two world poses, and passes are interleaved. It returns
//! the distance and both witness points in the world frame.
//!
//! - `coherent-*`: B orbits A and spins by the given degrees per frame, at a gap of 2 % of the
//!   radius.
//! - `random`: a new pose in every frame.
//! - `cold256-0.5`: the queries alternate between 256 pairs, each with separate shapes, so that CPU
//!   caches are cold.
//!
//! `n` is the number of vertices, so a prism with `n` = 8192 has 4096-gons.

use std::collections::BTreeMap;
use std::hint::black_box;
use std::time::Instant;

use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::{ConvexPolyhedron, RelativePose, Solver, Tracker, TrackerWork};
use race::progress::Progress;
use truth::Point;
use truth::contacts::plain;
use truth::motion::Frame;
use truth::parry::{Climber, GjkCached};
use truth::rng::Rng;
use truth::workload::{self, SIZES};

use race::common::{Options, Rows, WARM_UP, median};

/// A body in the form of each engine.
struct Body {
    ours: ConvexPolyhedron,
    climber: Climber,
    parry: Option<parry3d_f64::shape::ConvexPolyhedron>,
}

/// A pair of bodies and its motion.
pub(crate) struct Pair {
    a: Body,
    b: Body,
    frames: Vec<Frame>,
    isometries: Vec<(Isometry3<f64>, Isometry3<f64>)>,
}

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Engine {
    Ours,
    Walk,
    Exact,
    GjkCached,
    ParryDistance,
}

impl Engine {
    const ALL: [Engine; 5] = [
        Engine::Ours,
        Engine::Walk,
        Engine::Exact,
        Engine::GjkCached,
        Engine::ParryDistance,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Engine::Ours => "ours",
            Engine::Walk => "ours-walk",
            Engine::Exact => "ours-exact",
            Engine::GjkCached => "gjk-cached",
            Engine::ParryDistance => "parry-distance",
        }
    }
}

fn body(points: &[Point], with_parry: bool) -> Body {
    let cloud: Vec<Point3<f64>> = points.iter().map(|&p| p.into()).collect();
    let ours = ConvexPolyhedron::from_points(&cloud).expect("the points of a solid");
    let (at, faces) = plain(&ours);
    let parry = if with_parry {
        truth::parry::mesh(&at, &faces)
    } else {
        None
    };
    Body {
        climber: Climber::new(&at, &faces),
        parry,
        ours,
    }
}

pub(crate) fn pair(
    shape: &str,
    n: usize,
    degrees: Option<f64>,
    frames: usize,
    rng: &mut Rng,
    with_parry: bool,
) -> Pair {
    let a = body(&workload::points(shape, n, rng), with_parry);
    let b = body(&workload::points(shape, n, rng), with_parry);
    let frames = workload::motion(degrees, frames, rng, |f| {
        let (pa, pb) = (f.a.isometry(), f.b.isometry());
        let o = Tracker::new().closest(&a.ours, &b.ours, &RelativePose::new(&pa, &pb).ok()?);
        (o.lower > 0.0).then(|| ((pa * o.point_on_a).into(), (pb * o.point_on_b).into()))
    });
    let isometries = frames.iter().map(|f| (f.a.isometry(), f.b.isometry())).collect();
    Pair {
        a,
        b,
        frames,
        isometries,
    }
}

/// The state that an engine keeps for one pair.
#[derive(Default)]
pub(crate) struct State {
    tracker: Tracker,
    gjk: GjkCached,
}

/// Distance and witnesses of one frame, in the world frame.
pub(crate) type Answer = (f64, Point, Point);

#[inline(always)]
pub(crate) fn ask(engine: Engine, pair: &Pair, frame: usize, state: &mut State) -> Answer {
    let none = (f64::NAN, [0.0; 3], [0.0; 3]);
    match engine {
        Engine::Ours | Engine::Exact => {
            let (pa, pb) = &pair.isometries[frame];
            let Ok(relative) = RelativePose::new(pa, pb) else {
                return none;
            };
            let o = if engine == Engine::Ours {
                state.tracker.closest(&pair.a.ours, &pair.b.ours, &relative)
            } else {
                state.tracker.closest_exact(&pair.a.ours, &pair.b.ours, &relative)
            };
            (o.distance, (pa * o.point_on_a).into(), (pb * o.point_on_b).into())
        }
        Engine::Walk => {
            let (pa, pb) = &pair.isometries[frame];
            let Ok(relative) = RelativePose::new(pa, pb) else {
                return none;
            };
            let o = state.tracker.propose(&pair.a.ours, &pair.b.ours, &relative);
            (
                o.distance.unwrap_or(0.0),
                (pa * o.point_on_a).into(),
                (pb * o.point_on_b).into(),
            )
        }
        Engine::GjkCached => {
            let f = &pair.frames[frame];
            match state.gjk.closest(&pair.a.climber, &f.a, &pair.b.climber, &f.b) {
                Some(w) => (w.distance, w.on_a, w.on_b),
                None => none,
            }
        }
        Engine::ParryDistance => {
            let f = &pair.frames[frame];
            let (Some(a), Some(b)) = (&pair.a.parry, &pair.b.parry) else {
                return none;
            };
            match truth::parry::closest_points(a, &f.a, b, &f.b) {
                Some(w) => (w.distance, w.on_a, w.on_b),
                None => none,
            }
        }
    }
}

/// Runs one pass over all frames of all pairs, alternating between pairs.
///
/// Returns nanoseconds per query, and the work of the trackers. With `answers`, it stores the
/// answers instead of timing.
fn pass(engine: Engine, pairs: &[Pair], frames: usize, answers: Option<&mut Vec<Answer>>) -> (f64, TrackerWork) {
    match engine {
        Engine::Ours => time(pairs, frames, answers, |p, f, s| ask(Engine::Ours, p, f, s)),
        Engine::Walk => time(pairs, frames, answers, |p, f, s| ask(Engine::Walk, p, f, s)),
        Engine::Exact => time(pairs, frames, answers, |p, f, s| ask(Engine::Exact, p, f, s)),
        Engine::GjkCached => time(pairs, frames, answers, |p, f, s| ask(Engine::GjkCached, p, f, s)),
        Engine::ParryDistance => time(pairs, frames, answers, |p, f, s| ask(Engine::ParryDistance, p, f, s)),
    }
}

#[inline(always)]
fn time(
    pairs: &[Pair],
    frames: usize,
    answers: Option<&mut Vec<Answer>>,
    ask: impl Fn(&Pair, usize, &mut State) -> Answer,
) -> (f64, TrackerWork) {
    let fresh = || pairs.iter().map(|_| State::default()).collect::<Vec<State>>();
    if let Some(list) = answers {
        let mut states = fresh();
        for f in 0..frames {
            list.extend(pairs.iter().zip(&mut states).map(|(p, s)| ask(p, f, s)));
        }
        return (0.0, TrackerWork::default());
    }
    let pass = || {
        let mut states = fresh();
        let began = Instant::now();
        for f in 0..frames {
            for (p, s) in pairs.iter().zip(&mut states) {
                black_box(ask(p, f, s));
            }
        }
        (began.elapsed(), states)
    };
    // The first passes warm up caches and branch predictors after another engine; only the last
    // pass counts.
    let began = Instant::now();
    while began.elapsed() < WARM_UP {
        pass();
    }
    let last = pass();
    let mut totals = TrackerWork::default();
    last.1.iter().for_each(|s| totals += s.tracker.work());
    (last.0.as_nanos() as f64 / (frames * pairs.len()) as f64, totals)
}

/// Returns the largest relative difference from our certified distance, and the number of missing
/// answers.
fn disagreement(answers: &[Answer], reference: &[Answer]) -> (f64, usize) {
    let (mut worst, mut missing) = (0f64, 0);
    for (x, r) in answers.iter().zip(reference) {
        if x.0.is_nan() {
            missing += 1;
        } else {
            worst = worst.max(((x.0 - r.0) / r.0).abs());
        }
    }
    (worst, missing)
}

struct Row {
    scene: &'static str,
    shape: &'static str,
    n: usize,
    ns: BTreeMap<usize, f64>,
    totals: TrackerWork,
    note: String,
}

/// Runs all engines on the same pairs in interleaved passes, and returns the medians.
fn race(scene: &'static str, shape: &'static str, n: usize, pairs: &[Pair], quick: bool) -> Row {
    let frames = pairs[0].frames.len();
    let mut reference = Vec::new();
    pass(Engine::Ours, pairs, frames, Some(&mut reference));
    let mut row = Row {
        scene,
        shape,
        n,
        ns: BTreeMap::new(),
        totals: TrackerWork::default(),
        note: String::new(),
    };
    let mut times: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    // A slow engine gets fewer frames per pass, but at least 16.
    let share = |e: Engine| match e {
        Engine::ParryDistance => (40_000 / n).clamp(16, frames),
        Engine::Exact => frames.min(4000),
        _ => frames,
    };
    let rounds = if quick { 3 } else { 9 };
    for round in 0..=rounds {
        for (k, &engine) in Engine::ALL.iter().enumerate() {
            if engine == Engine::ParryDistance && pairs[0].a.parry.is_none() {
                continue;
            }
            if round == 0 {
                let mut answers = Vec::new();
                pass(engine, pairs, share(engine), Some(&mut answers));
                let (worst, missing) = disagreement(&answers, &reference);
                if worst > 1e-6 || missing > 0 {
                    row.note += &format!(" {}: off by {worst:.0e}, {missing} missing;", engine.name());
                }
                continue;
            }
            let (ns, totals) = pass(engine, pairs, share(engine), None);
            times.entry(k).or_default().push(ns);
            if engine == Engine::Ours {
                row.totals = totals;
            }
        }
    }
    row.ns = times.into_iter().map(|(k, mut list)| (k, median(&mut list))).collect();
    row
}

fn print(row: &Row) {
    let at = |k: usize| row.ns.get(&k).copied().unwrap_or(f64::NAN);
    let q = row.totals.queries as f64;
    let other: u64 = [Solver::Restart, Solver::Gjk, Solver::DoubleDouble, Solver::Exact]
        .iter()
        .map(|&l| row.totals.answered_by(l))
        .sum();
    println!(
        "{:<14} {:<7} {:>5} {:>8.1} {:>8.1} {:>9.0} {:>8.0} {:>10.0} {:>7.3} {:>9.5} {:>7.2} {:>8.3}%{}",
        row.scene,
        row.shape,
        row.n,
        at(0),
        at(1),
        at(2),
        at(3),
        at(4),
        at(0) / at(3),
        at(0) / at(4),
        row.totals.steps as f64 / q,
        100.0 * other as f64 / q,
        row.note
    );
}

/// Vertices of prisms: the sizes of the other shapes, and those of 128-gons and 8192-gons.
const PRISMS: [usize; 8] = [8, 32, 128, 256, 512, 2048, 8192, 16384];

pub(crate) const SCENES: [&str; 6] = [
    "coherent-0",
    "coherent-0.5",
    "coherent-5",
    "coherent-25",
    "random",
    "cold256-0.5",
];

/// Returns scenes, shapes and sizes in the order in which they run.
fn plan() -> Vec<(&'static str, &'static str, usize)> {
    let mut list = vec![];
    for scene in SCENES {
        for shape in ["sphere", "flat", "box", "prism", "cone"] {
            let sizes: &[usize] = if shape == "prism" { &PRISMS } else { &SIZES };
            for &n in sizes {
                let cold = scene.starts_with("cold");
                // Faces with many vertices and vertices with many edges concern the walk alone.
                let long = ["prism", "cone"].contains(&shape) && scene != "coherent-0.5";
                if (shape == "box" && n != 8) || (cold && n > 512) || long {
                    continue;
                }
                list.push((scene, shape, n));
            }
        }
    }
    list
}

pub(crate) fn degrees(scene: &str) -> Option<f64> {
    match scene {
        "coherent-0" => Some(0.0),
        "coherent-5" => Some(5.0),
        "coherent-25" => Some(25.0),
        "random" => None,
        _ => Some(0.5),
    }
}

pub(crate) fn run(o: &Options) -> Rows {
    let plan: Vec<_> = plan().into_iter().filter(|p| o.wants_cell(p.0, p.1, p.2)).collect();
    println!(
        "nanoseconds a query. ours: closest; walk: propose; exact: closest_exact; gjk: parry's, its simplex kept; parry: its distance.\n\
         /gjk, /parry: ours over theirs. steps: feature pairs looked at in a query; not walk: queries that another layer answered.\n"
    );
    println!(
        "{:<14} {:<7} {:>5} {:>8} {:>8} {:>9} {:>8} {:>10} {:>7} {:>9} {:>7} {:>9}",
        "scene", "shape", "n", "ours", "walk", "exact", "gjk", "parry", "/gjk", "/parry", "steps", "not walk"
    );
    let progress = Progress::new("race pairs", plan.len() as u64);
    let mut rows = vec![];
    for (scene, shape, n) in plan {
        let mut rng = Rng::new(1000 + n as u64);
        let cold = scene.starts_with("cold");
        let frames = match (cold, o.quick) {
            (true, quick) => {
                if quick {
                    10
                } else {
                    40
                }
            }
            (false, true) => 250,
            // So many that branch predictors do not learn the frames.
            (false, false) => {
                if n < 2048 {
                    20_000
                } else {
                    6000
                }
            }
        };
        let count = if cold { 256 } else { 1 };
        let pairs: Vec<Pair> = (0..count)
            .map(|_| pair(shape, n, degrees(scene), frames, &mut rng, !cold))
            .collect();
        let row = race(scene, shape, n, &pairs, o.quick);
        print(&row);
        rows.push(row);
        progress.step();
    }
    progress.done();
    let prism = |n| rows.iter().find(|r| r.shape == "prism" && r.n == n).map(|r| r.ns[&0]);
    if let (Some(few), Some(many)) = (prism(256), prism(16384)) {
        println!("a prism of 8192-gons costs {:.2} times one of 128-gons", many / few);
    }
    let mut csv = Rows::default();
    for row in &rows {
        for (&k, &ns) in &row.ns {
            csv.push((row.scene, row.shape, row.n), Engine::ALL[k].name(), ns, 1);
        }
    }
    csv
}
