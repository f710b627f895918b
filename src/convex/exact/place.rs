//! Exact points and directions in the frame of another body, and exact comparison of integers times
//! powers of two.

use core::cmp::Ordering;

use dashu_base::{BitTest, DivEuclid};
use dashu_int::IBig;
use nalgebra::{Isometry3, Vector3};

use super::integer::{Big3, dot, integer, sign};
use super::turn;
use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use crate::base::pose::{PoseBits, RelativePose};
use crate::body::polyhedron::{lowest_bit, power_of_two};

/// A vector of rational numbers: `at 2^exponent / over`.
#[derive(Clone, Debug)]
pub(crate) struct ExactVector {
    pub(crate) at: Big3,
    pub(crate) exponent: i32,
    /// Positive.
    pub(crate) over: IBig,
}

impl ExactVector {
    pub(crate) fn new(v: &Vector3<f64>) -> Self {
        let exponent = lowest_bit(v.iter().copied()).unwrap_or(0);
        Self {
            at: [v.x, v.y, v.z].each(|x| integer(x, exponent)),
            exponent,
            over: IBig::ONE,
        }
    }

    /// Returns the vector rotated by `R(q) / |q|^2`, or by its inverse.
    fn turned(self, q: &[f64; 4], is_back: bool) -> Self {
        let [x, y, z, w] = *q;
        let (rows, norm) = turn(&[x, y, z, if is_back { -w } else { w }]);
        Self {
            at: rows.each_ref().each(|row| dot(row, &self.at)),
            exponent: self.exponent,
            over: self.over * norm,
        }
    }

    /// Returns the vector plus `t`, or minus `t`.
    fn shifted(self, t: &[f64; 3], is_back: bool) -> Self {
        let Some(lowest) = lowest_bit(*t) else { return self };
        let exponent = lowest.min(self.exponent);
        let up = (self.exponent - exponent) as usize;
        let [x, y, z] = self.at;
        let sum = |x: IBig, t: f64| (x << up) + integer(if is_back { -t } else { t }, exponent) * &self.over;
        Self {
            at: [sum(x, t[0]), sum(y, t[1]), sum(z, t[2])],
            exponent,
            over: self.over,
        }
    }

    /// Returns the vector plus another one.
    pub(crate) fn plus(self, v: &Vector3<f64>) -> Self {
        self.shifted(&(*v).into(), false)
    }

    /// Returns the vector minus another one.
    pub(crate) fn minus(self, v: &Vector3<f64>) -> Self {
        self.shifted(&(*v).into(), true)
    }

    /// Maps a point from the frame of a piece to the frame of its body.
    pub(crate) fn placed(self, pose: &Isometry3<f64>) -> Self {
        let pose = PoseBits::new(pose);
        self.turned(&pose.q(), false).shifted(&pose.t(), false)
    }

    /// Maps a point of B to A's frame.
    pub(crate) fn in_a(self, pose: &RelativePose) -> Self {
        let in_world = self.turned(&pose.b.q(), false).shifted(&pose.b.t(), false);
        in_world.shifted(&pose.a.t(), true).turned(&pose.a.q(), true)
    }

    /// Maps a direction from B's frame to A's.
    pub(crate) fn direction_in_a(self, pose: &RelativePose) -> Self {
        self.turned(&pose.b.q(), false).turned(&pose.a.q(), true)
    }

    /// Returns the same vector in units of `2^unit`.
    pub(crate) fn in_units(self, unit: i32) -> Self {
        Self {
            exponent: self.exponent - unit,
            ..self
        }
    }

    /// Returns the order of the height along a vector and a number.
    pub(crate) fn compare_along(&self, n: &Vector3<f64>, level: f64) -> Ordering {
        let n = Self::new(n);
        let lowest = lowest_bit([level]).unwrap_or(0);
        let level = integer(level, lowest) * &self.over;
        compare(&dot(&n.at, &self.at), n.exponent + self.exponent, &level, lowest)
    }

    /// Returns the vector in f64. The error of each coordinate is less than two units in the last
    /// place.
    pub(crate) fn rounded(&self) -> Vector3<f64> {
        let number = |x: &IBig| {
            let [low, high] = quotient(if *x < IBig::ZERO { -x } else { x.clone() }, &self.over, self.exponent);
            f64::from(sign(x)) * (low + (high - low) * 0.5)
        };
        Vector3::new(number(&self.at[0]), number(&self.at[1]), number(&self.at[2]))
    }
}

/// Returns two f64 numbers that enclose `num / den 2^exponent`, for `num >= 0` and `den > 0`.
///
/// The first number is less than the quotient, unless both are zero; the second is not less. They
/// are at most a few units in the last place apart.
pub(crate) fn quotient(num: IBig, den: &IBig, exponent: i32) -> [f64; 2] {
    if num.is_zero() {
        return [0.0; 2];
    }
    // The integer quotient has 64 or 65 bits.
    let up = 64 + den.bit_len() as i64 - num.bit_len() as i64;
    let whole = if up >= 0 {
        (num << up as usize).div_euclid(den)
    } else {
        num.div_euclid(den << (-up) as usize)
    };
    let whole = u128::try_from(&whole).unwrap_or(u128::MAX);
    let power = i64::from(exponent) - up;
    if power > 1000 {
        return [f64::MAX, f64::INFINITY];
    }
    // Three factors, so that each is within the range of powers of two.
    let power = power.max(-2400) as i32;
    let scale = |x: f64| x * power_of_two(power / 3) * power_of_two(power / 3) * power_of_two(power - 2 * (power / 3));
    let (low, high) = ((whole as f64).next_down(), ((whole + 1) as f64).next_up());
    let (low, high) = (scale(low), scale(high));
    if low >= f64::MIN_POSITIVE {
        [low, high]
    } else {
        // A subnormal number was rounded once more by the scaling.
        [low.next_down().at_least(0.0), high.next_up()]
    }
}

/// Returns the order of `x 2^e` and `y 2^f`.
pub(crate) fn compare(x: &IBig, e: i32, y: &IBig, f: i32) -> Ordering {
    let least = e.min(f);
    match e.cmp(&f) {
        Ordering::Equal => x.cmp(y),
        Ordering::Greater => (x << (e - least) as usize).cmp(y),
        Ordering::Less => x.cmp(&(y << (f - least) as usize)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn quotients_lie_between_their_bounds() {
        let mut rng = Rng::new(9);
        for _ in 0..2000 {
            let (x, y) = (rng.log_range(1e-200, 1e100), rng.log_range(1e-100, 1e100));
            let (e, f) = (lowest_bit([x]).unwrap(), lowest_bit([y]).unwrap());
            let [low, high] = quotient(integer(x, e), &integer(y, f), e - f);
            let q = x / y;
            assert!(low < q && q <= high && high - low <= 4.0 * f64::EPSILON * q, "{x} {y}");
        }
        assert_eq!(quotient(IBig::ZERO, &IBig::ONE, 0), [0.0; 2]);
        let [low, high] = quotient(IBig::ONE, &IBig::ONE, -1080);
        assert!(low == 0.0 && high > 0.0);
        assert_eq!(quotient(IBig::ONE, &IBig::ONE, 1100)[1], f64::INFINITY);
    }

    #[test]
    fn a_place_in_another_frame_is_that_of_floating_point_up_to_rounding() {
        let mut rng = Rng::new(10);
        for _ in 0..200 {
            let pose = |rng: &mut Rng| {
                let turn = nalgebra::UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * rng.range(0.0, 3.0));
                Isometry3::from_parts(Vector3::from(rng.in_ball()).into(), turn)
            };
            let (a, b, piece) = (pose(&mut rng), pose(&mut rng), pose(&mut rng));
            let v = Vector3::from(rng.in_ball());
            let relative = RelativePose::new(&a, &b).unwrap();
            let found = ExactVector::new(&v).placed(&piece).in_a(&relative).rounded();
            let expected = a.inverse() * (b * (piece * nalgebra::Point3::from(v)));
            assert!((found - expected.coords).norm() < 1e-14);
            let found = ExactVector::new(&v).direction_in_a(&relative).rounded();
            assert!((found - a.inverse() * (b * v)).norm() < 1e-14);
        }
    }
}
