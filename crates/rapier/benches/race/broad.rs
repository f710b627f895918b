//! The broad phase of rapier.

use lin_canny_rapier::single::rapier::prelude::*;
use race::common::boxes::engines::Engine;
use truth::boxes::Scene;

/// rapier's broad phase at its best: cuboids without bodies, no prediction distance.
pub(crate) struct Broad {
    broad: BroadPhaseBvh,
    parameters: IntegrationParameters,
    colliders: ColliderSet,
    bodies: RigidBodySet,
    handles: Vec<ColliderHandle>,
    modified: Vec<ColliderHandle>,
    events: Vec<BroadPhasePairEvent>,
}

impl Broad {
    pub(crate) fn new(scene: &Scene) -> Self {
        let mut colliders = ColliderSet::new();
        let mut bodies = RigidBodySet::new();
        let handles = scene.boxes.iter().map(|aabb| {
            let half = (aabb.max - aabb.min) * 0.5;
            let at = aabb.min + half;
            let collider = ColliderBuilder::cuboid(half.x as f32, half.y as f32, half.z as f32)
                .translation(Vector::new(at.x as f32, at.y as f32, at.z as f32))
                .active_collision_types(ActiveCollisionTypes::all());
            colliders.insert(collider)
        });
        let handles = handles.collect();
        let mut broad = BroadPhaseBvh::new();
        // One step of the pipeline clears the flags of new colliders; otherwise every update
        // inserts every leaf again.
        let mut islands = IslandManager::new();
        let mut narrow = NarrowPhase::new();
        CollisionPipeline::new().step(
            0.0,
            &mut islands,
            &mut broad,
            &mut narrow,
            &mut bodies,
            &mut colliders,
            &(),
            &(),
        );
        let parameters = IntegrationParameters {
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

impl Engine for Broad {
    fn name(&self) -> &'static str {
        "rapier"
    }

    fn prepare(&mut self, scene: &Scene) {
        self.modified.clear();
        for &i in &scene.moved {
            let aabb = &scene.boxes[i as usize];
            let at = aabb.min + (aabb.max - aabb.min) * 0.5;
            let handle = self.handles[i as usize];
            if let Some(collider) = self.colliders.get_mut(handle) {
                collider.set_translation(Vector::new(at.x as f32, at.y as f32, at.z as f32));
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
