//! Rotation by a constant angular velocity over a time.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::base::num::double_double::{DoubleDouble, two_product};
use crate::base::num::each::Each;
use crate::base::num::scalar::{magnitude, sqrt};
use crate::base::tolerance::SQUARE_MIN;

/// An angular velocity as axis and rate.
///
/// The rate and its product with a time are kept in double-double. So a body that has rotated
/// thousands of times gets a pose as accurate as a body that has not (`TURN` in
/// `tolerance`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spin {
    /// Unit vector up to rounding; zero for a rate of zero.
    axis: Vector3<f64>,
    /// Radians per unit of time: the rounded number and the remainder.
    rate: [f64; 2],
}

impl Spin {
    pub(super) fn new(angular: &Vector3<f64>) -> Self {
        let squared = angular.norm_squared();
        if squared > SQUARE_MIN && squared < 1.0 / SQUARE_MIN {
            let rate = sqrt(squared);
            let square = |x: f64| DoubleDouble::product(x, x);
            let rest = square(angular.x) + square(angular.y) + square(angular.z) - square(rate);
            return Self {
                axis: angular / rate,
                rate: [rate, rest.hi / (2.0 * rate)],
            };
        }
        let unit = magnitude(angular.amax());
        if *angular == Vector3::zeros() || squared.is_nan() {
            return Self {
                axis: Vector3::zeros(),
                rate: [0.0; 2],
            };
        }
        let scaled = Self::new(&(angular / unit));
        Self {
            rate: scaled.rate.each(|rate| rate * unit),
            ..scaled
        }
    }

    /// Returns the rotation after a time, as a quaternion.
    #[inline]
    pub(super) fn after(&self, time: f64) -> Quaternion<f64> {
        let [rate, rest] = self.rate;
        if rate == 0.0 {
            return Quaternion::identity();
        }
        let (half, error) = two_product(rate, 0.5 * time);
        let rest = error + rest * (0.5 * time);
        let (sine, cosine) = libm::sincos(half);
        half_turn(&self.axis, sine, cosine, rest)
    }
}

/// Returns the rotation by a constant angular velocity over a time.
pub(crate) fn turned(angular: &Vector3<f64>, time: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Spin::new(angular).after(time))
}

/// Returns the quaternion of a rotation about an axis.
///
/// Sine and cosine belong to half the angle, except for a small `rest`.
#[inline(always)]
pub(crate) fn half_turn(axis: &Vector3<f64>, sine: f64, cosine: f64, rest: f64) -> Quaternion<f64> {
    Quaternion::from_parts(cosine - sine * rest, axis * (sine + cosine * rest))
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn rotations_are_those_of_sine_and_cosine() {
        for k in 0..400 {
            let angle = 1e-9 * 1.07f64.powi(k);
            let axis = Vector3::new(0.6, -0.64, 0.48);
            let expected = UnitQuaternion::from_scaled_axis(axis * angle).into_inner();
            let error = (Spin::new(&(axis * angle)).after(1.0) - expected).norm();
            assert!(error < 1e-15 * angle.max(1.0) * 4.0, "{angle}: {error:e}");
        }
        assert_eq!(Spin::new(&Vector3::zeros()).after(3.0), Quaternion::identity());
    }

    /// A rate beyond the range of squares rotates like any other.
    #[test]
    fn rates_of_any_size_turn() {
        for scale in [1e-150, 1e-120, 1e120, 1e150] {
            let spin = Spin::new(&(Vector3::new(0.6, 0.0, 0.8) * scale));
            let expected = UnitQuaternion::from_scaled_axis(Vector3::new(0.6, 0.0, 0.8));
            let error = (spin.after(1.0 / scale) - expected.into_inner()).norm();
            assert!(error < 1e-15, "{scale:e} {error:e}");
        }
    }

    /// Rate times time without rounding: sums of angles agree with angles of sums, to a few units
    /// of rounding at ten thousand radians.
    #[test]
    fn many_turns_lose_nothing() {
        let spin = Spin::new(&Vector3::new(1.1, -0.7, 2.3));
        let step = spin.after(1.0);
        for k in [10.0, 100.0, 4096.0] {
            let (whole, most) = (spin.after(k + 1.0), spin.after(k));
            let error = (step * most - whole).norm();
            assert!(error < 1e-15, "{k}: {error:e}");
        }
    }
}
