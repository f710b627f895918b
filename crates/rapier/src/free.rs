//! The engine without response: bodies move and pass through each other.

use lin_canny::nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use lin_canny::scene::{self, Group, Scene};
use lin_canny::{Geometry, Velocity};

use crate::effects::Movement;
use crate::overlap::Member;
use crate::{Body, BodyId, Effects, Report, Settings, SimulationError};

const FIXED: Group = Group::new(0).unwrap();
const MOVING: Group = Group::new(1).unwrap();

/// Bodies, and the scene that runs their pair queries.
#[derive(Debug)]
pub(crate) struct Free {
    scene: Scene,
    bodies: Vec<Option<FreeBody>>,
    effects: Effects,
    time_step: f64,
    moved: usize,
}

/// A shape in the engine without response.
pub(crate) struct Solid {
    pub(crate) geometry: Geometry,
    /// Pose of the geometry's frame in the body's frame.
    pub(crate) at: Isometry3<f64>,
    pub(crate) centroid: Point3<f64>,
    /// Inertia about the centroid at unit density.
    pub(crate) inertia: Matrix3<f64>,
}

#[derive(Debug)]
struct FreeBody {
    id: scene::BodyId,
    pose: Isometry3<f64>,
    /// Pose of the geometry's frame in the body's frame.
    at: Isometry3<f64>,
    movement: Movement,
    center: Point3<f64>,
    linear: Vector3<f64>,
    /// Angular momentum divided by the density; no torque changes it.
    momentum: Vector3<f64>,
    /// Inertia at unit density, in the body's frame; identity for a body without.
    spun: Matrix3<f64>,
    /// Inverse of the inertia at unit density, in the body's frame; identity for a body without.
    inverse: Matrix3<f64>,
}

impl Free {
    pub(crate) fn new(effects: Effects, settings: &Settings) -> Result<Self, SimulationError> {
        let mut scene = Scene::new();
        scene.set_queries(MOVING, MOVING, settings.queries)?;
        scene.set_queries(MOVING, FIXED, settings.queries)?;
        Ok(Self {
            scene,
            bodies: Vec::new(),
            effects,
            time_step: settings.step(),
            moved: 0,
        })
    }

    pub(crate) fn insert(&mut self, solid: Solid, body: &Body) -> Result<BodyId, SimulationError> {
        let Solid {
            geometry,
            at,
            centroid,
            inertia,
        } = solid;
        let movement = body.movement();
        let member = match movement {
            Movement::Fixed => scene::Body::fixed(geometry).group(FIXED),
            _ => scene::Body::moving(geometry).group(MOVING),
        };
        let id = self.scene.insert(member, body.pose * at)?;
        let size = inertia.amax();
        let inverse = (inertia / size).try_inverse().map(|m| m / size);
        let inverse = inverse
            .filter(|m| m.iter().all(|x| x.is_finite()))
            .unwrap_or_else(Matrix3::identity);
        let spun = inverse.try_inverse().unwrap_or_else(Matrix3::identity);
        let mut made = FreeBody {
            id,
            pose: body.pose,
            at,
            movement,
            center: centroid,
            linear: Vector3::zeros(),
            momentum: Vector3::zeros(),
            spun,
            inverse,
        };
        made.set_velocity(&body.velocity, self.effects.rotation);
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
        Some(self.bodies.get(body.index())?.as_ref()?.pose)
    }

    pub(crate) fn velocity(&self, body: BodyId) -> Option<Velocity> {
        let body = self.bodies.get(body.index())?.as_ref()?;
        Some(Velocity::new(body.linear, body.spin()))
    }

    /// Sets the pose of a body without a motion between; its velocity is unchanged.
    pub(crate) fn set_pose(&mut self, body: BodyId, pose: Isometry3<f64>) -> Result<(), SimulationError> {
        let of = found(&mut self.bodies, body)?;
        self.scene.set_pose(of.id, pose * of.at)?;
        let velocity = Velocity::new(of.linear, of.spin());
        of.pose = pose;
        of.set_velocity(&velocity, self.effects.rotation);
        Ok(())
    }

    pub(crate) fn set_velocity(&mut self, body: BodyId, velocity: &Velocity) -> Result<(), SimulationError> {
        found(&mut self.bodies, body)?.set_velocity(velocity, self.effects.rotation);
        Ok(())
    }

    /// Advances velocities, then poses with the new velocities (semi-implicit Euler), then the
    /// scene.
    pub(crate) fn step(&mut self) -> Result<(), SimulationError> {
        let (dt, gravity) = (self.time_step, self.effects.gravity.unwrap_or_else(Vector3::zeros));
        self.moved = 0;
        for body in self.bodies.iter_mut().flatten() {
            let linear = match body.movement {
                Movement::Fixed => continue,
                Movement::Kinematic => body.linear,
                Movement::Dynamic => body.linear + gravity * dt,
            };
            let next = body.advanced(&linear, dt);
            self.scene.set_pose(body.id, next * body.at)?;
            (body.pose, body.linear) = (next, linear);
            self.moved += 1;
        }
        self.scene.step();
        Ok(())
    }

    pub(crate) fn report(&self) -> Report {
        let near = |pair: &scene::PairResults| pair.overlaps == Some(true) || pair.manifold.is_some();
        Report {
            moved: self.moved,
            touching: self.scene.pairs().filter(near).count(),
            ..Report::default()
        }
    }

    pub(crate) fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Returns the bodies at their current poses.
    pub(crate) fn members(&self) -> impl Iterator<Item = Member> + '_ {
        self.bodies.iter().enumerate().filter_map(|(k, body)| {
            let of = body.as_ref()?;
            Some(Member {
                body: BodyId(k as u32),
                geometry: self.scene.geometry(of.id)?.clone(),
                pose: of.pose * of.at,
                is_pushed: of.movement == Movement::Dynamic,
            })
        })
    }
}

fn found(bodies: &mut [Option<FreeBody>], body: BodyId) -> Result<&mut FreeBody, SimulationError> {
    let slot = bodies.get_mut(body.index()).and_then(Option::as_mut);
    slot.ok_or(SimulationError::NoBody { body })
}

impl FreeBody {
    /// Sets the velocity; a fixed body has none, as in the engine with response.
    ///
    /// A kinematic body rotates even if `rotation` is not enabled.
    fn set_velocity(&mut self, velocity: &Velocity, rotation: bool) {
        let turns = match self.movement {
            Movement::Fixed => return,
            Movement::Kinematic => true,
            Movement::Dynamic => rotation,
        };
        self.linear = velocity.linear;
        let spin = if turns { velocity.angular } else { Vector3::zeros() };
        self.momentum = match self.movement {
            Movement::Kinematic => spin,
            _ => {
                let turn = self.pose.rotation;
                turn * (self.spun * turn.inverse_transform_vector(&spin))
            }
        };
    }

    /// Returns the angular velocity.
    ///
    /// It follows from the conserved angular momentum. For a kinematic body the angular velocity
    /// itself is conserved.
    fn spin(&self) -> Vector3<f64> {
        match self.movement {
            Movement::Kinematic => self.momentum,
            _ => {
                let turn = self.pose.rotation;
                turn * (self.inverse * turn.inverse_transform_vector(&self.momentum))
            }
        }
    }

    /// Returns the pose after a time `dt`; the centre of mass moves along a straight line.
    fn advanced(&self, linear: &Vector3<f64>, dt: f64) -> Isometry3<f64> {
        let center = self.pose * self.center + linear * dt;
        let turned = Velocity::new(Vector3::zeros(), self.spin())
            .applied(&self.pose, dt)
            .rotation;
        Isometry3::from_parts((center - turned * self.center).into(), turned)
    }
}
