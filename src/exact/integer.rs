//! Integers of arbitrary length and vectors of such integers.

use dashu_base::{BitTest, DivRem, SquareRoot};
use dashu_int::{IBig, UBig};
use nalgebra::Vector3;

use crate::polyhedron::{odd_part, power_of_two};

/// Vector of three integers.
pub(super) type Big3 = [IBig; 3];

/// Returns `x / 2^e`; no bit of `x` may be lower than `2^e`.
pub(super) fn integer(x: f64, e: i32) -> IBig {
    if x == 0.0 {
        return IBig::ZERO;
    }
    let (m, own) = odd_part(x);
    IBig::from(m) << (own - e) as usize
}

pub(super) fn dot(a: &Big3, b: &Big3) -> IBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

pub(super) fn cross(a: &Big3, b: &Big3) -> Big3 {
    [
        &a[1] * &b[2] - &a[2] * &b[1],
        &a[2] * &b[0] - &a[0] * &b[2],
        &a[0] * &b[1] - &a[1] * &b[0],
    ]
}

pub(super) fn sub(a: &Big3, b: &Big3) -> Big3 {
    [&a[0] - &b[0], &a[1] - &b[1], &a[2] - &b[2]]
}

pub(super) fn neg(a: &Big3) -> Big3 {
    [-&a[0], -&a[1], -&a[2]]
}

pub(super) fn is_zero(a: &Big3) -> bool {
    a.iter().all(IBig::is_zero)
}

/// Returns a multiple of `a` in f64 with the largest coordinate between a half and one: each
/// coordinate is correct to one rounding, or zero if below `2^-900` of the largest.
pub(super) fn direction(a: &Big3) -> Vector3<f64> {
    let bits = a.iter().map(BitTest::bit_len).max().unwrap_or(0);
    let coordinate = |x: &IBig| {
        // 62 bits fit in an i64; the bits cut off are below the rounding to f64.
        let (below, cut) = (bits - x.bit_len(), x.bit_len().saturating_sub(62));
        if below > 900 {
            return 0.0;
        }
        i64::try_from(x >> cut).unwrap_or(0) as f64 * power_of_two(cut as i32 - bits as i32)
    };
    Vector3::new(coordinate(&a[0]), coordinate(&a[1]), coordinate(&a[2]))
}

/// Returns `num / den` in f64, for `0 <= num <= den`, correct to two roundings.
pub(super) fn fraction(num: &IBig, den: &IBig) -> f64 {
    let shift = den.bit_len().saturating_sub(1000);
    (num >> shift).to_f64().value() / (den >> shift).to_f64().value()
}

/// Returns `sqrt(num / den) 2^e` for `num >= 0` and `den > 0`, correctly rounded if the result is a
/// normal number. A subnormal result is rounded twice and errs by less than `1/2 + 2^-52` units of
/// the least f64.
pub(super) fn root(num: &UBig, den: &UBig, e: i32) -> f64 {
    if num.is_zero() {
        return 0.0;
    }
    // Scaled by 4^h: the integer root gets at least 64 bits, and its last bit stands for all bits
    // below.
    let bits = num.bit_len() as i64 - den.bit_len() as i64;
    let h = ((132 - bits).max(0) / 2) as usize;
    let (quotient, rest) = (num << (2 * h)).div_rem(den);
    let root = quotient.sqrt();
    let inexact = !rest.is_zero() || &root * &root != quotient;
    let mantissa = (root << 1) | UBig::from(u8::from(inexact));
    let cut = mantissa.bit_len().saturating_sub(900);
    let low_bits = cut > 0 && mantissa.trailing_zeros().is_some_and(|z| z < cut);
    let mantissa = if cut > 0 {
        (mantissa >> cut) | UBig::from(u8::from(low_bits))
    } else {
        mantissa
    };
    let exponent = e - h as i32 - 1 + cut as i32;
    // Two half exponents keep either factor within the range of powers of two.
    mantissa.to_f64().value() * power_of_two(exponent / 2) * power_of_two(exponent - exponent / 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polyhedron::lowest_bit;

    #[test]
    fn numbers_go_in_and_out_exactly() {
        for x in [1.0, -0.1, 1e-300, 5e-324, 1.7e308, 3.0] {
            let e = lowest_bit([x, 1.0]).unwrap();
            let back = integer(x, e);
            let (num, den) = if e < 0 {
                (back, IBig::ONE << (-e) as usize)
            } else {
                (back << e as usize, IBig::ONE)
            };
            if x.abs() <= 1.0 && x > 0.0 && x > 1e-290 {
                assert_eq!(fraction(&num, &den), x);
            }
            assert_eq!(
                integer(x, e).to_f64().value() * 2f64.powi(e / 2) * 2f64.powi(e - e / 2),
                x
            );
        }
    }

    #[test]
    fn each_coordinate_of_a_direction_is_right() {
        let third = (IBig::ONE << 1400) / IBig::from(3);
        for k in [0usize, 40, 100, 700, 899] {
            let d = direction(&[third.clone(), -(&third >> k), IBig::ZERO]);
            assert!((d.x * 3.0 - 2.0).abs() <= f64::EPSILON * 2.0, "{d}");
            let scale = power_of_two(k as i32);
            assert!((d.y * scale / d.x + 1.0).abs() <= f64::EPSILON, "{k}: {d}");
        }
    }

    #[test]
    fn roots_are_correctly_rounded() {
        for n in [1u32, 2, 3, 4, 5, 1_000_003] {
            assert_eq!(root(&UBig::from(n), &UBig::ONE, 0), f64::from(n).sqrt());
        }
        assert_eq!(root(&UBig::from(1u8), &UBig::from(4u8), 3), 4.0);
        assert_eq!(root(&(UBig::ONE << 2000), &UBig::ONE, -900), 2f64.powi(100));
    }
}
