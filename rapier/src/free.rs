//! The engine without response: bodies that move and pass through each other.

use std::sync::Arc;

use lin_canny::nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use lin_canny::scene::{self, Group, Scene};
use lin_canny::{ConvexPolyhedron, Velocity};

use crate::{Body, BodyId, Effects, Report, Settings, SimulationError};

const FIXED: Group = Group::new(0).unwrap();
const MOVING: Group = Group::new(1).unwrap();

/// Bodies, and the scene that answers about their pairs.
#[derive(Debug)]
pub(crate) struct Free {
    scene: Scene,
    bodies: Vec<Option<FreeBody>>,
    effects: Effects,
    time_step: f64,
    moved: usize,
}

#[derive(Debug)]
struct FreeBody {
    id: scene::BodyId,
    is_fixed: bool,
    center: Point3<f64>,
    linear: Vector3<f64>,
    /// Angular momentum over the mass density, which no torque changes.
    momentum: Vector3<f64>,
    /// Inverse of the inertia at unit density, in the body's frame; identity for a body without.
    inverse: Matrix3<f64>,
}

impl Free {
    pub(crate) fn new(effects: Effects, settings: &Settings) -> Result<Self, SimulationError> {
        let mut scene = Scene::new();
        scene.call_for(MOVING, MOVING, settings.observe)?;
        scene.call_for(MOVING, FIXED, settings.observe)?;
        Ok(Self {
            scene,
            bodies: Vec::new(),
            effects,
            time_step: settings.time_step,
            moved: 0,
        })
    }

    pub(crate) fn insert(&mut self, shape: &Arc<ConvexPolyhedron>, body: &Body) -> Result<BodyId, SimulationError> {
        let is_fixed = body.density.is_none();
        let solid = match is_fixed {
            true => scene::Body::fixed(shape.clone()).group(FIXED),
            false => scene::Body::moving(shape.clone()).group(MOVING),
        };
        let id = self.scene.insert(solid, body.pose)?;
        let inertia = shape.inertia();
        let size = inertia.amax();
        let inverse = (inertia / size).try_inverse().map(|m| m / size);
        let inverse = inverse
            .filter(|m| m.iter().all(|x| x.is_finite()))
            .unwrap_or_else(Matrix3::identity);
        let spun = inverse.try_inverse().unwrap_or_else(Matrix3::identity);
        let turn = body.pose.rotation;
        // What does not move has no velocity, as in the engine with response.
        let linear = if is_fixed {
            Vector3::zeros()
        } else {
            body.velocity.linear
        };
        let spin = if is_fixed || !self.effects.rotation {
            Vector3::zeros()
        } else {
            body.velocity.angular
        };
        let made = FreeBody {
            id,
            is_fixed,
            center: shape.centroid(),
            linear,
            momentum: turn * (spun * turn.inverse_transform_vector(&spin)),
            inverse,
        };
        let index = BodyId(self.bodies.len() as u32);
        self.bodies.push(Some(made));
        Ok(index)
    }

    pub(crate) fn remove(&mut self, body: BodyId) -> Result<(), SimulationError> {
        let slot = self.bodies.get_mut(body.index()).and_then(Option::take);
        let gone = slot.ok_or(SimulationError::NoBody { body })?;
        Ok(self.scene.remove(gone.id)?)
    }

    pub(crate) fn pose(&self, body: BodyId) -> Option<Isometry3<f64>> {
        let body = self.bodies.get(body.index())?.as_ref()?;
        self.scene.pose(body.id).copied()
    }

    pub(crate) fn velocity(&self, body: BodyId) -> Option<Velocity> {
        let pose = self.pose(body)?;
        let body = self.bodies.get(body.index())?.as_ref()?;
        Some(Velocity::new(body.linear, body.spin(&pose)))
    }

    /// Advances velocities, then poses with the new velocities (semi-implicit Euler), then the
    /// scene.
    pub(crate) fn step(&mut self) -> Result<(), SimulationError> {
        let (dt, gravity) = (self.time_step, self.effects.gravity.unwrap_or_else(Vector3::zeros));
        self.moved = 0;
        for body in self.bodies.iter_mut().flatten().filter(|b| !b.is_fixed) {
            let Some(pose) = self.scene.pose(body.id) else { continue };
            let linear = body.linear + gravity * dt;
            let next = body.advanced(pose, &linear, &body.spin(pose), dt);
            self.scene.set_pose(body.id, next)?;
            body.linear = linear;
            self.moved += 1;
        }
        self.scene.step();
        Ok(())
    }

    pub(crate) fn report(&self) -> Report {
        let near = |pair: &scene::PairAnswer| pair.overlaps == Some(true) || pair.manifold.is_some();
        Report {
            moved: self.moved,
            touching: self.scene.pairs().filter(near).count(),
            ..Report::default()
        }
    }

    pub(crate) fn scene(&self) -> &Scene {
        &self.scene
    }
}

impl FreeBody {
    /// Returns the angular velocity of the conserved angular momentum.
    fn spin(&self, pose: &Isometry3<f64>) -> Vector3<f64> {
        let turn = pose.rotation;
        turn * (self.inverse * turn.inverse_transform_vector(&self.momentum))
    }

    /// Returns the pose after a time at which the centre of mass moves on a line.
    fn advanced(&self, pose: &Isometry3<f64>, linear: &Vector3<f64>, spin: &Vector3<f64>, dt: f64) -> Isometry3<f64> {
        let center = pose * self.center + linear * dt;
        let turned = Velocity::new(Vector3::zeros(), *spin).applied(pose, dt).rotation;
        Isometry3::from_parts((center - turned * self.center).into(), turned)
    }
}
