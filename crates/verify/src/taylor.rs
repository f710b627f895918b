//! Functions of x on [0, 1]: a polynomial in fixed point and a bound of the rest.
//!
//! **Lemma 0.** A form (c, r) encloses a function f if |f(x) - sum of c[k] x^k| <= r for every x in
//! [0, 1], in units of 2^-P. Sums of forms add c and r. For a product, let p be the product of
//! the polynomials, exact integers in units of 2^-2P. With |a| = sum of |c[k]| >= |polynomial
//! a(x)|, the product of the functions departs from p(x) by at most |a| r_b + |b| r_a + r_a r_b.
//! Terms of p of degree > D are dropped, which costs at most their sizes, as x^k <= 1. The shift
//! to units of 2^-P rounds each kept coefficient down by less than one unit.

use dashu_int::IBig;
use dashu_ratio::RBig;

use crate::int::Int;

/// A function of x on [0, 1] within r of the sum of c[k] x^k, in units of 2^-P.
#[derive(Clone, Debug)]
pub(crate) struct Taylor<I> {
    pub(crate) c: Vec<I>,
    pub(crate) r: I,
}

/// Returns the integer below q 2^bits, and whether it is less.
pub(crate) fn below(q: &RBig, bits: usize) -> (IBig, bool) {
    let (scaled, denominator) = (q.numerator() << bits, IBig::from(q.denominator().clone()));
    let mut whole = &scaled / &denominator;
    let rest = &scaled - &whole * &denominator;
    if rest < IBig::ZERO {
        whole -= IBig::ONE;
    }
    (whole, rest != IBig::ZERO)
}

impl<I: Int> Taylor<I> {
    pub(crate) fn whole(x: i32) -> Option<Self> {
        Some(Self {
            c: vec![I::small(x).up()?],
            r: I::small(0),
        })
    }

    /// Encloses a constant.
    pub(crate) fn fixed(q: &RBig) -> Option<Self> {
        let (c, rest) = below(q, I::P);
        Some(Self {
            c: vec![I::of(c)?],
            r: I::small(rest.into()),
        })
    }

    /// Encloses a polynomial in x.
    pub(crate) fn polynomial(coefficients: &[RBig]) -> Option<Self> {
        let mut all = Self {
            c: Vec::new(),
            r: I::small(0),
        };
        for (k, q) in coefficients.iter().enumerate() {
            let mut part = Self::fixed(q)?;
            all.r = all.r.add(&part.r)?;
            if k <= I::D {
                all.c.append(&mut part.c);
            } else {
                all.r = all.r.add(&part.most()?)?;
            }
        }
        Some(all)
    }

    pub(crate) fn plus(&self, o: &Self) -> Option<Self> {
        let (a, b) = if self.c.len() >= o.c.len() {
            (self, o)
        } else {
            (o, self)
        };
        let mut c = a.c.clone();
        for (x, y) in c.iter_mut().zip(&b.c) {
            *x = x.add(y)?;
        }
        Some(Self {
            c,
            r: self.r.add(&o.r)?,
        })
    }

    pub(crate) fn minus(&self, o: &Self) -> Option<Self> {
        let zero = I::small(0);
        let negated = o.c.iter().map(|x| zero.sub(x)).collect::<Option<_>>()?;
        self.plus(&Self {
            c: negated,
            r: o.r.clone(),
        })
    }

    pub(crate) fn times(&self, o: &Self) -> Option<Self> {
        let zero = I::small(0);
        let mut p = vec![zero.clone(); self.c.len() + o.c.len() - 1];
        for (i, x) in self.c.iter().enumerate().filter(|(_, x)| **x != zero) {
            for (j, y) in o.c.iter().enumerate() {
                p[i + j] = p[i + j].add(&x.mul(y)?)?;
            }
        }
        let mut rest = self.r.mul(&o.r)?;
        if self.r != zero || o.r != zero {
            rest = rest.add(&self.most()?.mul(&o.r)?)?.add(&o.most()?.mul(&self.r)?)?;
        }
        for dropped in p.iter().skip(I::D + 1) {
            rest = rest.add(&dropped.size()?)?;
        }
        p.truncate(I::D + 1);
        let r = rest.down().add(&I::small(1 + p.len() as i32))?;
        Some(Self {
            c: p.iter().map(I::down).collect(),
            r,
        })
    }

    /// Divided by a positive number.
    pub(crate) fn over(&self, n: i32) -> Option<Self> {
        let r = self.r.over(n).add(&I::small(1 + self.c.len() as i32))?;
        Some(Self {
            c: self.c.iter().map(|x| x.over(n)).collect(),
            r,
        })
    }

    /// No size of the polynomial on [0, 1] is larger.
    pub(crate) fn most(&self) -> Option<I> {
        self.c.iter().try_fold(I::small(0), |sum, x| sum.add(&x.size()?))
    }

    /// Returns the sign of a constant, 0 if not known.
    pub(crate) fn sign(&self) -> i32 {
        let below = I::small(0).sub(&self.r);
        i32::from(self.c[0] > self.r) - i32::from(below.is_some_and(|below| self.c[0] < below))
    }
}
