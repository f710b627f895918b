//! Bodies with velocities, and the ticks by which a scene advances these bodies.

use alloc::vec::Vec;

use super::body::checked;
use super::moving::Sweep;
use super::{BodyId, PairImpact, Scene, SceneError};
use crate::base::motion::Velocity;

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
        self.bodies.set_velocity(i, velocity);
        Ok(())
    }

    /// Returns the velocity of a body: zero unless set.
    #[must_use]
    pub fn velocity(&self, id: BodyId) -> Option<Velocity> {
        let i = self.bodies.index_of(id).ok()?;
        Some(self.bodies.velocity(i))
    }

    /// Moves every body by its velocity for a time, straight and evenly turning: one tick. A
    /// negative time goes back.
    ///
    /// Equal ticks let pairs of bodies at constant velocities sleep until the proof of their
    /// separation ends. If an impact is called for between any groups, a step sees one tick.
    ///
    /// # Errors
    /// If the time is not finite, a body would leave the scene's reach or turn by an angle beyond
    /// the range of f64, or an impact is called for and the scene was advanced since the last step;
    /// then no body has moved.
    pub fn advance(&mut self, time: f64) -> Result<(), SceneError> {
        if !time.is_finite() {
            return Err(SceneError::Velocity);
        }
        let is_swept = self.table.impact_groups() != 0;
        if is_swept && self.bodies.ticks.is_pending {
            return Err(SceneError::StepDue);
        }
        let rest = Velocity::default();
        let moving: Vec<usize> = (0..self.bodies.moving.len())
            .filter(|&i| self.bodies.moving[i].velocity != rest)
            .collect();
        let mut poses = Vec::with_capacity(moving.len());
        for &i in &moving {
            let pose = self.bodies.moving[i].velocity.applied(&self.bodies.poses[i], time);
            checked(&pose, Some(self.bodies.id(i as u32)))?;
            poses.push(pose);
        }
        self.bodies.begin_tick(time, is_swept);
        for (&i, pose) in moving.iter().zip(&poses) {
            let velocity = self.bodies.moving[i].velocity;
            let sweep = is_swept.then(|| Sweep {
                from: self.bodies.poses[i],
                velocity: if time < 0.0 { -velocity } else { velocity },
            });
            self.bodies.advance(i, pose, sweep);
        }
        Ok(())
    }

    /// Sets whether pairs of bodies at constant velocities sleep until the proof of their
    /// separation ends, see [`schedule`](crate::schedule); on by default. The answers do not depend
    /// on the setting.
    pub fn set_schedule(&mut self, on: bool) {
        self.schedule = on;
    }

    /// Returns the impacts of the last step in the order of [`PairImpact::safe`], then of the two
    /// bodies: each pair with the effect `impact` whose bodies were apart before the tick and are
    /// not proven to stay apart during it.
    ///
    /// ```
    /// use lin_canny::impact::{Impact, Tolerance};
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::scene::{Body, Effects, Group, Scene};
    /// use lin_canny::{Shape, Velocity};
    ///
    /// let all = Group::default();
    /// let mut scene = Scene::new();
    /// let impact = Tolerance::Time(1e-9);
    /// scene.call_for(all, all, Effects::none().impact(impact))?;
    /// let pane = solids::cuboid(Vector3::new(0.001, 1.0, 1.0))?;
    /// scene.insert(Body::fixed(pane), Isometry3::translation(2.0, 0.0, 0.0))?;
    /// let bullet = Body::moving(Shape::ball(0.01)?);
    /// let bullet = scene.insert(bullet, Isometry3::identity())?;
    /// let velocity = Velocity::new(Vector3::x() * 800.0, Vector3::zeros());
    /// scene.set_velocity(bullet, velocity)?;
    /// scene.advance(1.0 / 60.0)?; // 13 m
    /// scene.step();
    /// let [hit] = scene.impacts() else { panic!("through the pane") };
    /// let Impact::Hit { safe, hit, .. } = hit.impact else { panic!("not proven") };
    /// let met = (2.0 - 0.001 - 0.01) / 800.0;
    /// assert!(safe <= met && met <= hit && hit - safe < 2e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// Bodies that share a point before the tick are no impact: `overlap` has those. A body that
    /// [`set_pose`](Self::set_pose) moves jumps, before or after the tick.
    #[doc(alias = "ccd")]
    #[doc(alias = "tunnelling")]
    #[must_use]
    pub fn impacts(&self) -> &[PairImpact] {
        &self.impacts
    }
}
