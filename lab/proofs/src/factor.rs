//! Chains of positive numbers with quotients and roots: the factor that rounding may have put between a computed number
//! and the true one.

use super::majorant::{power, rounding};
use dashu_ratio::RBig;
use std::ops::{Add, Div, Mul};
use truth::rational::{exact, sqrt};

/// What positive numbers are computed with.
pub trait Positive: Clone + Add<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    /// A constant of the code.
    fn exact(x: f64) -> Self;

    /// The root.
    fn root(self) -> Self;

    /// The square of a number of either sign.
    fn squared(self) -> Self {
        self.clone() * self
    }
}

impl Positive for f64 {
    fn exact(x: f64) -> Self {
        x
    }

    fn root(self) -> Self {
        self.sqrt()
    }
}

/// The computed number is the true one times a factor from `low` to `high`.
#[derive(Clone, Debug)]
pub struct Factor {
    /// The least factor.
    pub low: RBig,
    /// The greatest factor.
    pub high: RBig,
}

impl Factor {
    /// An input without an error.
    pub fn input() -> Self {
        Self::off(&RBig::ZERO)
    }

    /// An input with a relative error of at most `off`.
    pub fn off(off: &RBig) -> Self {
        Self {
            low: RBig::ONE - off,
            high: RBig::ONE + off,
        }
    }

    /// A rounded difference of exact inputs, of either sign.
    pub fn difference() -> Self {
        Self::off(&rounding(53))
    }

    fn rounded(self) -> Self {
        let r = rounding(53);
        Self {
            low: self.low * (RBig::ONE - &r),
            high: self.high * (RBig::ONE + r),
        }
    }

    /// The greatest relative error.
    pub fn error(&self) -> RBig {
        let (below, above) = (RBig::ONE - &self.low, &self.high - RBig::ONE);
        if below > above { below } else { above }
    }

    /// The factor of the computed product with a constant of the code, whose true number is without the constant.
    #[must_use]
    pub fn raised(self, constant: f64) -> Self {
        let by = exact(constant);
        Self {
            low: self.low * &by,
            high: self.high * by,
        }
        .rounded()
    }
}

impl Add for Factor {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
        .rounded()
    }
}

impl Mul for Factor {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            low: self.low * other.low,
            high: self.high * other.high,
        }
        .rounded()
    }
}

impl Div for Factor {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self {
            low: self.low / other.high,
            high: self.high / other.low,
        }
        .rounded()
    }
}

impl Positive for Factor {
    fn exact(_: f64) -> Self {
        Self::input()
    }

    fn root(self) -> Self {
        // Head and tail of the root are right to 2^-104 of it.
        let near = |x: &RBig| {
            let (head, tail) = sqrt(x);
            exact(head) + exact(tail)
        };
        let low = near(&self.low) * (RBig::ONE - power(-100));
        let high = near(&self.high) * (RBig::ONE + power(-100));
        Self { low, high }.rounded()
    }
}
