//! Constant velocities: a straight path at constant speed or acceleration, and a constant rotation
//! about one axis.

use crate::base::motion::rotation::Spin;
use crate::base::motion::{Motion, MotionError, MotionModel, Remainder};
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::base::tolerance::{EXTENT_MAX, PLACED_CENTRE, PLACED_PIVOT, TURN, UNIT};
use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};

/// A motion with constant linear and angular velocity.
///
/// The pivot, a point of the body, moves along a straight line at a constant velocity (or
/// acceleration). The body rotates about the pivot at a constant rate about a fixed axis of the
/// world.
///
/// ```
/// use lin_canny::Velocity;
/// use lin_canny::motion::{Motion, Steady};
/// use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
///
/// // A door: it turns about a hinge one to the left of its origin.
/// let spin = Velocity::new(Vector3::zeros(), Vector3::z());
/// let pose = Isometry3::translation(1.0, 0.0, 0.0);
/// let hinge = Point3::new(-1.0, 0.0, 0.0);
/// let door = Steady::about(&pose, hinge, spin)?;
/// let open = door.pose(std::f64::consts::FRAC_PI_2);
/// assert!((open.translation.vector - Vector3::y()).norm() < 1e-15);
/// # Ok::<(), lin_canny::motion::MotionError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "StoredSteady")
)]
pub struct Steady {
    /// The rotation at time zero, and the pivot in the world at time zero.
    rotation: Quaternion<f64>,
    centre: Vector3<f64>,
    pivot: Point3<f64>,
    velocity: Velocity,
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    spin: Spin,
    acceleration: Vector3<f64>,
    /// Bounds of the unknown accelerations: of the pivot, and angular.
    open: [f64; 2],
}

impl Steady {
    /// Returns the motion that starts at `pose` with this velocity of the body's origin.
    ///
    /// The start is at time zero.
    ///
    /// # Errors
    /// Returns an error if the pose or the velocity is not finite or out of range.
    /// A pose or a velocity that is not finite or out of range.
    pub fn new(pose: &Isometry3<f64>, velocity: Velocity) -> Result<Self, MotionError> {
        Self::about(pose, Point3::origin(), velocity)
    }

    /// Returns the motion that starts at `pose` with this velocity of the pivot.
    ///
    /// The start is at time zero. The point `pivot` is in the body's frame.
    ///
    /// # Errors
    /// Returns an error if the pose, the pivot or the velocity is not finite or out of range.
    pub fn about(pose: &Isometry3<f64>, pivot: Point3<f64>, velocity: Velocity) -> Result<Self, MotionError> {
        RelativePose::new(pose, &Isometry3::identity())?;
        in_range("pivot", &pivot.coords)?;
        in_range("linear velocity", &velocity.linear)?;
        in_range("angular velocity", &velocity.angular)?;
        let rotation = normalised(&pose.rotation.into_inner());
        Ok(Self {
            rotation,
            centre: pose.translation.vector + turned(&rotation, &pivot.coords),
            pivot,
            velocity,
            spin: Spin::new(&velocity.angular),
            acceleration: Vector3::zeros(),
            open: [0.0; 2],
        })
    }

    /// Returns the motion between two poses in the given time, at constant velocities (slerp).
    ///
    /// The point `pivot` of the body moves along a straight line. The body rotates by at most half
    /// a revolution about one axis.
    ///
    /// # Errors
    /// Returns an error if a pose, the pivot or the duration is not finite or out of range.
    pub fn between(
        from: &Isometry3<f64>,
        to: &Isometry3<f64>,
        duration: f64,
        pivot: Point3<f64>,
    ) -> Result<Self, MotionError> {
        let ([first, last], way) = rotations_and_way([from, to], duration, &pivot)?;
        let turn = last * first.conjugate();
        let turn = if turn.w < 0.0 { -turn } else { turn };
        let sine = sqrt(turn.imag().norm_squared());
        // For small angles the vector part is the half angle itself.
        let per_sine = if sine > 0.0 {
            2.0 * libm::atan2(sine, turn.w) / sine
        } else {
            2.0
        };
        let velocity = Velocity::new(way / duration, turn.imag() * (per_sine / duration));
        Self::about(from, pivot, velocity)
    }

    /// Returns the screw motion of a body that is at `pose` at time zero.
    ///
    /// The body rotates about the line through `point` along `axis`, both in the world, by `rate`
    /// radians per unit of time. It moves along the line by `advance` per unit of time.
    ///
    /// # Errors
    /// Returns an error if the pose, the point or the axis is not finite or out of range, or if the
    /// axis has no direction.
    pub fn screw(
        pose: &Isometry3<f64>,
        point: &Point3<f64>,
        axis: &Vector3<f64>,
        rate: f64,
        advance: f64,
    ) -> Result<Self, MotionError> {
        RelativePose::new(pose, &Isometry3::identity())?;
        in_range("point", &point.coords)?;
        in_range("axis", axis)?;
        let length = axis.norm();
        positive("length of the axis", length)?;
        let unit = axis / length;
        let inverse = normalised(&pose.rotation.into_inner()).conjugate();
        let pivot = turned(&inverse, &(point.coords - pose.translation.vector));
        let velocity = Velocity::new(unit * advance, unit * rate);
        Self::about(pose, pivot.into(), velocity)
    }

    /// Returns this motion with a constant acceleration of the pivot, such as gravity.
    ///
    /// The acceleration counts from time zero on.
    ///
    /// # Errors
    /// Returns an error if the acceleration is not finite or out of range.
    pub fn with_acceleration(self, acceleration: Vector3<f64>) -> Result<Self, MotionError> {
        in_range("acceleration", &acceleration)?;
        Ok(Self { acceleration, ..self })
    }

    /// Returns the set of motions whose accelerations differ from this one's by bounded amounts.
    ///
    /// They start like this motion at time zero. Their accelerations differ from its by at most
    /// `linear` (of the pivot) and `angular` (radians per unit of time squared). The poses are
    /// still those of this motion. What is proven free is free for the whole set.
    ///
    /// # Errors
    /// Returns an error if a bound is negative or not finite.
    pub fn with_acceleration_bounds(self, linear: f64, angular: f64) -> Result<Self, MotionError> {
        for (what, value) in [
            ("bound of acceleration", linear),
            ("bound of angular acceleration", angular),
        ] {
            if !(0.0..=EXTENT_MAX).contains(&value) {
                return Err(MotionError::Size { what, value });
            }
        }
        Ok(Self {
            open: [linear, angular],
            ..self
        })
    }

    /// Returns the velocity of the pivot at time zero, and the angular velocity.
    #[must_use]
    pub fn velocity(&self) -> Velocity {
        self.velocity
    }

    /// Returns the point of the body, in the body's frame, about which the body rotates.
    #[must_use]
    pub fn pivot(&self) -> Point3<f64> {
        self.pivot
    }

    /// Returns the known acceleration of the pivot.
    #[must_use]
    pub fn acceleration(&self) -> Vector3<f64> {
        self.acceleration
    }

    /// Returns the bounds of the unknown accelerations: of the pivot, and angular.
    #[must_use]
    pub fn acceleration_bounds(&self) -> [f64; 2] {
        self.open
    }
}

/// The stored form of a [`Steady`]: values that follow from the others are not read.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct StoredSteady {
    rotation: Quaternion<f64>,
    centre: Vector3<f64>,
    pivot: Point3<f64>,
    velocity: Velocity,
    acceleration: Vector3<f64>,
    open: [f64; 2],
}

#[cfg(feature = "serde")]
impl TryFrom<StoredSteady> for Steady {
    type Error = MotionError;

    fn try_from(stored: StoredSteady) -> Result<Self, MotionError> {
        let turn = UnitQuaternion::new_unchecked(stored.rotation);
        let pose = Isometry3::from_parts(Translation3::from(stored.centre), turn);
        let [linear, angular] = stored.open;
        let motion = Self::about(&pose, stored.pivot, stored.velocity)?
            .with_acceleration(stored.acceleration)?
            .with_acceleration_bounds(linear, angular)?;
        Ok(Self {
            rotation: crate::base::pose::normalised(turn).into_inner(),
            centre: stored.centre,
            ..motion
        })
    }
}

impl Motion for Steady {
    #[inline]
    fn pose(&self, time: f64) -> Isometry3<f64> {
        let rotation = UnitQuaternion::new_unchecked(if self.velocity.angular == Vector3::zeros() {
            self.rotation
        } else {
            self.spin.after(time) * self.rotation
        });
        let mut at = self.centre + self.velocity.linear * time + self.acceleration * (0.5 * time * time);
        if self.pivot != Point3::origin() {
            at -= rotation * self.pivot.coords;
        }
        Isometry3::from_parts(Translation3::from(at), rotation)
    }

    #[inline]
    fn model(&self, time: f64, span: f64) -> MotionModel {
        let latest = time.abs().larger((time + span).abs());
        let length = |v: &Vector3<f64>| v.x.abs() + v.y.abs() + v.z.abs();
        let gone = latest * (length(&self.velocity.linear) + latest * length(&self.acceleration));
        let off = PLACED_CENTRE * (length(&self.centre) + gone) + PLACED_PIVOT * length(&self.pivot.coords);
        let phase = UNIT * latest * length(&self.velocity.angular);
        let open = |k: usize, constant: f64| {
            let bound = self.open[k];
            let ago = time.abs();
            Remainder([constant + 0.5 * bound * ago * ago, bound * ago, bound, 0.0])
        };
        MotionModel {
            pivot: self.pivot,
            linear: self.velocity.linear + self.acceleration * time,
            angular: self.velocity.angular,
            acceleration: self.acceleration,
            shift: open(0, off),
            turn: open(1, TURN + 32.0 * phase * (UNIT + phase)),
        }
    }
}

/// Returns the quaternion divided by its norm. The squared norm of the quaternion of a pose is 1 to
/// within 1e-12.
pub(super) fn normalised(q: &Quaternion<f64>) -> Quaternion<f64> {
    q / sqrt(q.norm_squared())
}

/// Returns the rotations of two poses and the displacement of the pivot.
///
/// # Errors
/// Returns an error if a pose, the pivot or the duration is not finite or out of range.
pub(super) fn rotations_and_way(
    [from, to]: [&Isometry3<f64>; 2],
    duration: f64,
    pivot: &Point3<f64>,
) -> Result<([Quaternion<f64>; 2], Vector3<f64>), MotionError> {
    RelativePose::new(from, to)?;
    positive("duration", duration)?;
    in_range("pivot", &pivot.coords)?;
    let [first, last] = [from, to].map(|pose| normalised(&pose.rotation.into_inner()));
    let mut way = to.translation.vector - from.translation.vector;
    if *pivot != Point3::origin() {
        way += turned(&last, &pivot.coords) - turned(&first, &pivot.coords);
    }
    Ok(([first, last], way))
}

pub(super) fn turned(q: &Quaternion<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    UnitQuaternion::new_unchecked(*q) * v
}

/// Rejects a vector that is not finite or larger than bodies may be.
pub(super) fn in_range(what: &'static str, v: &Vector3<f64>) -> Result<(), MotionError> {
    match v.iter().find(|x| !(x.abs() <= EXTENT_MAX)) {
        Some(&value) => Err(MotionError::Value { what, value }),
        None => Ok(()),
    }
}

pub(super) fn positive(what: &'static str, value: f64) -> Result<(), MotionError> {
    if value > 0.0 && value <= EXTENT_MAX {
        Ok(())
    } else {
        Err(MotionError::Size { what, value })
    }
}

/// The linear and angular velocity of a rigid body, in the world's frame.
///
/// The linear velocity belongs to the body's origin. The angular velocity is in radians per unit of
/// time about this origin. Physics engines mostly use the velocity of the centre of mass. Both
/// agree if the centre of mass is the origin, or if the body does not rotate.
///
/// For the time of impact of two bodies with constant velocities see
/// [`impact::cast`](crate::impact::cast) of two [`Steady`](crate::motion::Steady) motions.
#[doc(alias = "twist")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Velocity {
    /// Linear velocity of the body's origin: length per unit of time.
    pub linear: Vector3<f64>,
    /// Angular velocity: the axis of rotation, through the body's origin, times radians per unit of
    /// time.
    pub angular: Vector3<f64>,
}

impl Default for Velocity {
    fn default() -> Self {
        Self::new(Vector3::zeros(), Vector3::zeros())
    }
}

impl Velocity {
    /// Returns the velocity with these linear and angular components.
    #[must_use]
    pub const fn new(linear: Vector3<f64>, angular: Vector3<f64>) -> Self {
        Self { linear, angular }
    }

    /// Returns the pose of a body after `time` at this velocity.
    ///
    /// The body starts at `pose` and rotates by exactly `angular * time`, up to rounding.
    ///
    /// ```
    /// use lin_canny::Velocity;
    /// use lin_canny::nalgebra::{Isometry3, Vector3};
    ///
    /// let spin = Velocity::new(Vector3::x(), Vector3::z() * std::f64::consts::PI);
    /// let pose = spin.applied(&Isometry3::identity(), 0.5);
    /// assert!((pose * Vector3::x() - Vector3::y()).norm() < 1e-15);
    /// assert_eq!(pose.translation.vector, Vector3::x() * 0.5);
    /// ```
    #[must_use]
    pub fn applied(&self, pose: &Isometry3<f64>, time: f64) -> Isometry3<f64> {
        let at = pose.translation.vector + self.linear * time;
        let turned = Spin::new(&self.angular).after(time) * pose.rotation.into_inner();
        let rotation = turned / sqrt(turned.norm_squared());
        Isometry3::from_parts(Translation3::from(at), UnitQuaternion::new_unchecked(rotation))
    }
}

impl core::ops::Neg for Velocity {
    type Output = Self;

    /// Returns the velocity of the reverse motion.
    fn neg(self) -> Self {
        Self::new(-self.linear, -self.angular)
    }
}
