//! Cost per call of the contact dispatcher: replays the recorded calls of the first steps of a
//! pile.
//!
//! `cargo bench -p lin-canny-rapier --bench race -- calls [--csv FILE] [--bodies N] [--steps N] [--vertices N] [--quick]`
//!
//! Each engine runs the race `pile` with its own contacts. Every call is recorded with
//! the manifolds that the engine had before it, and repeated outside rapier: parry with its warm
//! manifold, ours with the contacts only. Times are thread CPU time per call in nanoseconds, the
//! least of the passes. `far` are calls whose shapes are beyond the prediction, `overlap` are calls
//! with a negative contact distance.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use crate::common::{Engine, Setup, bin, layers, pebble};
use clap::Args;
use cpu_time::ThreadTime;
use lin_canny_rapier::single::CertifiedDispatcher;
use lin_canny_rapier::single::rapier::parry::query::details::{NormalConstraints, ShapeCastOptions};
use lin_canny_rapier::single::rapier::parry::query::{
    ClosestPoints, Contact, ContactManifoldsWorkspace, DefaultQueryDispatcher, NonlinearRigidMotion,
    PersistentQueryDispatcher, QueryDispatcher, ShapeCastHit, ShapeDistance, ShapeIntersection, Unsupported,
};
use lin_canny_rapier::single::rapier::prelude::*;
use race::progress::Progress;
use truth::command::{count, file, write};
use truth::rng::Rng;

#[derive(Args)]
pub(crate) struct Options {
    /// Output table, one row per engine, number of vertices and kind of call
    #[arg(long, value_name = "FILE.csv", value_parser = file("csv"))]
    csv: Option<PathBuf>,
    /// Number of hulls in the pile
    #[arg(long, value_name = "N", default_value_t = 500, default_value_if("quick", "true", "200"), value_parser = count(1))]
    bodies: usize,
    /// Number of steps whose calls are recorded
    #[arg(long, value_name = "N", default_value_t = 120, default_value_if("quick", "true", "60"), value_parser = count(1))]
    steps: usize,
    /// Vertices per hull [default: 8, 64 and 512]
    #[arg(long, value_name = "N", value_parser = count(4))]
    vertices: Option<usize>,
    /// Short run with 200 hulls and 60 steps
    #[arg(long)]
    quick: bool,
}

impl Options {
    /// Vertices of the hulls, pile by pile.
    fn sizes(&self) -> Vec<usize> {
        self.vertices.map_or_else(|| vec![8, 64, 512], |n| vec![n])
    }
}

/// Calls that are kept of a pile, the rest are drawn evenly: a call holds about a kilobyte.
const MOST: usize = 60_000;

const PASSES: usize = 5;

/// Calls whose manifolds are put back together: about as many as a step of the engine makes, whose
/// manifolds stay in the cache.
const AT_ONCE: usize = 512;

type Dispatcher = dyn PersistentQueryDispatcher<ContactManifoldData, ContactData>;

/// One call of the dispatcher.
struct Call {
    pose: Pose,
    shapes: [SharedShape; 2],
    prediction: Real,
    before: Vec<ContactManifold>,
}

/// What was seen: calls, and copies of shapes by the address of the engine's.
#[derive(Default)]
struct Log {
    calls: Vec<Call>,
    shapes: HashMap<usize, SharedShape>,
}

impl Log {
    fn shape(&mut self, shape: &dyn Shape) -> SharedShape {
        let address = std::ptr::from_ref(shape).cast::<u8>() as usize;
        let copy = || SharedShape(Arc::from(shape.clone_dyn()));
        self.shapes.entry(address).or_insert_with(copy).clone()
    }
}

/// A dispatcher that answers nothing and keeps the calls.
struct Recorder(Arc<Mutex<Log>>);

impl QueryDispatcher for Recorder {
    fn intersection_test(&self, _: &Pose, _: &dyn Shape, _: &dyn Shape) -> Result<ShapeIntersection, Unsupported> {
        Err(Unsupported)
    }

    fn distance(&self, _: &Pose, _: &dyn Shape, _: &dyn Shape) -> Result<ShapeDistance, Unsupported> {
        Err(Unsupported)
    }

    fn contact(&self, _: &Pose, _: &dyn Shape, _: &dyn Shape, _: Real) -> Result<Option<Contact>, Unsupported> {
        Err(Unsupported)
    }

    fn closest_points(&self, _: &Pose, _: &dyn Shape, _: &dyn Shape, _: Real) -> Result<ClosestPoints, Unsupported> {
        Err(Unsupported)
    }

    fn cast_shapes(
        &self,
        _: &Pose,
        _: Vector,
        _: &dyn Shape,
        _: &dyn Shape,
        _: ShapeCastOptions,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        Err(Unsupported)
    }

    fn cast_shapes_nonlinear(
        &self,
        _: &NonlinearRigidMotion,
        _: &dyn Shape,
        _: &NonlinearRigidMotion,
        _: &dyn Shape,
        _: Real,
        _: Real,
        _: bool,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        Err(Unsupported)
    }
}

impl PersistentQueryDispatcher<ContactManifoldData, ContactData> for Recorder {
    fn contact_manifolds(
        &self,
        pos12: &Pose,
        a: &dyn Shape,
        b: &dyn Shape,
        prediction: Real,
        manifolds: &mut Vec<ContactManifold>,
        _: &mut Option<ContactManifoldsWorkspace>,
    ) -> Result<(), Unsupported> {
        let mut log = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let shapes = [log.shape(a), log.shape(b)];
        log.calls.push(Call {
            pose: *pos12,
            shapes,
            prediction,
            before: manifolds.clone(),
        });
        Err(Unsupported)
    }

    fn contact_manifold_convex_convex(
        &self,
        _: &Pose,
        _: &dyn Shape,
        _: &dyn Shape,
        _: Option<&dyn NormalConstraints>,
        _: Option<&dyn NormalConstraints>,
        _: Real,
        _: &mut ContactManifold,
    ) -> Result<(), Unsupported> {
        Err(Unsupported)
    }
}

/// Runs a pile and returns its calls.
fn recorded(options: &Options, engine: Engine, vertices: usize) -> Vec<Call> {
    let mut rng = Rng::of_case(0, vertices as u64);
    let hulls = (0..options.bodies)
        .map(|_| pebble(&mut rng, vertices, 0.3, 0.5))
        .collect();
    let mut scene = Setup::of(engine).scene(&bin(4.0, 12.0), &layers(&mut rng, hulls, 3.5, 1.05));
    let log = Arc::new(Mutex::new(Log::default()));
    let recorder = Recorder(log.clone());
    scene.world.narrow_phase = match engine {
        Engine::Parry => NarrowPhase::with_query_dispatcher(recorder.chain(DefaultQueryDispatcher)),
        Engine::Ours => NarrowPhase::with_query_dispatcher(recorder.chain(CertifiedDispatcher::default())),
    };
    (0..options.steps).for_each(|_| scene.world.step());
    let calls = std::mem::take(&mut log.lock().unwrap_or_else(PoisonError::into_inner).calls);
    let every = calls.len().div_ceil(MOST).max(1);
    calls.into_iter().step_by(every).collect()
}

/// Asks all calls again; returns nanoseconds a call and the least distance of each answer.
fn replayed(calls: &[&Call], dispatcher: &Dispatcher) -> (f64, Vec<Real>) {
    let deepest = |manifolds: &Vec<ContactManifold>| {
        let points = manifolds.iter().flat_map(|m| &m.points);
        points.map(|p| p.dist).fold(Real::INFINITY, Real::min)
    };
    let (mut least, mut found) = (f64::INFINITY, Vec::new());
    for _ in 0..PASSES {
        found.clear();
        let mut taken = 0.0;
        for calls in calls.chunks(AT_ONCE) {
            let mut manifolds: Vec<_> = calls.iter().map(|c| c.before.clone()).collect();
            let start = ThreadTime::now();
            for (call, manifolds) in calls.iter().zip(&mut manifolds) {
                let [a, b] = &call.shapes;
                let asked = dispatcher.contact_manifolds(&call.pose, &**a, &**b, call.prediction, manifolds, &mut None);
                asked.expect("a pair that was answered before");
            }
            taken += start.elapsed().as_nanos() as f64;
            found.extend(manifolds.iter().map(deepest));
        }
        least = least.min(taken / calls.len().max(1) as f64);
    }
    (least, found)
}

/// The lines of one engine: all calls, and those of each kind.
fn lines(options: &Options, engine: Engine, vertices: usize) -> Vec<String> {
    let calls = recorded(options, engine, vertices);
    let ours = CertifiedDispatcher::default();
    let dispatcher: &Dispatcher = match engine {
        Engine::Parry => &DefaultQueryDispatcher,
        Engine::Ours => &ours,
    };
    let all: Vec<&Call> = calls.iter().collect();
    let (ns, deepest) = replayed(&all, dispatcher);
    let name = engine.name();
    let line = |kind: &str, count: usize, ns: f64| format!("{name},{vertices},{kind},{count},{ns:.0}");
    let mut lines = vec![line("all", all.len(), ns)];
    for kind in ["far", "near", "overlap"] {
        let is_kind = |(call, d): &(&&Call, &Real)| match kind {
            "far" => **d > call.prediction,
            "near" => **d > 0.0 && **d <= call.prediction,
            _ => **d <= 0.0,
        };
        let of: Vec<&Call> = all.iter().zip(&deepest).filter(is_kind).map(|(c, _)| *c).collect();
        lines.push(line(kind, of.len(), replayed(&of, dispatcher).0));
    }
    lines
}

pub(crate) fn run(options: &Options) -> Result<(), String> {
    let mut csv = String::from("engine,vertices,kind,calls,ns\n");
    print!("{csv}");
    let bar = Progress::new("piles", 2 * options.sizes().len() as u64);
    for vertices in options.sizes() {
        for engine in Engine::BOTH {
            for line in lines(options, engine, vertices) {
                println!("{line}");
                let _ = writeln!(csv, "{line}");
            }
            bar.step();
        }
    }
    options.csv.as_deref().map_or(Ok(()), |path| write(path, &csv))
}
