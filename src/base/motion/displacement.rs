//! Upper bounds of the displacement of any point of a body between two poses.
//!
//! A point x relative to a centre moves by `shift + (R1 - R0) x` while the centre moves by `shift`,
//! and `R1 - R0` stretches by at most `2 sin(angle / 2)`. So no point within `radius` of the centre
//! moves farther than `|shift| + 2 radius sin(angle / 2)`, on any path of the body. Poses in the
//! world are quaternions, and there are many bodies. So [`displacement`] computes the angle from
//! the quaternions, slightly too large. A [`BallAtPose`] has the matrix of a relative pose
//! available and is exact up to rounding.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::pose::Operand;
use crate::base::tolerance::{DISPLACEMENT, FAR, LEAST_SQUARE, NEAR, WAY};

/// Upper bound of the displacement of any point within `radius` of a centre, rounded up.
///
/// The centre moves by `shift`, and the body rotates from one rotation to another.
///
/// ```text
///    q0, q1: unit quaternions, -q the rotation of q       |q1 - q0| = c = 2 sin(angle / 4)
///    a point at distance r from the centre turns by a chord of 2 r sin(angle / 2) <= 2 r c
/// ```
///
/// Two unit quaternions of opposite sign are the same rotation. The nearer of the two is at a
/// distance of `c = 2 sin(angle / 4)`, and `2 sin(angle / 2) <= 2 c`.
#[inline]
pub(crate) fn displacement(
    shift: &Vector3<f64>,
    radius: f64,
    from: &UnitQuaternion<f64>,
    to: &UnitQuaternion<f64>,
) -> f64 {
    let (less, more) = (to.coords - from.coords, to.coords + from.coords);
    let chord = less.norm_squared().smaller(more.norm_squared());
    let gone = sqrt(shift.norm_squared() + LEAST_SQUARE) + 2.0 * radius * sqrt(chord + LEAST_SQUARE);
    gone * (1.0 + WAY)
}

/// A ball fixed to one of two bodies, in the frame of the other body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct BallAtPose {
    /// Rotation from B to A, for a ball of either body.
    rotation: Matrix3<f64>,
    centre: Vector3<f64>,
    radius: f64,
    /// Size that scales the rounding errors of rotation and centre.
    size: f64,
}

impl BallAtPose {
    /// Returns the posed ball of the body `of`, given in the frame of `of`, at a relative pose
    /// `a_from_b`.
    #[inline(always)]
    pub(crate) fn new(
        of: Operand,
        centre: &Vector3<f64>,
        radius: f64,
        rotation: &Matrix3<f64>,
        translation: &Vector3<f64>,
    ) -> Self {
        let seen = match of {
            Operand::B => rotation * centre + translation,
            Operand::A => rotation.tr_mul(&(centre - translation)),
        };
        Self {
            rotation: *rotation,
            centre: seen,
            radius,
            size: radius + centre.abs().sum() + translation.abs().sum(),
        }
    }

    /// Returns the size that scales rounding errors.
    #[cfg(feature = "serde")]
    pub(crate) fn size(&self) -> f64 {
        self.size
    }

    /// Upper bound of the displacement of any point of the ball since `then`, rounded up.
    ///
    /// Infinite if squares of lengths leave the range.
    #[inline(always)]
    pub(crate) fn displacement(&self, then: &Self) -> f64 {
        let size = self.size + then.size;
        // Written so that NaN is out of range.
        if !(size > NEAR && size < FAR) {
            return f64::INFINITY;
        }
        let shift = sqrt((self.centre - then.centre).norm_squared());
        // A difference of rotations stretches two directions equally and the third not at all.
        let stretch = sqrt(0.5 * (self.rotation - then.rotation).norm_squared());
        shift + stretch * self.radius + DISPLACEMENT * size
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn no_point_goes_farther_than_its_bound() {
        let mut tight = 0;
        for k in 0..2000 {
            let f = f64::from(k);
            let axis = |s: f64| {
                Vector3::new((f * s).sin(), (f * 1.7 * s).cos(), (f * 0.3 * s).sin()) * (4.0 * (f * 0.01).sin())
            };
            let (from, to) = (
                UnitQuaternion::new(axis(1.0)),
                UnitQuaternion::new(axis(1.0 + 1e-4 * f)),
            );
            let shift = axis(3.0) * 1e-3 * f;
            let bound = displacement(&shift, 2.0, &from, &to);
            let mut most: f64 = 0.0;
            for i in 0..50 {
                let x =
                    Vector3::new(f64::from(i).sin(), f64::from(i * i).cos(), f64::from(3 * i).sin()).normalize() * 2.0;
                most = most.max((shift + to * x - from * x).norm());
            }
            assert!(most <= bound);
            tight += u32::from(most > 0.5 * bound);
        }
        assert!(tight > 1000, "{tight}");
    }

    /// Samples points of a ball of either body, seen from the other body at two relative poses.
    #[test]
    fn no_point_of_a_ball_goes_farther_than_its_places_are_apart() {
        let mut rng = Rng::new(93);
        let (mut tight, mut slack) = (0, f64::INFINITY);
        for k in 0..2000 {
            let small = 0.5_f64.powi(k % 40);
            let turn = UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * rng.range(0.0, 3.0));
            // Without a rotation all points move equally far, and rounding decides.
            let angle = if k % 4 == 0 { 0.0 } else { small };
            let more = UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * angle);
            let at = Vector3::from(rng.unit()) * rng.range(0.0, 3.0);
            let poses = [
                (turn, at),
                (
                    more * turn,
                    at + Vector3::from(rng.unit()) * small * rng.range(0.0, 1.0),
                ),
            ];
            let (centre, radius) = (Vector3::from(rng.unit()), rng.range(0.1, 2.0));
            for of in [Operand::A, Operand::B] {
                let [then, now] = poses.map(|(r, t)| {
                    let matrix = r.to_rotation_matrix().into_inner();
                    BallAtPose::new(of, &centre, radius, &matrix, &t)
                });
                let bound = now.displacement(&then);
                let mut most: f64 = 0.0;
                for _ in 0..60 {
                    let x = centre + Vector3::from(rng.unit()) * radius;
                    let [then, now] = poses.map(|(r, t)| match of {
                        Operand::A => r.inverse() * (x - t),
                        Operand::B => r * x + t,
                    });
                    most = most.max((now - then).norm());
                }
                slack = slack.min(bound - most);
                tight += u32::from(most > 0.9 * bound);
            }
        }
        assert!(slack > 0.0 && tight > 1500, "{slack:e} {tight}");
    }

    #[test]
    fn nothing_is_said_of_places_out_of_range() {
        let place = |t: f64| {
            BallAtPose::new(
                Operand::B,
                &Vector3::zeros(),
                0.0,
                &Matrix3::identity(),
                &Vector3::repeat(t),
            )
        };
        for t in [0.0, 1e-120, 1e120, f64::NAN] {
            assert_eq!(place(t).displacement(&place(t)), f64::INFINITY, "{t}");
        }
        assert!(place(1.0).displacement(&place(1.0)) < 1e-12);
    }
}
