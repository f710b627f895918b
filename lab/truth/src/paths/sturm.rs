//! Polynomials over the integers, with their roots counted by Sturm sequences.

use dashu_base::Gcd;
use dashu_int::IBig;
use dashu_ratio::RBig;

/// Coefficients, the constant first; the last is not zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Poly(pub Vec<IBig>);

fn trimmed(mut c: Vec<IBig>) -> Poly {
    while c.last().is_some_and(IBig::is_zero) {
        c.pop();
    }
    Poly(c)
}

impl Poly {
    /// Returns `a + b t`.
    pub fn linear(a: IBig, b: IBig) -> Self {
        trimmed(vec![a, b])
    }

    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    pub fn minus(&self, o: &Self) -> Self {
        let at = |p: &Self, k: usize| p.0.get(k).cloned().unwrap_or(IBig::ZERO);
        trimmed(
            (0..self.0.len().max(o.0.len()))
                .map(|k| at(self, k) - at(o, k))
                .collect(),
        )
    }

    pub fn plus(&self, o: &Self) -> Self {
        self.minus(&Poly(o.0.iter().map(|c| -c).collect()))
    }

    pub fn times(&self, o: &Self) -> Self {
        if self.is_zero() || o.is_zero() {
            return Poly(vec![]);
        }
        let mut c = vec![IBig::ZERO; self.0.len() + o.0.len() - 1];
        for (i, x) in self.0.iter().enumerate() {
            for (j, y) in o.0.iter().enumerate() {
                c[i + j] += x * y;
            }
        }
        trimmed(c)
    }

    /// Returns the sign of the value at a rational number.
    pub fn sign_at(&self, t: &RBig) -> i32 {
        let (num, den) = (t.numerator(), IBig::from(t.denominator().clone()));
        let mut scale = IBig::ONE;
        let mut sum = IBig::ZERO;
        for c in self.0.iter().rev() {
            sum = sum * num + c * &scale;
            scale *= &den;
        }
        sign(&sum)
    }

    /// Returns a remainder, times a positive number, without its content.
    fn remainder(&self, by: &Self) -> Self {
        let mut rest = self.0.clone();
        let lead = by.0.last().expect("not zero");
        while rest.len() >= by.0.len() {
            let top = rest.last().expect("not empty").clone();
            let shift = rest.len() - by.0.len();
            // Times lead^2, which is positive.
            for c in &mut rest {
                *c *= lead * lead;
            }
            for (k, c) in by.0.iter().enumerate() {
                rest[shift + k] -= c * &top * lead;
            }
            rest = trimmed(rest).0;
        }
        Poly(rest).without_content()
    }

    fn without_content(mut self) -> Self {
        let Some(last) = self.0.last().cloned() else {
            return self;
        };
        let content = self.0.iter().fold(last, |g, c| IBig::from((&g).gcd(c)));
        for c in &mut self.0 {
            *c /= &content;
        }
        self
    }

    fn derivative(&self) -> Self {
        trimmed((1..self.0.len()).map(|k| &self.0[k] * IBig::from(k)).collect())
    }

    /// Returns the polynomial divided by a divisor, times a nonzero number.
    fn over(&self, by: &Self) -> Self {
        let (mut rest, mut quotient) = (self.clone(), Poly(vec![]));
        let lead = by.0.last().expect("not zero");
        let scaled = |p: &Self| Poly(p.0.iter().map(|c| c * lead).collect());
        while rest.0.len() >= by.0.len() {
            let mut term = vec![IBig::ZERO; rest.0.len() - by.0.len()];
            term.push(rest.0[rest.0.len() - 1].clone());
            let term = Poly(term);
            quotient = scaled(&quotient).plus(&term);
            rest = scaled(&rest).minus(&by.times(&term));
        }
        assert!(rest.is_zero(), "a divisor leaves no rest");
        quotient.without_content()
    }

    /// Returns a polynomial with the same roots, each simple.
    fn square_free(&self) -> Self {
        self.over(&self.gcd(&self.derivative()))
    }

    pub fn gcd(&self, o: &Self) -> Self {
        let (mut a, mut b) = (self.clone(), o.clone());
        while !b.is_zero() {
            (a, b) = (b.clone(), a.remainder(&b));
        }
        a
    }

    fn chain(&self) -> Vec<Poly> {
        let simple = self.square_free();
        let derivative = simple.derivative();
        let mut chain = vec![simple, derivative];
        // Multiple roots at an end of an interval would make all signs zero.
        while !chain[chain.len() - 1].is_zero() {
            let rest = chain[chain.len() - 2].remainder(&chain[chain.len() - 1]);
            chain.push(Poly(rest.0.iter().map(|c| -c).collect()));
        }
        chain.pop();
        chain
    }
}

fn sign(x: &IBig) -> i32 {
    i32::from(*x > IBig::ZERO) - i32::from(*x < IBig::ZERO)
}

fn changes(chain: &[Poly], t: &RBig) -> usize {
    let signs: Vec<i32> = chain.iter().map(|p| p.sign_at(t)).filter(|s| *s != 0).collect();
    signs.windows(2).filter(|w| w[0] != w[1]).count()
}

/// Returns the number of distinct roots in `(low, high]`.
fn count(chain: &[Poly], low: &RBig, high: &RBig) -> usize {
    changes(chain, low) - changes(chain, high)
}

/// A root of `of`, the only one in `(low, high]`.
#[derive(Clone, Debug)]
pub struct Root {
    of: Poly,
    chain: Vec<Poly>,
    pub low: RBig,
    pub high: RBig,
}

/// Returns the roots in `(0, 1]` in order; the polynomial must not be zero.
pub fn roots(of: &Poly) -> Vec<Root> {
    let chain = of.chain();
    let mut open = vec![(RBig::ZERO, RBig::ONE)];
    let mut roots = vec![];
    while let Some((low, high)) = open.pop() {
        match count(&chain, &low, &high) {
            0 => {}
            1 => roots.push(Root {
                of: of.clone(),
                chain: chain.clone(),
                low,
                high,
            }),
            _ => {
                let middle = (&low + &high) / RBig::from(2);
                open.push((middle.clone(), high));
                open.push((low, middle));
            }
        }
    }
    roots
}

impl Root {
    /// Halves the interval.
    pub fn halve(&mut self) {
        let middle = (&self.low + &self.high) / RBig::from(2);
        if count(&self.chain, &self.low, &middle) == 1 {
            self.high = middle;
        } else {
            self.low = middle;
        }
    }

    /// Returns the sign of another polynomial at the root.
    pub fn sign_of(&mut self, other: &Poly) -> i32 {
        if other.is_zero() || self.of.sign_at(&self.high) == 0 {
            return other.sign_at(&self.high);
        }
        let common = self.of.gcd(other);
        if common.0.len() > 1 && count(&common.chain(), &self.low, &self.high) == 1 {
            return 0;
        }
        let chain = other.chain();
        loop {
            if count(&chain, &self.low, &self.high) == 0 && other.sign_at(&self.high) != 0 {
                return other.sign_at(&self.high);
            }
            self.halve();
        }
    }
}
