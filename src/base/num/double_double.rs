//! Numbers of twice the precision of f64, as an unevaluated sum of two.
//!
//! Algorithms: Dekker 1971, Knuth TAOCP 2 section 4.2.2. Sum and product are the accurate variants
//! whose error bounds Joldes, Muller and Popescu proved (2017, algorithm 6, and 12 without fused
//! multiply-add). The quotient is a long division with three partial quotients (Hida, Li and Bailey
//! 2001), bounded at `div`. Only + - * / are used, so results agree on every target. Valid while no
//! product overflows or loses bits to underflow: magnitudes between 2^-400 and 2^400.
//!
//! For more precision, [`Expansion`] is a sum without rounding.

use core::cmp::Ordering;
use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::base::num::scalar::Scalar;

/// The sum `hi + lo`, with `hi` the f64 nearest to the sum.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub(crate) struct DoubleDouble {
    pub(crate) hi: f64,
    pub(crate) lo: f64,
}

/// Returns the rounded sum and its exact error.
#[inline]
pub(crate) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let bb = s - a;
    (s, (a - (s - bb)) + (b - bb))
}

/// Returns the rounded sum and its exact error if `|a| >= |b|` or `a == 0`.
#[inline]
fn quick_two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    (s, b - (s - a))
}

#[inline]
fn split(a: f64) -> (f64, f64) {
    let c = 134_217_729.0 * a; // 2^27 + 1
    let hi = c - (c - a);
    (hi, a - hi)
}

/// Returns the rounded product and its exact error.
#[inline]
pub(crate) fn two_product(a: f64, b: f64) -> (f64, f64) {
    let p = a * b;
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    (p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}

impl DoubleDouble {
    /// Returns the exact sum of two f64.
    #[inline]
    pub(crate) fn sum(a: f64, b: f64) -> Self {
        let (hi, lo) = two_sum(a, b);
        Self { hi, lo }
    }

    /// Returns the exact product of two f64.
    #[inline]
    pub(crate) fn product(a: f64, b: f64) -> Self {
        let (hi, lo) = two_product(a, b);
        Self { hi, lo }
    }

    /// Returns the number times a power of two: exact, if neither of its two numbers leaves the
    /// range.
    #[inline]
    pub(crate) fn scaled(self, power: f64) -> Self {
        Self {
            hi: self.hi * power,
            lo: self.lo * power,
        }
    }
}

impl From<f64> for DoubleDouble {
    #[inline]
    fn from(hi: f64) -> Self {
        Self { hi, lo: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        let (s, e) = two_sum(self.hi, o.hi);
        let (t, f) = two_sum(self.lo, o.lo);
        let (s, e) = quick_two_sum(s, e + t);
        let (hi, lo) = quick_two_sum(s, e + f);
        Self { hi, lo }
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self {
            hi: -self.hi,
            lo: -self.lo,
        }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        let (p, e) = two_product(self.hi, o.hi);
        let (hi, lo) = quick_two_sum(p, e + (self.hi * o.lo + self.lo * o.hi));
        Self { hi, lo }
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    /// Returns the quotient with a relative error below `5 u^2`, `u = UNIT`.
    ///
    /// The error of each step:
    ///
    /// - A partial quotient of leading numbers has a relative error of `3 u`: both leading numbers
    ///   and the division.
    /// - A product `o q` with a single number has an error of `3 u^2`: `lo q` is rounded once, the
    ///   sum with the error of `hi q` once, and both numbers are at most `u |o q|`.
    /// - A difference has a relative error of `3 u^2`.
    /// - So the first remainder is correct to `3 u^2` of the dividend, and is at most `3 u` of the
    ///   dividend. The second remainder is at most `9 u^2` of the dividend. The rounding of the
    ///   second remainder and of the third quotient is of order `u^3`.
    /// - The last sum rounds a number of size `u |q|`: `u^2` more.
    ///
    /// Together these are `4 u^2` and terms of order `u^3`.
    #[inline]
    fn div(self, o: Self) -> Self {
        let q = self.hi / o.hi;
        if q == 0.0 || !q.is_finite() {
            return Self { hi: q, lo: 0.0 };
        }
        let r = self - o * Self::from(q);
        let q2 = r.hi / o.hi;
        let r = r - o * Self::from(q2);
        let (s, e) = quick_two_sum(q, q2);
        let (hi, lo) = quick_two_sum(s, e + r.hi / o.hi);
        Self { hi, lo }
    }
}

impl PartialOrd for DoubleDouble {
    #[inline]
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> {
        match self.hi.partial_cmp(&o.hi) {
            Some(Ordering::Equal) => self.lo.partial_cmp(&o.lo),
            other => other,
        }
    }
}

impl Scalar for DoubleDouble {
    const UNIT: f64 = crate::base::tolerance::UNIT_DOUBLE_DOUBLE;
    #[inline]
    fn value(self) -> f64 {
        self.hi
    }
}

/// An exact sum of up to `N` numbers: nonzero components of rising magnitude that do not overlap
/// (Shewchuk 1997, grow-expansion with zero elimination).
pub(crate) struct Expansion<const N: usize> {
    parts: [f64; N],
    len: usize,
}

impl<const N: usize> Expansion<N> {
    /// Returns zero.
    pub(crate) fn new() -> Self {
        Self {
            parts: [0.0; N],
            len: 0,
        }
    }

    /// Adds a number; must be called at most `N` times.
    pub(crate) fn add(&mut self, term: f64) {
        let (mut carry, mut kept) = (term, 0);
        for k in 0..self.len {
            let (sum, rest) = two_sum(carry, self.parts[k]);
            carry = sum;
            if rest != 0.0 {
                self.parts[kept] = rest;
                kept += 1;
            }
        }
        if carry != 0.0 {
            self.parts[kept] = carry;
            kept += 1;
        }
        self.len = kept;
    }

    /// Adds a product, which counts as two numbers.
    pub(crate) fn add_product(&mut self, a: f64, b: f64) {
        let (high, low) = two_product(a, b);
        self.add(low);
        self.add(high);
    }

    /// Returns the components in order of rising magnitude.
    pub(crate) fn parts(&self) -> &[f64] {
        &self.parts[..self.len]
    }

    /// Returns the sum as `K` numbers of falling magnitude, each the rounded remainder.
    ///
    /// The final remainder is dropped. Fewer than `N - K` numbers must have been added.
    pub(crate) fn leading<const K: usize>(mut self) -> [f64; K] {
        core::array::from_fn(|_| {
            let part = self.parts().iter().sum::<f64>();
            self.add(-part);
            part
        })
    }

    /// Returns -1, 0 or 1: the sign of the last component, which is greater in magnitude than the
    /// sum of the rest.
    pub(crate) fn sign(&self) -> i32 {
        let last = self.parts().last().copied().unwrap_or(0.0);
        i32::from(last > 0.0) - i32::from(last < 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operations_keep_twice_the_digits() {
        let third = DoubleDouble::from(1.0) / DoubleDouble::from(3.0);
        let one = third * DoubleDouble::from(3.0);
        assert!((one - DoubleDouble::from(1.0)).value().abs() < 1e-31);
        let tiny = DoubleDouble::sum(1.0, 1e-25);
        assert!(tiny > DoubleDouble::from(1.0));
        assert_eq!((tiny - DoubleDouble::from(1.0)).value(), 1e-25);
    }

    #[test]
    fn products_are_exact() {
        let (p, e) = two_product(1.0 + f64::EPSILON, 1.0 + f64::EPSILON);
        assert_eq!((p, e), (1.0 + 2.0 * f64::EPSILON, f64::EPSILON * f64::EPSILON));
    }
}
