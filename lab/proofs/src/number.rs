//! What a kernel is transcribed over, and the vectors it is written with.

use std::ops::{Add, Mul, Neg, Sub};

/// A number that a kernel computes with.
///
/// `f64` and `f32` round as the crate does. [`Majorant`](super::Majorant) bounds the rounding of every input at once,
/// [`Reach`](super::Reach) the size of every number on the way, [`Traced`](super::Traced) measures the rounding of one
/// input.
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> + 'static
{
    /// A number of the code, which has no error.
    fn exact(x: f64) -> Self;

    /// The absolute value.
    fn abs(self) -> Self;

    /// The nearest number of the format, of a product with a constant that is a power of two: nothing is rounded.
    fn times_power(self, exponent: i32) -> Self;

    /// The same number as a coordinate of a vector of its own. Bounds relative to the length of a vector need a name
    /// for the vector: its last rounding is then relative to the vector, not to the terms that cancel in it.
    fn named(self, _letter: char, _index: u8) -> Self {
        self
    }
}

impl Number for f64 {
    fn exact(x: f64) -> Self {
        x
    }

    fn abs(self) -> Self {
        f64::abs(self)
    }

    fn times_power(self, exponent: i32) -> Self {
        self * 2f64.powi(exponent)
    }
}

impl Number for f32 {
    fn exact(x: f64) -> Self {
        x as f32
    }

    fn abs(self) -> Self {
        f32::abs(self)
    }

    fn times_power(self, exponent: i32) -> Self {
        self * 2f32.powi(exponent)
    }
}

/// Three coordinates.
pub type Vector<N> = [N; 3];

/// `a - b`.
pub fn sub<N: Number>(a: Vector<N>, b: Vector<N>) -> Vector<N> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a + b`.
pub fn sum<N: Number>(a: Vector<N>, b: Vector<N>) -> Vector<N> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a s`.
pub fn scaled<N: Number>(a: Vector<N>, s: N) -> Vector<N> {
    a.map(|x| x * s)
}

/// `a . b`, summed from the first coordinate on.
pub fn dot<N: Number>(a: Vector<N>, b: Vector<N>) -> N {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The sum of the absolute coordinates.
pub fn one_norm<N: Number>(a: Vector<N>) -> N {
    a[0].abs() + a[1].abs() + a[2].abs()
}

/// `a x b`.
pub fn cross<N: Number>(a: Vector<N>, b: Vector<N>) -> Vector<N> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The coordinates as those of a vector of its own, see [`Number::named`].
pub fn named<N: Number, const K: usize>(letter: char, v: [N; K]) -> [N; K] {
    std::array::from_fn(|k| v[k].named(letter, k as u8))
}
