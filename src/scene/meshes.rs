//! Calls and data for meshes: convex patches, which give the contacts of bodies that are not
//! convex, and vertices that callers replace.

use crate::base::num::extremes::Extremes;
use crate::base::tolerance::SCENE_REACH;
use crate::pair_tracker::geometry::Geometry;
use crate::pair_tracker::patches_of;
use crate::scene::body::Ball;
use crate::scene::body::BodyTable;
use crate::scene::{BodyId, Scene, SceneError};
use alloc::collections::BTreeMap;
use alloc::sync::Arc;
use nalgebra::Point3;

impl Scene {
    /// Returns the scene with its convex patches.
    #[cfg(feature = "serde")]
    pub(super) fn with_patches(mut self) -> Self {
        self.make_patches();
        self
    }

    /// Computes the convex patches of meshes and compounds whose contacts are enabled, once for
    /// each geometry.
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

impl Scene {
    /// Replaces all vertices of a mesh, as [`Mesh::set_vertices`](crate::Mesh::set_vertices) does.
    ///
    /// All later queries use the new vertices. Until the next step all results remain those of the
    /// last step.
    ///
    /// If other bodies share the mesh, it is copied first, so that only this body deforms. The next
    /// step computes the convex patches for contacts again, in a time that grows with the size of
    /// the mesh. A tick uses the vertices that are set before it: impacts are those of the rigid
    /// motion of the body. For impacts of moving vertices use
    /// [`continuous::cast_meshes`](crate::continuous::cast_meshes).
    ///
    /// # Errors
    /// Returns an error if the id is stale, the body is not a mesh, or the vertices are invalid;
    /// the body keeps its vertices.
    #[doc(alias = "deform")]
    pub fn set_vertices(&mut self, id: BodyId, vertices: &[Point3<f64>]) -> Result<(), SceneError> {
        let i = self.bodies.index_of(id)?;
        self.bodies.bend(i, id, vertices)?;
        self.changed = true;
        Ok(())
    }
}

impl BodyTable {
    /// Replaces the vertices of a mesh. For the stages of a step this is a motion of all its
    /// points.
    fn bend(&mut self, i: usize, id: BodyId, vertices: &[Point3<f64>]) -> Result<(), SceneError> {
        let Some(solid) = &mut self.solids[i] else {
            return Err(SceneError::StaleBody { body: id });
        };
        let Geometry::Mesh(mesh) = &mut solid.shape else {
            return Err(SceneError::NotAMesh { body: id });
        };
        // A ball around the box has a radius of at most three times the largest coordinate.
        let reach = vertices.iter().fold(0.0, |m: f64, p| m.larger(p.coords.amax()));
        if reach.is_finite() && reach > SCENE_REACH / 4.0 {
            return Err(SceneError::TooLarge { reach });
        }
        // Patches share the mesh; if they are dropped first, the mesh is not copied.
        let patches = solid.patches.take();
        let moved = match Arc::make_mut(mesh).move_all(vertices) {
            Ok(moved) if moved > 0.0 => moved,
            other => {
                solid.patches = patches;
                return other
                    .map(|_| ())
                    .map_err(|error| SceneError::Vertices { body: id, error });
            }
        };
        solid.ball = Ball::about(&solid.shape);
        let pose = self.poses[i];
        let ball = solid.ball.at(&pose);
        let way = moved + solid.ball.error(&pose.translation.vector);
        self.disturb(i);
        self.keep_start(i);
        self.shift(i, &pose, ball, way);
        Ok(())
    }
}
