//! The larger and the smaller of two numbers, with the same bits on every target.
//!
//! `f64::max` and `f64::min` may return either of two zeros, and `f64::clamp` panics if its bounds
//! cross.
//!
//! The library has such a module, which is private: it is no part of its interface.

/// Choices between two numbers.
pub(crate) trait Extremes {
    /// Returns the larger number; of two zeros the first, and if one is NaN the other.
    #[must_use]
    fn larger(self, other: Self) -> Self;

    /// Returns the smaller number; of two zeros the first, and if one is NaN the other.
    #[must_use]
    fn smaller(self, other: Self) -> Self;

    /// Returns the number if it is above the bound, otherwise (and if it is NaN) the bound.
    #[must_use]
    fn at_least(self, bound: Self) -> Self;

    /// Returns the number if it is below the bound, otherwise (and if it is NaN) the bound.
    #[must_use]
    fn at_most(self, bound: Self) -> Self;

    /// Returns the closest number between two bounds; the upper bound if they cross.
    #[must_use]
    fn clamped(self, low: Self, high: Self) -> Self;
}

impl Extremes for f64 {
    #[inline]
    fn larger(self, other: Self) -> Self {
        if other > self || self.is_nan() { other } else { self }
    }

    #[inline]
    fn smaller(self, other: Self) -> Self {
        if other < self || self.is_nan() { other } else { self }
    }

    #[inline]
    fn at_least(self, bound: Self) -> Self {
        if self > bound { self } else { bound }
    }

    #[inline]
    fn at_most(self, bound: Self) -> Self {
        if self < bound { self } else { bound }
    }

    #[inline]
    fn clamped(self, low: Self, high: Self) -> Self {
        let above = if self < low { low } else { self };
        if above > high { high } else { above }
    }
}
