//! Motions of bodies: velocities, the ticks by which a scene advances its bodies, and the sweeps of
//! the step being prepared.
//!
//! A *tick* is one call of [`Scene::advance`](super::Scene::advance). While all ticks are equally
//! long and a body is moved by ticks alone, at one velocity, the motion of the body is known ahead.
//! A body is *disturbed* in a step if a call gave the body another velocity or another pose. From
//! the first tick on every body has a row of motions, with a velocity or without: no pair sleeps
//! before that tick, and afterwards no disturbance is lost.

use crate::base::motion::{Motion, Steady, Velocity, displacement};
use crate::base::num::Counter;
use crate::base::num::extremes::Extremes;
use crate::base::tolerance::{PLACED_CENTRE, ROUND_UP};
use crate::scene::body::checked;
use crate::scene::{BodyId, PairImpact, Scene, SceneError};
use alloc::vec::Vec;
use nalgebra::Isometry3;

/// Velocity of a body, and the steps in which the motion last changed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Moving {
    pub(super) velocity: Velocity,
    /// The last two steps in which the body was disturbed, the later first.
    disturbed: [u32; 2],
    /// The last step in which the body was disturbed after a tick of that step.
    late: u32,
}

impl Moving {
    /// Notes that the motion of the body changes in a step, before or after the tick.
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

    /// Returns whether the body was disturbed in this step and in the step before, as by a solver
    /// that changes velocities in every step: then a look ahead is wasted.
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
    /// The velocity during the tick; zero for a body that was moved after the tick alone.
    pub(super) velocity: Velocity,
}

impl Sweep {
    /// Returns the motion; `None` if a velocity is beyond the range of motions.
    pub(super) fn motion(&self) -> Option<Steady> {
        Steady::new(&self.from, self.velocity).ok()
    }

    /// Returns the growth of the box about both ends of a sweep that holds the body at every
    /// instant between. The body's own origin goes straight, and no point is farther than `radius`
    /// from the origin: the second derivative of its place is at most `radius w^2`, hence the
    /// distance from the chord of both ends at most `radius (w t)^2 / 8`. The drift of the motion
    /// is the rounding of the poses. No turn carries a point farther than the diameter.
    pub(super) fn bulge(&self, radius: f64, time: f64) -> f64 {
        let angle = self.velocity.angular.norm() * time;
        let model = self.motion().map(|motion| motion.model(0.0, time));
        let [shift, turn] = model.map_or([0.0; 2], |model| [model.shift.at(time), model.turn.at(time)]);
        // The least of a number and NaN is the number.
        (radius * (0.125 * angle * angle + turn)).smaller(2.0 * radius) + shift
    }

    /// Returns an upper bound of the displacement of any point of the body from its start, at every
    /// instant of the sweep. The bound is finite at every velocity: the body's own origin goes
    /// straight, and no turn carries a point farther than the diameter.
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
    /// Whether a tick came since the last step.
    pub(super) is_pending: bool,
    /// Whether impacts were enabled when that tick began, so that the step needs its sweeps.
    pub(super) is_swept: bool,
    /// Whether the length of a tick changed since the last step.
    pub(super) is_changed: bool,
}

impl Ticks {
    /// Begins a tick.
    pub(super) fn begin(&mut self, length: f64, is_swept: bool) {
        self.is_changed |= self.length != length;
        self.length = length;
        (self.is_pending, self.is_swept) = (true, is_swept);
        self.now.count(1);
    }

    /// Returns the tick that comes some ticks later, as the number that a pair stores: rounded
    /// down, so that beyond 2^53 ticks a pair sleeps less, and never too long.
    pub(super) fn later(&self, by: u64) -> f64 {
        let tick = self.now.saturating_add(by);
        let stored = tick as f64;
        if stored as u64 > tick {
            stored.next_down()
        } else {
            stored
        }
    }

    /// Ends a tick that moved nothing. Whether the length changed is kept for the next step.
    pub(super) fn end_idle(&mut self) {
        (self.is_pending, self.is_swept) = (false, false);
    }

    pub(super) fn end_step(&mut self) {
        self.end_idle();
        self.is_changed = false;
    }
}

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
    /// separation ends. If an impact is enabled between any groups, a step sees one tick.
    ///
    /// # Errors
    /// If the time is not finite, a body would leave the scene's reach or turn by an angle beyond
    /// the range of f64, or an impact is enabled and the scene was advanced since the last step;
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
    #[cfg(feature = "__internals")]
    #[doc(hidden)]
    pub fn set_schedule(&mut self, on: bool) {
        self.schedule = on;
    }

    /// Returns the impacts of the last step in the order of [`PairImpact::safe`], then of the two
    /// bodies: each pair with the query `impact` whose bodies were apart before the tick and are
    /// not proven to stay apart during it.
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
    /// Bodies that share a point before the tick are no impact: `overlap` has those. A body that
    /// [`set_pose`](Self::set_pose) moves jumps, before or after the tick.
    #[doc(alias = "ccd")]
    #[doc(alias = "tunnelling")]
    #[must_use]
    pub fn impacts(&self) -> &[PairImpact] {
        &self.impacts
    }
}
