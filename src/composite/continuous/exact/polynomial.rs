//! Polynomials over the integers: roots in the unit interval, isolated, and signs of other
//! polynomials at a root.
//!
//! Sources: Collins and Akritas 1976 (bisection by Descartes' rule of signs); Collins 1967
//! (remainder sequences). Bernstein coefficients stand for the sign variations.

use alloc::vec;
use alloc::vec::Vec;

use dashu_base::{BitTest, Gcd};
use dashu_int::IBig;

use crate::base::num::extremes::Bounded;
use crate::composite::continuous::search::WideWork;
use crate::convex::exact::integer::sign;

/// A polynomial by its coefficients, the constant first and the last not zero; zero has none.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Polynomial(Vec<IBig>);

/// Most halvings of an interval about a root, far beyond what separates the roots of polynomials
/// whose coefficients have some thousand bits.
const MOST: u32 = 1 << 16;

impl Polynomial {
    pub(super) fn new(mut coefficients: Vec<IBig>) -> Self {
        while coefficients.last().is_some_and(IBig::is_zero) {
            coefficients.pop();
        }
        Self(coefficients)
    }

    pub(super) fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the bits of the widest coefficient.
    fn bits(&self) -> usize {
        self.0.iter().map(BitTest::bit_len).max().unwrap_or(0)
    }

    fn degree(&self) -> usize {
        self.0.len().saturating_sub(1)
    }

    /// Returns the sum with a multiple of another polynomial.
    fn plus(&self, other: &Self, factor: i32) -> Self {
        let at = |p: &Self, k: usize| p.0.get(k).cloned().unwrap_or(IBig::ZERO);
        let length = self.0.len().max(other.0.len());
        Self::new(
            (0..length)
                .map(|k| at(self, k) + at(other, k) * IBig::from(factor))
                .collect(),
        )
    }

    pub(super) fn add(&self, other: &Self) -> Self {
        self.plus(other, 1)
    }

    pub(super) fn sub(&self, other: &Self) -> Self {
        self.plus(other, -1)
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self(Vec::new());
        }
        let mut product = vec![IBig::ZERO; self.0.len() + other.0.len() - 1];
        for (i, x) in self.0.iter().enumerate() {
            for (j, y) in other.0.iter().enumerate() {
                product[i + j] += x * y;
            }
        }
        Self::new(product)
    }

    fn derivative(&self) -> Self {
        let terms = self.0.iter().enumerate().skip(1);
        Self::new(terms.map(|(k, c)| c * IBig::from(k)).collect())
    }

    /// Returns the polynomial without the common divisor of its coefficients.
    fn primitive(self) -> Self {
        // The divisor of two zeros is not defined.
        let Some(last) = self.0.last() else { return self };
        let common = self.0.iter().fold(last.clone(), |g, c| IBig::from((&g).gcd(c)));
        Self(self.0.iter().map(|c| c / &common).collect())
    }

    /// Returns quotient and remainder of a multiple of the polynomial by another one, which is not
    /// zero.
    fn divided(&self, by: &Self) -> (Self, Self) {
        let (mut rest, mut quotient) = (self.clone(), Self(Vec::new()));
        let lead = &by.0[by.degree()];
        while rest.0.len() >= by.0.len() {
            let (shift, top) = (rest.0.len() - by.0.len(), rest.0[rest.degree()].clone());
            let mut term = vec![IBig::ZERO; shift];
            term.push(top);
            let term = Self(term);
            let scaled = |p: &Self| Self::new(p.0.iter().map(|c| c * lead).collect());
            quotient = scaled(&quotient).add(&term);
            rest = scaled(&rest).sub(&by.times(&term));
        }
        (quotient, rest)
    }

    fn common_divisor(&self, other: &Self, work: &mut WideWork) -> Option<Self> {
        let (mut a, mut b) = (self.clone().primitive(), other.clone().primitive());
        while !b.is_zero() {
            let bits = a.bits().max(b.bits());
            // Quotients of polynomials, and divisors of their coefficients.
            work.count(8 * a.0.len() * b.0.len(), [bits, bits])?;
            let rest = a.divided(&b).1.primitive();
            (a, b) = (b, rest);
        }
        Some(a)
    }

    /// Returns a multiple of the polynomial of the same roots, each once.
    fn square_free(&self, work: &mut WideWork) -> Option<Self> {
        let common = self.common_divisor(&self.derivative(), work)?;
        Some(if common.degree() == 0 {
            self.clone().primitive()
        } else {
            self.divided(&common).0.primitive()
        })
    }

    /// Returns multiples of the Bernstein coefficients from `k / 2^j` to `(k + 1) / 2^j`, each by
    /// the same positive factor; `None` if the budget is spent.
    fn bernstein(&self, k: &IBig, j: usize, work: &mut WideWork) -> Option<Vec<IBig>> {
        let n = self.degree();
        work.count((n + 1) * (n + 2), [self.bits() + j * n, k.bit_len()])?;
        // p((k + x) / 2^j) 2^(j n), by Horner's rule for the shift.
        let mut shifted: Vec<IBig> = self.0.iter().enumerate().map(|(i, c)| c << (j * (n - i))).collect();
        for first in 0..n {
            for i in (first..n).rev() {
                let carry = &shifted[i + 1] * k;
                shifted[i] += carry;
            }
        }
        // b_i = sum over m of binomial(i, m) / binomial(n, m) a_m, times n!.
        let factorial = |x: usize| (1..=x).product::<usize>();
        let weight = |i: usize, m: usize| factorial(i) / factorial(i - m) * factorial(n - m);
        let of = |i: usize| (0..=i).fold(IBig::ZERO, |sum, m| sum + &shifted[m] * IBig::from(weight(i, m)));
        Some((0..=n).map(of).collect())
    }

    /// Returns the roots from zero to one, in order; `None` if halving has not isolated them.
    pub(super) fn roots(&self, work: &mut WideWork) -> Option<Vec<Root>> {
        let simple = self.square_free(work)?;
        let mut roots = Vec::new();
        if simple.degree() == 0 {
            return Some(roots);
        }
        if simple.0[0].is_zero() {
            roots.push(Root::exact(simple.clone(), IBig::ZERO, 0));
        }
        let mut open = vec![(IBig::ZERO, 0usize)];
        for _ in 0..MOST {
            let Some((k, j)) = open.pop() else {
                return Some(roots);
            };
            let coefficients = simple.bernstein(&k, j, work)?;
            match variations(&coefficients) {
                0 => {}
                1 => roots.push(Root {
                    of: simple.clone(),
                    low: k.clone(),
                    halvings: j,
                    is_exact: false,
                }),
                _ => {
                    open.push((2 * &k + 1, j + 1));
                    open.push((2 * &k, j + 1));
                    continue;
                }
            }
            if coefficients.last().is_some_and(IBig::is_zero) {
                roots.push(Root::exact(simple.clone(), k + 1, j));
            }
        }
        None
    }
}

/// Returns the number of changes of sign, zeros left out: the number of roots in the open interval
/// or more by an even number.
fn variations(coefficients: &[IBig]) -> usize {
    let signs = coefficients.iter().map(sign).filter(|s| *s != 0);
    let (count, _) = signs.fold((0, 0), |(count, last), s| (count + usize::from(last * s < 0), s));
    count
}

/// A root of a polynomial without multiple roots: the only one between `low / 2^halvings` and the
/// next such number, or that number itself.
#[derive(Clone, Debug)]
pub(super) struct Root {
    of: Polynomial,
    low: IBig,
    halvings: usize,
    is_exact: bool,
}

impl Root {
    fn exact(of: Polynomial, low: IBig, halvings: usize) -> Self {
        Self {
            of,
            low,
            halvings,
            is_exact: true,
        }
    }

    /// Returns zero as the root of a polynomial.
    pub(super) fn zero() -> Self {
        Self::exact(Polynomial(vec![IBig::ZERO, IBig::ONE]), IBig::ZERO, 0)
    }

    pub(super) fn is_zero(&self) -> bool {
        self.is_exact && self.low.is_zero()
    }

    /// Halves the interval; `None` if the budget is spent.
    fn refine(&mut self, work: &mut WideWork) -> Option<()> {
        let (left, halvings) = (2 * &self.low, self.halvings + 1);
        let coefficients = self.of.bernstein(&left, halvings, work)?;
        self.halvings = halvings;
        self.is_exact = coefficients.last().is_some_and(IBig::is_zero);
        let is_left = variations(&coefficients) == 1;
        self.low = if self.is_exact || !is_left { left + 1 } else { left };
        Some(())
    }

    /// Returns the sign of a polynomial at the root; `None` if halving has not found it.
    pub(super) fn sign_of(&mut self, other: &Polynomial, work: &mut WideWork) -> Option<i32> {
        if other.is_zero() {
            return Some(0);
        }
        let mut is_unequal = false;
        for _ in 0..MOST {
            if self.is_exact {
                return other.bernstein(&self.low, self.halvings, work)?.first().map(sign);
            }
            let coefficients = other.bernstein(&self.low, self.halvings, work)?;
            if variations(&coefficients) == 0 {
                let first = coefficients.iter().map(sign).find(|s| *s != 0);
                return Some(first.unwrap_or(0));
            }
            if !is_unequal {
                let common = self.of.common_divisor(other, work)?;
                // The interval holds one root of either, if any.
                let is_common = |at: Vec<IBig>| variations(&at) % 2 == 1;
                if common.degree() > 0 && is_common(common.bernstein(&self.low, self.halvings, work)?) {
                    return Some(0);
                }
                is_unequal = true;
            }
            self.refine(work)?;
        }
        None
    }

    /// Returns numbers of f64 about the root, less than `width` and a rounding apart: one below,
    /// and one that is not below; `None` if the budget is spent. Zero is no root here, and `width`
    /// not below `2^-1000`.
    pub(super) fn bracket(&mut self, width: f64, work: &mut WideWork) -> Option<[f64; 2]> {
        while !self.is_exact && crate::body::polyhedron::power_of_two(-(self.halvings as i32)) > width {
            self.refine(work)?;
        }
        if self.is_exact {
            let [below, above] = rounded(&self.low, self.halvings);
            let low = if below == above { below.next_down() } else { below };
            return Some([low.at_least(0.0), above]);
        }
        Some([
            rounded(&self.low, self.halvings)[0],
            rounded(&(&self.low + 1), self.halvings)[1],
        ])
    }
}

/// Returns `k / 2^j`, from zero to one, rounded down and up.
fn rounded(k: &IBig, j: usize) -> [f64; 2] {
    if k.is_zero() {
        return [0.0, 0.0];
    }
    let cut = k.bit_len().saturating_sub(53);
    let exponent = cut as i64 - j as i64;
    if exponent < -1000 {
        return [0.0, f64::from_bits((1023 - 900) << 52)];
    }
    let unit = crate::body::polyhedron::power_of_two(exponent as i32);
    let head = k >> cut;
    let is_whole = cut == 0 || &head << cut == *k;
    let number = |x: &IBig| i64::try_from(x).unwrap_or(0) as f64 * unit;
    [number(&head), number(&if is_whole { head.clone() } else { &head + 1 })]
}
