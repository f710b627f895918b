//! A simulation on one of the two engines.

use lin_canny::Velocity;
use lin_canny::nalgebra::Isometry3;
use lin_canny::scene::{self, Scene};

use super::BodyShape;
use super::rapier::dynamics::RigidBodyHandle;
use super::rapier::math::Real;
use super::rapier::pipeline::{EventHandler, PhysicsHooks, PhysicsWorld};
use super::world::World;
use crate::effects::{Reals, moved, placed};
use crate::free::Free;
use crate::overlap::{self, Overlap};
use crate::{Body, BodyId, Effects, Report, Settings, SimulationError};

/// A simulation of bodies with the enabled effects. See the [page of the crate](crate).
pub struct Simulation {
    engine: Engine,
}

enum Engine {
    Free(Box<Free>),
    Response(Box<World>),
}

impl std::fmt::Debug for Simulation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Simulation")
            .field("report", &self.report())
            .finish_non_exhaustive()
    }
}

impl Simulation {
    /// Returns an empty simulation.
    ///
    /// # Errors
    /// Returns an error if:
    ///
    /// * a number of the effects or settings is out of range ([`SimulationError::Number`] has the
    ///   ranges);
    /// * an effect needs response, and response is not enabled;
    /// * pairs are observed with response;
    /// * the default step is too long for the size of the bodies ([`SimulationError::LongStep`]).
    pub fn new(effects: Effects, settings: Settings) -> Result<Self, SimulationError> {
        let reals = reals(effects.response);
        effects.check(reals)?;
        settings.check(reals, &effects)?;
        let engine = if effects.response {
            if settings.queries != scene::PairQueries::none() {
                return Err(SimulationError::ObservedResponse);
            }
            Engine::Response(Box::new(World::new(effects, &settings)))
        } else {
            Engine::Free(Box::new(Free::new(effects, &settings)?))
        };
        Ok(Self { engine })
    }

    /// Inserts a body into the simulation.
    ///
    /// # Errors
    /// Returns an error if the pose is not a rigid motion, or if a position, density, mass,
    /// velocity or coefficient is out of range. Without response, also returns an error if
    /// [`lin_canny`] has no equivalent of the shape, if the shape is too large for a scene, or if a
    /// coefficient is given.
    pub fn insert(&mut self, shape: impl Into<BodyShape>, body: Body) -> Result<BodyId, SimulationError> {
        body.check(self.reals())?;
        let shape = shape.into();
        match &mut self.engine {
            Engine::Free(free) => {
                let given = [("friction", body.friction), ("restitution", body.restitution)];
                if let Some((effect, _)) = given.iter().find(|(_, x)| x.is_some()) {
                    return Err(SimulationError::NeedsResponse { effect });
                }
                free.insert(shape.solid().ok_or(SimulationError::Shape)?, &body)
            }
            Engine::Response(world) => world.insert(&shape, &body),
        }
    }

    /// Sets the pose of a body without a motion between. Keeps its velocity and wakes it.
    ///
    /// # Errors
    /// Returns an error if the body does not exist, the pose is not a rigid motion, or the position
    /// is out of range.
    pub fn set_pose(&mut self, body: BodyId, pose: Isometry3<f64>) -> Result<(), SimulationError> {
        placed(&pose, self.reals())?;
        match &mut self.engine {
            Engine::Free(free) => free.set_pose(body, pose),
            Engine::Response(world) => world.set_pose(body, &pose),
        }
    }

    /// Sets the velocity of a body's centre of mass and its angular velocity; no effect on fixed
    /// bodies.
    ///
    /// # Errors
    /// Returns an error if the body does not exist or a coordinate is out of range.
    pub fn set_velocity(&mut self, body: BodyId, velocity: Velocity) -> Result<(), SimulationError> {
        moved(&velocity, self.reals())?;
        match &mut self.engine {
            Engine::Free(free) => free.set_velocity(body, &velocity),
            Engine::Response(world) => world.set_velocity(body, &velocity),
        }
    }

    fn reals(&self) -> Reals {
        reals(matches!(self.engine, Engine::Response(_)))
    }

    /// Removes a body.
    ///
    /// # Errors
    /// Returns an error if the body does not exist.
    pub fn remove(&mut self, body: BodyId) -> Result<(), SimulationError> {
        match &mut self.engine {
            Engine::Free(free) => free.remove(body),
            Engine::Response(world) => world.remove(body),
        }
    }

    /// Advances the simulation by one time step.
    ///
    /// # Errors
    /// Returns an error without response if a body leaves the range of the scene, 1e37. Then the
    /// bodies after it in the order of insertion have not moved.
    pub fn step(&mut self) -> Result<(), SimulationError> {
        match &mut self.engine {
            Engine::Free(free) => free.step(),
            Engine::Response(world) => {
                world.world.step();
                Ok(())
            }
        }
    }

    /// Advances a simulation with response by one time step, with rapier's hooks and event handler.
    ///
    /// Hooks may reject pairs and change contacts. The handler receives the start and end of
    /// contacts. rapier calls both only for colliders with `active_hooks` and `active_events`,
    /// which you set through [`world_mut`](Self::world_mut). Without response, hooks and handler
    /// are not called; the events are those of [`scene`](Self::scene).
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn step_with(&mut self, hooks: &dyn PhysicsHooks, events: &dyn EventHandler) -> Result<(), SimulationError> {
        match &mut self.engine {
            Engine::Free(free) => free.step(),
            Engine::Response(world) => {
                world.world.step_with_events(hooks, events);
                Ok(())
            }
        }
    }

    /// Returns the pose of a body's frame.
    ///
    /// The rotation is normalised in `f64`, because poses of [`lin_canny`] require it.
    #[must_use]
    pub fn pose(&self, body: BodyId) -> Option<Isometry3<f64>> {
        match &self.engine {
            Engine::Free(free) => free.pose(body),
            Engine::Response(world) => world.pose(body),
        }
    }

    /// Returns the velocity of a body's centre of mass, and its angular velocity.
    #[must_use]
    pub fn velocity(&self, body: BodyId) -> Option<Velocity> {
        match &self.engine {
            Engine::Free(free) => free.velocity(body),
            Engine::Response(world) => world.velocity(body),
        }
    }

    /// Returns the deepest overlap of two solids at their current poses; `None` if none overlap.
    ///
    /// [`lin_canny`] measures the overlap, for any engine and dispatcher. Pairs in which neither
    /// body is dynamic do not count. Do not call it in every step: it builds a scene of all bodies,
    /// which takes a few microseconds per body, and measures the full depth of every overlap. These
    /// are not measured:
    ///
    /// * open meshes, which have no inside (a terrain, an open tray);
    /// * shapes without an equivalent in [`lin_canny`] (half-spaces, voxels, custom shapes);
    /// * colliders that were added through [`world_mut`](Self::world_mut).
    ///
    /// ```
    /// use lin_canny_rapier::single::Simulation;
    /// use lin_canny_rapier::single::rapier::geometry::SharedShape;
    /// use lin_canny_rapier::{Body, Effects, Settings};
    /// use lin_canny::nalgebra::Isometry3;
    ///
    /// let mut simulation = Simulation::new(Effects::response(), Settings::default())?;
    /// let cube = SharedShape::cuboid(0.5, 0.5, 0.5);
    /// let table = simulation.insert(&cube, Body::fixed(Isometry3::identity()))?;
    /// let ball = Body::moving(Isometry3::translation(0.0, 0.9, 0.0), 1.0);
    /// let ball = simulation.insert(SharedShape::ball(0.5), ball)?;
    /// let overlap = simulation.deepest_overlap()?.expect("an overlap");
    /// assert!(overlap.bodies.contains(&table) && overlap.bodies.contains(&ball));
    /// assert!((overlap.upper - 0.1).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if a body has left the range of a scene, 1e37, or its pose is not finite.
    pub fn deepest_overlap(&self) -> Result<Option<Overlap>, SimulationError> {
        match &self.engine {
            Engine::Free(free) => overlap::deepest(free.members()),
            Engine::Response(world) => overlap::deepest(world.members()),
        }
    }

    /// Returns the counts of the last step.
    #[must_use]
    pub fn report(&self) -> Report {
        match &self.engine {
            Engine::Free(free) => free.report(),
            Engine::Response(world) => world.report(),
        }
    }

    /// Returns the scene of a simulation without response, with its pairs, events and costs.
    #[must_use]
    pub fn scene(&self) -> Option<&Scene> {
        match &self.engine {
            Engine::Free(free) => Some(free.scene()),
            Engine::Response(_) => None,
        }
    }

    /// Returns the rapier world of a simulation with response.
    #[must_use]
    pub fn world(&self) -> Option<&PhysicsWorld> {
        match &self.engine {
            Engine::Free(_) => None,
            Engine::Response(world) => Some(&world.world),
        }
    }

    /// Returns the rapier world of a simulation with response, for joints, forces, sensors and
    /// events.
    ///
    /// ```
    /// use lin_canny_rapier::single::rapier::prelude::RevoluteJointBuilder;
    /// use lin_canny_rapier::single::rapier::math::Vector;
    /// use lin_canny_rapier::single::rapier::geometry::SharedShape;
    /// use lin_canny_rapier::single::Simulation;
    /// use lin_canny_rapier::{Body, Effects, Settings};
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    ///
    /// let effects = Effects { gravity: Some(Vector3::y() * -9.81), ..Effects::response() };
    /// let mut simulation = Simulation::new(effects, Settings::default())?;
    /// let post = simulation.insert(SharedShape::cuboid(0.1, 0.1, 0.1), Body::fixed(Isometry3::identity()))?;
    /// let at = Isometry3::translation(1.0, 0.0, 0.0);
    /// let bob = simulation.insert(SharedShape::cylinder(0.1, 0.1), Body::moving(at, 1000.0))?;
    /// // A pendulum: the bob turns about z at the post.
    /// let (a, b) = (simulation.handle(post).unwrap(), simulation.handle(bob).unwrap());
    /// let joint = RevoluteJointBuilder::new(Vector::Z).local_anchor2(Vector::new(-1.0, 0.0, 0.0));
    /// simulation.world_mut().unwrap().insert_impulse_joint(a, b, joint);
    /// for _ in 0..20 {
    ///     simulation.step()?;
    /// }
    /// let at = simulation.pose(bob).unwrap().translation.vector;
    /// assert!(at.y < -0.1 && (at.norm() - 1.0).abs() < 0.01);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// For a comparison, set `world.narrow_phase = NarrowPhase::new()` before the first step: the
    /// world then uses parry's contacts.
    pub fn world_mut(&mut self) -> Option<&mut PhysicsWorld> {
        match &mut self.engine {
            Engine::Free(_) => None,
            Engine::Response(world) => Some(&mut world.world),
        }
    }

    /// Returns rapier's handle of a body of a simulation with response.
    #[must_use]
    pub fn handle(&self, body: BodyId) -> Option<RigidBodyHandle> {
        match &self.engine {
            Engine::Free(_) => None,
            Engine::Response(world) => world.handle(body),
        }
    }
}

/// Returns the range of numbers of the engine: rapier's, or without response that of [`lin_canny`].
fn reals(response: bool) -> Reals {
    if response {
        Reals::new(f64::from(Real::MIN_POSITIVE), f64::from(Real::MAX))
    } else {
        Reals::new(f64::MIN_POSITIVE, f64::MAX)
    }
}
