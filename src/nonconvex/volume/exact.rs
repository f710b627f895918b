//! Terms of a volume in exact rationals, for terms whose bounds in double-double are too wide.
//!
//! A term is computed as a quotient of integers and rounded once, down to a multiple of a common
//! power of two. The sum of such numbers has no other rounding, and no denominator grows.

use core::cmp::Ordering;

use alloc::vec::Vec;

use dashu_base::DivEuclid;
use dashu_int::IBig;

use super::arithmetic::Arithmetic;
use super::sums::{Sums, Term};
use crate::base::num::double_double::DoubleDouble;
use crate::body::polyhedron::{lowest_bit, power_of_two};
use crate::convex::exact::integer::integer;
use crate::convex::exact::place::quotient;

/// A rational number, `num 2^exponent / over` with a positive `over`.
#[derive(Clone)]
pub(super) struct Ratio {
    num: IBig,
    over: IBig,
    exponent: i32,
}

impl Ratio {
    fn of(x: f64) -> Self {
        let exponent = lowest_bit([x]).unwrap_or(0);
        Self {
            num: integer(x, exponent),
            over: IBig::ONE,
            exponent,
        }
    }

    /// Returns the largest multiple of `2^unit` that is not larger.
    fn floor(&self, unit: i32) -> IBig {
        let up = self.exponent - unit;
        if up >= 0 {
            (&self.num << up as usize).div_euclid(&self.over)
        } else {
            (&self.num).div_euclid(&self.over << (-up) as usize)
        }
    }
}

/// Returns `x 2^e + y 2^f` as an integer and its exponent.
fn sum(x: IBig, e: i32, y: IBig, f: i32) -> (IBig, i32) {
    match e.cmp(&f) {
        Ordering::Equal => (x + y, e),
        Ordering::Greater => ((x << (e - f) as usize) + y, f),
        Ordering::Less => (x + (y << (f - e) as usize), e),
    }
}

impl Arithmetic for Ratio {
    fn difference(x: f64, y: f64) -> Self {
        Self::of(x).minus(&Self::of(y))
    }

    fn whole(n: i32) -> Self {
        Self {
            num: n.into(),
            over: IBig::ONE,
            exponent: 0,
        }
    }

    fn plus(&self, o: &Self) -> Self {
        if self.over == o.over {
            let (num, exponent) = sum(self.num.clone(), self.exponent, o.num.clone(), o.exponent);
            let over = self.over.clone();
            return Self { num, over, exponent };
        }
        let (num, exponent) = sum(&self.num * &o.over, self.exponent, &o.num * &self.over, o.exponent);
        Self {
            num,
            over: &self.over * &o.over,
            exponent,
        }
    }

    fn minus(&self, o: &Self) -> Self {
        self.plus(&Self {
            num: -&o.num,
            ..o.clone()
        })
    }

    fn times(&self, o: &Self) -> Self {
        Self {
            num: &self.num * &o.num,
            over: &self.over * &o.over,
            exponent: self.exponent + o.exponent,
        }
    }

    fn fraction(&self, o: &Self) -> Self {
        let (num, over) = (&self.num * &o.over, &self.over * &o.num);
        let is_negative = over < IBig::ZERO;
        Self {
            num: if is_negative { -num } else { num },
            over: if is_negative { -over } else { over },
            exponent: self.exponent - o.exponent,
        }
    }
}

/// A sum of terms in multiples of a power of two.
pub(super) struct FixedSum {
    sum: IBig,
    unit: i32,
    /// Number of terms, each of which is less than one unit too small.
    count: u32,
}

impl FixedSum {
    pub(super) fn new(unit: i32) -> Self {
        Self {
            sum: IBig::ZERO,
            unit,
            count: 0,
        }
    }

    /// Adds a term of a sum.
    pub(super) fn add_term(&mut self, sums: &Sums, term: &Term) {
        let value = sums.value(term, |of, k| sums.passage::<Ratio>(of, sums.crossing(of, k)));
        self.add(&value);
    }

    /// Adds a number in double-double.
    pub(super) fn add_number(&mut self, x: DoubleDouble) {
        self.add(&Ratio::of(x.hi).plus(&Ratio::of(x.lo)));
    }

    fn add(&mut self, x: &Ratio) {
        self.sum += x.floor(self.unit);
        self.count += 1;
    }

    /// Returns the sum as a number in double-double, and its error.
    pub(super) fn total(&self) -> (DoubleDouble, f64) {
        let near = |x: &IBig| {
            let is_negative = *x < IBig::ZERO;
            let [low, _] = quotient(if is_negative { -x } else { x.clone() }, &IBig::ONE, self.unit);
            if is_negative { -low } else { low }
        };
        let hi = near(&self.sum);
        let lo = near(&(&self.sum - Ratio::of(hi).floor(self.unit)));
        // Two numbers hold the sum to far less than one unit in the last place of the second.
        let error = lo.abs() * power_of_two(-40) + f64::from(self.count + 2) * power_of_two(self.unit);
        (DoubleDouble::sum(hi, lo), error)
    }
}

/// Returns the terms in falling order of their errors, with the errors.
pub(super) fn by_error(errors: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..errors.len()).collect();
    order.sort_by(|&i, &j| errors[j].total_cmp(&errors[i]).then(i.cmp(&j)));
    order
}
