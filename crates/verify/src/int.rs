//! Integers of two widths. Narrow ones are fast; what they cannot hold, or cannot show, is evaluated again in wide ones: at
//! the same degree of polynomials, and at a higher one. Neither degree is always the better: where an angle is far from
//! small, the rest of the higher one can be larger.

use dashu_base::Abs;
use dashu_int::IBig;

/// An integer of fixed-point numbers. `None`: the result does not fit.
pub(crate) trait Int: Clone + Ord {
    /// Bits after the point.
    const P: usize;
    /// Degree of the polynomials.
    const D: usize;
    /// Least common multiple of the binomials of the degree.
    const W: i32;
    fn of(x: IBig) -> Option<Self>;
    fn small(x: i32) -> Self;
    fn wide(&self) -> IBig;
    fn add(&self, o: &Self) -> Option<Self>;
    fn sub(&self, o: &Self) -> Option<Self>;
    fn mul(&self, o: &Self) -> Option<Self>;
    /// Times 2^P.
    fn up(&self) -> Option<Self>;
    /// Divided by 2^P, rounded down.
    fn down(&self) -> Self;
    /// Half, rounded down.
    fn half(&self) -> Self;
    /// Divided by a positive number: within 1 of the quotient.
    fn over(&self, n: i32) -> Self;
    fn size(&self) -> Option<Self>;
    /// Divided by a positive number, rounded down.
    fn quotient(&self, o: &Self) -> Self;
}

impl Int for i128 {
    const P: usize = 58;
    const D: usize = 4;
    const W: i32 = 12;
    fn of(x: IBig) -> Option<Self> {
        Self::try_from(x).ok()
    }
    fn small(x: i32) -> Self {
        Self::from(x)
    }
    fn wide(&self) -> IBig {
        IBig::from(*self)
    }
    fn add(&self, o: &Self) -> Option<Self> {
        self.checked_add(*o)
    }
    fn sub(&self, o: &Self) -> Option<Self> {
        self.checked_sub(*o)
    }
    fn mul(&self, o: &Self) -> Option<Self> {
        self.checked_mul(*o)
    }
    fn up(&self) -> Option<Self> {
        self.checked_mul(1 << Self::P)
    }
    fn down(&self) -> Self {
        self >> Self::P
    }
    fn half(&self) -> Self {
        self >> 1
    }
    fn over(&self, n: i32) -> Self {
        self / Self::from(n)
    }
    fn size(&self) -> Option<Self> {
        self.checked_abs()
    }
    fn quotient(&self, o: &Self) -> Self {
        self.div_euclid(*o)
    }
}

/// An integer of any size, for polynomials of degree D.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Big<const D: usize>(IBig);

impl<const D: usize> Int for Big<D> {
    const P: usize = 128;
    const D: usize = D;
    const W: i32 = match D {
        4 => 12,
        5 => 10,
        _ => panic!("another degree"),
    };
    fn of(x: IBig) -> Option<Self> {
        Some(Self(x))
    }
    fn small(x: i32) -> Self {
        Self(x.into())
    }
    fn wide(&self) -> IBig {
        self.0.clone()
    }
    fn add(&self, o: &Self) -> Option<Self> {
        Some(Self(&self.0 + &o.0))
    }
    fn sub(&self, o: &Self) -> Option<Self> {
        Some(Self(&self.0 - &o.0))
    }
    fn mul(&self, o: &Self) -> Option<Self> {
        Some(Self(&self.0 * &o.0))
    }
    fn up(&self) -> Option<Self> {
        Some(Self(&self.0 << Self::P))
    }
    fn down(&self) -> Self {
        Self(&self.0 >> Self::P)
    }
    fn half(&self) -> Self {
        Self(&self.0 >> 1usize)
    }
    fn over(&self, n: i32) -> Self {
        Self(&self.0 / IBig::from(n))
    }
    fn size(&self) -> Option<Self> {
        Some(Self(self.0.clone().abs()))
    }
    fn quotient(&self, o: &Self) -> Self {
        Self(dashu_base::DivEuclid::div_euclid(&self.0, &o.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<I: Int>() {
        let of = |x: i32| I::small(x).up().unwrap();
        assert!(I::small(-3).half() == I::small(-2) && I::small(3).half() == I::small(1));
        let below = of(-3).sub(&I::small(1)).unwrap();
        assert!(below.down() == I::small(-4) && of(-3).down() == I::small(-3));
        assert!(
            I::small(-7).quotient(&I::small(2)) == I::small(-4) && I::small(7).quotient(&I::small(2)) == I::small(3)
        );
        assert!(I::small(-7).over(2).sub(&I::small(-4)).unwrap().size().unwrap() <= I::small(1));
    }

    #[test]
    fn both_widths_round_down() {
        check::<i128>();
        check::<Big<4>>();
        check::<Big<5>>();
    }
}
