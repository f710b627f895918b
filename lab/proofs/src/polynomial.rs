//! Polynomials of many variables with rational coefficients.

use dashu_base::Abs;
use dashu_ratio::RBig;
use std::collections::BTreeMap;

/// A variable: a vector, and the number of a coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Symbol {
    /// The vector.
    pub letter: char,
    /// The coordinate.
    pub index: u8,
}

/// A product of variables, in order.
pub type Monomial = Vec<Symbol>;

/// A sum of monomials with coefficients that are not zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polynomial(BTreeMap<Monomial, RBig>);

impl Polynomial {
    /// The polynomial of one variable.
    pub fn variable(letter: char, index: u8) -> Self {
        Self::term(vec![Symbol { letter, index }], RBig::ONE)
    }

    /// A constant.
    pub fn constant(value: RBig) -> Self {
        Self::term(Vec::new(), value)
    }

    /// One monomial with its coefficient.
    pub fn term(mut monomial: Monomial, coefficient: RBig) -> Self {
        monomial.sort_unstable();
        let mut one = Self::default();
        one.add(monomial, coefficient);
        one
    }

    fn add(&mut self, monomial: Monomial, coefficient: RBig) {
        use std::collections::btree_map::Entry;
        match self.0.entry(monomial) {
            Entry::Vacant(slot) if !coefficient.is_zero() => {
                slot.insert(coefficient);
            }
            Entry::Vacant(_) => {}
            Entry::Occupied(mut slot) => {
                *slot.get_mut() += coefficient;
                if slot.get().is_zero() {
                    slot.remove();
                }
            }
        }
    }

    /// Monomials and coefficients.
    pub fn terms(&self) -> impl Iterator<Item = (&Monomial, &RBig)> {
        self.0.iter()
    }

    /// True for the sum of no term.
    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// The sum.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let mut sum = self.clone();
        other.terms().for_each(|(m, c)| sum.add(m.clone(), c.clone()));
        sum
    }

    /// The product.
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        let mut product = Self::default();
        for (m, c) in self.terms() {
            for (n, d) in other.terms() {
                let mut both = [&m[..], &n[..]].concat();
                both.sort_unstable();
                product.add(both, c * d);
            }
        }
        product
    }

    /// The product with a number.
    #[must_use]
    pub fn scaled(&self, factor: &RBig) -> Self {
        if factor.is_zero() {
            return Self::default();
        }
        Self(self.0.iter().map(|(m, c)| (m.clone(), c * factor)).collect())
    }

    /// The same with absolute coefficients: no less than the absolute value of this at the absolute variables.
    #[must_use]
    pub fn absolute(&self) -> Self {
        Self(self.0.iter().map(|(m, c)| (m.clone(), c.clone().abs())).collect())
    }

    /// The same with every variable of a letter replaced by a polynomial of its index.
    #[must_use]
    pub fn with(&self, letter: char, of: impl Fn(u8) -> Self) -> Self {
        let mut result = Self::default();
        for (m, c) in self.terms() {
            let (gone, kept): (Vec<Symbol>, Vec<Symbol>) = m.iter().partition(|s| s.letter == letter);
            let kept = Self::term(kept, c.clone());
            let product = gone.iter().fold(kept, |p, s| p.times(&of(s.index)));
            result = result.plus(&product);
        }
        result
    }

    /// The greatest number of variables in a monomial.
    pub fn degree(&self) -> usize {
        self.0.keys().map(Vec::len).max().unwrap_or(0)
    }

    /// The value where every variable has the value of its letter.
    pub fn at(&self, value: impl Fn(char) -> RBig) -> RBig {
        let term = |(m, c): (&Monomial, &RBig)| m.iter().fold(c.clone(), |x, s| x * value(s.letter));
        self.terms().map(term).fold(RBig::ZERO, |s, x| s + x)
    }

    /// The value of a polynomial without variables.
    pub fn number(&self) -> RBig {
        self.at(|letter| panic!("{letter} is not known"))
    }

    /// The least `c` such that no coefficient of this exceeds `c` times that of `bound`; `None` if `bound` lacks a
    /// monomial.
    pub fn over(&self, bound: &Self) -> Option<RBig> {
        self.terms().try_fold(RBig::ZERO, |most, (m, c)| {
            let ratio = c / bound.0.get(m)?;
            Some(if ratio > most { ratio } else { most })
        })
    }
}

impl From<RBig> for Polynomial {
    fn from(value: RBig) -> Self {
        Self::constant(value)
    }
}
