//! Numbers in which the terms of a volume are computed: double-double with a counted error, and the
//! vectors of any such number.

use nalgebra::Vector3;

use crate::base::num::double_double::DoubleDouble;
use crate::base::tolerance::{COUNTED, UNIT_DOUBLE_DOUBLE};

/// A vector of three numbers.
pub(super) type Triple<N> = [N; 3];

/// Arithmetic of the terms.
pub(super) trait Arithmetic: Clone {
    /// Returns a difference of two coordinates, without rounding.
    fn difference(x: f64, y: f64) -> Self;

    /// Returns a whole number.
    fn whole(n: i32) -> Self;

    fn plus(&self, o: &Self) -> Self;

    fn minus(&self, o: &Self) -> Self;

    fn times(&self, o: &Self) -> Self;

    /// Returns a quotient that is known to be from 0 to 1.
    fn fraction(&self, o: &Self) -> Self;
}

/// Returns the vector from one point to another.
#[inline]
pub(super) fn between<N: Arithmetic>(from: &Vector3<f64>, to: &Vector3<f64>) -> Triple<N> {
    [
        N::difference(to.x, from.x),
        N::difference(to.y, from.y),
        N::difference(to.z, from.z),
    ]
}

#[inline]
pub(super) fn dot<N: Arithmetic>(a: &Triple<N>, b: &Triple<N>) -> N {
    a[0].times(&b[0]).plus(&a[1].times(&b[1])).plus(&a[2].times(&b[2]))
}

#[inline]
pub(super) fn cross<N: Arithmetic>(a: &Triple<N>, b: &Triple<N>) -> Triple<N> {
    let component = |j: usize, k: usize| a[j].times(&b[k]).minus(&a[k].times(&b[j]));
    [component(1, 2), component(2, 0), component(0, 1)]
}

/// A number in double-double with a bound of its absolute error.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counted {
    pub(super) value: DoubleDouble,
    pub(super) error: f64,
}

impl Counted {
    /// Returns a number without error.
    pub(super) fn exactly(value: DoubleDouble) -> Self {
        Self { value, error: 0.0 }
    }

    /// Returns the number times a power of two.
    pub(super) fn scaled(&self, power: f64) -> Self {
        Self {
            value: self.value.scaled(power),
            error: self.error * power.abs(),
        }
    }

    /// Returns the number with a larger error.
    pub(super) fn lossy(self, lost: f64) -> Self {
        Self {
            error: self.error + lost,
            ..self
        }
    }

    /// Adds the rounding of the value to errors of its terms.
    #[inline]
    fn rounded(value: DoubleDouble, error: f64) -> Self {
        Self {
            value,
            error: (error + UNIT_DOUBLE_DOUBLE * value.hi.abs()) * COUNTED,
        }
    }
}

impl Arithmetic for Counted {
    #[inline]
    fn difference(x: f64, y: f64) -> Self {
        Self::exactly(DoubleDouble::sum(x, -y))
    }

    fn whole(n: i32) -> Self {
        Self::exactly(f64::from(n).into())
    }

    #[inline]
    fn plus(&self, o: &Self) -> Self {
        Self::rounded(self.value + o.value, self.error + o.error)
    }

    #[inline]
    fn minus(&self, o: &Self) -> Self {
        Self::rounded(self.value - o.value, self.error + o.error)
    }

    #[inline]
    fn times(&self, o: &Self) -> Self {
        let (a, b) = (self.value.hi.abs(), o.value.hi.abs());
        Self::rounded(self.value * o.value, a * o.error + self.error * (b + o.error))
    }

    #[inline]
    fn fraction(&self, o: &Self) -> Self {
        let least = o.value.hi.abs() - o.error * COUNTED;
        let half = Self {
            value: 0.5.into(),
            error: 0.5,
        };
        // Written so that NaN gives the whole range.
        if !(least > 0.0) {
            return half;
        }
        let value = self.value / o.value;
        // The least normal number is for a quotient that underflows.
        let error = (self.error + value.hi.abs() * o.error) / least * COUNTED;
        let found = Self::rounded(value, error + f64::MIN_POSITIVE);
        if found.error < 0.5 { found } else { half }
    }
}
