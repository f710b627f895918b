//! The convex patches of bodies that are not convex, from which their contacts are computed.

use alloc::collections::BTreeMap;

use super::Scene;
use crate::pair_tracker::patches_of;

impl Scene {
    /// Returns the scene with the patches made.
    #[cfg(feature = "serde")]
    pub(super) fn with_patches(mut self) -> Self {
        self.make_patches();
        self
    }

    /// Makes the patches of meshes and composites whose contacts are called for, once for each
    /// shape.
    pub(super) fn make_patches(&mut self) {
        let groups = self.table.manifold_groups();
        if !self.census.has_parts(groups) {
            return;
        }
        let mut made = BTreeMap::new();
        for solid in self.bodies.solids.iter().flatten() {
            if let Some(patches) = &solid.patches {
                made.insert(solid.shape.address(), Some(patches.clone()));
            }
        }
        for solid in self.bodies.solids.iter_mut().flatten() {
            if groups & 1 << solid.group.number() == 0 || solid.patches.is_some() {
                continue;
            }
            let shape = &solid.shape;
            let new = || patches_of(shape.into());
            if !shape.kind().is_convex() {
                solid.patches = made.entry(shape.address()).or_insert_with(new).clone();
            }
        }
    }
}
