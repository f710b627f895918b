//! Motions of bodies: velocities, the ticks by which a scene advances its bodies, and the swept
//! motions of the step being prepared.
//!
//! A *tick* is one call of [`Scene::advance`](super::Scene::advance). The motion of a body is known
//! in advance as long as all ticks are equally long and only ticks move the body, at one velocity.
//! A body is *disturbed* in a step if a call sets another velocity or another pose. From the first
//! tick on every body has a row of motions, with or without a velocity: no pair sleeps before that
//! tick, and afterwards no disturbance is lost.

use crate::base::motion::{Motion, Steady, Velocity, displacement};
use crate::base::num::Counter;
use crate::base::num::extremes::Extremes;
use crate::base::tolerance::{PLACED_CENTRE, ROUND_UP};
use crate::scene::body::checked;
use crate::scene::{BodyId, PairImpact, Scene, SceneError};
use alloc::vec::Vec;
use nalgebra::Isometry3;

/// Velocity of a body, and the steps in which its motion last changed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Moving {
    pub(super) velocity: Velocity,
    /// The last two steps in which the body was disturbed, the later one first.
    disturbed: [u32; 2],
    /// The last step in which the body was disturbed after a tick of that step.
    late: u32,
}

impl Moving {
    /// Records that the motion of the body changes in a step, before or after the tick.
    pub(super) fn disturb(&mut self, step: u32, is_late: bool) {
        if self.disturbed[0] != step {
            self.disturbed = [step, self.disturbed[0]];
        }
        if is_late {
            self.late = step;
        }
    }

    pub(super) fn is_disturbed(&self, step: u32) -> bool {
        self.disturbed[0] == step
    }

    pub(super) fn is_late(&self, step: u32) -> bool {
        self.late == step
    }

    /// Returns whether the body was disturbed in this step and in the step before, for instance by
    /// a solver that changes velocities in every step. A look-ahead query is then useless.
    pub(super) fn is_steered(&self, step: u32) -> bool {
        self.disturbed == [step, step.wrapping_sub(1)]
    }
}

/// The motion of a body over the tick of the step being prepared.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Sweep {
    /// The pose before the tick.
    pub(super) from: Isometry3<f64>,
    /// The velocity during the tick; zero for a body that only a call after the tick moved.
    pub(super) velocity: Velocity,
}

impl Sweep {
    /// Returns the motion, or `None` if a velocity is beyond the range of motions.
    pub(super) fn motion(&self) -> Option<Steady> {
        Steady::new(&self.from, self.velocity).ok()
    }

    /// Returns the growth for which the box around the start and the end of a swept motion contains
    /// the body at every instant between. The origin of the body moves on a straight line, and no
    /// point is farther than `radius` from the origin. So the second derivative of the position of
    /// a point is at most `radius w^2`, and its distance from the chord is at most `radius (w t)^2
    /// / 8`. The drift of the motion accounts for the rounding of the poses. No rotation moves a
    /// point farther than the diameter.
    pub(super) fn bulge(&self, radius: f64, time: f64) -> f64 {
        let angle = self.velocity.angular.norm() * time;
        let model = self.motion().map(|motion| motion.model(0.0, time));
        let [shift, turn] = model.map_or([0.0; 2], |model| [model.shift.at(time), model.turn.at(time)]);
        // The least of a number and NaN is the number.
        (radius * (0.125 * angle * angle + turn)).smaller(2.0 * radius) + shift
    }

    /// Returns an upper bound of the displacement of any point of the body from its start, at every
    /// instant of the swept motion. The bound is finite at every velocity, because the origin of
    /// the body moves on a straight line and no rotation moves a point farther than the diameter.
    pub(super) fn displacement(&self, radius: f64, time: f64) -> f64 {
        let (start, way) = (&self.from.translation.vector, self.velocity.linear * time);
        let straight = displacement(&way, 0.0, &self.from.rotation, &self.from.rotation);
        let rounding = PLACED_CENTRE * (start.abs().sum() + way.abs().sum());
        let most = (straight + rounding + 2.0 * radius) * ROUND_UP;
        let model = self.motion().map(|motion| motion.model(0.0, time));
        // The least of a number and NaN is the number.
        model.map_or(most, |model| model.displacement(radius, time).smaller(most))
    }
}

/// The ticks of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Ticks {
    /// Number of the last tick.
    pub(super) now: u64,
    /// Length of the last tick.
    pub(super) length: f64,
    /// Whether there was a tick since the last step.
    pub(super) is_pending: bool,
    /// Whether impacts were enabled when that tick started, so that the step needs its swept
    /// motions.
    pub(super) is_swept: bool,
    /// Whether the length of a tick changed since the last step.
    pub(super) is_changed: bool,
}

impl Ticks {
    /// Starts a tick.
    pub(super) fn begin(&mut self, length: f64, is_swept: bool) {
        self.is_changed |= self.length != length;
        self.length = length;
        (self.is_pending, self.is_swept) = (true, is_swept);
        self.now.count(1);
    }

    /// Returns the number of the tick after `by` further ticks, as a pair stores it. The number is
    /// rounded down, so that beyond 2^53 ticks a pair sleeps less and never too long.
    pub(super) fn later(&self, by: u64) -> f64 {
        let tick = self.now.saturating_add(by);
        let stored = tick as f64;
        if stored as u64 > tick {
            stored.next_down()
        } else {
            stored
        }
    }

    /// Ends a tick that moved nothing. The next step still sees whether the length changed.
    pub(super) fn end_idle(&mut self) {
        (self.is_pending, self.is_swept) = (false, false);
    }

    pub(super) fn end_step(&mut self) {
        self.end_idle();
        self.is_changed = false;
    }
}

impl Scene {
    /// Sets the velocity of a moving body, which [`advance`](Self::advance) uses.
    ///
    /// # Errors
    /// Returns an error if the id is stale, the body is fixed, or the velocity is not finite.
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

    /// Advances every body by `time` at constant linear and angular velocity: one tick. A negative
    /// time moves backwards.
    ///
    /// If ticks are equally long, pairs of bodies at constant velocities sleep until the proof of
    /// their separation ends. If an impact is enabled between any groups, call [`step`](Self::step)
    /// after each tick.
    ///
    /// # Errors
    /// Returns an error if the time is not finite, if a body would leave the range of the scene or
    /// rotate by an angle beyond the range of f64, or if an impact is enabled and the scene was
    /// advanced since the last step. Then no body has moved.
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
    /// separation ends, see [`schedule`](crate::schedule). The default is on; results do not depend
    /// on the setting.
    #[cfg(feature = "__internals")]
    #[doc(hidden)]
    pub fn set_schedule(&mut self, on: bool) {
        self.schedule = on;
    }

    /// Returns the impacts of the last step, ordered by [`PairImpact::safe`] and then by the two
    /// bodies.
    ///
    /// There is one for each pair with the query `impact` whose bodies were separated before the
    /// tick and are not proven to stay separated during the tick. With the query `impact_within`
    /// there is one for each pair whose bodies were farther apart than its distance before the tick
    /// and are not proven to stay so; [`PairImpact::distance`] distinguishes the two.
    ///
    /// ```
    /// use lin_canny::impact::{Impact, Tolerance};
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    /// use lin_canny::polyhedron::solids;
    /// use lin_canny::scene::{Body, PairQueries, Group, Scene};
    /// use lin_canny::{Shape, Velocity};
    ///
    /// let all = Group::default();
    /// let mut scene = Scene::new();
    /// let impact = Tolerance::Time(1e-9);
    /// scene.set_queries(all, all, PairQueries::none().impact(impact))?;
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
    /// Bodies that share a point before the tick have no impact, and those within the distance no
    /// impact within; use the queries `overlap` and `within` to find them. A body that
    /// [`set_pose`](Self::set_pose) moves before or after the tick jumps: its path is not tested.
    #[doc(alias = "ccd")]
    #[doc(alias = "tunnelling")]
    #[must_use]
    pub fn impacts(&self) -> &[PairImpact] {
        &self.impacts
    }
}
