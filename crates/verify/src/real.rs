//! A number of a receipt: an `f64` in one written form, read digit by digit and taken exactly.
//!
//! A hex float states mantissa and exponent, so nothing is rounded. A text is accepted only if it
//! equals the form that [`Real::text`] writes, so no two texts state one number.

use dashu_base::{Abs, SquareRoot};
use dashu_int::{IBig, UBig};
use dashu_ratio::RBig;

/// A finite number: never a NaN, never -0.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(crate) struct Real(f64);

impl Real {
    pub(crate) const ZERO: Self = Self(0.0);
    pub(crate) const ONE: Self = Self(1.0);

    pub(crate) fn parse(text: &str) -> Option<Self> {
        let (sign, rest) = text.strip_prefix('-').map_or((0, text), |rest| (1 << 63, rest));
        let (digits, exponent) = rest.strip_prefix("0x")?.split_once('p')?;
        let (whole, part) = digits.split_once('.').unwrap_or((digits, "0"));
        let exponent = exponent.parse::<i64>().ok()?;
        let biased = match whole {
            "1" => u64::try_from(exponent.checked_add(1023)?).ok()?,
            "0" => 0,
            _ => return None,
        };
        if part.len() > 13 || biased > 2046 {
            return None;
        }
        let fraction = u64::from_str_radix(part, 16).ok()? << (4 * (13 - part.len()));
        let value = Self(f64::from_bits(sign | biased << 52 | fraction));
        (value.text() == text).then_some(value)
    }

    /// Returns the one written form.
    pub(crate) fn text(self) -> String {
        let bits = self.0.to_bits();
        let sign = if bits >> 63 == 1 { "-" } else { "" };
        let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i64, bits & ((1 << 52) - 1));
        let digits = format!("{fraction:013x}");
        let digits = digits.trim_end_matches('0');
        let point = if digits.is_empty() { "" } else { "." };
        match (exponent, fraction) {
            (0, 0) => "0x0p0".into(),
            (0, _) => format!("{sign}0x0{point}{digits}p-1022"),
            _ => format!("{sign}0x1{point}{digits}p{}", exponent - 1023),
        }
    }

    /// Returns m and e: the number is m 2^e.
    pub(crate) fn parts(self) -> (i64, i64) {
        let bits = self.0.to_bits();
        let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i64, (bits & ((1 << 52) - 1)) as i64);
        let size = if exponent == 0 { fraction } else { fraction | 1 << 52 };
        let mantissa = if bits >> 63 == 1 { -size } else { size };
        (mantissa, exponent.max(1) - 1075)
    }

    pub(crate) fn exact(self) -> RBig {
        let (mantissa, exponent) = self.parts();
        RBig::from(IBig::from(mantissa)) * two_to(exponent)
    }

    pub(crate) fn bits(self) -> u64 {
        self.0.to_bits()
    }

    /// Returns the greater of two sizes.
    pub(crate) fn larger(self, o: Self) -> Self {
        let [x, y] = [self, o].map(|x| f64::from_bits(x.bits() & !(1 << 63)));
        if x < y { Self(y) } else { Self(x) }
    }

    /// Returns an exponent e with |x| < 2^e.
    pub(crate) fn scale(self) -> i64 {
        (self.bits() >> 52 & 0x7ff) as i64 - 1022
    }

    /// For texts alone.
    pub(crate) fn shown(self) -> f64 {
        self.0
    }
}

/// Returns a power of two.
pub(crate) fn two_to(exponent: i64) -> RBig {
    let power = IBig::from(1) << exponent.unsigned_abs() as usize;
    if exponent < 0 {
        RBig::from_parts_signed(1.into(), power)
    } else {
        RBig::from(power)
    }
}

pub(crate) type Exact = [RBig; 3];

pub(crate) fn dot(u: &Exact, v: &Exact) -> RBig {
    &u[0] * &v[0] + &u[1] * &v[1] + &u[2] * &v[2]
}

pub(crate) fn cross(u: &Exact, v: &Exact) -> Exact {
    let part = |i: usize, j: usize| &u[i] * &v[j] - &u[j] * &v[i];
    [part(1, 2), part(2, 0), part(0, 1)]
}

pub(crate) fn minus(u: &Exact, v: &Exact) -> Exact {
    std::array::from_fn(|k| &u[k] - &v[k])
}

pub(crate) fn zero() -> Exact {
    std::array::from_fn(|_| RBig::ZERO)
}

/// Decides x <= y sqrt(square) without a root.
pub(crate) fn at_most(x: &RBig, y: &RBig, square: &RBig) -> bool {
    let (left, right) = (x * x, y * y * square);
    match (*x > RBig::ZERO, *y < RBig::ZERO) {
        (false, false) => true,
        (true, true) => false,
        (true, false) => left <= right,
        (false, true) => left >= right,
    }
}

/// Returns a number no less than the square root of a fraction that is not negative.
pub(crate) fn root_above(q: &RBig) -> RBig {
    let scaled = (q.numerator().clone().abs() << 256) / IBig::from(q.denominator().clone());
    let root = UBig::try_from(scaled).map_or(UBig::ZERO, |x| x.sqrt());
    RBig::from_parts_signed(IBig::from(root) + IBig::ONE, IBig::ONE << 128)
}
