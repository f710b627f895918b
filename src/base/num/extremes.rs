//! The larger and the smaller of two numbers, with the same bits on every target.
//!
//! `f64::max` and `f64::min` may return either zero of `-0.0` and `0.0`, depending on the target.
//! `f64::clamp` panics if its bounds cross. The functions here are comparisons and selections, so
//! they have one result on every target and never panic.

use core::cmp::Ordering;

use nalgebra::{Point3, Vector3};

/// Choices between two numbers.
pub(crate) trait Extremes: Copy {
    /// Returns the larger number; the other one if one is NaN; the first of two zeros.
    #[must_use]
    fn larger(self, other: Self) -> Self;

    /// Returns the smaller number; the other one if one is NaN; the first of two zeros.
    #[must_use]
    fn smaller(self, other: Self) -> Self;
}

/// The order of numbers.
pub(crate) trait ByValue: Copy {
    /// Returns the order of `total_cmp`, but two zeros are equal: the sign of a zero may depend on
    /// the target.
    #[must_use]
    fn by_value(self, other: Self) -> Ordering;
}

/// Choices between a number and its bounds.
pub(crate) trait Bounded: Extremes {
    /// Returns the number if it is above the bound, otherwise the bound.
    ///
    /// NaN returns the bound. A zero of either sign with a bound of zero returns the bound. This is
    /// a single instruction, so hot loops without NaN also use it as their maximum.
    #[must_use]
    fn at_least(self, bound: Self) -> Self;

    /// Returns the number if it is below the bound, otherwise the bound, like
    /// [`at_least`](Self::at_least).
    #[must_use]
    fn at_most(self, bound: Self) -> Self;

    /// Returns the nearest number between two bounds.
    ///
    /// If the bounds cross, the upper bound is returned; NaN returns NaN. A bound that is NaN has
    /// no effect.
    #[must_use]
    fn clamped(self, low: Self, high: Self) -> Self;
}

macro_rules! choices {
    ($($float:ty),+) => {$(
        impl Extremes for $float {
            #[inline(always)]
            fn larger(self, other: Self) -> Self {
                if other > self || self.is_nan() { other } else { self }
            }

            #[inline(always)]
            fn smaller(self, other: Self) -> Self {
                if other < self || self.is_nan() { other } else { self }
            }
        }

        impl ByValue for $float {
            #[inline(always)]
            fn by_value(self, other: Self) -> Ordering {
                // Zero of either sign plus zero is a positive zero.
                (self + 0.0).total_cmp(&(other + 0.0))
            }
        }

        impl Bounded for $float {
            #[inline(always)]
            fn at_least(self, bound: Self) -> Self {
                if self > bound { self } else { bound }
            }

            #[inline(always)]
            fn at_most(self, bound: Self) -> Self {
                if self < bound { self } else { bound }
            }

            #[inline(always)]
            fn clamped(self, low: Self, high: Self) -> Self {
                let above = if self < low { low } else { self };
                if above > high { high } else { above }
            }
        }
    )+};
}
choices!(f32, f64);

/// Coordinate by coordinate.
impl Extremes for Vector3<f64> {
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.zip_map(&other, f64::larger)
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        self.zip_map(&other, f64::smaller)
    }
}

/// Coordinate by coordinate.
impl Extremes for Point3<f64> {
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.coords.larger(other.coords).into()
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        self.coords.smaller(other.coords).into()
    }
}

/// Returns the largest of some numbers; negative infinity if there are none.
#[inline]
pub(crate) fn largest<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> f64 {
    numbers.into_iter().copied().fold(f64::NEG_INFINITY, f64::larger)
}

/// Returns the smallest of some numbers; infinity if there are none.
#[inline]
pub(crate) fn smallest<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> f64 {
    numbers.into_iter().copied().fold(f64::INFINITY, f64::smaller)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ODD: [f64; 9] = [
        -f64::INFINITY,
        -1.0,
        -5e-324,
        -0.0,
        0.0,
        5e-324,
        1.0,
        f64::INFINITY,
        f64::NAN,
    ];

    /// Bit by bit, but for NaN.
    fn are_same(x: f64, y: f64) -> bool {
        x.to_bits() == y.to_bits() || x.is_nan() && y.is_nan()
    }

    #[test]
    fn zeros_and_nan_have_one_result() {
        for (x, y) in ODD.into_iter().flat_map(|x| ODD.map(|y| (x, y))) {
            let (high, low) = (x.larger(y), x.smaller(y));
            if x == 0.0 && y == 0.0 {
                assert!(are_same(high, x) && are_same(low, x), "{x} {y}");
                assert!(are_same(x.at_least(y), y) && are_same(x.at_most(y), y), "{x} {y}");
                continue;
            }
            assert!(are_same(high, x.max(y)) && are_same(low, x.min(y)), "{x} {y}");
            if !y.is_nan() {
                assert!(are_same(x.at_least(y), x.max(y)), "{x} {y}");
                assert!(are_same(x.at_most(y), x.min(y)), "{x} {y}");
            }
        }
        assert_eq!((-0.0f64).at_least(0.0).to_bits(), 0);
        let (p, q) = (Vector3::new(-0.0, 1.0, 3.0), Vector3::new(0.0, 2.0, -4.0));
        assert_eq!(p.larger(q), Vector3::new(0.0, 2.0, 3.0));
        assert_eq!((largest(&p), smallest(&q)), (3.0, -4.0));
    }

    /// `f64::clamp` panics if the bounds cross or are NaN.
    #[test]
    fn bounds_that_cross_or_are_nan_clamp_without_a_panic() {
        for x in ODD {
            for (low, high) in ODD.into_iter().flat_map(|x| ODD.map(|y| (x, y))) {
                let found = x.clamped(low, high);
                assert_eq!(found.is_nan(), x.is_nan(), "{x} {low} {high}");
                assert!(!(found > high), "{x} {low} {high}");
                if low <= high {
                    assert!(are_same(found, x.clamp(low, high)), "{x} {low} {high}");
                }
            }
        }
        assert_eq!(0.5f64.clamped(1.0, 1.0 - 1e-16), 1.0 - 1e-16);
    }
}
