//! Sine and cosine of the angle of a joint or of a spin, enclosed over an interval.
//!
//! **Lemma 1.** A turn by the vector a v is I + s [a] + u [a]^2, with s = sin(|a| v) / |a| and
//! u = (1 - cos(|a| v)) / |a|^2: power series in |a|^2 v^2, without a root and without a division
//! by zero. At v = v0 they are found in three steps:
//!
//! 1. y = v0 / 2^k with |a|^2 y^2 <= 1/4.
//! 2. The series to 17 terms by Horner. They alternate and fall, so the rest is less than the first
//!    term left out, below 2^-170: less than one unit.
//! 3. k times: s becomes 2 s (1 - |a|^2 u), u becomes 2 s^2.
//!
//! Around v0 they are polynomials in w = v - v0. The derivatives are u' = s, s' = cos,
//! cos' = -|a|^2 s. Lagrange's rest of degree D is at most |w| (|a||w|)^D / (D+1)! for s and
//! w^2 (|a||w|)^(D-1) / (D+1)! for u, as no derivative exceeds a power of |a|. The angle of a joint
//! along a curve makes w a polynomial in x: the form of w is put into the polynomial by Horner.

use dashu_base::Abs;
use dashu_int::IBig;
use dashu_ratio::RBig;

use crate::int::Int;
use crate::real::root_above;
use crate::taylor::Taylor;

fn power(q: &RBig, n: usize) -> RBig {
    (0..n).fold(RBig::ONE, |p, _| p * q)
}

/// Encloses s and u at v = sum of angle[k] x^k, with square = |a|^2; `None` if it turns too far.
pub(crate) fn turn<I: Int>(square: &RBig, angle: &[RBig]) -> Option<[Taylor<I>; 2]> {
    let start = angle.first()?;
    let way = angle[1..].iter().fold(RBig::ZERO, |sum, x| sum + x.clone().abs());
    let mut rest = square * start * start;
    if rest >= RBig::from(1u64 << 40) || square * &way * &way >= RBig::from(1u64 << 10) {
        return None;
    }
    let mut halvings = 0;
    while rest > RBig::from_parts_signed(IBig::ONE, IBig::from(4)) {
        rest /= RBig::from(4);
        halvings += 1;
    }
    let (n, one) = (Taylor::<I>::fixed(square)?, Taylor::whole(1)?);
    let y = Taylor::fixed(&(start / RBig::from(1u64 << halvings)))?;
    let z = n.times(&y)?.times(&y)?;
    let (mut s, mut u) = (one.clone(), one.clone());
    for j in (1..=17).rev() {
        s = one.minus(&z.times(&s)?.over(2 * j * (2 * j + 1))?)?;
        u = one.minus(&z.times(&u)?.over((2 * j + 1) * (2 * j + 2))?)?;
    }
    (s.r, u.r) = (s.r.add(&I::small(1))?, u.r.add(&I::small(1))?);
    (s, u) = (y.times(&s)?, y.times(&y)?.times(&u)?.over(2)?);
    for _ in 0..halvings {
        let cosine = one.minus(&n.times(&u)?)?;
        (s, u) = (s.times(&cosine)?, s.times(&s)?);
        (s, u) = (s.plus(&s)?, u.plus(&u)?);
    }
    if way.is_zero() {
        return Some([s, u]);
    }
    let cosine = one.minus(&n.times(&u)?)?;
    let mut derivatives = vec![u, s, cosine];
    while derivatives.len() < I::D + 2 {
        let zero = Taylor::whole(0)?;
        derivatives.push(zero.minus(&n.times(&derivatives[derivatives.len() - 2])?)?);
    }
    let mut parts = angle.to_vec();
    parts[0] = RBig::ZERO;
    let w = Taylor::polynomial(&parts)?;
    let rho = root_above(square) * &way;
    let factorial = |k: usize| (1..=k as i32).product::<i32>();
    let series = |first: usize, rest: RBig| {
        let mut all = derivatives[first + I::D].over(factorial(I::D))?;
        for k in (0..I::D).rev() {
            all = all.times(&w)?.plus(&derivatives[first + k].over(factorial(k))?)?;
        }
        let rest = Taylor::<I>::fixed(&(rest / RBig::from(factorial(I::D + 1))))?;
        all.r = all.r.add(&rest.c[0])?.add(&I::small(1))?;
        Some(all)
    };
    Some([
        series(1, &way * power(&rho, I::D))?,
        series(0, &way * &way * power(&rho, I::D - 1))?,
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::int::Big;

    /// The value of a form at x = k / 4, in units of 2^-P, and its rest.
    fn at<I: Int>(form: &Taylor<I>, k: i32) -> [RBig; 2] {
        let x = RBig::from(k) / RBig::from(4);
        let value = form
            .c
            .iter()
            .rev()
            .fold(RBig::ZERO, |sum, c| sum * &x + RBig::from(c.wide()));
        [value, RBig::from(form.r.wide())].map(|y| y / RBig::from(IBig::ONE << I::P))
    }

    /// Over an interval the forms enclose what they are at its points, in both widths.
    fn check<I: Int>(square: i32, angle: &[RBig]) {
        let over = turn::<I>(&RBig::from(square), angle).unwrap();
        for k in 0..=4 {
            let x = RBig::from(k) / RBig::from(4);
            let value = angle.iter().rev().fold(RBig::ZERO, |sum, c| sum * &x + c);
            let point = turn::<Big<5>>(&RBig::from(square), &[value]).unwrap();
            for (over, point) in over.iter().zip(&point) {
                let ([y, r], [z, s]) = (at(over, k), at(point, 0));
                assert!((y - z).abs() <= r + s, "{square} {angle:?} {k}");
            }
        }
        // Sine and cosine: n s^2 + (1 - n u)^2 = 1.
        let [s, u] = turn::<I>(&RBig::from(square), &angle[..1]).unwrap();
        let (n, one) = (Taylor::<I>::whole(square).unwrap(), Taylor::whole(1).unwrap());
        let cosine = one.minus(&n.times(&u).unwrap()).unwrap();
        let sum = n
            .times(&s)
            .unwrap()
            .times(&s)
            .unwrap()
            .plus(&cosine.times(&cosine).unwrap())
            .unwrap();
        let [y, r] = at(&sum, 0);
        assert!((y - RBig::ONE).abs() <= r, "{square} {angle:?}");
    }

    #[test]
    fn forms_enclose_what_they_are_at_points() {
        let mut state = 1u64;
        let mut next = |size: i64| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            RBig::from_parts_signed(
                IBig::from((state >> 33) as i64 - (1 << 30)) * IBig::from(size),
                IBig::ONE << 33,
            )
        };
        for k in 0..200 {
            let size = [1, 8, 300][k % 3];
            let angle: Vec<_> = (0..1 + k % 7).map(|j| next(if j == 0 { size } else { 2 })).collect();
            let square = [0, 1, 2, 5][k % 4];
            check::<i128>(square, &angle);
            check::<Big<5>>(square, &angle);
        }
    }
}
