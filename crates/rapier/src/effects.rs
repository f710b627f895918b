//! What a simulation is asked for, and what it did.

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::{Velocity, scene};

use crate::SimulationError;

/// The numbers of which an engine of a precision has the squares and the squares of the inverses, with
/// a factor of 100 to spare.
#[derive(Clone, Copy)]
pub(crate) struct Reals {
    least: f64,
    most: f64,
}

impl Reals {
    /// Of the least positive normal number and the largest number of a precision.
    pub(crate) fn new(least: f64, most: f64) -> Self {
        Self {
            least: 100.0 * least.sqrt(),
            most: 0.01 * most.sqrt(),
        }
    }

    /// Refuses a number that is not positive, or none of the engine's.
    fn positive(self, what: &'static str, value: f64) -> Result<(), SimulationError> {
        match value >= self.least && value <= self.most {
            true => Ok(()),
            false => Err(SimulationError::Number { what, value }),
        }
    }

    /// Refuses a vector with a coordinate that the engine does not have.
    fn vector(self, what: &'static str, v: &Vector3<f64>) -> Result<(), SimulationError> {
        // Written so that NaN is refused.
        match v.iter().find(|x| !(x.abs() <= self.most)) {
            Some(&value) => Err(SimulationError::Number { what, value }),
            None => Ok(()),
        }
    }
}

/// The effects a simulation computes. An effect left out is not computed; see the table on the
/// [page of the crate](crate) for what that saves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effects {
    /// Acceleration of all moving bodies, in lengths a square of time.
    pub gravity: Option<Vector3<f64>>,
    /// Whether bodies push each other. Without response no physics engine is built, and the effects
    /// below except `rotation` are refused.
    pub response: bool,
    /// Coefficient of friction of all contacts.
    pub friction: Option<f64>,
    /// Coefficient of restitution of all contacts, 0 to 1.
    pub restitution: Option<f64>,
    /// Whether bodies rotate.
    pub rotation: bool,
    /// Whether bodies at rest are put to sleep.
    pub sleeping: bool,
    /// Which fast bodies are swept, so that they do not pass through others between steps.
    pub continuous: Continuous,
    /// Model of friction.
    pub friction_model: FrictionModel,
    /// Iterations of the solver a step; rapier's default is 4.
    pub iterations: usize,
}

/// Which bodies are swept between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Continuous {
    /// No body is swept.
    #[default]
    Off,
    /// Fast bodies are swept against fixed bodies, as rapier does by default.
    AgainstFixed,
    /// All bodies are swept against all.
    AgainstAll,
}

/// Model of friction in the solver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FrictionModel {
    /// One friction block for each manifold, a third cheaper in the solver.
    #[default]
    Simplified,
    /// A friction cone at each contact.
    Coulomb,
}

impl Effects {
    /// Returns no effects but the motion along straight lines.
    #[must_use]
    pub const fn none() -> Self {
        Self {
            gravity: None,
            response: false,
            friction: None,
            restitution: None,
            rotation: false,
            sleeping: false,
            continuous: Continuous::Off,
            friction_model: FrictionModel::Simplified,
            iterations: 0,
        }
    }

    /// Returns response with rotation, sleeping, motion swept against fixed bodies and four
    /// iterations: rapier's defaults, without gravity, friction and restitution.
    #[must_use]
    pub const fn response() -> Self {
        Self {
            response: true,
            rotation: true,
            sleeping: true,
            continuous: Continuous::AgainstFixed,
            iterations: 4,
            ..Self::none()
        }
    }

    /// Refuses numbers that are none, and effects that need response.
    pub(crate) fn check(&self, reals: Reals) -> Result<(), SimulationError> {
        coefficient("friction", self.friction)?;
        coefficient("restitution", self.restitution)?;
        if let Some(gravity) = &self.gravity {
            reals.vector("gravity", gravity)?;
        }
        if self.response {
            return match self.iterations {
                1..=1000 => Ok(()),
                n => Err(SimulationError::Number {
                    what: "iterations",
                    value: n as f64,
                }),
            };
        }
        let needs = [
            ("friction", self.friction.is_some()),
            ("restitution", self.restitution.is_some()),
            ("sleeping", self.sleeping),
            ("continuous", self.continuous != Continuous::Off),
            ("friction_model", self.friction_model != FrictionModel::default()),
            ("iterations", self.iterations > 0),
        ];
        match needs.iter().find(|(_, called)| *called) {
            Some((effect, _)) => Err(SimulationError::NeedsResponse { effect }),
            None => Ok(()),
        }
    }
}

/// Settings of a simulation that are no effects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Time of a step. `None`, the default, is 1/60, and with response and gravity is refused for
    /// bodies so small that one falls by more than an eighth of `length_unit` within it: on Earth, in
    /// metres, below 2.2 cm. A step that is given is taken.
    pub time_step: Option<f64>,
    /// Diameter of an ordinary body: rapier's `length_unit`, to which its prediction, slop and
    /// thresholds of sleep are relative. Default 1. Millimetre parts in metres need 0.001, and
    /// short steps: no body should move by more than its size in a step. Sixty hulls of 6 mm that
    /// fell into a bin at 1 m/s came to rest 61 % of their radius deep with steps of 1/60 s, 6 %
    /// with 1/240 s, and 1 % with 1/1000 s. The [page of the crate](crate) lists what follows from it.
    pub length_unit: f64,
    /// Greatest speed of a body with response, in lengths a time: a faster one is slowed down to it.
    /// `None`, the default, is no limit. rapier's own limit, 400 sizes a second, would stop the fall
    /// of a part of 2 mm after eight hundredths of a second.
    pub max_speed: Option<f64>,
    /// What a scene without response answers about pairs of bodies; refused with response.
    pub queries: scene::PairQueries,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            time_step: None,
            length_unit: 1.0,
            max_speed: None,
            queries: scene::PairQueries::none(),
        }
    }
}

impl Settings {
    /// Time of a step if none is given.
    const STEP: f64 = 1.0 / 60.0;

    /// How far a body may fall from rest in the default step, over its size.
    const FALL: f64 = 0.125;

    pub(crate) fn time_step(&self) -> f64 {
        self.time_step.unwrap_or(Self::STEP)
    }

    pub(crate) fn check(&self, reals: Reals, effects: &Effects) -> Result<(), SimulationError> {
        reals.positive("time_step", self.time_step())?;
        reals.positive("size", self.length_unit)?;
        if let Some(speed) = self.max_speed {
            reals.positive("max_speed", speed)?;
        }
        let gravity = effects.gravity.filter(|_| effects.response && self.time_step.is_none());
        let longest = gravity.map(|g| (Self::FALL * self.length_unit / g.norm()).sqrt());
        match longest {
            Some(longest) if longest < Self::STEP => Err(SimulationError::LongStep { longest }),
            _ => Ok(()),
        }
    }
}

/// A body to be inserted: how it moves, from where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Pose of the body's frame in the world.
    pub pose: Isometry3<f64>,
    /// Mass a unit of volume; `None` for a body that nothing pushes.
    pub density: Option<f64>,
    /// Velocity of the centre of mass, and angular velocity.
    pub velocity: Velocity,
    /// Whether a body without density moves at its velocity, pushed by nothing.
    pub is_kinematic: bool,
    /// Coefficient of friction of this body; `None` for that of the effects.
    pub friction: Option<f64>,
    /// Coefficient of restitution of this body, 0 to 1; `None` for that of the effects.
    pub restitution: Option<f64>,
}

/// How a body moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Movement {
    Fixed,
    Kinematic,
    Dynamic,
}

impl Body {
    /// Returns a body that never moves.
    #[must_use]
    pub fn fixed(pose: Isometry3<f64>) -> Self {
        Self {
            pose,
            density: None,
            velocity: Velocity::default(),
            is_kinematic: false,
            friction: None,
            restitution: None,
        }
    }

    /// Returns a body that moves at its velocity and pushes others, and that nothing pushes: a
    /// conveyor, a gripper, a lift.
    #[must_use]
    pub fn kinematic(pose: Isometry3<f64>, velocity: Velocity) -> Self {
        Self {
            velocity,
            is_kinematic: true,
            ..Self::fixed(pose)
        }
    }

    /// Returns a body that moves, at rest.
    #[must_use]
    pub fn moving(pose: Isometry3<f64>, density: f64) -> Self {
        Self {
            density: Some(density),
            ..Self::fixed(pose)
        }
    }

    /// Returns the body with a velocity of its centre of mass and an angular velocity.
    #[must_use]
    pub fn velocity(self, velocity: Velocity) -> Self {
        Self { velocity, ..self }
    }

    /// Returns the body with a coefficient of friction of its own. Two bodies in contact have the mean
    /// of theirs.
    #[must_use]
    pub fn friction(self, friction: f64) -> Self {
        Self {
            friction: Some(friction),
            ..self
        }
    }

    /// Returns the body with a coefficient of restitution of its own, 0 to 1. Two bodies in contact
    /// have the mean of theirs.
    #[must_use]
    pub fn restitution(self, restitution: f64) -> Self {
        Self {
            restitution: Some(restitution),
            ..self
        }
    }

    pub(crate) fn movement(&self) -> Movement {
        match self.density {
            Some(_) => Movement::Dynamic,
            None if self.is_kinematic => Movement::Kinematic,
            None => Movement::Fixed,
        }
    }

    pub(crate) fn check(&self, reals: Reals) -> Result<(), SimulationError> {
        coefficient("friction", self.friction)?;
        coefficient("restitution", self.restitution)?;
        if let Some(value) = self.density.filter(|d| !(*d > 0.0 && d.is_finite())) {
            return Err(SimulationError::Number { what: "density", value });
        }
        placed(&self.pose, reals)?;
        moved(&self.velocity, reals)
    }
}

/// Refuses a coefficient that is negative, NaN or beyond all use.
fn coefficient(what: &'static str, x: Option<f64>) -> Result<(), SimulationError> {
    match x {
        Some(value) if !(0.0..=1e6).contains(&value) => Err(SimulationError::Number { what, value }),
        _ => Ok(()),
    }
}

/// Refuses a pose that is none of the engine's. A position may be as near to the origin as it likes.
pub(crate) fn placed(pose: &Isometry3<f64>, reals: Reals) -> Result<(), SimulationError> {
    lin_canny::RelativePose::from_isometry(pose)?;
    let at = &pose.translation.vector;
    match at.iter().find(|x| x.abs() > reals.most) {
        Some(&value) => Err(SimulationError::Number {
            what: "position",
            value,
        }),
        None => Ok(()),
    }
}

/// Refuses a velocity that the engine does not have.
pub(crate) fn moved(velocity: &Velocity, reals: Reals) -> Result<(), SimulationError> {
    reals.vector("velocity", &velocity.linear)?;
    reals.vector("velocity", &velocity.angular)
}

/// Id of a body of one simulation, never used again after the body is removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BodyId(pub(crate) u32);

impl BodyId {
    /// Returns the number of bodies inserted before this one.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// What the last step did. The counters of effects left out are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Moving bodies whose velocity was integrated.
    pub moved: usize,
    /// Moving bodies that sleep.
    pub asleep: usize,
    /// Pairs of bodies that share a contact point or are as near as the prediction.
    pub touching: usize,
    /// Iterations of the solver.
    pub iterations: usize,
    /// Bodies fast enough to be swept.
    pub swept: usize,
}
