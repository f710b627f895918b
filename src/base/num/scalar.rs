//! Scalar types of the solvers: f64 or double-double.

use core::ops::{Add, Mul, Sub};

use crate::base::num::extremes::Bounded;

/// Returns the square root, correctly rounded with and without std.
#[inline]
pub(crate) fn sqrt(x: f64) -> f64 {
    #[cfg(feature = "std")]
    return x.sqrt();
    #[cfg(not(feature = "std"))]
    return libm::sqrt(x);
}

/// Returns the largest power of two that is at most a positive normal number.
///
/// Products and quotients with it are exact, except if they leave the range. A subnormal number
/// returns the least normal number; a number that is not positive and finite returns 1.
#[inline]
pub(crate) fn magnitude(x: f64) -> f64 {
    if x > 0.0 && x < f64::INFINITY {
        f64::from_bits(x.to_bits() & f64::INFINITY.to_bits()).at_least(f64::MIN_POSITIVE)
    } else {
        1.0
    }
}

/// Arithmetic of a solver: the generic code runs in f64 and in double-double.
pub(crate) trait Scalar:
    Copy
    + Default
    + PartialOrd
    + core::ops::Add<Output = Self>
    + core::ops::Sub<Output = Self>
    + core::ops::Mul<Output = Self>
    + core::ops::Div<Output = Self>
    + core::ops::Neg<Output = Self>
    + From<f64>
{
    /// Bound of the relative rounding error of an operation.
    const UNIT: f64;
    /// Returns the nearest f64.
    fn value(self) -> f64;
}

impl Scalar for f64 {
    const UNIT: f64 = crate::base::tolerance::UNIT;
    #[inline]
    fn value(self) -> f64 {
        self
    }
}

/// Returns the square root to the precision of the arithmetic (one Newton step past f64).
///
/// Zero if `x` is not positive.
pub(crate) fn root<T: Scalar>(x: T) -> T {
    let r = sqrt(x.value());
    if !(r > 0.0) {
        return T::from(0.0);
    }
    let r = T::from(r);
    if T::UNIT == crate::base::tolerance::UNIT {
        return r;
    }
    (r + x / r) * T::from(0.5)
}

/// Numbers that are added, subtracted and multiplied: scalars, and lanes of them.
pub(crate) trait Ring: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {}

impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T>> Ring for T {}

/// Vector in the arithmetic of a solver.
pub(crate) type Vec3<T> = [T; 3];

#[inline]
pub(crate) fn sub<T: Ring>(a: &Vec3<T>, b: &Vec3<T>) -> Vec3<T> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
pub(crate) fn neg<T: Scalar>(a: &Vec3<T>) -> Vec3<T> {
    [-a[0], -a[1], -a[2]]
}

#[inline]
pub(crate) fn scaled<T: Scalar>(a: &Vec3<T>, s: T) -> Vec3<T> {
    [a[0] * s, a[1] * s, a[2] * s]
}

#[inline(always)]
pub(crate) fn dot<T: Ring>(a: &Vec3<T>, b: &Vec3<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn cross<T: Ring>(a: &Vec3<T>, b: &Vec3<T>) -> Vec3<T> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Serialises numbers that may be infinite, for formats without infinity.
///
/// An infinite number becomes the largest finite number of equal sign.
#[cfg(feature = "serde")]
pub(crate) mod infinite {
    use serde::{Deserialize, Deserializer, Serializer};

    use crate::base::num::extremes::Bounded;

    pub(crate) fn serialize<S: Serializer>(x: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_f64(x.clamped(f64::MIN, f64::MAX))
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        let x = f64::deserialize(deserializer)?;
        Ok(if x.abs() == f64::MAX { x * 2.0 } else { x })
    }
}
