//! Races bodies in contact: depth, normal and contact points, ours against parry.
//!
//! Every engine gets the same frames and two world poses, and passes are interleaved. `ours`,
//! `ours-local` (a local depth) and `parry-contact` return signed distance, normal and both points
//! in the world frame. Manifolds stay in the frames of the bodies. The scenes are defined in
//! `truth::contacts`.

use std::hint::black_box;
use std::time::{Duration, Instant};

use lin_canny::nalgebra::Isometry3;
use lin_canny::{ConvexPolyhedron, Manifold, ManifoldOptions, RelativePose, Tracker};
use race::progress::Progress;
use truth::contacts::{self, PREDICTION, SCENES, Scene, plain};
use truth::parry::{self, ContactPair};
use truth::workload::DEPTH;

use race::common::{Options, Rows, WARM_UP, median};

#[derive(Clone, Copy, PartialEq)]
enum Engine {
    Ours,
    Local,
    Manifold,
    ParryContact,
    ParryManifold,
}

impl Engine {
    const ALL: [Engine; 5] = [
        Engine::Ours,
        Engine::Local,
        Engine::Manifold,
        Engine::ParryContact,
        Engine::ParryManifold,
    ];

    fn name(self) -> &'static str {
        match self {
            Engine::Ours => "ours",
            Engine::Local => "ours-local",
            Engine::Manifold => "ours-manifold",
            Engine::ParryContact => "parry-contact",
            Engine::ParryManifold => "parry-manifold-warm",
        }
    }
}

/// A pair of bodies in the form of each engine, and its motion.
struct Race {
    scene: Scene,
    hulls: (parry::Hull, parry::Hull),
    poses: Vec<(Isometry3<f64>, Isometry3<f64>)>,
    parry_poses: Vec<(parry::ParryPose, parry::ParryPose)>,
}

impl Race {
    fn new(scene: Scene) -> Option<Self> {
        let hull = |body: &ConvexPolyhedron| {
            let (points, faces) = plain(body);
            parry::mesh(&points, &faces)
        };
        let parry_poses = scene.frames.iter().map(|f| (parry::pose(&f.a), parry::pose(&f.b)));
        Some(Self {
            hulls: (hull(&scene.a)?, hull(&scene.b)?),
            poses: scene.poses(),
            parry_poses: parry_poses.collect(),
            scene,
        })
    }
}

/// The state that an engine keeps for the pair.
#[derive(Default)]
struct State {
    tracker: Tracker,
    manifold: Manifold,
    parry: ContactPair,
}

/// Signed distance of the deepest point (NaN if the engine has none), and the number of points.
type Answer = (f64, usize);

#[inline(always)]
fn ask(engine: Engine, race: &Race, frame: usize, state: &mut State) -> Answer {
    let none = (f64::NAN, 0);
    match engine {
        Engine::Ours | Engine::Local => {
            let (pa, pb) = &race.poses[frame];
            let Ok(relative) = RelativePose::new(pa, pb) else {
                return none;
            };
            let (a, b, tracker) = (&race.scene.a, &race.scene.b, &mut state.tracker);
            let o = match engine {
                Engine::Local => tracker.closest_with_local_depth(a, b, &relative),
                _ => tracker.closest(a, b, &relative),
            };
            black_box((pa * o.point_on_a, pb * o.point_on_b, pa * o.normal.into_inner()));
            (o.distance, 1)
        }
        Engine::Manifold => {
            let (pa, pb) = &race.poses[frame];
            let Ok(relative) = RelativePose::new(pa, pb) else {
                return none;
            };
            let (a, b) = (&race.scene.a, &race.scene.b);
            let options = ManifoldOptions::default().prediction(PREDICTION);
            state.tracker.manifold(a, b, &relative, &options, &mut state.manifold);
            let points = state.manifold.points();
            let deepest = points.iter().map(|p| p.separation).reduce(f64::min);
            (deepest.unwrap_or(f64::NAN), points.len())
        }
        Engine::ParryContact => {
            let (pa, pb) = &race.parry_poses[frame];
            match parry::contact(&race.hulls.0, pa, &race.hulls.1, pb, PREDICTION) {
                Some(contact) => (black_box(contact).dist, 1),
                None => none,
            }
        }
        Engine::ParryManifold => {
            let (pa, pb) = &race.parry_poses[frame];
            let points = state.parry.manifold(&race.hulls.0, pa, &race.hulls.1, pb, PREDICTION);
            let deepest = points.iter().map(|p| p.dist).reduce(f64::min);
            (deepest.unwrap_or(f64::NAN), points.len())
        }
    }
}

/// Returns the nanoseconds per frame of one pass over the first frames, from a fresh state.
fn pass(engine: Engine, race: &Race, frames: usize) -> f64 {
    match engine {
        Engine::Ours => time(frames, |f, s| ask(Engine::Ours, race, f, s)),
        Engine::Local => time(frames, |f, s| ask(Engine::Local, race, f, s)),
        Engine::Manifold => time(frames, |f, s| ask(Engine::Manifold, race, f, s)),
        Engine::ParryContact => time(frames, |f, s| ask(Engine::ParryContact, race, f, s)),
        Engine::ParryManifold => time(frames, |f, s| ask(Engine::ParryManifold, race, f, s)),
    }
}

#[inline(always)]
fn time(frames: usize, ask: impl Fn(usize, &mut State) -> Answer) -> f64 {
    let pass = || {
        let mut state = State::default();
        let began = Instant::now();
        for f in 0..frames {
            black_box(ask(f, &mut state));
        }
        began.elapsed()
    };
    // The first passes warm up caches and branch predictors after another engine; only the last
    // pass counts.
    let began = Instant::now();
    while began.elapsed() < WARM_UP {
        pass();
    }
    pass().as_nanos() as f64 / frames as f64
}

/// Returns the answers of the first frames.
fn answers(engine: Engine, race: &Race, frames: usize) -> Vec<Answer> {
    let mut state = State::default();
    (0..frames).map(|f| ask(engine, race, f, &mut state)).collect()
}

/// Returns the least time of each frame over some passes, which suppresses other activity of the
/// machine.
fn frame_times(engine: Engine, race: &Race, passes: usize) -> Vec<f64> {
    let mut least = vec![Duration::MAX; race.poses.len()];
    for _ in 0..passes {
        let mut state = State::default();
        for (f, least) in least.iter_mut().enumerate() {
            let began = Instant::now();
            black_box(ask(engine, race, f, &mut state));
            *least = began.elapsed().min(*least);
        }
    }
    least.iter().map(|t| t.as_nanos() as f64).collect()
}

/// Returns the median of the frames, and the ratio of their 99th percentile to it.
fn spread(mut times: Vec<f64>) -> (f64, f64) {
    let middle = median(&mut times);
    (middle, times[times.len() * 99 / 100] / middle)
}

struct Row {
    scene: &'static str,
    shape: &'static str,
    n: usize,
    /// Nanoseconds per frame, by engine.
    ns: Vec<f64>,
    /// Median time per frame and the ratio of the 99th percentile to it: for `ours` and
    /// `ours-local`.
    spread: [(f64, f64); 2],
    /// Mean number of contacts of a manifold, ours and parry's.
    points: [f64; 2],
    note: String,
}

/// Returns how far an engine differs from our certified signed distance, and how often it misses a
/// contact.
fn compare(engine: Engine, answers: &[Answer], reference: &[Answer]) -> String {
    let (mut off, mut worst, mut missing) = (0, 0f64, 0);
    for (x, r) in answers.iter().zip(reference) {
        let due = r.0 < PREDICTION * (1.0 - 1e-6);
        if x.0.is_nan() {
            missing += usize::from(due);
        } else if due && (x.0 - r.0).abs() > 1e-6 * DEPTH {
            off += 1;
            worst = worst.max((x.0 - r.0).abs());
        }
    }
    if off + missing == 0 {
        return String::new();
    }
    format!(
        " {}: {off} of {} off by up to {worst:.0e}, {missing} missing;",
        engine.name(),
        answers.len()
    )
}

fn run_scene(scene: &'static str, shape: &'static str, n: usize, quick: bool) -> Option<Row> {
    let count = if quick { 200 } else { 1000 };
    let race = Race::new(Scene::new(scene, shape, n, count))?;
    let share = |e: Engine| match e {
        Engine::Ours | Engine::Local | Engine::Manifold => count,
        _ => (40_000 / n).clamp(16, count),
    };
    let reference = answers(Engine::Ours, &race, count);
    let mut row = Row {
        scene,
        shape,
        n,
        ns: vec![],
        spread: [Engine::Ours, Engine::Local].map(|e| spread(frame_times(e, &race, 3))),
        points: [0.0; 2],
        note: String::new(),
    };
    for engine in Engine::ALL {
        let answers = answers(engine, &race, share(engine));
        row.note += &compare(engine, &answers, &reference);
        let mean = answers.iter().map(|a| a.1 as f64).sum::<f64>() / answers.len() as f64;
        match engine {
            Engine::Manifold => row.points[0] = mean,
            Engine::ParryManifold => row.points[1] = mean,
            _ => {}
        }
    }
    let mut times = vec![vec![]; Engine::ALL.len()];
    for _ in 0..if quick { 3 } else { 9 } {
        for (list, engine) in times.iter_mut().zip(Engine::ALL) {
            list.push(pass(engine, &race, share(engine)));
        }
    }
    row.ns = times.iter_mut().map(|list| median(list)).collect();
    Some(row)
}

fn print(row: &Row) {
    let at = |e: Engine| row.ns[Engine::ALL.iter().position(|&x| x == e).unwrap_or(0)];
    println!(
        "{:<12} {:<7} {:>5} {:>9.0} {:>9.0} {:>9.0} {:>9.0} {:>9.0} {:>7.4} {:>7.4} {:>9.0} {:>6.1} {:>6.1} {:>4.1} {:>4.1}{}",
        row.scene,
        row.shape,
        row.n,
        at(Engine::Ours),
        at(Engine::Local),
        at(Engine::Manifold),
        at(Engine::ParryContact),
        at(Engine::ParryManifold),
        at(Engine::Ours) / at(Engine::ParryContact),
        at(Engine::Manifold) / at(Engine::ParryManifold),
        row.spread[0].0,
        row.spread[0].1,
        row.spread[1].1,
        row.points[0],
        row.points[1],
        row.note
    );
}

pub(crate) fn run(o: &Options) -> Rows {
    let scenes = SCENES.into_iter().filter(|s| o.wants(s));
    let plan: Vec<_> = scenes
        .flat_map(|scene| {
            contacts::shapes(scene)
                .into_iter()
                .map(move |(shape, n)| (scene, shape, n))
        })
        .filter(|p| o.wants_cell(p.0, p.1, p.2))
        .collect();
    println!(
        "nanoseconds a frame. ours: depth and witnesses; local: with a local depth; manifold: ours; parry: its contact; p-manif: its manifold, kept.\n\
         /parry, /p-man: ours over theirs. frame, p99: the median frame of ours, and the 99th percentile over it; l-p99: of local. points: contacts of a\n\
         manifold on the mean, ours and parry's. off: how far a signed distance is from our certified one, for bodies of radius 1.\n"
    );
    println!(
        "{:<12} {:<7} {:>5} {:>9} {:>9} {:>9} {:>9} {:>9} {:>7} {:>7} {:>9} {:>6} {:>6} {:>9}",
        "scene",
        "shape",
        "n",
        "ours",
        "local",
        "manifold",
        "parry",
        "p-manif",
        "/parry",
        "/p-man",
        "frame",
        "p99",
        "l-p99",
        "points"
    );
    let progress = Progress::new("race contact", plan.len() as u64);
    let mut rows = vec![];
    for (scene, shape, n) in plan {
        if let Some(row) = run_scene(scene, shape, n, o.quick) {
            print(&row);
            rows.push(row);
        }
        progress.step();
    }
    progress.done();
    let mut csv = Rows::default();
    for row in &rows {
        for (engine, &ns) in Engine::ALL.iter().zip(&row.ns) {
            csv.push((row.scene, row.shape, row.n), engine.name(), ns, 1);
        }
    }
    csv
}
