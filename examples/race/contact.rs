//! Bodies in contact: depth, normal and contact points, ours against parry, the same frames for every engine, passes
//! interleaved.
//!
//! Every engine gets two world poses. `ours` and `parry-contact` return signed distance, normal and both points in the world;
//! the manifolds stay in the bodies' frames. Scenes: `shallow-0.5` holds a depth of 1 % of the size (0.02 at radius 1) while B
//! spins and orbits by half a degree a frame; `resting` lays a face on a face, with a noise of a millionth; `sliding` shifts
//! it by 1 % a frame (a random hull orbits without a spin, in contact); `passing` goes from apart to overlap and back, 4 % of the
//! radius each way, while B spins and orbits.

use std::hint::black_box;
use std::time::{Duration, Instant};

use lab::motion::Frame;
use lab::parry::{self, ContactPair};
use lab::pose::scale;
use lab::progress::Progress;
use lab::rng::Rng;
use lab::workload::{self, DEPTH, FacePlane, SIZES};
use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::{ConvexPolyhedron, FaceId, Manifold, ManifoldOptions, RelativePose, Tracker};

use crate::common::{Options, WARM_UP, isometry, median, plain};

/// Contacts this near are asked for: 1 % of the size.
const PREDICTION: f64 = 0.02;

const SCENES: [&str; 4] = ["shallow-0.5", "resting", "sliding", "passing"];

#[derive(Clone, Copy, PartialEq)]
enum Engine {
    Ours,
    Manifold,
    ParryContact,
    ParryManifold,
}

impl Engine {
    const ALL: [Engine; 4] = [
        Engine::Ours,
        Engine::Manifold,
        Engine::ParryContact,
        Engine::ParryManifold,
    ];

    fn name(self) -> &'static str {
        match self {
            Engine::Ours => "ours",
            Engine::Manifold => "ours-manifold",
            Engine::ParryContact => "parry-contact",
            Engine::ParryManifold => "parry-manifold-warm",
        }
    }
}

/// A pair of bodies in the form of each engine, and its motion.
struct Scene {
    a: ConvexPolyhedron,
    b: ConvexPolyhedron,
    parry: (parry::Hull, parry::Hull),
    poses: Vec<(Isometry3<f64>, Isometry3<f64>)>,
    parry_poses: Vec<(parry::ParryPose, parry::ParryPose)>,
}

fn body(shape: &str, n: usize, rng: &mut Rng) -> ConvexPolyhedron {
    let points: Vec<Point3<f64>> = workload::points(shape, n, rng).into_iter().map(Into::into).collect();
    ConvexPolyhedron::from_points(&points).expect("the points of a solid")
}

/// The face with the most room: its plane, and how far its corners are from its middle on the mean.
fn widest_face(body: &ConvexPolyhedron) -> (FacePlane, f64) {
    let of = |f: FaceId| {
        let corners: Vec<_> = body.face_vertices(f).filter_map(|v| body.vertex(v)).collect();
        let count = corners.len() as f64;
        let middle = corners
            .iter()
            .map(|p| p.coords)
            .sum::<lin_canny::nalgebra::Vector3<f64>>()
            / count;
        let reach = corners.iter().map(|p| (p.coords - middle).norm()).sum::<f64>() / count;
        let (normal, _) = body.face_plane(f).expect("a face of the body");
        ((middle.into(), normal.into_inner().into()), reach)
    };
    let faces = body.faces().map(of);
    faces.max_by(|x, y| x.1.total_cmp(&y.1)).expect("a solid has faces")
}

fn frames(
    scene: &str,
    shape: &str,
    count: usize,
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    rng: &mut Rng,
) -> Vec<Frame> {
    let mut pair = Tracker::new();
    let query = |f: &Frame| {
        let (pa, pb) = (isometry(&f.a), isometry(&f.b));
        let relative = RelativePose::new(&pa, &pb).expect("a pose");
        let o = pair.closest(a, b, &relative);
        (o.distance, (pa * o.normal.into_inner()).into())
    };
    let laid = |rng: &mut Rng| {
        let ((face_a, ra), (face_b, rb)) = (widest_face(a), widest_face(b));
        let reach = ra.min(rb);
        (
            workload::stacked(face_a, face_b, rng.range(0.0, 6.0), -1e-3 * reach),
            face_a,
            reach,
        )
    };
    match (scene, shape) {
        ("shallow-0.5", _) => workload::contact((0.5, 0.5), count, rng, |_| -DEPTH, query),
        ("passing", _) => {
            let swing = |k: usize| 2.0 * DEPTH * (std::f64::consts::TAU * k as f64 / 100.0).cos();
            workload::contact((0.5, 0.5), count, rng, swing, query)
        }
        ("sliding", "sphere" | "flat") => workload::contact((0.0, 0.5), count, rng, |_| -DEPTH, query),
        ("sliding", _) => {
            let (start, (_, up), reach) = laid(rng);
            let aside = lab::pose::unit(lab::pose::cross(up, [0.3, 0.5, 0.8]));
            workload::to_and_fro(start, scale(aside, 0.5 * reach), 200, count, rng)
        }
        _ => {
            let (start, _, reach) = laid(rng);
            workload::at_rest(start, 1e-6 * reach, reach, count, rng)
        }
    }
}

fn build(scene: &str, shape: &str, n: usize, count: usize) -> Option<Scene> {
    let mut rng = Rng::new(2000 + n as u64);
    let (a, b) = (body(shape, n, &mut rng), body(shape, n, &mut rng));
    let frames = frames(scene, shape, count, &a, &b, &mut rng);
    let mesh = |body: &ConvexPolyhedron| {
        let (points, faces) = plain(body);
        parry::mesh(&points, &faces)
    };
    Some(Scene {
        parry: (mesh(&a)?, mesh(&b)?),
        poses: frames.iter().map(|f| (isometry(&f.a), isometry(&f.b))).collect(),
        parry_poses: frames.iter().map(|f| (parry::pose(&f.a), parry::pose(&f.b))).collect(),
        a,
        b,
    })
}

/// What one engine keeps of the pair.
#[derive(Default)]
struct State {
    tracker: Tracker,
    manifold: Manifold,
    parry: ContactPair,
}

/// Signed distance of the deepest point, NaN where the engine has none; and how many points there are.
type Answer = (f64, usize);

#[inline(always)]
fn ask(engine: Engine, scene: &Scene, frame: usize, state: &mut State) -> Answer {
    let none = (f64::NAN, 0);
    match engine {
        Engine::Ours => {
            let (pa, pb) = &scene.poses[frame];
            let Ok(relative) = RelativePose::new(pa, pb) else {
                return none;
            };
            let o = state.tracker.closest(&scene.a, &scene.b, &relative);
            black_box((pa * o.point_on_a, pb * o.point_on_b, pa * o.normal.into_inner()));
            (o.distance, 1)
        }
        Engine::Manifold => {
            let (pa, pb) = &scene.poses[frame];
            let Ok(relative) = RelativePose::new(pa, pb) else {
                return none;
            };
            let (a, b) = (&scene.a, &scene.b);
            let options = ManifoldOptions::within(PREDICTION);
            state.tracker.manifold(a, b, &relative, &options, &mut state.manifold);
            let points = state.manifold.points();
            let deepest = points.iter().map(|p| p.separation).reduce(f64::min);
            (deepest.unwrap_or(f64::NAN), points.len())
        }
        Engine::ParryContact => {
            let (pa, pb) = &scene.parry_poses[frame];
            match parry::contact(&scene.parry.0, pa, &scene.parry.1, pb, PREDICTION) {
                Some(contact) => (black_box(contact).dist, 1),
                None => none,
            }
        }
        Engine::ParryManifold => {
            let (pa, pb) = &scene.parry_poses[frame];
            let points = state.parry.manifold(&scene.parry.0, pa, &scene.parry.1, pb, PREDICTION);
            let deepest = points.iter().map(|p| p.dist).reduce(f64::min);
            (deepest.unwrap_or(f64::NAN), points.len())
        }
    }
}

/// One pass over the first frames from a fresh state: nanoseconds a frame.
fn pass(engine: Engine, scene: &Scene, frames: usize) -> f64 {
    match engine {
        Engine::Ours => time(frames, |f, s| ask(Engine::Ours, scene, f, s)),
        Engine::Manifold => time(frames, |f, s| ask(Engine::Manifold, scene, f, s)),
        Engine::ParryContact => time(frames, |f, s| ask(Engine::ParryContact, scene, f, s)),
        Engine::ParryManifold => time(frames, |f, s| ask(Engine::ParryManifold, scene, f, s)),
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
    // The first pass finds the caches and branch tables of another engine; the last is the one that counts.
    let began = Instant::now();
    while began.elapsed() < WARM_UP {
        pass();
    }
    pass().as_nanos() as f64 / frames as f64
}

/// Answers of the first frames.
fn answers(engine: Engine, scene: &Scene, frames: usize) -> Vec<Answer> {
    let mut state = State::default();
    (0..frames).map(|f| ask(engine, scene, f, &mut state)).collect()
}

/// The least time of each frame over some passes, in which what the machine does besides hardly shows.
fn frame_times(engine: Engine, scene: &Scene, passes: usize) -> Vec<f64> {
    let mut least = vec![Duration::MAX; scene.poses.len()];
    for _ in 0..passes {
        let mut state = State::default();
        for (f, least) in least.iter_mut().enumerate() {
            let began = Instant::now();
            black_box(ask(engine, scene, f, &mut state));
            *least = began.elapsed().min(*least);
        }
    }
    least.iter().map(|t| t.as_nanos() as f64).collect()
}

/// Median of the frames and their 99th percentile over it.
fn spread(mut times: Vec<f64>) -> (f64, f64) {
    let middle = median(&mut times);
    (middle, times[times.len() * 99 / 100] / middle)
}

struct Row {
    scene: &'static str,
    shape: &'static str,
    n: usize,
    /// By engine.
    ns: Vec<f64>,
    /// Median of a frame of ours, and the 99th percentile over it.
    spread: (f64, f64),
    /// Contacts of a manifold on the mean, ours and parry's.
    points: [f64; 2],
    note: String,
}

/// How far an engine is off our certified signed distance, and how often it has no contact that it should have.
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

fn race(scene_name: &'static str, shape: &'static str, n: usize, quick: bool) -> Option<Row> {
    let count = if quick { 200 } else { 1000 };
    let scene = build(scene_name, shape, n, count)?;
    let share = |e: Engine| match e {
        Engine::Ours | Engine::Manifold => count,
        _ => (40_000 / n).clamp(16, count),
    };
    let reference = answers(Engine::Ours, &scene, count);
    let mut row = Row {
        scene: scene_name,
        shape,
        n,
        ns: vec![],
        spread: spread(frame_times(Engine::Ours, &scene, 3)),
        points: [0.0; 2],
        note: String::new(),
    };
    for engine in Engine::ALL {
        let answers = answers(engine, &scene, share(engine));
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
            list.push(pass(engine, &scene, share(engine)));
        }
    }
    row.ns = times.iter_mut().map(|list| median(list)).collect();
    Some(row)
}

fn print(row: &Row) {
    let at = |e: Engine| row.ns[Engine::ALL.iter().position(|&x| x == e).unwrap_or(0)];
    println!(
        "{:<12} {:<7} {:>5} {:>9.0} {:>9.0} {:>9.0} {:>9.0} {:>7.4} {:>7.4} {:>9.0} {:>6.1} {:>4.1} {:>4.1}{}",
        row.scene,
        row.shape,
        row.n,
        at(Engine::Ours),
        at(Engine::Manifold),
        at(Engine::ParryContact),
        at(Engine::ParryManifold),
        at(Engine::Ours) / at(Engine::ParryContact),
        at(Engine::Manifold) / at(Engine::ParryManifold),
        row.spread.0,
        row.spread.1,
        row.points[0],
        row.points[1],
        row.note
    );
}

/// Scenes, shapes and sizes in the order they run.
fn plan() -> Vec<(&'static str, &'static str, usize)> {
    let mut list = vec![];
    for scene in SCENES {
        let shapes: &[&str] = match scene {
            "resting" | "sliding" => &["sphere", "prism", "box"],
            _ => &["sphere", "flat", "box"],
        };
        for &shape in shapes {
            for n in SIZES {
                if shape != "box" || n == 8 {
                    list.push((scene, shape, n));
                }
            }
        }
    }
    list
}

pub(crate) fn run(words: &[String]) {
    let Some(o) = Options::of(words) else {
        eprintln!("usage: race contact [--csv FILE] [--quick] [--only SCENE]");
        std::process::exit(2);
    };
    let plan: Vec<_> = plan()
        .into_iter()
        .filter(|p| o.only.as_ref().is_none_or(|s| s == p.0))
        .collect();
    println!(
        "{:<12} {:<7} {:>5} {:>9} {:>9} {:>9} {:>9} {:>7} {:>7} {:>9} {:>6} {:>9}",
        "scene", "shape", "n", "ours", "manifold", "parry", "p-manif", "/parry", "/p-man", "frame", "p99", "points"
    );
    let progress = Progress::new("race contact", plan.len() as u64);
    let mut rows = vec![];
    for (scene, shape, n) in plan {
        if let Some(row) = race(scene, shape, n, o.quick) {
            print(&row);
            rows.push(row);
        }
        progress.step();
    }
    progress.done();
    let lines = rows.iter().flat_map(|row| {
        let engine = |(e, &ns): (&Engine, &f64)| (row.scene, row.shape, row.n, e.name(), ns);
        Engine::ALL.iter().zip(&row.ns).map(engine)
    });
    o.write(lines);
}
