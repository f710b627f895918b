//! Long test against an independent judge: random bodies of every hard family, and curved shapes,
//! in random motions.
//!
//! One tracker follows each motion, and every frame is judged.
//!
//! ```text
//! cargo run --release -p race --bin soak -- --minutes 60 [--seed S] [--threads N] [--out DIR] [--trial K]
//! ```
//!
//! A failure is written to DIR (`target/soak-failures`) as a text for
//! `cargo run -p race --example replay`. The run continues and ends with exit code 1. Seed and
//! number identify a trial: `--trial K` runs that trial alone.

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
use lin_canny::broad::SweepAndPrune;
use lin_canny::scene::Scene;
use lin_canny::{Accuracy, ContactState, Manifold, ManifoldOptions, Outcome, RelativePose, Tracker};
use race::progress::Progress;
use tally::Tally;
use truth::command::{count, number};
use truth::driven::{
    bytes, calls, clouds, copies, corners, distances, far, lattice, overlaps, planner, points, rays, repairs, scenes,
    slivers, solids, surfaces, throws, turned_boxes, underflow,
};
use truth::motion::Frame;
use truth::rng::Rng;
use truth::support;
use truth::tally::Tally as _;

/// Test random bodies in random motions and check every frame with independent arithmetic
///
/// Bodies are polyhedra of every hard family, curved shapes, meshes with the errors of real files,
/// meshes that bend, clouds and surfaces, near their origins and far away. Worlds are of boxes,
/// scenes with bodies of every kind, and worlds of the planner with segments, curves and ranges. A
/// failure is written to DIR as a text for the example replay, and the program then ends with
/// status 1.
#[derive(Parser)]
struct Options {
    /// Duration in minutes
    #[arg(long, value_name = "M", default_value_t = 1.0, value_parser = number(0.0))]
    minutes: f64,
    /// Random seed
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Number of threads
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = count(1))]
    threads: usize,
    /// Output folder of failures
    #[arg(long, value_name = "DIR", default_value = "target/soak-failures")]
    out: PathBuf,
    /// Number of the single trial to run
    #[arg(long, value_name = "K")]
    trial: Option<u64>,
}

impl Options {
    /// Returns the command that repeats a trial.
    fn command(&self, trial: u64) -> String {
        format!(
            "cargo run --release --all-features -p race --bin soak -- --seed {} --trial {trial}",
            self.seed
        )
    }
}

/// One motion with the state that is kept along it.
struct Run<'a> {
    options: &'a Options,
    number: u64,
    trial: &'a Trial,
    judge: Judge,
    pair: Tracker,
    /// Tracker of the same motion with A and B exchanged.
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
        let replay = before.replay(&a.body, &b.body, pose, Accuracy::Certified);
        let text: String = head.lines().map(|l| format!("# {l}\n")).collect();
        eprintln!("{text}{replay}\n{}\n", self.options.command(self.number));
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

    /// Compares an outcome with other queries that must agree, and searches directions that might
    /// refute it.
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
                    intersects == (o.state != ContactState::Separated),
                    "intersects contradicts the contact state",
                )
            })
            .or_else(|| wrong(within, "not within the upper bound"))
            .or_else(|| wrong(!beyond, "within less than the lower bound"))
            .or_else(|| self.judge.refuted(frame, o, &mut self.rng))
    }

    /// Judges the manifold of an outcome.
    fn contacts(&mut self, frame: &Frame, pose: &RelativePose, o: &Outcome) -> Option<String> {
        let (a, b) = (&self.trial.a.body, &self.trial.b.body);
        let options = ManifoldOptions::default().prediction(o.upper.max(0.0));
        self.tally.manifolds += 1;
        self.judge
            .contact_fault(frame, o, &Manifold::from_outcome(a, b, pose, o, &options))
    }

    fn against_truth(&mut self, frame: &Frame, pose: &RelativePose, o: &Outcome) -> Option<String> {
        let truth = self.judge.truth(frame)?;
        let exact = Tracker::new().closest_exact(&self.trial.a.body, &self.trial.b.body, pose);
        self.tally.truths += 1;
        self.tally.queries += 1;
        let ulp = truth.distance.next_up() - truth.distance;
        let last_bit = truth.state != truth::ContactState::Separated || (exact.distance - truth.distance).abs() <= ulp;
        judge::against(&truth, o)
            .or_else(|| judge::against(&truth, &exact).map(|what| format!("{what}, and exactly {exact:?}")))
            .or_else(|| (!last_bit).then(|| format!("the truth is {:e}, not exactly {exact:?}", truth.distance)))
    }
}

/// Runs one trial. A panic outside a query counts as a failure.
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
            "a panic outside the first query of a frame\n{}\n",
            options.command(number)
        );
    }
    drive(options, number, &mut run.tally);
    let frames = run.tally.frames;
    run.tally.body(trial.a.family, frames);
    run.tally.body(trial.b.family, frames);
    run.tally
}

/// A sequence that a trial plays after its motion: drawn from a seed, with a separate judge.
struct Driver {
    name: &'static str,
    /// Mixed into the seed, so that no two drivers draw the same numbers.
    salt: u64,
    /// Sequences per trial.
    count: u64,
    /// Plays the sequence of a seed; an error describes the fault.
    play: fn(u64, &mut Tally) -> Result<(), String>,
}

/// Bytes of the calls of a scene or a broad phase.
const CALLS: usize = 1500;

/// Bytes of three bodies and their poses.
const BODIES: usize = 1200;

fn random_bytes(seed: u64, count: usize) -> Vec<u8> {
    let mut rng = Rng::new(seed);
    (0..count).map(|_| rng.bits() as u8).collect()
}

const DRIVERS: [Driver; 23] = [
    // Lattices, bricks and stacks combine equal bounds, reused indices and slow motion. Brute force
    // checks each step.
    Driver {
        name: "world of equal boxes",
        salt: 0x1a77,
        count: 16,
        play: |seed, tally| lattice::sequence(seed, SweepAndPrune::new()).map(|mix| tally.worlds.add(&mix)),
    },
    // Walls, slides, replaced bodies and hostile numbers; brute force checks each step.
    Driver {
        name: "calls of the broad phase",
        salt: 0xca11,
        count: 4,
        play: |seed, tally| {
            tally.calls.add(&calls::drive(&random_bytes(seed, CALLS)));
            Ok(())
        },
    },
    // Polyhedra of any numbers, by every query.
    Driver {
        name: "bodies of random bytes",
        salt: 0xb17e,
        count: 16,
        play: |seed, tally| {
            tally.bytes.add(&bytes::drive(&random_bytes(seed, BODIES)));
            Ok(())
        },
    },
    // A failure is written as the numbers of the pair, because only polyhedra can be replayed.
    Driver {
        name: "motion of curved and rounded shapes",
        salt: 0xc0c0,
        count: 4,
        play: |seed, tally| curved::play(seed).map(|mix| tally.curves.add(&mix)),
    },
    // Triangles without area, cut edges, repeats and slivers, compared with the same meshes without
    // them.
    Driver {
        name: "pair of meshes with faults",
        salt: 0xfa17,
        count: 2,
        play: |seed, tally| faulty::play(seed).map(|mix| tally.faulty.add(&mix)),
    },
    // Volumes that two solids share: closed forms, and rationals.
    Driver {
        name: "overlap of lattice bodies",
        salt: 0x0e1a,
        count: 20,
        play: |seed, tally| overlaps::play(seed).map(|mix| tally.overlaps.add(&mix)),
    },
    Driver {
        name: "overlap of meshes",
        salt: 0x0e1b,
        count: 1,
        play: |seed, tally| overlaps::play_exactly(seed).map(|mix| tally.overlaps.add(&mix)),
    },
    // Meshes that lost triangles, or have some turned, doubled or apart, repaired.
    Driver {
        name: "damaged mesh",
        salt: 0xda4a,
        count: 2,
        play: |seed, tally| repairs::play(seed).map(|mix| tally.repairs.add(&mix)),
    },
    // Triangles that are a line up to rounding, on oblique lines and planes, among ordinary
    // triangles.
    Driver {
        name: "meshes of slivers",
        salt: 0x511f,
        count: 4,
        play: |seed, tally| slivers::play(seed).map(|mix| tally.slivers.add(&mix)),
    },
    // Equal, flush, nested and crossing solids whose coordinates are far from their origin.
    Driver {
        name: "solids with faces in common",
        salt: 0x501d,
        count: 1,
        play: |seed, tally| solids::play(seed).map(|mix| tally.solids.add(&mix)),
    },
    // Unions of boxes of every form pressed into inner corners, and meshes inside out.
    Driver {
        name: "bodies in inner corners",
        salt: 0xc027,
        count: 4,
        play: |seed, tally| corners::play(seed).map(|mix| tally.corners.add(&mix)),
    },
    // Points and rays closer to a closed mesh than rounding, judged over the rationals.
    Driver {
        name: "points and rays next to a mesh",
        salt: 0x9017,
        count: 1,
        play: |seed, tally| points::play(seed).map(|mix| tally.points.add(&mix)),
    },
    // Rays in planes of faces, along edges and within rounding of both, at poses off unit length.
    Driver {
        name: "rays at a body of any kind",
        salt: 0x4a95,
        count: 1,
        play: |seed, tally| rays::play(seed).map(|mix| tally.rays.add(&mix)),
    },
    // Points on rotated pieces whose vertices are far from the origins of the pieces.
    Driver {
        name: "points on rotated pieces",
        salt: 0x7b0c,
        count: 1,
        play: |seed, tally| turned_boxes::play(seed).map(|mix| tally.turned_boxes.add(&mix)),
    },
    // Compounds with pieces of all sizes, clones with a common ancestor, and equal bodies with
    // different numbers.
    Driver {
        name: "bodies that stand in for others",
        salt: 0x57a9,
        count: 1,
        play: |seed, tally| copies::play(seed).map(|mix| tally.copies.add(&mix)),
    },
    // Casts of convex and other bodies, judged at many times; planes of certificates by all
    // vertices.
    Driver {
        name: "throw of two bodies",
        salt: 0x7420,
        count: 6,
        play: |seed, tally| throws::play(seed).map(|mix| tally.throws.add(&mix)),
    },
    // Signed distances of points on, within rounding of and away from closed meshes, judged over
    // the rationals.
    Driver {
        name: "signed distances of points",
        salt: 0xd157,
        count: 1,
        play: |seed, tally| distances::play(seed).map(|mix| tally.distances.add(&mix)),
    },
    // Polyhedra so close that products and directions underflow, judged by whole numbers.
    Driver {
        name: "distance that underflows",
        salt: 0x0f10,
        count: 2,
        play: |seed, tally| underflow::play(seed).map(|mix| tally.underflows.add(&mix)),
    },
    // Clouds, judged element by element.
    Driver {
        name: "cloud and body",
        salt: 0xc10d,
        count: 2,
        play: |seed, tally| clouds::play(seed).map(|mix| tally.clouds.add(&mix)),
    },
    // Solids of every kind far from the origins of their frames, judged by exact arithmetic.
    Driver {
        name: "far pair",
        salt: 0xfa22,
        count: 2,
        play: |seed, tally| far::play(seed).map(|mix| tally.far.add(&mix)),
    },
    // Bézier surfaces, judged by points of both.
    Driver {
        name: "pair of surfaces",
        salt: 0x5a4f,
        count: 1,
        play: |seed, tally| surfaces::play(seed).map(|mix| tally.surfaces.add(&mix)),
    },
    // Changing worlds of the planner; segments, curves and ranges through them.
    Driver {
        name: "world of the planner",
        salt: 0x91a7,
        count: 1,
        play: |seed, tally| planner::play(seed).map(|mix| tally.planner.add(&mix)),
    },
    // Bodies without velocities, ticks, jumps and files are combined. Brute force checks each step.
    Driver {
        name: "scene of bodies of every kind",
        salt: 0x5ce2,
        count: 3,
        play: |seed, tally| {
            tally.scenes.add(&scenes::drive(&random_bytes(seed, CALLS), read_back));
            Ok(())
        },
    },
];

/// Plays all sequences of a trial.
fn drive(options: &Options, number: u64, tally: &mut Tally) {
    for driver in &DRIVERS {
        for k in 0..driver.count {
            let seed = Rng::of_case(options.seed ^ driver.salt, number * driver.count + k).bits();
            let played = catch_unwind(AssertUnwindSafe(|| (driver.play)(seed, tally)));
            let what = match played {
                Ok(Ok(())) => continue,
                Ok(Err(what)) => what,
                Err(_) => "a panic, or another answer than brute force gives (see above)".to_owned(),
            };
            tally.failures += 1;
            eprintln!("{} {seed}: {what}\n{}\n", driver.name, options.command(number));
        }
    }
}

/// Returns the scene as read back from a file, if serialisation is enabled; otherwise a clone.
fn read_back(scene: &Scene) -> Scene {
    #[cfg(feature = "serde")]
    let read = serde_json::from_str(&serde_json::to_string(scene).expect("a scene is written")).expect("and read");
    #[cfg(not(feature = "serde"))]
    let read = scene.clone();
    read
}

/// Runs trials until the time is over.
fn soak(options: &Options) -> (Tally, f64) {
    let limit = Duration::from_secs_f64(60.0 * options.minutes);
    let (began, next) = (Instant::now(), AtomicU64::new(0));
    let bar = Progress::new("soak", limit.as_secs());
    let sum = Mutex::new(Tally::default());
    let work = || {
        while began.elapsed() < limit {
            let tally = run(options, next.fetch_add(1, Ordering::Relaxed));
            let mut sum = sum.lock().expect("no thread panics with the sum");
            sum.add(&tally);
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
    truth::command::main(judge_all)
}

fn judge_all(options: &Options) -> Result<(), String> {
    println!("seed {}, failures go to {}", options.seed, options.out.display());
    let began = Instant::now();
    let (tally, seconds) = match options.trial {
        Some(number) => (run(options, number), began.elapsed().as_secs_f64()),
        None => soak(options),
    };
    tally.print(seconds);
    match tally.failures {
        0 => Ok(()),
        n => Err(format!("{n} failures")),
    }
}
