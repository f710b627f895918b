//! Effects and settings of a simulation, bodies, and the report of a step.

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::{Velocity, scene};

use crate::SimulationError;

/// The range of numbers whose squares and inverse squares an engine can represent, with a reserve
/// of a factor of 100.
#[derive(Clone, Copy)]
pub(crate) struct Reals {
    least: f64,
    most: f64,
}

impl Reals {
    /// Returns the range from the least positive normal number and the largest number of a
    /// precision.
    pub(crate) fn new(least: f64, most: f64) -> Self {
        Self {
            least: 100.0 * least.sqrt(),
            most: 0.01 * most.sqrt(),
        }
    }

    /// Returns an error unless a number is positive and in range.
    fn positive(self, what: &'static str, value: f64) -> Result<(), SimulationError> {
        match value >= self.least && value <= self.most {
            true => Ok(()),
            false => Err(SimulationError::Number { what, value }),
        }
    }

    /// Returns an error if a coordinate of a vector is out of range.
    fn vector(self, what: &'static str, v: &Vector3<f64>) -> Result<(), SimulationError> {
        // Written so that NaN is an error.
        match v.iter().find(|x| !(x.abs() <= self.most)) {
            Some(&value) => Err(SimulationError::Number { what, value }),
            None => Ok(()),
        }
    }
}

/// The effects that a simulation computes.
///
/// An effect that is not enabled is not computed. The table on the [page of the crate](crate) lists
/// the cost of each effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effects {
    /// Acceleration of all dynamic bodies, in lengths per square of time.
    pub gravity: Option<Vector3<f64>>,
    /// Whether bodies push each other.
    ///
    /// Without response no physics engine is created, and the effects below except `rotation` are
    /// an error.
    pub response: bool,
    /// Coefficient of friction of all contacts.
    pub friction: Option<f64>,
    /// Coefficient of restitution of all contacts, 0 to 1.
    pub restitution: Option<f64>,
    /// Whether bodies rotate.
    pub rotation: bool,
    /// Whether bodies at rest are put to sleep.
    pub sleeping: bool,
    /// Which fast bodies are swept, so that they cannot pass through others between steps.
    pub continuous: Continuous,
    /// Model of friction.
    pub friction_model: FrictionModel,
    /// Number of solver iterations per step; rapier's default is 4.
    pub iterations: usize,
}

/// Which bodies are swept between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Continuous {
    /// No body is swept.
    #[default]
    Off,
    /// Fast bodies are swept against fixed bodies; this is rapier's default.
    AgainstFixed,
    /// All bodies are swept against all others.
    AgainstAll,
}

/// Model of friction in the solver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum FrictionModel {
    /// One friction block per manifold; the solver is a third cheaper than with `Coulomb`.
    #[default]
    Simplified,
    /// A friction cone at each contact.
    Coulomb,
}

impl Effects {
    /// Returns effects with motion along straight lines only.
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

    /// Returns an error if a number is out of range, or an effect needs response.
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

/// Settings of a simulation other than effects.
///
/// ```
/// use lin_canny_rapier::Settings;
///
/// let small_parts = Settings::default().length_unit(0.02).time_step(1.0 / 240.0);
/// assert_eq!(small_parts.max_speed, None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// Duration of a step; 1/60 if `None` (the default).
    ///
    /// With response and gravity, the default is an error if a body of this size falls by more
    /// than an eighth of its size in one step (2.2 cm on Earth, in metres). An explicit value is
    /// always accepted.
    pub time_step: Option<f64>,
    /// Diameter of an ordinary body (default 1): rapier's `length_unit`.
    ///
    /// rapier's prediction, slop and sleep thresholds are relative to it; the [page of the
    /// crate](crate) lists all of them. Millimetre parts in metres need 0.001 and short steps: no
    /// body should move by more than its size in a step. Sixty hulls of 6 mm that fell into a bin
    /// at 1 m/s came to rest with overlaps of 61 % of their radius with steps of 1/60 s, 6 % with
    /// 1/240 s and 1 % with 1/1000 s.
    pub length_unit: f64,
    /// Speed limit of a body with response, in lengths per time; `None` (the default) is no limit.
    ///
    /// rapier's default limit of 400 sizes per second would stop the acceleration of a falling 2 mm
    /// part after 0.08 s.
    pub max_speed: Option<f64>,
    /// Pair queries of a scene without response; must be empty with response.
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
    /// Default duration of a step.
    const STEP: f64 = 1.0 / 60.0;

    /// Distance that a body may fall from rest in the default step, divided by its size.
    const FALL: f64 = 0.125;

    /// Returns the settings with another duration of a step.
    #[must_use]
    pub const fn time_step(mut self, seconds: f64) -> Self {
        self.time_step = Some(seconds);
        self
    }

    /// Returns the settings with another diameter of an ordinary body.
    #[must_use]
    pub const fn length_unit(mut self, diameter: f64) -> Self {
        self.length_unit = diameter;
        self
    }

    /// Returns the settings with a speed limit of bodies with response.
    #[must_use]
    pub const fn max_speed(mut self, speed: f64) -> Self {
        self.max_speed = Some(speed);
        self
    }

    /// Returns the settings with pair queries of a scene without response.
    #[must_use]
    pub const fn queries(mut self, queries: scene::PairQueries) -> Self {
        self.queries = queries;
        self
    }

    /// Returns the duration of a step.
    pub(crate) fn step(&self) -> f64 {
        self.time_step.unwrap_or(Self::STEP)
    }

    pub(crate) fn check(&self, reals: Reals, effects: &Effects) -> Result<(), SimulationError> {
        reals.positive("time_step", self.step())?;
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

/// A body to insert: its pose, velocity, density and coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Pose of the body's frame in the world.
    pub pose: Isometry3<f64>,
    /// Mass per unit of volume; `None` for a body that nothing pushes.
    pub density: Option<f64>,
    /// Velocity of the centre of mass, and angular velocity.
    pub velocity: Velocity,
    /// Whether a body without density moves at its velocity.
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

    /// Returns a body that moves at its velocity and pushes others, but that nothing pushes.
    ///
    /// Examples are a conveyor, a gripper and a lift.
    #[must_use]
    pub fn kinematic(pose: Isometry3<f64>, velocity: Velocity) -> Self {
        Self {
            velocity,
            is_kinematic: true,
            ..Self::fixed(pose)
        }
    }

    /// Returns a dynamic body that is initially at rest.
    #[must_use]
    pub fn moving(pose: Isometry3<f64>, density: f64) -> Self {
        Self {
            density: Some(density),
            ..Self::fixed(pose)
        }
    }

    /// Sets the velocity of the centre of mass and the angular velocity.
    #[must_use]
    pub fn velocity(self, velocity: Velocity) -> Self {
        Self { velocity, ..self }
    }

    /// Sets the coefficient of friction of this body; a contact uses the mean of both bodies.
    #[must_use]
    pub fn friction(self, friction: f64) -> Self {
        Self {
            friction: Some(friction),
            ..self
        }
    }

    /// Sets the coefficient of restitution of this body, 0 to 1; a contact uses the mean of both.
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

/// Returns an error if a coefficient is negative, NaN or above 1e6.
fn coefficient(what: &'static str, x: Option<f64>) -> Result<(), SimulationError> {
    match x {
        Some(value) if !(0.0..=1e6).contains(&value) => Err(SimulationError::Number { what, value }),
        _ => Ok(()),
    }
}

/// Returns an error if a pose is out of range. A position may be arbitrarily close to the origin.
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

/// Returns an error if a velocity is out of range.
pub(crate) fn moved(velocity: &Velocity, reals: Reals) -> Result<(), SimulationError> {
    reals.vector("velocity", &velocity.linear)?;
    reals.vector("velocity", &velocity.angular)
}

/// Id of a body of a simulation. It is never reused after the body is removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BodyId(pub(crate) u32);

impl BodyId {
    /// Returns the number of bodies inserted before this one.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Counts of the last step. The counts of effects that are not enabled are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Report {
    /// Number of moving bodies whose velocity was integrated.
    pub moved: usize,
    /// Number of moving bodies that are asleep.
    pub asleep: usize,
    /// Number of pairs that are in contact or within the prediction.
    pub touching: usize,
    /// Number of solver iterations.
    pub iterations: usize,
    /// Number of bodies fast enough to be swept.
    pub swept: usize,
}
