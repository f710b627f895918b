//! Integers of arbitrary length and vectors of such integers.

use core::cmp::Ordering;

use dashu_base::{BitTest, DivRem, SquareRoot, UnsignedAbs};
use dashu_int::{IBig, UBig};
use nalgebra::Vector3;

use crate::body::polyhedron::{odd_part, power_of_two};

/// Vector of three integers.
pub(crate) type Big3 = [IBig; 3];

/// Returns `x / 2^e`. The lowest bit of `x` must not be below `2^e`.
pub(crate) fn integer(x: f64, e: i32) -> IBig {
    if x == 0.0 {
        return IBig::ZERO;
    }
    let (m, own) = odd_part(x);
    IBig::from(m) << (own - e) as usize
}

pub(crate) fn dot(a: &Big3, b: &Big3) -> IBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

pub(crate) fn cross(a: &Big3, b: &Big3) -> Big3 {
    [
        &a[1] * &b[2] - &a[2] * &b[1],
        &a[2] * &b[0] - &a[0] * &b[2],
        &a[0] * &b[1] - &a[1] * &b[0],
    ]
}

pub(crate) fn sub(a: &Big3, b: &Big3) -> Big3 {
    [&a[0] - &b[0], &a[1] - &b[1], &a[2] - &b[2]]
}

pub(super) fn neg(a: &Big3) -> Big3 {
    [-&a[0], -&a[1], -&a[2]]
}

pub(super) fn is_zero(a: &Big3) -> bool {
    a.iter().all(IBig::is_zero)
}

pub(crate) fn sign(x: &IBig) -> i32 {
    match x.cmp(&IBig::ZERO) {
        Ordering::Less => -1,
        Ordering::Equal => 0,
        Ordering::Greater => 1,
    }
}

/// Returns a multiple of `a` in f64 whose largest coordinate is between 1/2 and 1.
///
/// Each coordinate is rounded once, or has the size `2^-901` if it is below about `2^-900`. The
/// signs are always right, and a coordinate is zero only if it is exactly zero.
pub(super) fn direction(a: &Big3) -> Vector3<f64> {
    let bits = a.iter().map(BitTest::bit_len).max().unwrap_or(0);
    let coordinate = |x: &IBig| {
        // 62 bits fit in an i64; the bits cut off are below the rounding to f64.
        let (below, cut) = (bits - x.bit_len(), x.bit_len().saturating_sub(62));
        if below > 900 {
            return f64::from(sign(x)) * power_of_two(-901);
        }
        i64::try_from(x >> cut).unwrap_or(0) as f64 * power_of_two(cut as i32 - bits as i32)
    };
    Vector3::new(coordinate(&a[0]), coordinate(&a[1]), coordinate(&a[2]))
}

/// Returns `num / den` in f64, for `0 <= num <= den`, rounded at most three times.
pub(super) fn fraction(num: &IBig, den: &IBig) -> f64 {
    let shift = den.bit_len().saturating_sub(1000);
    let [num, den] = [num, den].map(|x| nearest(&(x >> shift).unsigned_abs()));
    num / den
}

/// Returns the number in f64, rounded to nearest, for less than 1,024 bits.
///
/// `UBig::to_f64` of dashu-int 0.6 does not round every number beyond two words to nearest, so the
/// result would depend on the length of a word.
fn nearest(x: &UBig) -> f64 {
    let cut = x.bit_len().saturating_sub(64);
    let is_cut = x.trailing_zeros().is_some_and(|zeros| zeros < cut);
    // The last of 64 bits represents all bits that are cut off.
    let top = u64::try_from(x >> cut).unwrap_or(u64::MAX) | u64::from(is_cut);
    top as f64 * power_of_two(cut as i32)
}

/// Returns `sqrt(num / den) 2^e` for `num >= 0` and `den > 0`, correctly rounded if the result is
/// normal.
///
/// A subnormal result is rounded twice, and its error is less than `1/2 + 2^-52` units of the least
/// f64.
pub(super) fn root(num: &UBig, den: &UBig, e: i32) -> f64 {
    if num.is_zero() {
        return 0.0;
    }
    // Scaled by 4^h, so that the integer root has at least 64 bits. A last bit is appended that
    // represents all lower bits.
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
    // Two half exponents, so that each factor is within the range of powers of two.
    nearest(&mantissa) * power_of_two(exponent / 2) * power_of_two(exponent - exponent / 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::num::sign::edge_sign;
    use crate::body::polyhedron::highest::steeper;
    use crate::body::polyhedron::lowest_bit;
    use crate::rng::Rng;

    #[test]
    fn numbers_round_to_nearest_even() {
        let even = 1u64 << 53;
        for cut in (0..200).chain([300, 600, 900]) {
            let size = power_of_two(cut as i32);
            for (above, rounded) in [(1, 0), (3, 4), (5, 4)] {
                let tie = UBig::from(even + above) << cut;
                assert_eq!(nearest(&tie), (even + rounded) as f64 * size, "{above} << {cut}");
                if cut > 0 {
                    let beyond = &tie + UBig::ONE;
                    assert_eq!(nearest(&beyond), (even + above + 1) as f64 * size, "{above} << {cut}");
                }
            }
        }
        // `UBig::to_f64` returns the number below.
        let long = UBig::from(0x45a827999fcef3u128) << 104;
        assert_eq!(nearest(&long), 3.976703380349734e47);
    }

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

    /// Returns an integer of up to about 1,300 bits, or zero.
    fn long(rng: &mut Rng) -> IBig {
        // Near the size at which a coordinate is too small for f64, and well below.
        let shift = *rng.pick(&[0.0, 90.0, 600.0, 1180.0, 1250.0]) + rng.range(0.0, 20.0);
        IBig::from(rng.range(-9e15, 9e15) as i64) << shift as usize
    }

    /// Returns a coordinate of an edge between stored points: a multiple of `2^-357`.
    fn length(rng: &mut Rng, most: i32) -> f64 {
        let high = most - *rng.pick(&[0, 40, 100, 200]);
        match rng.below(6) {
            0 => 0.0,
            1 => -power_of_two(high),
            _ => {
                (rng.range(-1e6, 1e6).round() * power_of_two(high - 20) / power_of_two(-357)).round()
                    * power_of_two(-357)
            }
        }
    }

    #[test]
    fn a_certain_sign_of_a_rounded_direction_is_the_exact_one() {
        let mut rng = Rng::new(21);
        let (mut certain, mut uncertain) = ([0; 2], [0; 2]);
        for _ in 0..40_000 {
            // The largest coordinate is the first, to which the edges are often at right angles.
            let n = [IBig::from(3) << 2160, long(&mut rng), long(&mut rng)];
            let n = if rng.chance(0.2) { n.map(|x| x >> 40) } else { n };
            let most = *rng.pick(&[-60, 0, 60, 104]);
            let edge = |rng: &mut Rng, most: i32| {
                let first = if rng.chance(0.1) { length(rng, most) } else { 0.0 };
                Vector3::new(first, length(rng, most), length(rng, most))
            };
            let (e, f) = (edge(&mut rng, most), edge(&mut rng, most));
            let m = Vector3::from_fn(|_, _| rng.range(-1e6, 1e6).round() * power_of_two(-20));
            let whole = |v: &Vector3<f64>| [v.x, v.y, v.z].map(|x| integer(x, -400));
            let rounded = direction(&n);
            let truth = sign(&dot(&n, &whole(&e)));
            let reported = edge_sign(&rounded, &e);
            assert!(reported == 0 || reported == truth, "{rounded:?} {e:?}");
            certain[0] += i32::from(reported != 0);
            uncertain[0] += i32::from(reported == 0);
            let (n_e, n_f) = (dot(&n, &whole(&e)), dot(&n, &whole(&f)));
            let truth = sign(&(n_e * dot(&whole(&m), &whole(&f)) - n_f * dot(&whole(&m), &whole(&e))));
            let reported = steeper(&rounded, &m, &e, &f);
            assert!(
                reported.is_none_or(|sign| sign == truth),
                "{rounded:?} {m:?} {e:?} {f:?}"
            );
            certain[1] += i32::from(reported.is_some());
            uncertain[1] += i32::from(reported.is_none());
        }
        assert!(
            certain.iter().chain(&uncertain).all(|&n| n > 2000),
            "{certain:?} {uncertain:?}"
        );
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
