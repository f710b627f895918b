//! `race boxes`: broad phases on moving boxes, in nanoseconds of thread CPU time a body and step.
//!
//! What is timed: taking over the new boxes of a step and knowing the pairs afterwards. `ours` and `rapier` report
//! what began and ended; `parry-bvh` lists all pairs and remembers nothing, which is less. Boxes are tight, but for the
//! scenes where most boxes rest or crawl, where `ours` takes the margin rapier always has (0.04).

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
    fn pairs(&self) -> usize;
    fn bytes(&self) -> usize {
        0
    }
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

    fn pairs(&self) -> usize {
        self.broad.pair_count()
    }

    fn bytes(&self) -> usize {
        self.broad.bytes()
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

    fn pairs(&self) -> usize {
        self.pairs.len()
    }

    fn bytes(&self) -> usize {
        self.tree.total_memory_size()
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
    pairs: std::collections::HashSet<(u32, u32)>,
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
        let (modified, events, pairs) = Default::default();
        Self {
            broad,
            parameters,
            colliders,
            bodies,
            handles,
            modified,
            events,
            pairs,
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

    fn pairs(&self) -> usize {
        self.pairs.len()
    }
}

/// What was measured of one engine on one scene, in nanoseconds a body and step.
struct Row {
    mean: f64,
    median: f64,
    /// 99th percentile.
    high: f64,
    pairs: usize,
    bytes: f64,
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
        bytes: engine.bytes() as f64 / n,
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

pub(crate) fn run(arguments: &[String]) {
    let option = |name: &str| {
        let at = arguments.iter().position(|a| a == name)?;
        arguments.get(at + 1).cloned()
    };
    let only = option("--scene");
    let upto: usize = option("--upto").and_then(|n| n.parse().ok()).unwrap_or(1_000_000);
    let engines = option("--engines").unwrap_or("ours,parry-bvh,rapier,three-axes".into());
    let mut csv = String::from("scene,shape,n,engine,ns\n");
    println!("ns a body and step, thread CPU time; p99 and median over the steps; bytes a body\n");
    println!(
        "{:<13}{:>8} {:<11}{:>9}{:>9}{:>9}{:>8}{:>8}{:>9}",
        "scene", "n", "engine", "mean", "median", "p99", "/ours", "bytes", "pairs/n"
    );
    for kind in RACED
        .into_iter()
        .filter(|k| only.as_ref().is_none_or(|name| name == k.name()))
    {
        for n in [1_000, 10_000, 100_000, 1_000_000].into_iter().filter(|n| *n <= upto) {
            let scene = Scene::new(kind, n);
            let (steps, warm) = match n {
                1_000 => (1000, 100),
                10_000 => (200, 60),
                100_000 => (50, 25),
                _ => (20, 6),
            };
            let mut ours = f64::NAN;
            for name in engines.split(',').filter(|name| !skipped(name, kind, n)) {
                let mut racer = engine(name, &scene);
                let limit = Duration::from_secs(if name == "ours" { 30 } else { 5 });
                let row = measure(racer.as_mut(), scene.clone(), steps, warm, limit);
                if name == "ours" {
                    ours = row.mean;
                }
                println!(
                    "{:<13}{n:>8} {:<11}{:>9.2}{:>9.2}{:>9.2}{:>8.2}{:>8.0}{:>9.2}",
                    kind.name(),
                    racer.name(),
                    row.mean,
                    row.median,
                    row.high,
                    row.mean / ours,
                    row.bytes,
                    row.pairs as f64 / n as f64
                );
                let _ = writeln!(csv, "{},box,{n},{},{:.3}", kind.name(), racer.name(), row.mean);
            }
        }
    }
    if let Some(file) = option("--csv")
        && let Err(error) = std::fs::write(&file, csv)
    {
        eprintln!("{file}: {error}");
    }
}
