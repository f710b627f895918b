//! `race boxes`: broad phases on moving boxes, in nanoseconds of thread CPU time a body and step.
//!
//! What is timed: taking over the new boxes of a step and knowing the pairs afterwards. `ours` and `rapier` report
//! what began and ended; `parry-bvh` lists all pairs and remembers nothing, which is less. Boxes are tight, but for the
//! scenes where most boxes rest or crawl, where `ours` takes the margin rapier always has (0.04).

use crate::hulls;
use cpu_time::ThreadTime;
use lab::boxes::{Kind, Scene};
use lin_canny::broad::{Aabb, Body, BodyId, BroadPhase, PencilSweep, SortedAxes};
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use rapier3d::prelude as rapier;
use std::fmt::Write as _;
use std::time::{Duration, Instant};

/// A broad phase that is fed a scene.
trait Engine {
    fn name(&self) -> &'static str;
    /// Preparation that is not timed: the step's input in the form the engine wants it.
    fn prepare(&mut self, scene: &Scene);
    /// The timed part.
    fn step(&mut self);
    /// Pairs present, where the engine counts them.
    fn pairs(&self) -> Option<usize>;
    /// Bytes of the whole structure, where the engine tells.
    fn bytes(&self) -> Option<usize>;
}

struct Ours<B> {
    name: &'static str,
    broad: B,
    ids: Vec<BodyId>,
    batch: Vec<(BodyId, Aabb)>,
}

impl<B: BroadPhase> Ours<B> {
    fn new(name: &'static str, mut broad: B, scene: &Scene) -> Self {
        let margin = if matches!(scene.kind, Kind::Movers | Kind::UniformSlow) {
            0.04
        } else {
            0.0
        };
        let body = Body::moving().margin(margin);
        let ids = scene.boxes.iter().filter_map(|b| broad.insert(b, body).ok()).collect();
        Self {
            name,
            broad,
            ids,
            batch: Vec::new(),
        }
    }
}

impl<B: BroadPhase> Engine for Ours<B> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn prepare(&mut self, scene: &Scene) {
        self.batch.clear();
        self.batch.extend(
            scene
                .moved
                .iter()
                .map(|&i| (self.ids[i as usize], scene.boxes[i as usize])),
        );
    }

    fn step(&mut self) {
        assert!(self.broad.set_boxes(&self.batch).is_ok());
        std::hint::black_box(self.broad.step());
    }

    fn pairs(&self) -> Option<usize> {
        Some(self.broad.pair_count())
    }

    fn bytes(&self) -> Option<usize> {
        Some(self.broad.bytes())
    }
}

/// parry's tree alone: leaves updated in place, optimised and refitted as its documentation has it, all pairs listed.
struct Parry {
    tree: Bvh,
    workspace: BvhWorkspace,
    boxes: Vec<(u32, parry3d::bounding_volume::Aabb)>,
    pairs: Vec<(u32, u32)>,
}

fn parry_box(aabb: &Aabb) -> parry3d::bounding_volume::Aabb {
    let point = |p: &nalgebra::Point3<f64>| parry3d::math::Vector::new(p.x as f32, p.y as f32, p.z as f32);
    parry3d::bounding_volume::Aabb::new(point(&aabb.min), point(&aabb.max))
}

impl Parry {
    fn new(scene: &Scene) -> Self {
        let leaves: Vec<_> = scene.boxes.iter().map(parry_box).collect();
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves);
        Self {
            tree,
            workspace: BvhWorkspace::default(),
            boxes: Vec::new(),
            pairs: Vec::new(),
        }
    }
}

impl Engine for Parry {
    fn name(&self) -> &'static str {
        "parry-bvh"
    }

    fn prepare(&mut self, scene: &Scene) {
        self.boxes.clear();
        self.boxes
            .extend(scene.moved.iter().map(|&i| (i, parry_box(&scene.boxes[i as usize]))));
    }

    fn step(&mut self) {
        for (i, aabb) in &self.boxes {
            self.tree.insert_or_update_partially(*aabb, *i, 0.0);
        }
        self.tree.optimize_incremental(&mut self.workspace);
        self.tree.refit(&mut self.workspace);
        self.pairs.clear();
        let pairs = &mut self.pairs;
        self.tree
            .traverse_bvtt_single_tree::<false>(&mut self.workspace, &mut |a, b| pairs.push((a, b)));
    }

    fn pairs(&self) -> Option<usize> {
        Some(self.pairs.len())
    }

    fn bytes(&self) -> Option<usize> {
        Some(self.tree.total_memory_size() + self.pairs.capacity() * size_of::<(u32, u32)>())
    }
}

/// rapier's broad phase at its best: cuboids without bodies, no prediction distance.
struct Rapier {
    broad: rapier::BroadPhaseBvh,
    parameters: rapier::IntegrationParameters,
    colliders: rapier::ColliderSet,
    bodies: rapier::RigidBodySet,
    handles: Vec<rapier::ColliderHandle>,
    modified: Vec<rapier::ColliderHandle>,
    events: Vec<rapier::BroadPhasePairEvent>,
}

impl Rapier {
    fn new(scene: &Scene) -> Self {
        let mut colliders = rapier::ColliderSet::new();
        let mut bodies = rapier::RigidBodySet::new();
        let handles = scene.boxes.iter().map(|aabb| {
            let half = (aabb.max - aabb.min) * 0.5;
            let at = aabb.min + half;
            let collider = rapier::ColliderBuilder::cuboid(half.x as f32, half.y as f32, half.z as f32)
                .translation(rapier::Vector::new(at.x as f32, at.y as f32, at.z as f32))
                .active_collision_types(rapier::ActiveCollisionTypes::all());
            colliders.insert(collider)
        });
        let handles = handles.collect();
        let mut broad = rapier::BroadPhaseBvh::new();
        // One step of the pipeline clears the flags of new colliders; otherwise every update inserts every leaf anew.
        let mut islands = rapier::IslandManager::new();
        let mut narrow = rapier::NarrowPhase::new();
        rapier::CollisionPipeline::new().step(
            0.0,
            &mut islands,
            &mut broad,
            &mut narrow,
            &mut bodies,
            &mut colliders,
            &(),
            &(),
        );
        let parameters = rapier::IntegrationParameters {
            normalized_prediction_distance: 0.0,
            ..Default::default()
        };
        let (modified, events) = Default::default();
        Self {
            broad,
            parameters,
            colliders,
            bodies,
            handles,
            modified,
            events,
        }
    }
}

impl Engine for Rapier {
    fn name(&self) -> &'static str {
        "rapier"
    }

    fn prepare(&mut self, scene: &Scene) {
        self.modified.clear();
        for &i in &scene.moved {
            let aabb = &scene.boxes[i as usize];
            let at = nalgebra::center(&aabb.min, &aabb.max);
            let handle = self.handles[i as usize];
            if let Some(collider) = self.colliders.get_mut(handle) {
                collider.set_translation(rapier::Vector::new(at.x as f32, at.y as f32, at.z as f32));
                self.modified.push(handle);
            }
        }
        self.events.clear();
    }

    fn step(&mut self) {
        let Self {
            broad,
            parameters,
            colliders,
            bodies,
            modified,
            events,
            ..
        } = self;
        broad.update(parameters, colliders, bodies, modified, &[], events);
    }

    fn pairs(&self) -> Option<usize> {
        None
    }

    fn bytes(&self) -> Option<usize> {
        None
    }
}

/// What was measured of one engine on one scene, in nanoseconds a body and step.
struct Row {
    mean: f64,
    median: f64,
    /// 99th percentile.
    high: f64,
    pairs: Option<usize>,
    bytes: Option<usize>,
}

/// Thread CPU time of reading the clock, to be taken off.
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

fn engine(name: &str, scene: &Scene) -> Box<dyn Engine> {
    match name {
        "ours" => Box::new(Ours::new("ours", PencilSweep::new(), scene)),
        "three-axes" => Box::new(Ours::new("three-axes", SortedAxes::new(), scene)),
        "parry-bvh" => Box::new(Parry::new(scene)),
        _ => Box::new(Rapier::new(scene)),
    }
}

/// Cases nobody wants to wait for.
fn skipped(name: &str, kind: Kind, n: usize) -> bool {
    let tree = name == "rapier" || name == "parry-bvh";
    (name == "three-axes" && n > 10_000) || (tree && kind == Kind::Teleport && n > 10_000)
}

const RACED: [Kind; 7] = [
    Kind::Uniform,
    Kind::UniformSlow,
    Kind::Pile,
    Kind::Movers,
    Kind::Teleport,
    Kind::Mixed,
    Kind::Clusters,
];

/// Steps timed and steps before them, by the number of bodies.
fn steps(n: usize) -> (usize, usize) {
    match n {
        1_000 => (1000, 100),
        10_000 => (200, 60),
        100_000 => (50, 25),
        _ => (20, 6),
    }
}

/// A number in a table, or a dash where the engine does not tell.
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

/// All engines on one scene; means by engine.
fn race(kind: Kind, n: usize, engines: &str, csv: &mut String) -> Vec<(String, f64)> {
    let scene = Scene::new(kind, n);
    let (steps, warm) = steps(n);
    let (mut ours, mut means) = (f64::NAN, Vec::new());
    for name in engines.split(',').filter(|name| !skipped(name, kind, n)) {
        let mut racer = engine(name, &scene);
        let limit = Duration::from_secs(if name == "ours" { 30 } else { 5 });
        let row = measure(racer.as_mut(), scene.clone(), steps, warm, limit);
        if name == "ours" {
            ours = row.mean;
        }
        print_row(kind.name(), n, racer.name(), &row, ours);
        let _ = writeln!(csv, "{},box,{n},{},{:.3}", kind.name(), racer.name(), row.mean);
        means.push((racer.name().to_owned(), row.mean));
    }
    means
}

/// How the cost of a step grows from `low` to `high` bodies: the exponent of n, by engine.
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

/// What overlaps cost: the uniform scene with larger boxes.
fn race_overlaps() {
    let n = 10_000;
    println!("\nuniform with larger boxes, ours: what overlaps cost\n{HEAD}");
    let mut points = Vec::new();
    for factor in [1.0, 1.5, 2.0, 3.0] {
        let scene = Scene::new(Kind::Uniform, n).grown(factor);
        let mut racer = engine("ours", &scene);
        let row = measure(racer.as_mut(), scene, 60, 30, Duration::from_secs(10));
        print_row(&format!("boxes x {factor}"), n, racer.name(), &row, row.mean);
        points.push((row.pairs.unwrap_or(0) as f64 / n as f64, row.mean));
    }
    let (first, last) = (points[0], points[points.len() - 1]);
    let each = (last.1 - first.1) / (last.0 - first.0);
    println!("a pair more costs {each:.1} ns a step");
}

pub(crate) fn run(arguments: &[String]) {
    let option = |name: &str| {
        let at = arguments.iter().position(|a| a == name)?;
        arguments.get(at + 1).cloned()
    };
    let only = option("--scene");
    let upto: usize = option("--upto").and_then(|n| n.parse().ok()).unwrap_or(1_000_000);
    let engines = option("--engines").unwrap_or("ours,parry-bvh,rapier,three-axes".into());
    let mut csv = String::from("scene,shape,n,engine,ns\n");
    println!("ns a body and step, thread CPU time; p99 and median over the steps; bytes a body and a pair\n\n{HEAD}");
    for kind in RACED {
        if only.as_ref().is_some_and(|name| name != kind.name()) {
            continue;
        }
        let sizes = [1_000, 10_000, 100_000, 1_000_000].into_iter().filter(|n| *n <= upto);
        let raced: Vec<_> = sizes.map(|n| (n, race(kind, n, &engines, &mut csv))).collect();
        let at = |n: usize| raced.iter().find(|r| r.0 == n).map(|(n, means)| (*n, &means[..]));
        if let (Some(low), Some(high)) = (at(1_000), at(100_000)) {
            print_growth(kind, low, high);
        }
    }
    if only.is_none() {
        race_overlaps();
        hulls::run(&mut csv);
    }
    if let Some(file) = option("--csv")
        && let Err(error) = std::fs::write(&file, csv)
    {
        eprintln!("{file}: {error}");
    }
}
