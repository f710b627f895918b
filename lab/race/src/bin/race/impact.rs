//! Races casts of two moving bodies: ours against conservative advancement and parry's three casts.
//!
//! Every engine gets the same throws, and passes are interleaved. Bodies have radius 1, B is aimed
//! past A, and every engine starts cold.
//!
//! - `ours` returns a proven bracket at a tolerance of 1e-9.
//! - `ours-5e-3` returns a bracket at the gap at which the sweep stops. It is judged by the start
//!   of the bracket, as the sweep is judged by the time of that gap.
//! - `ours-d3` advances by a directional bound until the gap is 5e-3, without a proof of a hit.
//! - `parry-sweep` is the cast that rapier 0.36 uses for fast bodies: contact at 5e-3, on the
//!   normalised interpolation of the end poses. It is judged on that motion.
//! - `parry-nonlinear` and `parry-linear` are parry's other casts.

use std::hint::black_box;

use cpu_time::ThreadTime;
use lin_canny::ConvexPolyhedron;
use lin_canny::Tracker;
use lin_canny::impact::{Cast, Impact, Tolerance, cast};
use lin_canny::motion::{Motion, Nlerp, Steady};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use race::progress::Progress;
use truth::casts::{self, Advance, SHAPES, Throw};
use truth::contacts::plain;
use truth::parry::casts::{Flight, SLOP, linear, nonlinear, sweep};
use truth::parry::{self, ParryPose};
use truth::rng::Rng;

use race::common::{Options, Rows};

/// Name of each scene, and largest rotation of each body in radians.
pub(crate) const SCENES: [(&str, f64); 5] = [
    ("turn-0", 0.0),
    ("turn-0.3", 0.3),
    ("turn-1", 1.0),
    ("turn-6", 6.0),
    ("turn-60", 60.0),
];

const SIZES: [usize; 5] = [8, 32, 128, 512, 2048];
const PAIRS: usize = 4;
const TOLERANCE: Tolerance = Tolerance::Distance(1e-9);

/// A time later than the end of our bracket by more than this counts as late.
const LATE: f64 = 1e-6;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Engine {
    Ours,
    Coarse,
    D3,
    Sweep,
    Nonlinear,
    Linear,
}

impl Engine {
    const ALL: [Engine; 6] = [
        Engine::Ours,
        Engine::Coarse,
        Engine::D3,
        Engine::Sweep,
        Engine::Nonlinear,
        Engine::Linear,
    ];

    fn name(self) -> &'static str {
        match self {
            Engine::Ours => "ours",
            Engine::Coarse => "ours-5e-3",
            Engine::D3 => "ours-d3",
            Engine::Sweep => "parry-sweep",
            Engine::Nonlinear => "parry-nonlinear",
            Engine::Linear => "parry-linear",
        }
    }
}

/// Two bodies in the form of each engine.
struct Pair {
    ours: [ConvexPolyhedron; 2],
    hulls: [parry::Hull; 2],
}

/// One throw in the form of each engine.
struct Case {
    pair: usize,
    throw: Throw,
    motions: [Steady; 2],
    flights: [([ParryPose; 2], [Vector3<f64>; 2]); 2],
    /// Our result for the motion, and for the sweep between its end poses.
    truth: Cast,
    swept: Cast,
}

fn parry_pose(pose: &Isometry3<f64>) -> ParryPose {
    let (t, q) = (pose.translation.vector, pose.rotation.coords);
    parry::pose(&truth::Pose {
        q: [q.x, q.y, q.z, q.w],
        t: t.into(),
    })
}

impl Case {
    fn new(pair: usize, bodies: &[ConvexPolyhedron; 2], throw: Throw) -> Option<Self> {
        let motions = throw.motions();
        let ends = [0, 1].map(|k| [motions[k].pose(0.0), motions[k].pose(1.0)]);
        let sweeps = ends.map(|[p, q]| Nlerp::new(&p, &q, 1.0, Point3::origin()));
        let [Ok(sweep_a), Ok(sweep_b)] = sweeps else {
            return None;
        };
        let cold = |a: &dyn Motion, b: &dyn Motion| {
            cast(
                &mut Tracker::new().pair(&bodies[0], &bodies[1]),
                a,
                b,
                0.0..1.0,
                TOLERANCE,
            )
            .ok()
        };
        Some(Self {
            pair,
            truth: cold(&motions[0], &motions[1])?,
            swept: cold(&sweep_a, &sweep_b)?,
            flights: [0, 1].map(|k| {
                let v = throw.velocity[k];
                (ends[k].map(|p| parry_pose(&p)), [v.linear, v.angular])
            }),
            throw,
            motions,
        })
    }

    fn flight<'a>(&self, pair: &'a Pair, k: usize) -> Flight<'a> {
        let (poses, [linear, angular]) = self.flights[k];
        let vector = |v: Vector3<f64>| [v.x, v.y, v.z].into();
        Flight {
            hull: &pair.hulls[k],
            poses,
            linear: vector(linear),
            angular: vector(angular),
        }
    }

    /// Returns the time at which the bodies meet according to an engine.
    fn ask(&self, engine: Engine, pairs: &[Pair]) -> Option<f64> {
        let pair = &pairs[self.pair];
        let [a, b] = &pair.ours;
        let cold = |tolerance| {
            let mut tracker = Tracker::new();
            let mut ours = tracker.pair(a, b);
            let [of_a, of_b] = &self.motions;
            cast(&mut ours, of_a, of_b, 0.0..1.0, tolerance).ok()
        };
        let flights = || (self.flight(pair, 0), self.flight(pair, 1));
        match engine {
            Engine::Ours => match cold(TOLERANCE)?.impact {
                Impact::Hit { hit, .. } => Some(hit),
                Impact::Miss => None,
                _ => Some(0.0),
            },
            Engine::Coarse => match cold(Tolerance::Distance(SLOP))?.impact {
                Impact::Hit { safe, .. } => Some(safe),
                Impact::Miss => None,
                _ => Some(0.0),
            },
            Engine::D3 => match casts::advance([a, b], &self.throw, SLOP, 100_000).0 {
                Advance::Near(time) | Advance::Limit(time) => Some(time),
                Advance::Miss => None,
                Advance::Start => Some(0.0),
            },
            Engine::Sweep => {
                let (a, b) = flights();
                sweep(&a, &b)
            }
            Engine::Nonlinear => {
                let (a, b) = flights();
                nonlinear(&a, &b)
            }
            Engine::Linear => {
                let (a, b) = flights();
                linear(&a, &b)
            }
        }
    }
}

fn pairs(shape: &str, n: usize, rng: &mut Rng) -> Option<Vec<Pair>> {
    let hull = |body: &ConvexPolyhedron| {
        let (points, faces) = plain(body);
        parry::mesh(&points, &faces)
    };
    (0..PAIRS)
        .map(|_| {
            let ours = [casts::body(shape, n, rng), casts::body(shape, n, rng)];
            let hulls = [hull(&ours[0])?, hull(&ours[1])?];
            Some(Pair { ours, hulls })
        })
        .collect()
}

/// Returns the missed and the late hits of an engine, and the number of hits.
fn faults(engine: Engine, cases: &[Case], pairs: &[Pair]) -> (usize, usize, usize) {
    let (mut missed, mut late, mut hits) = (0, 0, 0);
    for case in cases {
        let truth = if engine == Engine::Sweep {
            case.swept
        } else {
            case.truth
        };
        let Impact::Hit { hit, .. } = truth.impact else {
            continue;
        };
        hits += 1;
        match case.ask(engine, pairs) {
            None => missed += 1,
            Some(time) if time > hit + LATE => late += 1,
            Some(_) => {}
        }
    }
    (missed, late, hits)
}

/// Returns nanoseconds of thread time per cast, the least of some passes.
fn time(engine: Engine, cases: &[Case], pairs: &[Pair], passes: usize) -> f64 {
    let pass = || {
        let began = ThreadTime::now();
        for case in cases {
            black_box(case.ask(engine, pairs));
        }
        began.elapsed().as_nanos() as f64 / cases.len() as f64
    };
    (0..passes).map(|_| pass()).fold(f64::INFINITY, f64::min)
}

fn queries(cases: &[Case]) -> (u32, u32) {
    let hits = cases.iter().filter(|c| matches!(c.truth.impact, Impact::Hit { .. }));
    let mut list: Vec<u32> = hits.map(|c| c.truth.queries).collect();
    list.sort_unstable();
    match list.len() {
        0 => (0, 0),
        n => (list[n / 2], list[n * 95 / 100]),
    }
}

fn race(o: &Options, (scene, turn): (&'static str, f64), shape: &'static str, n: usize, rows: &mut Rows) -> Option<()> {
    let mut rng = Rng::new(n as u64 ^ 0x19);
    let pairs = pairs(shape, n, &mut rng)?;
    let count = if o.quick { 100 } else { 400 };
    let case = |k: usize| {
        let throw = casts::aimed(&mut rng, (1.0, 1.0), turn);
        Case::new(k % PAIRS, &pairs[k % PAIRS].ours, throw)
    };
    let cases: Vec<Case> = (0..count).filter_map(case).collect();
    let (median, most) = queries(&cases);
    print!("{scene:<9}{shape:<8}{n:>5}");
    let mut ours = 0.0;
    let mut notes = String::new();
    for engine in Engine::ALL {
        let runs = engine != Engine::Linear || turn == 0.0;
        let few = if engine == Engine::Nonlinear || engine == Engine::Sweep && n > 512 {
            &cases[..cases.len() / 4]
        } else {
            &cases[..]
        };
        if !runs {
            print!("{:>17}", "-");
            continue;
        }
        let ns = time(engine, few, &pairs, if o.quick { 2 } else { 5 });
        rows.push((scene, shape, n), engine.name(), ns, 1);
        if engine == Engine::Ours {
            ours = ns;
            print!("{:>9.2}", ns / 1000.0);
        } else {
            print!("{:>10.2}{:>7.3}", ns / 1000.0, ours / ns);
        }
        let (missed, late, hits) = faults(engine, few, &pairs);
        notes += &format!(" {missed}+{late}/{hits}");
    }
    println!("{median:>5}{most:>4} {notes}");
    Some(())
}

pub(crate) fn run(o: &Options) -> Rows {
    println!(
        "microseconds a cast over one unit of time; beside each rival ours over theirs. q: our queries a hit, median and 95th percentile.\n\
         faults: hits missed + late, of how many, engine by engine (ours judged by itself: its brackets are proven).\n"
    );
    println!(
        "{:<9}{:<8}{:>5}{:>9}{:>10}{:>7}{:>10}{:>7}{:>10}{:>7}{:>10}{:>7}{:>10}{:>7}{:>9}  faults",
        "scene", "shape", "n", "ours", "5e-3", "", "d3", "", "sweep", "", "nonlin", "", "linear", "", "q"
    );
    let mut rows = Rows::default();
    let progress = Progress::new("race impact", (SCENES.len() * SHAPES.len() * SIZES.len()) as u64);
    for scene in SCENES.into_iter().filter(|s| o.wants(s.0)) {
        for shape in SHAPES {
            for n in SIZES {
                progress.step();
                if (shape == "box" && n > 8) || o.quick && n > 128 || !o.wants_cell(scene.0, shape, n) {
                    continue;
                }
                if race(o, scene, shape, n, &mut rows).is_none() {
                    eprintln!("{shape} {n}: no body of parry's");
                }
            }
        }
    }
    rows
}
