//! Motions of a rigid body: where it is at a time, and how it may go on from there.
//!
//! A [`Motion`] places its body at any time and gives a [`MotionModel`]: velocities at that time
//! and a proven bound of how far the body can leave the motion at those velocities. Bounds hold for
//! the motion meant, and for the poses that [`Motion::pose`] places, rounding included (`PLACED_*`
//! and `TURN` in [`tolerance`](crate::tolerance)).
//!
//! | motion | kind |
//! |---|---|
//! | constant velocities of a body's origin, or of any point | [`Steady::new`], [`Steady::about`] |
//! | with a known or bounded acceleration | [`Steady::with_acceleration`], [`Steady::with_acceleration_bounds`] |
//! | from one pose to another at a constant rate about one axis (slerp) | [`Steady::between`] |
//! | a screw: a turn about a line of the world and a shift along the line | [`Steady::screw`] |
//! | from one pose to another by nlerp, as Box2D, parry and rapier sweep | [`Nlerp`] |
//! | any other | the trait [`Motion`] |
//!
//! # Bounds
//!
//! Let the pivot of a body go at `v` with acceleration `a`, and the body turn at `w`, at a time
//! `t`. The *model* of the motion is `c + v s + a s^2 / 2` for the pivot and `exp(w s)` for the
//! turn, from the pose that is placed at `t`. Of a motion whose angular velocity changes at most at
//! a rate `k`, the turn that parts motion and model has a rate of at most `k s`, hence an angle of
//! at most `k s^2 / 2`, and no point within `r` of the pivot is farther from where the model has it
//! than `r k s^2 / 2`. A [`Remainder`] is a cubic bound of that form, of the pivot's place (a
//! length) and of the turn (an angle).

mod displacement;
mod nlerp;
pub(crate) mod rotation;
mod steady;

pub(crate) use crate::base::motion::displacement::{BallAtPose, displacement};
pub use crate::base::motion::nlerp::Nlerp;
pub use crate::base::motion::steady::Steady;
pub use crate::base::motion::steady::Velocity;
use crate::base::num::extremes::Bounded;
use crate::base::num::scalar::{magnitude, sqrt};
use crate::base::pose::PoseError;
use crate::base::tolerance::{SQUARE_MIN, UNIT};
use nalgebra::{Isometry3, Point3, Vector3};

/// A rigid motion: a pose at every time, and bounds of the displacement from there.
///
/// # Contract
///
/// For every `s` in `0..=span` the model at `time` bounds two things: the motion itself at `time +
/// s` and, if `time + s` is an f64, the pose that [`pose`](Self::pose) returns for `time + s`. For
/// every point within `r` of the pivot both are within `shift(s) + r turn(s)` of the position in
/// the model, if the model starts from the pose returned for `time`. Rounding of the
/// poses is part of the bound: remainders start above zero. A model with a number that is NaN or
/// infinite, or with a negative bound, is one of which nothing is known: no query proves anything
/// by it.
///
/// A turntable whose rate swings, so that the rate changes by at most 0.6 a unit of time each unit
/// of time:
///
/// ```
/// use lin_canny::motion::{MotionModel, Remainder, Motion};
/// use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
///
/// struct Swing;
/// impl Motion for Swing {
///     fn pose(&self, time: f64) -> Isometry3<f64> {
///         let angle = 0.3 * (1.0 - time.cos()) * 2.0;
///         let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * angle);
///         Isometry3::from_parts(Vector3::zeros().into(), turn)
///     }
///     fn model(&self, time: f64, _span: f64) -> MotionModel {
///         MotionModel {
///             pivot: Point3::origin(),
///             linear: Vector3::zeros(),
///             angular: Vector3::z() * 0.6 * time.sin(),
///             acceleration: Vector3::zeros(),
///             shift: Remainder::default(),
///             turn: Remainder([1e-13, 0.0, 0.6, 0.0]),
///         }
///     }
/// }
/// let most = Swing.model(1.0, 0.5).displacement(2.0, 0.5);
/// let x = Point3::new(2.0, 0.0, 0.0);
/// let far = |s: f64| (Swing.pose(1.0 + s) * x - Swing.pose(1.0) * x).norm();
/// assert!(far(0.25) <= most && far(0.5) <= most);
/// ```
pub trait Motion {
    /// Returns the pose of the body's own frame in the world at a time.
    fn pose(&self, time: f64) -> Isometry3<f64>;

    /// Returns the velocities at a time, and bounds of the deviation from these velocities within
    /// `span` from then on.
    fn model(&self, time: f64, span: f64) -> MotionModel;

    /// Returns the pose and the model at a time: for motions that compute one while they compute
    /// the other.
    #[inline(always)]
    fn placed(&self, time: f64, span: f64) -> (Isometry3<f64>, MotionModel) {
        (self.pose(time), self.model(time, span))
    }
}

impl<M: Motion + ?Sized> Motion for &M {
    fn pose(&self, time: f64) -> Isometry3<f64> {
        (**self).pose(time)
    }

    fn model(&self, time: f64, span: f64) -> MotionModel {
        (**self).model(time, span)
    }

    #[inline(always)]
    fn placed(&self, time: f64, span: f64) -> (Isometry3<f64>, MotionModel) {
        (**self).placed(time, span)
    }
}

/// Velocities of a body at a time, in the world's axes, and bounds of the deviation of the motion
/// from then on.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MotionModel {
    /// The point of the body, in the body's own frame, about which the body turns and whose
    /// velocity is `linear`.
    pub pivot: Point3<f64>,
    /// Velocity of the pivot.
    pub linear: Vector3<f64>,
    /// Axis of rotation times radians a unit of time.
    pub angular: Vector3<f64>,
    /// Acceleration of the pivot, constant in the model.
    pub acceleration: Vector3<f64>,
    /// Upper bound of the distance of the pivot from the model: a length.
    pub shift: Remainder,
    /// Upper bound of the angle of the body against the model: radians.
    pub turn: Remainder,
}

impl MotionModel {
    /// Returns an upper bound of the displacement of any point within `radius` of the pivot within
    /// `span`.
    #[must_use]
    pub fn displacement(&self, radius: f64, span: f64) -> f64 {
        // Products with the time first: the ways are lengths, and what they lose by underflow is
        // less than the least normal number.
        let straight = length(&(self.linear * span)) + 0.5 * length(&(self.acceleration * span * span));
        let turned = length(&(self.angular * span)).at_most(2.0);
        let most = straight + self.shift.at(span) + radius * (turned + self.turn.at(span));
        most * (1.0 + 16.0 * UNIT) + f64::MIN_POSITIVE
    }

    /// Returns whether all numbers are finite, and no bound is negative: else nothing is known of
    /// the motion.
    #[inline]
    pub(crate) fn is_known(&self) -> bool {
        // Zero times a finite number is zero, and NaN times any other: no branch a number. Two sums
        // side by side take one instruction a step.
        let (p, v, w, a) = (&self.pivot.coords, &self.linear, &self.angular, &self.acceleration);
        let (Remainder(s), Remainder(t)) = (self.shift, self.turn);
        let mut sums = [0.0; 2];
        for [x, y] in [[p.x, p.y], [p.z, v.x], [v.y, v.z], [w.x, w.y], [w.z, a.x], [a.y, a.z]] {
            sums = [sums[0] + 0.0 * x, sums[1] + 0.0 * y];
        }
        let mut least = [0.0; 2];
        for [x, y] in [[s[0], s[1]], [s[2], s[3]], [t[0], t[1]], [t[2], t[3]]] {
            sums = [sums[0] + 0.0 * x, sums[1] + 0.0 * y];
            least = [least[0].at_most(x), least[1].at_most(y)];
        }
        (sums[0] + sums[1]) + (least[0] + least[1]) == 0.0
    }

    /// Returns the model on a clock with this unit, a power of two.
    #[inline(always)]
    pub(crate) fn on_clock(&self, unit: f64) -> Self {
        Self {
            pivot: self.pivot,
            linear: self.linear * unit,
            angular: self.angular * unit,
            acceleration: self.acceleration * unit * unit,
            shift: self.shift.on_clock(unit),
            turn: self.turn.on_clock(unit),
        }
    }

    /// Returns an upper bound of the distance of a point within `radius` of the pivot from the
    /// model.
    #[must_use]
    #[inline]
    pub fn drift(&self, radius: f64) -> Remainder {
        let (Remainder(p), Remainder(q)) = (self.shift, self.turn);
        Remainder(core::array::from_fn(|k| p[k] + radius * q[k]))
    }
}

/// A bound that grows with time: `[d0, d1, d2, d3]` stands for `d0 + d1 s + d2 s^2 / 2 + d3 s^3 /
/// 6` at `s` after the start. No coefficient is negative.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Remainder(pub [f64; 4]);

impl Remainder {
    /// Returns the bound at `s` after the start.
    #[must_use]
    pub fn at(&self, s: f64) -> f64 {
        // Products with the time first, as of a displacement.
        let [d0, d1, d2, d3] = self.on_clock(s).0;
        d0 + (d1 + (0.5 * d2 + d3 / 6.0))
    }

    /// Returns the bound on a clock with this unit.
    pub(crate) fn on_clock(&self, unit: f64) -> Self {
        let [d0, d1, d2, d3] = self.0;
        Self([d0, d1 * unit, d2 * unit * unit, d3 * unit * unit * unit])
    }
}

/// Returns the length of a vector of any size, also of a vector whose square leaves f64.
#[inline(always)]
pub(crate) fn length(v: &Vector3<f64>) -> f64 {
    let square = v.norm_squared();
    if square > SQUARE_MIN && square < 1.0 / SQUARE_MIN {
        return sqrt(square);
    }
    if v.x == 0.0 && v.y == 0.0 && v.z == 0.0 {
        return 0.0;
    }
    length_of_any_size(v)
}

#[cold]
fn length_of_any_size(v: &Vector3<f64>) -> f64 {
    let unit = magnitude(v.amax());
    unit * sqrt((v / unit).norm_squared())
}

impl core::ops::Add for Remainder {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(core::array::from_fn(|k| self.0[k] + other.0[k]))
    }
}

/// Fault of the numbers of a motion.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// A pose is no rigid placement. The body named is A for the first pose given, B for the
    /// second.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// A velocity, an acceleration, an axis or a point is NaN or infinite, or its square leaves
    /// f64.
    #[error("{what} is out of range: {value}")]
    Value {
        /// The name of the value.
        what: &'static str,
        /// The coordinate that is largest, or NaN.
        value: f64,
    },
    /// A bound or a duration is negative, NaN or infinite; a duration is zero.
    #[error("{what} is out of range: {value} (expected a positive finite number)")]
    Size {
        /// The name of the size.
        what: &'static str,
        /// The size.
        value: f64,
    },
}
