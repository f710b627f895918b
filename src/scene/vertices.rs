//! Vertices of meshes that bend.

use alloc::sync::Arc;

use nalgebra::Point3;

use super::ball::Ball;
use super::body::BodyTable;
use super::{BodyId, Scene, SceneError};
use crate::base::num::extremes::Extremes;
use crate::base::tolerance::SCENE_REACH;
use crate::pair_tracker::geometry::Geometry;

impl Scene {
    /// Replaces all vertices of a body that is a mesh, as
    /// [`Mesh::set_vertices`](crate::Mesh::set_vertices): all effects see the mesh as it is then.
    /// Until the next step all answers remain those of the last step.
    ///
    /// A mesh that other bodies share is copied first, so that only this body bends. The patches
    /// from which contacts are computed are made anew in the next step, in a time that grows with
    /// the mesh. A tick sees the vertices as they are set before it, not where they will be:
    /// impacts are those of the motion of the body. For those of its vertices ask
    /// [`continuous::meshes`](crate::continuous::meshes).
    ///
    /// # Errors
    /// If the id is stale, the body no mesh, or the vertices are refused; the body keeps its
    /// vertices.
    #[doc(alias = "deform")]
    pub fn set_vertices(&mut self, id: BodyId, vertices: &[Point3<f64>]) -> Result<(), SceneError> {
        let i = self.bodies.index_of(id)?;
        self.bodies.bend(i, id, vertices)?;
        self.changed = true;
        Ok(())
    }
}

impl BodyTable {
    /// Replaces the vertices of a mesh: to the stages of a step that is a motion of all its points.
    fn bend(&mut self, i: usize, id: BodyId, vertices: &[Point3<f64>]) -> Result<(), SceneError> {
        let Some(solid) = &mut self.solids[i] else {
            return Err(SceneError::StaleBody { body: id });
        };
        let Geometry::Mesh(mesh) = &mut solid.shape else {
            return Err(SceneError::NotAMesh { body: id });
        };
        // A ball about the box reaches no farther than thrice the largest coordinate.
        let reach = vertices.iter().fold(0.0, |m: f64, p| m.larger(p.coords.amax()));
        if reach.is_finite() && reach > SCENE_REACH / 4.0 {
            return Err(SceneError::TooLarge { reach });
        }
        // Patches share the mesh: without them it is not copied.
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
        self.shift(i, (&pose, ball), way);
        Ok(())
    }
}
