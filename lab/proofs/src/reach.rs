//! The size and the grid of every number on the way through a kernel.

use super::majorant::{power, unit};
use super::number::Number;
use dashu_base::Abs;
use dashu_ratio::RBig;
use std::ops::{Add, Mul, Neg, Sub};
use truth::rational::exact;

/// A bound of the size of a number and of all numbers that it was made of; and the same of their grids: a number is a
/// whole multiple of a power of two, and no rounding takes that from it. A product on the grid of the least number of
/// the format does not underflow.
#[derive(Clone, Copy, Debug)]
pub struct Reach(&'static Extent);

#[derive(Debug)]
struct Extent {
    most: RBig,
    highest: RBig,
    grid: i64,
    finest: i64,
}

impl Reach {
    /// An input no larger than `most`, a multiple of `2^grid`.
    pub fn input(most: &RBig, grid: i64) -> Self {
        Self::new(most.clone(), most.clone(), grid, grid)
    }

    /// A vector of such inputs.
    pub fn vector<const K: usize>(most: &RBig, grid: i64) -> [Self; K] {
        std::array::from_fn(|_| Self::input(most, grid))
    }

    fn new(most: RBig, highest: RBig, grid: i64, finest: i64) -> Self {
        Self(Box::leak(Box::new(Extent {
            most,
            highest,
            grid,
            finest,
        })))
    }

    /// The bound of the number.
    pub fn most(self) -> &'static RBig {
        &self.0.most
    }

    /// The bound of the largest number on the way.
    pub fn highest(self) -> &'static RBig {
        &self.0.highest
    }

    /// The exponent of the finest grid on the way.
    pub fn finest(self) -> i64 {
        self.0.finest
    }

    /// The sum, or the difference.
    fn beside(self, other: Self) -> Self {
        Self::of(self.most() + other.most(), self.0.grid.min(other.0.grid), [self, other])
    }

    fn of(most: RBig, grid: i64, [a, b]: [Self; 2]) -> Self {
        let rounded = most * (RBig::ONE + unit());
        let higher = |x: RBig, y: &RBig| if x > *y { x } else { y.clone() };
        let highest = higher(higher(rounded.clone(), a.highest()), b.highest());
        Self::new(rounded, highest, grid, grid.min(a.finest()).min(b.finest()))
    }
}

impl Add for Reach {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.beside(other)
    }
}

impl Sub for Reach {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.beside(other)
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
        Self::of(self.most() * other.most(), self.0.grid + other.0.grid, [self, other])
    }
}

impl Number for Reach {
    fn exact(x: f64) -> Self {
        // The last bit that a number of this size may have.
        let grid = (x.to_bits() >> 52 & 0x7ff) as i64 - 1075;
        Self::input(&exact(x).abs(), grid)
    }

    fn abs(self) -> Self {
        self
    }

    fn times_power(self, exponent: i32) -> Self {
        let exponent = i64::from(exponent);
        Self::of(self.most() * power(exponent), self.0.grid + exponent, [self, self])
    }
}
