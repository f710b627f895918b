//! A long run against an independent judge: random bodies of every hard family and curved shapes, moved at random, one tracker along
//! each motion, every frame judged.
//!
//! ```text
//! cargo run --release -p lab --bin soak -- --minutes 60 [--seed S] [--threads N] [--out DIR] [--trial K]
//! ```
//!
//! What fails is written to DIR (`target/soak-failures`) as a text that `cargo run --example replay` answers; the run goes on and
//! ends with exit code 1. A trial is named by seed and number: `--trial K` runs that one alone.

mod curved;
mod draw;
mod faulty;
mod judge;
mod tally;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use clap::Parser;
use draw::Trial;
use judge::Judge;
use lab::command::{count, number};
use lab::driven::{lattice, scenes};
use lab::motion::Frame;
use lab::progress::Progress;
use lab::rng::Rng;
use lab::support;
use lin_canny::broad::PencilSweep;
use lin_canny::scene::Scene;
use lin_canny::{Accuracy, Class, Manifold, ManifoldOptions, Outcome, RelativePose, Tracker};
use tally::Tally;

/// Random bodies of every hard family and curved shapes in random motions, meshes with the faults of
/// real files, worlds of boxes, and scenes of bodies of every kind, every frame judged by arithmetic of
/// its own
///
/// Failures are written to DIR as texts for the example replay, and end the program with status 1.
#[derive(Parser)]
struct Options {
    /// How long
    #[arg(long, value_name = "M", default_value_t = 1.0, value_parser = number(0.0))]
    minutes: f64,
    /// Names the run
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Threads
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = count(1))]
    threads: usize,
    /// Where failures go
    #[arg(long, value_name = "DIR", default_value = "target/soak-failures")]
    out: PathBuf,
    /// This trial alone
    #[arg(long, value_name = "K")]
    trial: Option<u64>,
}

/// One motion with all that is kept along it.
struct Run<'a> {
    options: &'a Options,
    number: u64,
    trial: &'a Trial,
    judge: Judge,
    pair: Tracker,
    /// Along the same motion, letters exchanged.
    back: Tracker,
    rng: Rng,
    tally: Tally,
}

impl Run<'_> {
    fn fail(&mut self, frame: usize, before: &Tracker, pose: &RelativePose, what: &str) {
        self.tally.failures += 1;
        let (a, b) = (&self.trial.a, &self.trial.b);
        let head = format!(
            "seed {} trial {} frame {frame}: {} ({}) and {} ({}), {}\n{what}",
            self.options.seed, self.number, a.family, a.shape.name, b.family, b.shape.name, self.trial.motion
        );
        eprintln!("{head}\n");
        let replay = before.replay(&a.body, &b.body, pose, Accuracy::Certified);
        let text: String = head.lines().map(|l| format!("# {l}\n")).collect();
        let name = format!("{}-{}-{frame}.txt", self.options.seed, self.number);
        let file = self.options.out.join(name);
        let written =
            std::fs::create_dir_all(&self.options.out).and_then(|()| std::fs::write(&file, text + &replay.to_string()));
        if let Err(e) = written {
            eprintln!("{}: {e}", file.display());
        }
    }

    fn frames(&mut self) {
        let truths: [usize; 3] = std::array::from_fn(|_| self.rng.below(self.trial.frames.len()));
        let mut last: Option<(Frame, f64)> = None;
        for (k, frame) in self.trial.frames.iter().enumerate() {
            let pose = support::relative(frame);
            let before = self.pair.clone();
            let began = Instant::now();
            let asked = catch_unwind(AssertUnwindSafe(|| {
                self.pair.closest(&self.trial.a.body, &self.trial.b.body, &pose)
            }));
            self.tally.slowest = self.tally.slowest.max((began.elapsed().as_nanos(), self.number));
            self.tally.queries += 1;
            let Ok(o) = asked else {
                self.fail(k, &before, &pose, "a panic");
                self.pair.reset();
                last = None;
                continue;
            };
            self.tally.frame(self.trial.motion, &o);
            let (mut fault, exactly) = self.judge.fault(frame, &o, k % 64 == 0);
            fault = fault.or(self.pair.check().err());
            self.tally.exactly += u64::from(exactly);
            if let Some((old, s)) = last
                && fault.is_none()
                && (o.distance - s).abs() > self.judge.most_change(&old, frame)
            {
                fault = Some(format!("the distance jumped from {s:e}"));
            }
            if fault.is_none() && self.trial.motion == draw::ALONG_A_RIM {
                fault = self.contacts(frame, &pose, &o);
            }
            last = Some((*frame, o.distance));
            if fault.is_none() && self.rng.chance(0.125) {
                fault = self.more(frame, &pose, &o);
            }
            if fault.is_none() && truths.contains(&k) {
                fault = self.against_truth(frame, &pose, &o);
            }
            if let Some(what) = fault {
                self.fail(k, &before, &pose, &format!("{what}\n{o:?}"));
            }
        }
    }

    /// Other ways to the same answer, and directions that might refute it.
    fn more(&mut self, frame: &Frame, pose: &RelativePose, o: &Outcome) -> Option<String> {
        let (a, b) = (&self.trial.a.body, &self.trial.b.body);
        let cold = Tracker::new().closest(a, b, pose);
        let swapped = self.back.closest(b, a, &pose.swapped());
        let exact = Tracker::new().closest_exact(a, b, pose);
        let intersects = self.pair.intersects(a, b, pose);
        let within = self.pair.within(a, b, pose, o.upper.max(0.0));
        let beyond = o.lower > 0.0 && self.pair.within(a, b, pose, o.lower.next_down());
        self.tally.queries += 6;
        let wrong = |holds: bool, what: &str| (!holds).then(|| what.to_owned());
        judge::differ(o, &cold)
            .or_else(|| judge::differ(o, &swapped))
            .or_else(|| judge::differ(o, &exact))
            .or_else(|| {
                wrong(
                    intersects == (o.class != Class::Separated),
                    "intersects contradicts the class",
                )
            })
            .or_else(|| wrong(within, "not within the upper bound"))
            .or_else(|| wrong(!beyond, "within less than the lower bound"))
            .or_else(|| self.judge.refuted(frame, o, &mut self.rng))
    }

    /// The manifold of an answer, judged.
    fn contacts(&mut self, frame: &Frame, pose: &RelativePose, o: &Outcome) -> Option<String> {
        let (a, b) = (&self.trial.a.body, &self.trial.b.body);
        let options = ManifoldOptions::within(o.upper.max(0.0));
        self.tally.manifolds += 1;
        self.judge
            .contact_fault(frame, o, &Manifold::of_outcome((a, b), pose, o, &options))
    }

    fn against_truth(&mut self, frame: &Frame, pose: &RelativePose, o: &Outcome) -> Option<String> {
        let truth = self.judge.truth(frame)?;
        let exact = Tracker::new().closest_exact(&self.trial.a.body, &self.trial.b.body, pose);
        self.tally.truths += 1;
        self.tally.queries += 1;
        let ulp = truth.distance.next_up() - truth.distance;
        let last_bit = truth.class != lab::Class::Separated || (exact.distance - truth.distance).abs() <= ulp;
        judge::against(&truth, o)
            .or_else(|| judge::against(&truth, &exact).map(|what| format!("{what}, and exactly {exact:?}")))
            .or_else(|| (!last_bit).then(|| format!("the truth is {:e}, not exactly {exact:?}", truth.distance)))
    }
}

/// One trial, all of it; a panic outside of a query is one too.
fn run(options: &Options, number: u64) -> Tally {
    let trial = draw::trial(options.seed, number);
    let mut run = Run {
        options,
        number,
        judge: Judge::new(&trial),
        trial: &trial,
        pair: Tracker::new(),
        back: Tracker::new(),
        rng: Rng::of_case(options.seed ^ 0x50a4, number),
        tally: Tally::default(),
    };
    run.tally.trials = 1;
    if catch_unwind(AssertUnwindSafe(|| run.frames())).is_err() {
        run.tally.failures += 1;
        eprintln!(
            "seed {} trial {number}: a panic beside the first query of a frame",
            options.seed
        );
    }
    worlds(options, number, &mut run.tally);
    curves(options, number, &mut run.tally);
    meshes(options, number, &mut run.tally);
    scenes_of_bodies(options, number, &mut run.tally);
    let frames = run.tally.frames;
    run.tally.body(trial.a.family, frames);
    run.tally.body(trial.b.family, frames);
    run.tally
}

/// Worlds of equal boxes a trial.
const WORLDS: u64 = 16;

/// The broad phase on lattices, bricks and stacks, each step against brute force. The soak used to draw pairs of bodies alone,
/// and nowhere were equal bounds, an index used again and slow motion drawn together.
fn worlds(options: &Options, number: u64, tally: &mut Tally) {
    for k in 0..WORLDS {
        let seed = Rng::of_case(options.seed ^ 0x1a77, number * WORLDS + k).bits();
        let played = catch_unwind(|| lattice::sequence(seed, PencilSweep::new()));
        let what = match played {
            Ok(Ok(mix)) => {
                tally.worlds.add(&mix);
                continue;
            }
            Ok(Err(what)) => what,
            Err(_) => "a panic".to_owned(),
        };
        tally.failures += 1;
        eprintln!("seed {} trial {number}: world {seed}: {what}", options.seed);
    }
}

/// Motions of curved shapes a trial.
const CURVES: u64 = 4;

/// Curved and rounded shapes; a failure is written as the numbers of the pair, since only polyhedra can be replayed.
fn curves(options: &Options, number: u64, tally: &mut Tally) {
    for k in 0..CURVES {
        let seed = Rng::of_case(options.seed ^ 0xc0c0, number * CURVES + k).bits();
        match curved::play(seed) {
            Ok(mix) => tally.curves.add(&mix),
            Err(what) => {
                tally.failures += 1;
                eprintln!("seed {} trial {number}: curved motion {seed}: {what}\n", options.seed);
            }
        }
    }
}

/// Pairs of meshes with faults a trial.
const MESHES: u64 = 2;

/// Meshes with triangles without area, cut edges, repeats and slivers, beside the same meshes without them.
fn meshes(options: &Options, number: u64, tally: &mut Tally) {
    for k in 0..MESHES {
        let seed = Rng::of_case(options.seed ^ 0xfa17, number * MESHES + k).bits();
        match faulty::play(seed) {
            Ok(mix) => tally.faulty.add(&mix),
            Err(what) => {
                tally.failures += 1;
                eprintln!("seed {} trial {number}: faulty meshes {seed}: {what}\n", options.seed);
            }
        }
    }
}

/// Scenes a trial, and the bytes of their calls.
const SCENES: u64 = 3;
const CALLS: usize = 1500;

/// Scenes of bodies of every kind, each step against brute force. Nowhere else were bodies without velocities, ticks, jumps and
/// files drawn together.
fn scenes_of_bodies(options: &Options, number: u64, tally: &mut Tally) {
    for k in 0..SCENES {
        let mut rng = Rng::of_case(options.seed ^ 0x5ce2, number * SCENES + k);
        let bytes: Vec<u8> = (0..CALLS).map(|_| rng.bits() as u8).collect();
        match catch_unwind(|| scenes::drive(&bytes, read_back)) {
            Ok(mix) => tally.scenes.add(&mix),
            Err(_) => {
                tally.failures += 1;
                eprintln!(
                    "seed {} trial {number}: scene {k} is not that of brute force",
                    options.seed
                );
            }
        }
    }
}

/// The scene as a file gives it back, if files are compiled in.
fn read_back(scene: &Scene) -> Scene {
    #[cfg(feature = "serde")]
    let read = serde_json::from_str(&serde_json::to_string(scene).expect("a scene is written")).expect("and read");
    #[cfg(not(feature = "serde"))]
    let read = scene.clone();
    read
}

/// Trials until the time is over.
fn soak(options: &Options) -> (Tally, f64) {
    let limit = Duration::from_secs_f64(60.0 * options.minutes);
    let (began, next) = (Instant::now(), AtomicU64::new(0));
    let bar = Progress::new("soak", limit.as_secs());
    let sum = Mutex::new(Tally::default());
    let work = || {
        while began.elapsed() < limit {
            let tally = run(options, next.fetch_add(1, Ordering::Relaxed));
            let mut sum = sum.lock().expect("no thread panics with the sum");
            sum.add(tally);
            bar.steps(began.elapsed().as_secs().saturating_sub(bar.done()));
            bar.say(&format!("{} queries, {} failures", sum.queries, sum.failures));
        }
    };
    std::thread::scope(|s| {
        (0..options.threads.max(1)).for_each(|_| drop(s.spawn(work)));
    });
    drop(bar);
    (
        sum.into_inner().expect("no thread panics with the sum"),
        began.elapsed().as_secs_f64(),
    )
}

fn main() -> ExitCode {
    lab::command::main(judge_all)
}

fn judge_all(options: &Options) -> Result<(), String> {
    println!("failures go to {}", options.out.display());
    let began = Instant::now();
    let (tally, seconds) = match options.trial {
        Some(number) => (run(options, number), began.elapsed().as_secs_f64()),
        None => soak(options),
    };
    println!("seed {}, {} threads", options.seed, options.threads);
    tally.print(seconds);
    match tally.failures {
        0 => Ok(()),
        n => Err(format!("{n} failures")),
    }
}
