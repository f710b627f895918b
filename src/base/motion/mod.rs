//! Motions of a rigid body: its pose at a time, and how it may move from there.
//!
//! A [`Motion`] returns the pose of its body at any time, and a [`MotionModel`]: the velocities at
//! that time, and a proven bound of how far the body can deviate from them. The bounds hold for the
//! mathematical motion and for the poses that [`Motion::pose`] returns, rounding included
//! (`PLACED_*` and `TURN` in `tolerance`).
//!
//! | motion | kind |
//! |---|---|
//! | constant velocities of a body's origin, or of any point | [`Steady::new`], [`Steady::about`] |
//! | with a known or bounded acceleration | [`Steady::with_acceleration`], [`Steady::with_acceleration_bounds`] |
//! | from one pose to another at a constant rate about one axis (slerp) | [`Steady::between`] |
//! | a screw: a rotation about a line of the world and a shift along the line | [`Steady::screw`] |
//! | from one pose to another by nlerp, as Box2D, parry and rapier sweep | [`Nlerp`] |
//! | any other | the trait [`Motion`] |
//!
//! # Bounds
//!
//! At a time `t`, let the pivot of a body move at `v` with acceleration `a`, and let the body
//! rotate at `w`. The *model* of the motion starts from the pose at `t`. Its pivot is at
//! `c + v s + a s^2 / 2` and its rotation is `exp(w s)`.
//!
//! Suppose that the angular velocity changes at most at a rate `k`. Then the rotation between
//! motion and model has a rate of at most `k s`, and hence an angle of at most `k s^2 / 2`. So no
//! point within `r` of the pivot is farther than `r k s^2 / 2` from its position in the model. A
//! [`Remainder`] is a cubic bound of this form, for the position of the pivot (a length) and for
//! the rotation (an angle).

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
/// For every `s` in `0..=span`, the model at `time` bounds two things:
///
/// - the motion itself at `time + s`;
/// - the pose that [`pose`](Self::pose) returns for `time + s`, if `time + s` is an f64.
///
/// For every point within `r` of the pivot, both are within `shift(s) + r turn(s)` of the position
/// in the model, if the model starts from the pose returned for `time`. The rounding of the poses
/// is part of the bound, so remainders start above zero. If a number of the model is NaN or
/// infinite, or a bound is negative, queries treat the motion as unknown and prove nothing.
///
/// Example: a turntable whose rate oscillates, with an angular acceleration of at most 0.6 radians
/// per unit of time squared:
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
    /// Returns the pose of the body's frame in the world at a time.
    fn pose(&self, time: f64) -> Isometry3<f64>;

    /// Returns the velocities at a time, and bounds of the deviation from them within `span`.
    fn model(&self, time: f64, span: f64) -> MotionModel;

    /// Returns the pose and the model at a time.
    ///
    /// Override this if a motion computes one of them together with the other.
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

/// Velocities of a body at a time, and bounds of the later deviation.
///
/// Velocities are in the world's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MotionModel {
    /// The point of the body, in the body's frame, about which the body rotates; its velocity is
    /// `linear`.
    pub pivot: Point3<f64>,
    /// Velocity of the pivot.
    pub linear: Vector3<f64>,
    /// Axis of rotation times radians per unit of time.
    pub angular: Vector3<f64>,
    /// Acceleration of the pivot, constant in the model.
    pub acceleration: Vector3<f64>,
    /// Upper bound of the distance of the pivot from the model: a length.
    pub shift: Remainder,
    /// Upper bound of the angle between the body and the model: radians.
    pub turn: Remainder,
}

impl MotionModel {
    /// Returns an upper bound of the displacement of any point within `span`.
    ///
    /// The bound holds for all points within `radius` of the pivot.
    #[must_use]
    pub fn displacement(&self, radius: f64, span: f64) -> f64 {
        // Products take the time first. So the displacements are lengths, and what they lose by
        // underflow is less than the least normal number.
        let straight = length(&(self.linear * span)) + 0.5 * length(&(self.acceleration * span * span));
        let turned = length(&(self.angular * span)).at_most(2.0);
        let most = straight + self.shift.at(span) + radius * (turned + self.turn.at(span));
        most * (1.0 + 16.0 * UNIT) + f64::MIN_POSITIVE
    }

    /// Returns whether all numbers are finite and no bound is negative; otherwise nothing is known
    /// about the motion.
    #[inline]
    pub(crate) fn is_known(&self) -> bool {
        // Zero times a finite number is zero, and NaN otherwise, so no number needs a branch. Two
        // independent sums take one instruction per step.
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

    /// Returns an upper bound of a point's distance from its position in the model.
    ///
    /// The point is within `radius` of the pivot.
    #[must_use]
    #[inline]
    pub fn drift(&self, radius: f64) -> Remainder {
        let (Remainder(p), Remainder(q)) = (self.shift, self.turn);
        Remainder(core::array::from_fn(|k| p[k] + radius * q[k]))
    }
}

/// A bound that grows with time: `[d0, d1, d2, d3]` means `d0 + d1 s + d2 s^2 / 2 + d3 s^3 / 6`.
///
/// `s` is the time after the start. No coefficient is negative.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Remainder(pub [f64; 4]);

impl Remainder {
    /// Returns the bound at `s` after the start.
    #[must_use]
    pub fn at(&self, s: f64) -> f64 {
        // Products take the time first, as in a displacement.
        let [d0, d1, d2, d3] = self.on_clock(s).0;
        d0 + (d1 + (0.5 * d2 + d3 / 6.0))
    }

    /// Returns the bound on a clock with this unit.
    pub(crate) fn on_clock(&self, unit: f64) -> Self {
        let [d0, d1, d2, d3] = self.0;
        Self([d0, d1 * unit, d2 * unit * unit, d3 * unit * unit * unit])
    }
}

/// Returns the length of a vector of any size, even if its square leaves the range of f64.
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

/// Error in the numbers of a motion.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MotionError {
    /// A pose is not a rigid pose.
    ///
    /// The error names body A for the first pose passed, body B for the second.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// A velocity, an acceleration, an axis or a point is NaN or infinite, or its square leaves the
    /// range of f64.
    #[error("{what} is out of range: {value}")]
    Value {
        /// The name of the value.
        what: &'static str,
        /// The largest coordinate, or NaN.
        value: f64,
    },
    /// A bound or a duration is negative, NaN or infinite, or a duration is zero.
    #[error("{what} is out of range: {value} (expected a positive finite number)")]
    Size {
        /// The name of the size.
        what: &'static str,
        /// The size.
        value: f64,
    },
}
