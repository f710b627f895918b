//! Rounding errors of straight-line code, for every input at once, in exact rational arithmetic.
//!
//! A number is an exact polynomial `value` of the inputs and two polynomials with coefficients that are not negative:
//! what the code computes differs from `value` by at most `error + lost * least` at the absolute inputs. `error` holds
//! what is relative (`|fl(x) - x| <= r |x|` with `r = u / (1 + u)`), `lost` what underflow takes, in halves of the
//! least number of the format (2^-1075 for f64): a product may lose one, a sum loses none.

use super::number::Number;
use super::polynomial::Polynomial;
use dashu_int::{IBig, UBig};
use dashu_ratio::RBig;
use std::ops::{Add, Mul, Neg, Sub};
use truth::rational::exact;

/// Precision of f64.
pub const DOUBLE: u32 = 53;

/// Precision of f32.
pub const SINGLE: u32 = 24;

/// Constants of the code are numbers of every format.
const EXACT: u32 = 0;

/// `2^exponent`.
pub fn power(exponent: i64) -> RBig {
    let one = UBig::ONE << usize::try_from(exponent.unsigned_abs()).expect("a small exponent");
    if exponent < 0 {
        RBig::from_parts(IBig::ONE, one)
    } else {
        RBig::from(one)
    }
}

/// Unit roundoff of a precision.
pub fn unit_of(precision: u32) -> RBig {
    power(-i64::from(precision))
}

/// Unit roundoff of f64.
pub fn unit() -> RBig {
    unit_of(DOUBLE)
}

/// Largest relative error of one rounding, `u / (1 + u)` (Jeannerod and Rump 2018).
pub fn rounding(precision: u32) -> RBig {
    RBig::from_parts(IBig::ONE, (UBig::ONE << precision as usize) + UBig::ONE)
}

/// What the code computes, for all inputs.
///
/// Copies share one record, which lives to the end of the process: a kernel has some hundred numbers.
#[derive(Clone, Copy, Debug)]
pub struct Majorant(&'static Record);

#[derive(Debug)]
struct Record {
    value: Polynomial,
    error: Polynomial,
    lost: Polynomial,
    /// `error` and `lost` before the last rounding.
    before: [Polynomial; 2],
    precision: u32,
}

impl Majorant {
    fn new(value: Polynomial, [error, lost]: [Polynomial; 2], before: [Polynomial; 2], precision: u32) -> Self {
        Self(Box::leak(Box::new(Record {
            value,
            error,
            lost,
            before,
            precision,
        })))
    }

    /// An input that the code holds with a relative error of at most `off`.
    pub fn input(letter: char, index: u8, off: &RBig) -> Self {
        Self::input_in(DOUBLE, letter, index, off)
    }

    /// The same in another precision.
    pub fn input_in(precision: u32, letter: char, index: u8, off: &RBig) -> Self {
        let value = Polynomial::variable(letter, index);
        let error = value.scaled(off);
        Self::with_error(precision, value, error)
    }

    /// A number that the code holds with a given error.
    pub fn with_error(precision: u32, value: Polynomial, error: Polynomial) -> Self {
        let error = [error, Polynomial::default()];
        Self::new(value, error.clone(), error, precision)
    }

    /// A vector of inputs with a relative error of at most `off` a coordinate.
    pub fn vector<const K: usize>(letter: char, off: &RBig) -> [Self; K] {
        std::array::from_fn(|k| Self::input(letter, k as u8, off))
    }

    /// The exact value.
    pub fn value(self) -> &'static Polynomial {
        &self.0.value
    }

    /// The bound of what is relative.
    pub fn error(self) -> &'static Polynomial {
        &self.0.error
    }

    /// The bound of what underflow takes, in halves of the least number.
    pub fn lost(self) -> &'static Polynomial {
        &self.0.lost
    }

    /// The error over the absolute terms of the value: a bound of the error relative to their sum.
    pub fn relative(self) -> RBig {
        self.error()
            .over(&self.value().absolute())
            .expect("errors stand at the terms of the value")
    }

    /// The bounds of the value's size, then of its error.
    fn after_rounding(self, error: &Polynomial, underflow: &RBig) -> [Polynomial; 2] {
        let r = rounding(self.0.precision);
        let [own, lost] = [error, &self.0.lost];
        let size = self.0.value.absolute().plus(own);
        let lost = lost
            .plus(&lost.scaled(&r))
            .plus(&Polynomial::constant(underflow.clone()));
        [own.plus(&size.scaled(&r)), lost]
    }

    fn rounded(value: Polynomial, before: [Polynomial; 2], underflow: RBig, precision: u32) -> Self {
        let [error, lost] = before.clone();
        let raw = Self::new(value.clone(), [error.clone(), lost], before.clone(), precision);
        let after = raw.after_rounding(&error, &underflow);
        Self::new(value, after, before, precision)
    }

    fn precision_with(self, other: Self) -> u32 {
        let (a, b) = (self.0.precision, other.0.precision);
        assert!(a == b || a == EXACT || b == EXACT, "numbers of one format");
        a.max(b)
    }
}

impl Add for Majorant {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        let before = [a.error.plus(&b.error), a.lost.plus(&b.lost)];
        Self::rounded(a.value.plus(&b.value), before, RBig::ZERO, self.precision_with(other))
    }
}

impl Sub for Majorant {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Majorant {
    type Output = Self;
    fn neg(self) -> Self {
        let a = self.0;
        let minus = exact(-1.0);
        Self::new(
            a.value.scaled(&minus),
            [a.error.clone(), a.lost.clone()],
            a.before.clone(),
            a.precision,
        )
    }
}

impl Mul for Majorant {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.0, other.0);
        let precision = self.precision_with(other);
        let (x, y) = (a.value.absolute(), b.value.absolute());
        let error = x
            .times(&b.error)
            .plus(&a.error.times(&y))
            .plus(&a.error.times(&b.error));
        // With the largest size of each factor: |x| + error.
        let lost = x.plus(&a.error).times(&b.lost).plus(&a.lost.times(&y.plus(&b.error)));
        let least = power(if precision == DOUBLE { -1075 } else { -150 });
        let lost = lost.plus(&a.lost.times(&b.lost).scaled(&least));
        Self::rounded(a.value.times(&b.value), [error, lost], RBig::ONE, precision)
    }
}

impl Number for Majorant {
    fn exact(x: f64) -> Self {
        Self::with_error(EXACT, Polynomial::constant(exact(x)), Polynomial::default())
    }

    fn abs(self) -> Self {
        // The sign is not known: the absolute terms take the place of the value, which is what a bound sums up.
        let a = self.0;
        Self::new(
            a.value.absolute(),
            [a.error.clone(), a.lost.clone()],
            a.before.clone(),
            a.precision,
        )
    }

    fn times_power(self, exponent: i32) -> Self {
        let (a, factor) = (self.0, power(i64::from(exponent)));
        let scaled = |p: &[Polynomial; 2]| [p[0].scaled(&factor), p[1].scaled(&factor)];
        // A number below the normal ones, halved, may lose another half.
        let [error, mut lost] = scaled(&[a.error.clone(), a.lost.clone()]);
        if exponent < 0 {
            lost = lost.plus(&Polynomial::constant(RBig::ONE));
        }
        Self::new(a.value.scaled(&factor), [error, lost], scaled(&a.before), a.precision)
    }

    fn named(self, letter: char, index: u8) -> Self {
        let a = self.0;
        let value = Polynomial::variable(letter, index);
        let [error, lost] = a.before.clone();
        let raw = Self::new(value.clone(), [error.clone(), lost], a.before.clone(), a.precision);
        let after = raw.after_rounding(&error, &RBig::ONE);
        Self::new(value, after, a.before.clone(), a.precision)
    }
}
