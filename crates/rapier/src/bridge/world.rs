//! The engine with response: a rapier world under the certified dispatcher.

use lin_canny::Velocity;
use lin_canny::nalgebra::{Isometry3, Vector3};

use super::rapier::dynamics::{RigidBody, RigidBodyBuilder, RigidBodyHandle};
use super::rapier::geometry::{ColliderBuilder, NarrowPhase};
use super::rapier::math::{Real, Vector};
use super::rapier::pipeline::PhysicsWorld;
use super::rapier::{self};
use super::{BodyShape, CertifiedDispatcher, engine};
use crate::effects::Movement;
use crate::overlap::Member;
use crate::{Body, BodyId, Continuous, Effects, FrictionModel, Report, Settings, SimulationError};

/// Inverse mass up to which rapier treats a body as immovable.
const IMMOVABLE: Real = 1e-20;

/// Returns an empty rapier world with a dispatcher, for bodies of about `size`.
///
/// The world has no gravity. It has the length unit and the contact stiffness that bodies of this
/// size and steps of `time_step` need, and no speed limit (rapier's limit is 400 sizes per second).
/// The [page of the crate](crate) lists what follows from the size. Use it if you work with rapier
/// directly; [`Simulation`](super::Simulation) uses it as well.
#[must_use]
pub fn certified_world(dispatcher: CertifiedDispatcher, size: Real, time_step: Real) -> PhysicsWorld {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::ZERO;
    world.narrow_phase = NarrowPhase::with_query_dispatcher(dispatcher);
    let parameters = &mut world.integration_parameters;
    parameters.dt = time_step;
    parameters.min_ccd_dt = time_step / 100.0;
    parameters.length_unit = size;
    // rapier's default limits the speed of small bodies in free fall.
    parameters.normalized_max_linear_velocity = Real::MAX;
    let stiffer = 1.0 / (60.0 * time_step);
    parameters.contact_softness.natural_frequency *= stiffer;
    parameters.static_contact_softness.natural_frequency *= stiffer;
    world
}

/// Bodies in a rapier world.
pub(super) struct World {
    pub(super) world: PhysicsWorld,
    bodies: Vec<Option<RigidBodyHandle>>,
    effects: Effects,
}

impl World {
    pub(super) fn new(effects: Effects, settings: &Settings) -> Self {
        let (size, step) = (settings.length_unit as Real, settings.step() as Real);
        let mut world = certified_world(CertifiedDispatcher::default(), size, step);
        world.gravity = narrow(&effects.gravity.unwrap_or_else(Vector3::zeros));
        let parameters = &mut world.integration_parameters;
        parameters.num_solver_iterations = effects.iterations;
        if let Some(speed) = settings.max_speed {
            parameters.normalized_max_linear_velocity = speed as Real / size;
        }
        parameters.friction_model = match effects.friction_model {
            FrictionModel::Simplified => rapier::dynamics::FrictionModel::Simplified,
            FrictionModel::Coulomb => rapier::dynamics::FrictionModel::Coulomb,
        };
        if effects.continuous == Continuous::Off {
            parameters.max_ccd_substeps = 0;
        }
        Self {
            world,
            bodies: Vec::new(),
            effects,
        }
    }

    pub(super) fn insert(&mut self, shape: &BodyShape, body: &Body) -> Result<BodyId, SimulationError> {
        let effects = &self.effects;
        let is_stuck = |density: f64| shape.inverse_mass(density).is_some_and(|inverse| inverse <= IMMOVABLE);
        if let Some(value) = body.density.filter(|&density| is_stuck(density)) {
            return Err(SimulationError::Number { what: "density", value });
        }
        let (linear, angular) = (narrow(&body.velocity.linear), narrow(&body.velocity.angular));
        let builder = match body.movement() {
            Movement::Fixed => RigidBodyBuilder::fixed(),
            Movement::Kinematic => RigidBodyBuilder::kinematic_velocity_based()
                .linvel(linear)
                .angvel(angular),
            Movement::Dynamic => RigidBodyBuilder::dynamic()
                .can_sleep(effects.sleeping)
                .ccd_enabled(effects.continuous == Continuous::AgainstAll)
                .linvel(linear)
                .angvel(if effects.rotation { angular } else { Vector::ZERO }),
        };
        let builder = match body.movement() {
            Movement::Dynamic if !effects.rotation => builder.lock_rotations(),
            _ => builder,
        };
        let collider = ColliderBuilder::new(shape.shared().clone())
            .density(body.density.unwrap_or(1.0) as Real)
            .friction(body.friction.or(effects.friction).unwrap_or(0.0) as Real)
            .restitution(body.restitution.or(effects.restitution).unwrap_or(0.0) as Real);
        let (handle, _) = self.world.insert(builder.pose(engine::pose(&body.pose)), collider);
        let id = BodyId(self.bodies.len() as u32);
        self.bodies.push(Some(handle));
        Ok(id)
    }

    pub(super) fn remove(&mut self, body: BodyId) -> Result<(), SimulationError> {
        let slot = self.bodies.get_mut(body.index()).and_then(Option::take);
        let handle = slot.ok_or(SimulationError::NoBody { body })?;
        self.world.remove_body(handle);
        Ok(())
    }

    fn body_mut(&mut self, body: BodyId) -> Result<&mut RigidBody, SimulationError> {
        let handle = self.handle(body);
        let found = handle.and_then(|handle| self.world.bodies.get_mut(handle));
        found.ok_or(SimulationError::NoBody { body })
    }

    pub(super) fn set_pose(&mut self, body: BodyId, pose: &Isometry3<f64>) -> Result<(), SimulationError> {
        self.body_mut(body)?.set_position(engine::pose(pose), true);
        Ok(())
    }

    pub(super) fn set_velocity(&mut self, body: BodyId, velocity: &Velocity) -> Result<(), SimulationError> {
        let rotation = self.effects.rotation;
        let body = self.body_mut(body)?;
        body.set_linvel(narrow(&velocity.linear), true);
        if rotation || body.is_kinematic() {
            body.set_angvel(narrow(&velocity.angular), true);
        }
        Ok(())
    }

    pub(super) fn handle(&self, body: BodyId) -> Option<RigidBodyHandle> {
        *self.bodies.get(body.index())?
    }

    fn body(&self, body: BodyId) -> Option<&RigidBody> {
        self.world.bodies.get(self.handle(body)?)
    }

    pub(super) fn pose(&self, body: BodyId) -> Option<Isometry3<f64>> {
        Some(engine::isometry(self.body(body)?.position()))
    }

    pub(super) fn velocity(&self, body: BodyId) -> Option<Velocity> {
        let body = self.body(body)?;
        Some(Velocity::new(wide(body.linvel()), wide(body.angvel())))
    }

    /// Returns the bodies at their current poses, without shapes that [`lin_canny`] does not have.
    pub(super) fn members(&self) -> impl Iterator<Item = Member> + '_ {
        self.bodies.iter().enumerate().filter_map(|(k, handle)| {
            let body = self.world.bodies.get((*handle)?)?;
            let collider = self.world.colliders.get(*body.colliders().first()?)?;
            let solid = BodyShape::from(collider.shared_shape()).solid()?;
            Some(Member {
                body: BodyId(k as u32),
                geometry: solid.geometry,
                pose: engine::isometry(body.position()) * solid.at,
                is_pushed: body.is_dynamic(),
            })
        })
    }

    pub(super) fn report(&self) -> Report {
        let world = &self.world;
        let moving = || world.bodies.iter().map(|(_, b)| b).filter(|b| b.is_dynamic());
        let awake = moving().filter(|b| !b.is_sleeping()).count();
        Report {
            moved: awake,
            asleep: moving().count() - awake,
            touching: world
                .narrow_phase
                .contact_pairs()
                .filter(|p| p.has_any_active_contact())
                .count(),
            iterations: world.integration_parameters.num_solver_iterations,
            swept: match self.effects.continuous {
                Continuous::Off => 0,
                _ => moving().filter(|b| b.is_ccd_active()).count(),
            },
        }
    }
}

fn narrow(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x as Real, v.y as Real, v.z as Real)
}

fn wide(v: Vector) -> Vector3<f64> {
    Vector3::from(v.to_array().map(f64::from))
}
