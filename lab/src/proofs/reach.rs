//! The size of every number on the way through a kernel.

use super::majorant::unit;
use super::number::Number;
use crate::rational::exact;
use dashu::base::Abs;
use dashu::rational::RBig;
use std::ops::{Add, Mul, Neg, Sub};

/// A bound of the size of a number, and of all numbers that it was made of.
#[derive(Clone, Copy, Debug)]
pub struct Reach(&'static [RBig; 2]);

impl Reach {
    fn new(most: RBig, highest: RBig) -> Self {
        Self(Box::leak(Box::new([most, highest])))
    }

    /// An input no larger than this.
    pub fn input(most: &RBig) -> Self {
        Self::new(most.clone(), most.clone())
    }

    /// A vector of such inputs.
    pub fn vector<const K: usize>(most: &RBig) -> [Self; K] {
        std::array::from_fn(|_| Self::input(most))
    }

    /// The bound of the number.
    pub fn most(self) -> &'static RBig {
        &self.0[0]
    }

    /// The bound of the largest number on the way.
    pub fn highest(self) -> &'static RBig {
        &self.0[1]
    }

    fn of(most: RBig, parts: [Self; 2]) -> Self {
        let rounded = most * (RBig::ONE + unit());
        let highest = parts.into_iter().map(|p| p.highest().clone());
        let highest = highest.fold(rounded.clone(), |a, b| if a > b { a } else { b });
        Self::new(rounded, highest)
    }
}

impl Add for Reach {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::of(self.most() + other.most(), [self, other])
    }
}

impl Sub for Reach {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + other
    }
}

impl Neg for Reach {
    type Output = Self;
    fn neg(self) -> Self {
        self
    }
}

impl Mul for Reach {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::of(self.most() * other.most(), [self, other])
    }
}

impl Number for Reach {
    fn exact(x: f64) -> Self {
        Self::input(&exact(x).abs())
    }

    fn abs(self) -> Self {
        self
    }

    fn times_power(self, exponent: i32) -> Self {
        Self::of(self.most() * super::majorant::power(i64::from(exponent)), [self, self])
    }
}
