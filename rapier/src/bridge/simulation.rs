//! A simulation on one of the two engines.

use lin_canny::Velocity;
use lin_canny::nalgebra::Isometry3;
use lin_canny::scene::{self, Scene};

use super::Hull;
use super::rapier::dynamics::RigidBodyHandle;
use super::rapier::math::Real;
use super::rapier::pipeline::PhysicsWorld;
use super::world::World;
use crate::effects::Reals;
use crate::free::Free;
use crate::{Body, BodyId, Effects, Report, Settings, SimulationError};

/// Bodies that move by the effects called for. See the [page of the crate](crate).
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
    /// If a number of the effects or settings is out of range (with response, that of the engine's
    /// precision: see [`SimulationError::Number`]), an effect needs response that is not
    /// called for, or pairs are observed with response.
    pub fn new(effects: Effects, settings: Settings) -> Result<Self, SimulationError> {
        let reals = reals(effects.response);
        effects.check(reals)?;
        settings.check(reals)?;
        let engine = if effects.response {
            if settings.observe != scene::Effects::none() {
                return Err(SimulationError::ObservedResponse);
            }
            Engine::Response(Box::new(World::new(effects, &settings)))
        } else {
            Engine::Free(Box::new(Free::new(effects, &settings)?))
        };
        Ok(Self { engine })
    }

    /// Puts a body into the simulation.
    ///
    /// # Errors
    /// If the pose is not a rigid motion, position, density, mass or velocity is not a number of the
    /// engine, or the shape is too large for a scene.
    pub fn insert(&mut self, shape: &Hull, body: Body) -> Result<BodyId, SimulationError> {
        body.check(reals(matches!(self.engine, Engine::Response(_))))?;
        match &mut self.engine {
            Engine::Free(free) => free.insert(shape.body(), &body),
            Engine::Response(world) => world.insert(shape, &body),
        }
    }

    /// Removes a body.
    ///
    /// # Errors
    /// If there is no such body.
    pub fn remove(&mut self, body: BodyId) -> Result<(), SimulationError> {
        match &mut self.engine {
            Engine::Free(free) => free.remove(body),
            Engine::Response(world) => world.remove(body),
        }
    }

    /// Advances the simulation by one time step.
    ///
    /// # Errors
    /// If a body without response leaves the reach of the scene, 1e37: bodies after it in the order
    /// of insertion have not moved then.
    pub fn step(&mut self) -> Result<(), SimulationError> {
        match &mut self.engine {
            Engine::Free(free) => free.step(),
            Engine::Response(world) => {
                world.world.step();
                Ok(())
            }
        }
    }

    /// Returns the pose of a body's frame. The rotation is normalised in `f64`, as poses of
    /// [`lin_canny`] need.
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

    /// Returns what the last step did.
    #[must_use]
    pub fn report(&self) -> Report {
        match &self.engine {
            Engine::Free(free) => free.report(),
            Engine::Response(world) => world.report(),
        }
    }

    /// Returns the scene of a simulation without response: its pairs, events and costs.
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

    /// Returns the rapier world of a simulation with response, for what effects do not cover:
    /// joints, forces, sensors. `world.narrow_phase = NarrowPhase::new()` before the first step puts
    /// parry's contacts in the place of the certified ones, for a comparison.
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

/// Returns the numbers of the engine: rapier's, or without response those of [`lin_canny`].
fn reals(response: bool) -> Reals {
    if response {
        Reals::new(f64::from(Real::MIN_POSITIVE), f64::from(Real::MAX))
    } else {
        Reals::new(f64::MIN_POSITIVE, f64::MAX)
    }
}
