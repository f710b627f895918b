//! Broad phases in one form.

use crate::tree::Tree;
use lab::boxes::{Kind, Scene};
use lin_canny::broad::{Aabb, Body, BodyId, BroadPhase, PencilSweep, SortedAxes};
use rapier3d::prelude as rapier;

/// A broad phase that is fed a scene.
pub(crate) trait Engine {
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
    tree: Tree,
    boxes: Vec<(u32, parry3d::bounding_volume::Aabb)>,
}

fn parry_box(aabb: &Aabb) -> parry3d::bounding_volume::Aabb {
    let point = |p: &nalgebra::Point3<f64>| parry3d::math::Vector::new(p.x as f32, p.y as f32, p.z as f32);
    parry3d::bounding_volume::Aabb::new(point(&aabb.min), point(&aabb.max))
}

impl Parry {
    fn new(scene: &Scene) -> Self {
        let leaves: Vec<_> = scene.boxes.iter().map(parry_box).collect();
        Self {
            tree: Tree::new(&leaves),
            boxes: Vec::new(),
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
        self.tree.step(self.boxes.iter().copied());
    }

    fn pairs(&self) -> Option<usize> {
        Some(self.tree.pairs.len())
    }

    fn bytes(&self) -> Option<usize> {
        Some(self.tree.bytes())
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

/// In the order of the tables.
pub(crate) const ENGINES: [&str; 4] = ["ours", "parry-bvh", "rapier", "three-axes"];

pub(crate) fn engine(name: &str, scene: &Scene) -> Box<dyn Engine> {
    match name {
        "ours" => Box::new(Ours::new("ours", PencilSweep::new(), scene)),
        "three-axes" => Box::new(Ours::new("three-axes", SortedAxes::new(), scene)),
        "parry-bvh" => Box::new(Parry::new(scene)),
        _ => Box::new(Rapier::new(scene)),
    }
}
