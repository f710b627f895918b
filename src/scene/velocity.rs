//! Bodies with velocities, and the time by which a scene advances these bodies.

use alloc::vec::Vec;

use super::body::checked;
use super::{BodyId, Scene, SceneError};
use crate::motion::Velocity;

impl Scene {
    /// Gives a moving body a velocity, used by [`advance`](Self::advance).
    ///
    /// # Errors
    /// If the id is stale, the body fixed, or the velocity not finite.
    pub fn set_velocity(&mut self, id: BodyId, velocity: Velocity) -> Result<(), SceneError> {
        let i = self.bodies.index_of(id)?;
        if self.bodies.solids[i].as_ref().is_some_and(|s| s.fixed) {
            return Err(SceneError::Fixed { body: id });
        }
        let finite = velocity
            .linear
            .iter()
            .chain(velocity.angular.iter())
            .all(|v| v.is_finite());
        if !finite {
            return Err(SceneError::Velocity);
        }
        self.bodies
            .velocities
            .resize(self.bodies.generations.len(), Velocity::default());
        self.bodies.velocities[i] = velocity;
        Ok(())
    }

    /// Returns the velocity of a body: zero unless set.
    #[must_use]
    pub fn velocity(&self, id: BodyId) -> Option<Velocity> {
        let i = self.bodies.index_of(id).ok()?;
        Some(self.bodies.velocities.get(i).copied().unwrap_or_default())
    }

    /// Moves every body by its velocity for a time, straight and evenly turning. A negative time
    /// goes back.
    ///
    /// # Errors
    /// If the time is not finite or a body would leave the scene's reach; then no body has moved.
    pub fn advance(&mut self, time: f64) -> Result<(), SceneError> {
        if !time.is_finite() {
            return Err(SceneError::Velocity);
        }
        let rest = Velocity::default();
        let moving = |(i, v): (usize, &Velocity)| (*v != rest).then_some(i);
        let moving: Vec<usize> = self.bodies.velocities.iter().enumerate().filter_map(moving).collect();
        let mut poses = Vec::with_capacity(moving.len());
        for &i in &moving {
            let pose = self.bodies.velocities[i].applied(&self.bodies.poses[i], time);
            checked(&pose, Some(self.bodies.id(i as u32)))?;
            poses.push(pose);
        }
        for (&i, pose) in moving.iter().zip(&poses) {
            self.bodies.place(i, pose);
        }
        Ok(())
    }
}
