//! Two meshes tumble past each other while one tracker follows their closest features.
//!
//! `cargo run --release -p lin-canny-record --example track -- [A.obj|stl B.obj|stl] [--frames N] [--out track.svg]`
//!
//! With poses from a file the meshes are taken as they are, convex or not:
//! `cargo run --release -p lin-canny-record --example track -- A.stl B.stl --poses POSES.csv [--csv OUT.csv] [--out track.svg]`

mod given;
mod load;
mod motion;
mod options;
mod picture;

use std::io::{IsTerminal, Write, stderr};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use lin_canny::nalgebra::Isometry3;
use lin_canny::{ContactState, ConvexPolyhedron, Geometry, Outcome, PairTracker, RelativePose, Solver, Tracker};
use lin_canny_record::{PageOptions, Recorder, Recording, page};
use load::Loaded;
use options::Options;
use picture::{Curve, Drawn, Shown};
use truth::say;

type Trouble = Box<dyn std::error::Error>;

/// Lines of the table.
const LINES: usize = 24;

/// Frames between two readings of the clock and updates of the progress bar.
const BLOCK: usize = 512;

/// Largest number of points of a curve.
const CURVE: usize = 2000;

/// Every 16th frame is also queried by a new tracker.
const COLD: usize = 16;

/// The results of a motion.
struct Run {
    outcomes: Vec<Outcome>,
    tracker: Tracker,
    time: Duration,
    /// Mean number of steps of cold queries.
    cold: f64,
}

impl Run {
    /// Returns the frame with the least distance.
    fn closest(&self) -> Option<(usize, &Outcome)> {
        let frames = self.outcomes.iter().enumerate();
        frames.min_by(|x, y| x.1.distance.total_cmp(&y.1.distance))
    }
}

fn main() -> ExitCode {
    truth::command::main(track)
}

fn track(options: &Options) -> Result<(), Trouble> {
    let [a, b] = &options.pair();
    truth::command::writable(&options.out)?;
    if let Some(poses) = &options.poses {
        return given::answer(options, [a, b], poses);
    }
    let (a, b) = (load::load('A', a)?, load::load('B', b)?);
    let poses = motion::poses(&a.body, &b.body, options.frames as usize);
    let run = follow(&a.body, &b.body, &poses)?;
    if options.record.is_some() || options.page.is_some() {
        let lines = record([&a.body, &b.body], &poses)?;
        if let Some(file) = &options.record {
            truth::command::write(file, std::str::from_utf8(&lines)?)?;
        }
        if let Some(file) = &options.page {
            let recording = Recording::read(lines.as_slice())?;
            truth::command::write(file, &page(&recording, &PageOptions::default()))?;
        }
    }
    table(&a, &b, &run);
    summary(&run);
    draw(options, [&a.body, &b.body], &poses, &run)?;
    Ok(())
}

/// Queries every frame with one tracker.
fn follow(a: &ConvexPolyhedron, b: &ConvexPolyhedron, poses: &[[Isometry3<f64>; 2]]) -> Result<Run, Trouble> {
    let (mut tracker, mut outcomes, mut time) = (Tracker::new(), Vec::with_capacity(poses.len()), Duration::ZERO);
    // Answers of a block are stored in warm memory, so that the clock measures queries and no page
    // faults.
    let mut answers = Vec::with_capacity(BLOCK);
    for block in poses.chunks(BLOCK) {
        let began = Instant::now();
        for [pose_a, pose_b] in block {
            let a_from_b = RelativePose::new(pose_a, pose_b)?;
            answers.push(tracker.closest(a, b, &a_from_b));
        }
        time += began.elapsed();
        outcomes.append(&mut answers);
        progress(outcomes.len(), poses.len());
    }
    let mut cold = 0;
    for [pose_a, pose_b] in poses.iter().step_by(COLD) {
        cold += Tracker::new()
            .closest(a, b, &RelativePose::new(pose_a, pose_b)?)
            .work
            .steps;
    }
    Ok(Run {
        outcomes,
        tracker,
        time,
        cold: f64::from(cold) / poses.len().div_ceil(COLD) as f64,
    })
}

/// Shows the progress if stderr is a terminal; removes the line after the last frame.
fn progress(done: usize, all: usize) {
    let mut err = stderr();
    if err.is_terminal() {
        let line = if done < all {
            format!("\r{done} of {all} frames")
        } else {
            "\r\x1b[K".into()
        };
        let _ = err.write_all(line.as_bytes());
    }
}

/// Returns a recording of the motion and the answers.
fn record(bodies: [&ConvexPolyhedron; 2], poses: &[[Isometry3<f64>; 2]]) -> Result<Vec<u8>, Trouble> {
    let shapes = bodies.map(|body| Geometry::from(body.clone()));
    let mut recorder = Recorder::new(Vec::new(), "two meshes tumble past each other")?;
    let a = recorder.body("A", &shapes[0], &poses[0][0])?;
    let b = recorder.body("B", &shapes[1], &poses[0][1])?;
    let mut tracker = PairTracker::new();
    for [pose_a, pose_b] in poses.iter().step_by(poses.len().div_ceil(CURVE)) {
        recorder.pose(a, pose_a)?;
        recorder.pose(b, pose_b)?;
        let a_from_b = RelativePose::new(pose_a, pose_b)?;
        recorder.answer(a, b, &tracker.closest(&shapes[0], &shapes[1], &a_from_b))?;
        recorder.end_frame()?;
    }
    Ok(recorder.finish()?)
}

/// Prints a line for every frame of a short motion, or for groups of frames: the first of the
/// group, and the steps of all.
fn table(a: &Loaded, b: &Loaded, run: &Run) {
    let group = run.outcomes.len().div_ceil(LINES);
    say!("\nNames: v vertex, e edge, f face, by the numbers of their points in the files.");
    if group > 1 {
        say!("Every {group}th frame; steps and changes of the features over the {group} frames from there on.");
    }
    say!(
        "\n{:>7}  {:>13}  {:>8}  {:<14} {:<14} {:>5} {:>4} {:>7}  layer",
        "frame",
        "distance",
        "+-",
        "on A",
        "on B",
        "steps",
        "most",
        "changes"
    );
    for (k, frames) in run.outcomes.chunks(group).enumerate() {
        let first = &frames[0];
        let steps: u32 = frames.iter().map(|o| o.work.steps).sum();
        let changes = frames.windows(2).filter(|w| w[0].features != w[1].features).count();
        say!(
            "{:>7}  {:>13.8}  {:>8.1e}  {:<14} {:<14} {:>5.1} {:>4} {:>7}  {}",
            k * group,
            first.distance,
            (first.upper - first.lower) / 2.0,
            a.name(first.features.a),
            b.name(first.features.b),
            f64::from(steps) / frames.len() as f64,
            frames.iter().map(|o| o.work.steps).max().unwrap_or(0),
            changes,
            word(first),
        );
    }
}

/// Returns the contact state if the bodies are not separated, otherwise the solver that answered.
fn word(outcome: &Outcome) -> String {
    match outcome.state {
        ContactState::Separated => format!("{:?}", outcome.solver).to_lowercase(),
        state => format!("{state:?}").to_lowercase(),
    }
}

fn summary(run: &Run) {
    let (totals, frames) = (run.tracker.work(), run.outcomes.len());
    if let Some((frame, o)) = run.closest() {
        say!(
            "\nclosest: {} in [{}, {}] at frame {frame}",
            o.distance,
            o.lower,
            o.upper
        );
    }
    let layers = [
        (Solver::Walk, "walk"),
        (Solver::Restart, "restarted walk"),
        (Solver::Gjk, "fallback"),
        (Solver::DoubleDouble, "double-double"),
        (Solver::Exact, "exact"),
        (Solver::Far, "far"),
    ];
    let answered = layers
        .iter()
        .map(|(l, name)| (totals.answered_by(*l), name))
        .filter(|x| x.0 > 0);
    let answered: Vec<String> = answered.map(|(n, name)| format!("{name} {n}")).collect();
    say!("answered by: {} of {frames} frames", answered.join(", "));
    say!(
        "steps a frame: {:.2} tracked, {:.2} from nothing",
        totals.steps as f64 / frames as f64,
        run.cold
    );
    let each = run.time.as_nanos() as f64 / frames as f64;
    say!(
        "time a frame: {each:.0} ns, two poses in, certified answer out ({:.2?} in all)",
        run.time
    );
}

/// Draws the closest frame with the curves of distance and steps.
fn draw(
    options: &Options,
    bodies: [&ConvexPolyhedron; 2],
    poses: &[[Isometry3<f64>; 2]],
    run: &Run,
) -> Result<(), Trouble> {
    let group = run.outcomes.len().div_ceil(CURVE);
    let curve = |name, of: fn(&[Outcome]) -> f64| {
        let groups = run.outcomes.chunks(group).enumerate();
        let points = groups.map(|(k, g)| (k * group, of(g))).collect();
        Curve { name, points }
    };
    let distance = curve("distance", |g| {
        g.iter().map(|o| o.distance).fold(f64::INFINITY, f64::min)
    });
    let steps = curve("steps of the walk from the last frame's features", |g| {
        g.iter().map(|o| f64::from(o.work.steps)).fold(0.0, f64::max)
    });
    let Some((frame, outcome)) = run.closest() else {
        return Ok(());
    };
    let (features, poses) = ([outcome.features.a, outcome.features.b], &poses[frame]);
    let shown = Shown {
        bodies: [0, 1].map(|k| Drawn::convex(bodies[k], &poses[k], features[k])),
        normal: poses[0] * outcome.normal.into_inner(),
        points: [poses[0] * outcome.point_on_a, poses[1] * outcome.point_on_b],
        title: format!(
            "frame {frame}: {:.6} apart, between {:.12} and {:.12}",
            outcome.distance, outcome.lower, outcome.upper
        ),
    };
    picture::draw(&shown, &[distance, steps], &options.out)?;
    say!("\npicture of frame {frame}: {}", options.out.display());
    Ok(())
}
