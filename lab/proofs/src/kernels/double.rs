//! Numbers of twice the precision.

use crate::number::Number;
use std::ops::{Add, Mul, Neg, Sub};

/// Sums and products with their errors, which are numbers of the format.
pub trait ErrorFree: Number {
    /// The rounded sum of any two numbers, and its error.
    fn two_sum(self, other: Self) -> (Self, Self);

    /// The same if the first is not the smaller.
    fn quick_two_sum(self, other: Self) -> (Self, Self);

    /// The rounded product, and its error.
    fn two_product(self, other: Self) -> (Self, Self);
}

impl ErrorFree for f64 {
    fn two_sum(self, other: Self) -> (Self, Self) {
        let s = self + other;
        let t = s - self;
        (s, (self - (s - t)) + (other - t))
    }

    fn quick_two_sum(self, other: Self) -> (Self, Self) {
        let s = self + other;
        (s, other - (s - self))
    }

    fn two_product(self, other: Self) -> (Self, Self) {
        let split = |a: f64| {
            let c = 134_217_729.0 * a; // 2^27 + 1
            let high = c - (c - a);
            (high, a - high)
        };
        let p = self * other;
        let ((ah, al), (bh, bl)) = (split(self), split(other));
        (p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
    }
}

/// High and low part.
pub type Double<N> = [N; 2];

/// `DoubleDouble::add`.
pub fn add<N: ErrorFree>(a: Double<N>, b: Double<N>) -> Double<N> {
    let ((s, e), (t, f)) = (a[0].two_sum(b[0]), a[1].two_sum(b[1]));
    let (s, e) = s.quick_two_sum(e + t);
    s.quick_two_sum(e + f).into()
}

/// `DoubleDouble::mul`.
pub fn mul<N: ErrorFree>(a: Double<N>, b: Double<N>) -> Double<N> {
    let (p, e) = a[0].two_product(b[0]);
    p.quick_two_sum(e + (a[0] * b[1] + a[1] * b[0])).into()
}

/// `DoubleDouble::div`, of a quotient that is not zero.
pub fn div(a: Double<f64>, b: Double<f64>) -> Double<f64> {
    let minus = |d: Double<f64>| d.map(|x| -x);
    let q = a[0] / b[0];
    let r = add(a, minus(mul(b, [q, 0.0])));
    let q2 = r[0] / b[0];
    let r = add(r, minus(mul(b, [q2, 0.0])));
    let (s, e) = q.quick_two_sum(q2);
    s.quick_two_sum(e + r[0] / b[0]).into()
}

/// A double-double as a number of kernels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twice(pub Double<f64>);

impl Twice {
    /// The quotient.
    #[must_use]
    pub fn over(self, below: Self) -> Self {
        // As the crate does: a quotient that is zero, or no number, has no low part.
        let quotient = self.0[0] / below.0[0];
        if quotient == 0.0 || !quotient.is_finite() {
            return Self([quotient, 0.0]);
        }
        Self(div(self.0, below.0))
    }

    /// `num::scalar::root`, of a number that is not negative.
    #[must_use]
    pub fn root(self) -> Self {
        let root = self.0[0].sqrt();
        if root == 0.0 {
            return Self([0.0; 2]);
        }
        let near = Self([root, 0.0]);
        (near + self.over(near)) * Self([0.5, 0.0])
    }
}

impl Add for Twice {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(add(self.0, other.0))
    }
}

impl Sub for Twice {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Twice {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(mul(self.0, other.0))
    }
}

impl Neg for Twice {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(|x| -x))
    }
}

impl Number for Twice {
    fn exact(x: f64) -> Self {
        Self([x, 0.0])
    }

    fn abs(self) -> Self {
        if self.0[0] < 0.0 { -self } else { self }
    }

    fn times_power(self, exponent: i32) -> Self {
        Self(self.0.map(|x| x * 2f64.powi(exponent)))
    }
}
