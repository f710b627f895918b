//! Powers in the arithmetic of a solver.

use crate::base::num::scalar::Scalar;

/// Terms of the series of the exponential: the rest is below 2^-110 for arguments below 2^-9.
const TERMS: u32 = 10;

/// Halvings of the argument.
const HALVINGS: i32 = 8;

/// `ln 2` in two parts.
const LN2: [f64; 2] = [core::f64::consts::LN_2, crate::base::tolerance::LN2_REST];

/// Returns `x^p` for an `x` that is not negative; zero if `x` is zero and `p` positive.
pub(super) fn power<T: Scalar>(x: T, p: T) -> T {
    let rough = libm::pow(x.value(), p.value());
    if T::UNIT == f64::UNIT || !(rough > 0.0 && rough.is_finite() && x.value() > 0.0) {
        return T::from(rough);
    }
    // One step of Newton's method doubles the digits of the logarithm.
    let l = T::from(libm::log(x.value()));
    // As a product of two roots: the inverse of a subnormal number is infinite.
    let inverse_root = exponential(-l * T::from(0.5));
    let l = l + (x * inverse_root * inverse_root - T::from(1.0));
    exponential(p * l)
}

/// Returns `e^x`.
fn exponential<T: Scalar>(x: T) -> T {
    let k = libm::round(x.value() / LN2[0]);
    let r = x - T::from(k) * T::from(LN2[0]) - T::from(k * LN2[1]);
    let small = r * T::from(1.0 / f64::from(1 << HALVINGS));
    // The series times the factorial of its last term: all factors are whole numbers.
    let (mut sum, mut factor) = (T::from(1.0), T::from(1.0));
    for n in (1..=TERMS).rev() {
        factor = factor * T::from(f64::from(n));
        sum = sum * small + factor;
    }
    sum = sum / factor;
    for _ in 0..HALVINGS {
        sum = sum * sum;
    }
    sum * T::from(libm::exp2(k))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::num::double_double::DoubleDouble;

    #[test]
    fn powers_keep_the_digits_of_their_arithmetic() {
        let of = DoubleDouble::from;
        for (x, n) in [(1.25, 3), (0.3, 5), (7.0, 2), (0.01, 7)] {
            let product = (0..n).fold(of(1.0), |y, _| y * of(x));
            let error = (power(of(x), of(f64::from(n))) / product - of(1.0)).value();
            assert!(error.abs() < 1e-28, "{x} {n} {error}");
        }
        let root = power(of(2.0), of(0.5));
        assert!((root * root - of(2.0)).value().abs() < 1e-28);
    }

    #[test]
    fn powers_of_subnormal_numbers_are_numbers() {
        for k in [1, 2, 3, 1 << 20, (1 << 52) - 1] {
            let x = f64::from_bits(k);
            let fourth = power(DoubleDouble::from(x), DoubleDouble::from(0.25));
            let error = (fourth * fourth * fourth * fourth).value() / x - 1.0;
            assert!(error.abs() < 1e-15 || x < 1e-308, "{x:e} {fourth:?} {error}");
            assert!((fourth.value() - libm::pow(x, 0.25)).abs() < 1e-90, "{x:e} {fourth:?}");
        }
    }
}
