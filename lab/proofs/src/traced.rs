//! The rounding of one input, measured beside the result.

use super::number::Number;
use std::ops::{Add, Mul, Neg, Sub};

/// A number as the code computes it, and by how much the true one is greater.
///
/// The error of each operation is exact (Knuth 1969, Dekker 1971), and is carried on in f64: right to some UNIT of
/// itself, as long as nothing leaves the range.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Traced {
    /// What the code computes.
    pub value: f64,
    /// The true number less `value`.
    pub error: f64,
}

impl Traced {
    /// An input, which has no error.
    pub fn input(value: f64) -> Self {
        Self { value, error: 0.0 }
    }

    /// A vector of inputs.
    pub fn vector<const K: usize>(values: &[f64]) -> [Self; K] {
        std::array::from_fn(|k| Self::input(values[k]))
    }

    /// The true number, rounded.
    pub fn truth(self) -> f64 {
        self.value + self.error
    }

    /// The quotient.
    #[must_use]
    pub fn over(self, below: Self) -> Self {
        let value = self.value / below.value;
        let (product, rest) = two_product(value, below.value);
        let residual = ((self.value - product) - rest) + self.error - value * below.error;
        Self {
            value,
            error: residual / below.truth(),
        }
    }

    /// The root, of a number whose error is far smaller.
    #[must_use]
    pub fn root(self) -> Self {
        let value = self.value.sqrt();
        let (square, rest) = two_product(value, value);
        let residual = ((self.value - square) - rest) + self.error;
        Self {
            value,
            error: if value == 0.0 { 0.0 } else { residual / (2.0 * value) },
        }
    }
}

/// The rounded sum and its error.
pub fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let t = s - a;
    (s, (a - (s - t)) + (b - t))
}

/// The rounded product and its error.
pub fn two_product(a: f64, b: f64) -> (f64, f64) {
    let p = a * b;
    (p, a.mul_add(b, -p))
}

impl Add for Traced {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (value, own) = two_sum(self.value, other.value);
        let error = own + (self.error + other.error);
        Self { value, error }
    }
}

impl Sub for Traced {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Traced {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            error: -self.error,
        }
    }
}

impl Mul for Traced {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (value, own) = two_product(self.value, other.value);
        let cross = self.value * other.error + self.error * other.value;
        let error = own + (cross + self.error * other.error);
        Self { value, error }
    }
}

impl Number for Traced {
    fn exact(x: f64) -> Self {
        Self::input(x)
    }

    fn abs(self) -> Self {
        if self.value < 0.0 { -self } else { self }
    }

    fn times_power(self, exponent: i32) -> Self {
        let factor = 2f64.powi(exponent);
        Self {
            value: self.value * factor,
            error: self.error * factor,
        }
    }
}
