//! Numbers whose rounding is measured, in double precision and in twice that.

use super::factor::Positive;
use super::kernels::double::{ErrorFree, Twice};
use super::number::{Number, Vector, dot};
use super::traced::{Traced, two_sum};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number as the code computes it, beside the true one.
pub trait Measured: Number {
    /// The unit that errors are told in.
    const UNIT: f64;

    /// An input, which has no error.
    fn input(value: f64) -> Self;

    /// By how much the true number is greater than what the code computes.
    fn error(self) -> f64;

    /// The true number, rounded.
    fn truth(self) -> f64;

    /// What the code computes, taken for exact.
    #[must_use]
    fn computed(self) -> Self;

    /// By how much what the code computes is greater than another true number.
    fn above(self, other: Self) -> f64;

    /// The quotient.
    #[must_use]
    fn over(self, below: Self) -> Self;

    /// The root, of a number whose error is far smaller.
    #[must_use]
    fn root(self) -> Self;

    /// A vector of inputs.
    fn vector(values: &[f64]) -> Vector<Self> {
        [0, 1, 2].map(|k| Self::input(values[k]))
    }

    /// The length of a vector.
    fn length(v: Vector<Self>) -> Self {
        dot(v, v).root()
    }
}

impl Measured for Traced {
    const UNIT: f64 = f64::EPSILON / 2.0;

    fn input(value: f64) -> Self {
        Self::input(value)
    }

    fn error(self) -> f64 {
        self.error
    }

    fn truth(self) -> f64 {
        self.truth()
    }

    fn computed(self) -> Self {
        Self::input(self.value)
    }

    fn above(self, other: Self) -> f64 {
        (self.value - other.value) - other.error
    }

    fn over(self, below: Self) -> Self {
        self.over(below)
    }

    fn root(self) -> Self {
        self.root()
    }
}

/// The same of twice the precision.
#[derive(Clone, Copy, Debug)]
pub struct TracedTwice {
    /// What the code computes.
    pub value: Twice,
    /// The true number less `value`.
    pub error: f64,
}

/// A sum of numbers that may cancel, right to some UNIT of itself.
fn total<const K: usize>(mut parts: [f64; K]) -> f64 {
    for _ in 0..3 {
        for k in 1..K {
            (parts[k], parts[k - 1]) = two_sum(parts[k], parts[k - 1]);
        }
    }
    parts.iter().sum()
}

/// The exact product, by parts.
fn product(a: Twice, b: Twice) -> [f64; 8] {
    let [p, q, r, s] = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(i, j)| a.0[i].two_product(b.0[j]));
    [p.0, p.1, q.0, q.1, r.0, r.1, s.0, s.1]
}

/// The exact sum of a number and of one that is less.
fn less(x: Twice, [a, b, c, d, e, f, g, h]: [f64; 8]) -> f64 {
    total([x.0[0], -a, x.0[1], -b, -c, -d, -e, -f, -g, -h])
}

impl TracedTwice {
    /// An input of two parts.
    pub fn of(parts: (f64, f64)) -> Self {
        let value = Twice(parts.into());
        Self { value, error: 0.0 }
    }
}

impl Add for TracedTwice {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let value = self.value + other.value;
        let ([a, b], [c, d], [x, y]) = (self.value.0, other.value.0, value.0);
        let error = total([a, c, -x, b, d, -y]) + (self.error + other.error);
        Self { value, error }
    }
}

impl Sub for TracedTwice {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for TracedTwice {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            error: -self.error,
        }
    }
}

impl Mul for TracedTwice {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let value = self.value * other.value;
        let own = -less(value, product(self.value, other.value));
        let error = own + self.value.0[0] * other.error + self.error * other.value.0[0];
        Self { value, error }
    }
}

impl Number for TracedTwice {
    fn exact(x: f64) -> Self {
        Self::of((x, 0.0))
    }

    fn abs(self) -> Self {
        if self.value.0[0] < 0.0 { -self } else { self }
    }

    fn times_power(self, exponent: i32) -> Self {
        Self {
            value: self.value.times_power(exponent),
            error: self.error * 2f64.powi(exponent),
        }
    }
}

impl Measured for TracedTwice {
    /// What an operation errs by at most, and some more: `2^-102`.
    const UNIT: f64 = 4.0 * f64::EPSILON * f64::EPSILON;

    fn input(value: f64) -> Self {
        Self::of((value, 0.0))
    }

    fn error(self) -> f64 {
        self.error
    }

    fn truth(self) -> f64 {
        self.value.0[0] + self.error
    }

    fn computed(self) -> Self {
        Self { error: 0.0, ..self }
    }

    fn above(self, other: Self) -> f64 {
        (self.value - other.value).0[0] - other.error
    }

    fn over(self, below: Self) -> Self {
        let value = self.value.over(below.value);
        let residual = less(self.value, product(value, below.value)) + self.error - value.0[0] * below.error;
        Self {
            value,
            error: residual / below.value.0[0],
        }
    }

    fn root(self) -> Self {
        let value = self.value.root();
        let residual = less(self.value, product(value, value)) + self.error;
        Self {
            value,
            error: if value.0[0] == 0.0 {
                0.0
            } else {
                residual / (2.0 * value.0[0])
            },
        }
    }
}

/// Quotients and roots for kernels of positive numbers.
macro_rules! positive {
    ($($measured:ty)*) => {
        $(
            impl Div for $measured {
                type Output = Self;
                fn div(self, other: Self) -> Self {
                    Measured::over(self, other)
                }
            }

            impl Positive for $measured {
                fn exact(x: f64) -> Self {
                    Measured::input(x)
                }

                fn root(self) -> Self {
                    Measured::root(self)
                }
            }
        )*
    };
}

positive!(Traced TracedTwice);

#[cfg(test)]
mod tests {
    use super::*;
    use truth::rational::exact;
    use truth::rng::Rng;

    #[test]
    fn an_error_of_twice_the_precision_is_the_true_one() {
        let mut rng = Rng::new(6);
        for _ in 0..1000 {
            let mut number = || TracedTwice::of(two_sum(rng.range(-1.0, 1.0), rng.range(-1e-16, 1e-16)));
            let (a, b, c) = (number(), number(), number());
            let [x, y, z] = [a, b, c].map(|n| exact(n.value.0[0]) + exact(n.value.0[1]));
            let close = |measured: TracedTwice, truth: truth::rational::RBig| {
                let off = truth - exact(measured.value.0[0]) - exact(measured.value.0[1]);
                let off = off.to_f64().value();
                assert!(
                    (off - measured.error).abs() <= 1e-6 * off.abs(),
                    "{off} {}",
                    measured.error
                );
            };
            close(a * b - c, &x * &y - &z);
            close((a + b).over(c), (&x + &y) / &z);
            let square = (a * a).computed();
            let root = Measured::root(square);
            let of = |n: TracedTwice| exact(n.value.0[0]) + exact(n.value.0[1]);
            let (near, off) = (of(root), of(square) - of(root) * of(root));
            let off = (off / (near * exact(2.0))).to_f64().value();
            assert!((off - root.error).abs() <= 1e-6 * off.abs());
        }
    }
}
