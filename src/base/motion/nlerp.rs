//! Motion between two poses by normalised quaternions (nlerp).

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};

use super::steady::{normalised, rotations_and_way, turned};
use super::{Motion, MotionError, MotionModel, Remainder};
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{PLACED_CENTRE, PLACED_PIVOT, TURN, UNIT};

/// A motion from one pose to another in a given time, by nlerp.
///
/// A point of the body moves along a straight line. The rotation is the normalised sum of both
/// quaternions, `(1 - x) q0 + x q1`, along the shorter of both paths.
///
/// Box2D v3, Box3D, parry's `sweep_toi` and rapier move a body like this in a step. The axis is
/// fixed, but the rate is not. Let `b` be half the angle between the poses and
/// `p = 1 - 2 x (1 - x) (1 - cos b)`. Then the rate is `2 sin b / p` radians per duration: from
/// `2 sin b` at the ends to `4 tan (b / 2)` in the middle. Before and after the given time the
/// motion continues by the same formula.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "StoredNlerp")
)]
pub struct Nlerp {
    /// Unit quaternions whose product is not negative.
    from: Quaternion<f64>,
    to: Quaternion<f64>,
    centre: Vector3<f64>,
    way: Vector3<f64>,
    pivot: Point3<f64>,
    duration: f64,
    /// The axis times the sine of `b`.
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    axis: Vector3<f64>,
    /// One minus the cosine of `b`.
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    versine: f64,
}

impl Nlerp {
    /// Returns the motion from one pose at time zero to another at `duration`.
    ///
    /// The point `pivot` of the body moves along a straight line.
    ///
    /// # Errors
    /// Returns an error if a pose, the pivot or the duration is not finite or out of range.
    pub fn new(
        from: &Isometry3<f64>,
        to: &Isometry3<f64>,
        duration: f64,
        pivot: Point3<f64>,
    ) -> Result<Self, MotionError> {
        let ([first, last], way) = rotations_and_way([from, to], duration, &pivot)?;
        let centre = from.translation.vector + turned(&first, &pivot.coords);
        Ok(Self::of([first, last], [centre, way], pivot, duration))
    }

    /// Returns the motion from one rotation to another, with the pivot's start position and
    /// displacement.
    fn of(
        [from, to]: [Quaternion<f64>; 2],
        [centre, way]: [Vector3<f64>; 2],
        pivot: Point3<f64>,
        duration: f64,
    ) -> Self {
        let to = if from.dot(&to) < 0.0 { -to } else { to };
        Self {
            from,
            to,
            centre,
            way,
            pivot,
            duration,
            axis: (to * from.conjugate()).imag(),
            versine: 0.5 * (to - from).norm_squared(),
        }
    }

    /// Returns the squared norm of the sum of the quaternions.
    ///
    /// `from_middle` is the time before or after the middle, as a fraction of the whole time.
    fn square(&self, from_middle: f64) -> f64 {
        1.0 - 2.0 * (0.25 - from_middle * from_middle) * self.versine
    }
}

/// The stored form of a [`Nlerp`]: values that follow from the others are not read.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct StoredNlerp {
    from: Quaternion<f64>,
    to: Quaternion<f64>,
    centre: Vector3<f64>,
    way: Vector3<f64>,
    pivot: Point3<f64>,
    duration: f64,
}

#[cfg(feature = "serde")]
impl TryFrom<StoredNlerp> for Nlerp {
    type Error = MotionError;

    fn try_from(stored: StoredNlerp) -> Result<Self, MotionError> {
        let (centre, way) = (stored.centre, stored.way);
        let pose = |q: Quaternion<f64>, at: Vector3<f64>| {
            Isometry3::from_parts(Translation3::from(at), UnitQuaternion::new_unchecked(q))
        };
        let (from, to) = (pose(stored.from, centre), pose(stored.to, centre + way));
        Self::new(&from, &to, stored.duration, stored.pivot)?;
        let rotations = [from, to].map(|pose| crate::base::pose::normalised(pose.rotation).into_inner());
        Ok(Self::of(rotations, [centre, way], stored.pivot, stored.duration))
    }
}

impl Motion for Nlerp {
    fn pose(&self, time: f64) -> Isometry3<f64> {
        let x = time / self.duration;
        let rotation = UnitQuaternion::new_unchecked(normalised(&(self.from * (1.0 - x) + self.to * x)));
        let mut at = self.centre + self.way * x;
        if self.pivot != Point3::origin() {
            at -= rotation * self.pivot.coords;
        }
        Isometry3::from_parts(Translation3::from(at), rotation)
    }

    fn model(&self, time: f64, span: f64) -> MotionModel {
        let (x, end) = (time / self.duration, (time + span) / self.duration);
        let latest = x.abs().larger(end.abs());
        let length = |v: &Vector3<f64>| v.x.abs() + v.y.abs() + v.z.abs();
        let off = PLACED_CENTRE * (length(&self.centre) + latest * length(&self.way));
        let rate = 2.0 / (self.square(x - 0.5) * self.duration);
        // The second derivative of the angle, `4 sin b (1 - cos b) |1 - 2 x| / p^2`, is at most its
        // greatest numerator over its least denominator.
        let (far, near) = (
            (x - 0.5).abs().larger((end - 0.5).abs()),
            if (x - 0.5) * (end - 0.5) <= 0.0 {
                0.0
            } else {
                (x - 0.5).abs().smaller((end - 0.5).abs())
            },
        );
        let least = self.square(near) * self.duration;
        let bend = 8.0 * sqrt(self.axis.norm_squared()) * self.versine * far / (least * least);
        let constant = TURN * (1.0 + 4.0 * latest);
        MotionModel {
            pivot: self.pivot,
            linear: self.way / self.duration,
            angular: self.axis * rate,
            acceleration: Vector3::zeros(),
            shift: Remainder([off + PLACED_PIVOT * length(&self.pivot.coords), 0.0, 0.0, 0.0]),
            turn: Remainder([constant, 0.0, bend * (1.0 + 64.0 * UNIT), 0.0]),
        }
    }
}
