//! Collision detection of rapier without dynamics.

use lin_canny_rapier::single::rapier::prelude as rapier;
use race::common::scene::engines::{Engine, RANGE, hulls32, pose32};
use rapier::{
    ActiveCollisionTypes, BroadPhaseBvh, ColliderBuilder, ColliderHandle, ColliderSet, CollisionPipeline, ContactPair,
    IslandManager, NarrowPhase, RigidBodySet,
};
use truth::Pose;
use truth::crowd::Crowd;

/// rapier without dynamics: colliders that belong to no body.
pub(crate) struct Pipeline {
    pipeline: CollisionPipeline,
    islands: IslandManager,
    broad: BroadPhaseBvh,
    narrow: NarrowPhase,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    handles: Vec<ColliderHandle>,
    poses: Vec<rapier::Pose>,
}

impl Pipeline {
    pub(crate) fn new(crowd: &Crowd) -> Self {
        let distinct = hulls32(crowd);
        let mut colliders = ColliderSet::new();
        let insert = |(shape, pose): (&usize, &Pose)| {
            // Two colliders without a body are no pair unless asked for.
            let collider = ColliderBuilder::new(distinct[*shape].clone())
                .position(pose32(pose))
                .active_collision_types(ActiveCollisionTypes::all());
            colliders.insert(collider)
        };
        let handles = crowd.shape_of.iter().zip(&crowd.poses).map(insert).collect();
        Self {
            pipeline: CollisionPipeline::new(),
            islands: IslandManager::new(),
            broad: BroadPhaseBvh::new(),
            narrow: NarrowPhase::new(),
            bodies: RigidBodySet::new(),
            colliders,
            handles,
            poses: Vec::new(),
        }
    }
}

impl Engine for Pipeline {
    fn name(&self) -> &'static str {
        "rapier-collision"
    }

    fn prepare(&mut self, poses: &[Pose]) {
        self.poses.clear();
        self.poses.extend(poses.iter().map(pose32));
    }

    fn step(&mut self) {
        for (handle, pose) in self.handles.iter().zip(&self.poses) {
            if let Some(collider) = self.colliders.get_mut(*handle) {
                collider.set_position(*pose);
            }
        }
        self.pipeline.step(
            RANGE as f32,
            &mut self.islands,
            &mut self.broad,
            &mut self.narrow,
            &mut self.bodies,
            &mut self.colliders,
            &(),
            &(),
        );
    }

    fn pairs(&self) -> usize {
        let touching = |p: &&ContactPair| p.manifolds().iter().any(|m| !m.points.is_empty());
        self.narrow.contact_pairs().filter(touching).count()
    }
}
