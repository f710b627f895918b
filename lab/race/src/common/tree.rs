//! parry's tree of boxes and the pairs it finds, stepped as its documentation recommends.

use parry3d::bounding_volume::Aabb;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

/// A tree over numbered boxes.
pub struct Tree {
    bvh: Bvh,
    workspace: BvhWorkspace,
    /// Pairs of the last step.
    pub pairs: Vec<(u32, u32)>,
}

impl Tree {
    pub fn new(leaves: &[Aabb]) -> Self {
        Self {
            bvh: Bvh::from_leaves(BvhBuildStrategy::Binned, leaves),
            workspace: BvhWorkspace::default(),
            pairs: Vec::new(),
        }
    }

    /// Updates the boxes that moved, and finds all pairs.
    pub fn step(&mut self, moved: impl Iterator<Item = (u32, Aabb)>) {
        for (i, aabb) in moved {
            self.bvh.insert_or_update_partially(aabb, i, 0.0);
        }
        self.bvh.optimize_incremental(&mut self.workspace);
        self.bvh.refit(&mut self.workspace);
        self.pairs.clear();
        let pairs = &mut self.pairs;
        self.bvh
            .traverse_bvtt_single_tree::<false>(&mut self.workspace, &mut |a, b| pairs.push((a, b)));
    }

    /// Returns the bytes of the tree and the pairs.
    pub fn bytes(&self) -> usize {
        self.bvh.total_memory_size() + self.pairs.capacity() * size_of::<(u32, u32)>()
    }
}
