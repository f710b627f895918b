//! Numbers as texts that lose no bit.

use nalgebra::Vector3;

/// Returns the one hexadecimal form of a finite number: no zeros at the end, no plus, one zero.
pub(super) fn hex(x: f64) -> String {
    if x == 0.0 {
        return "0x0p0".into();
    }
    let bits = x.to_bits();
    let sign = if bits >> 63 == 1 { "-" } else { "" };
    let (exponent, mantissa) = ((bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
    let digits = format!("{mantissa:013x}");
    let digits = digits.trim_end_matches('0');
    let point = if digits.is_empty() { "" } else { "." };
    match (exponent, mantissa) {
        (0, _) => format!("{sign}0x0{point}{digits}p-1022"),
        _ => format!("{sign}0x1{point}{digits}p{}", exponent - 1023),
    }
}

/// Returns a list of numbers.
pub(super) fn hexes(all: &[f64]) -> String {
    let all: Vec<_> = all.iter().map(|x| format!("\"{}\"", hex(*x))).collect();
    format!("[{}]", all.join(","))
}

/// Returns a vector whose components are multiples of 2^-bits of its greatest component, so that
/// its text is short.
pub(super) fn rounded(v: &Vector3<f64>, bits: u32) -> Vector3<f64> {
    let most = v.amax();
    if !(most > 0.0) || !most.is_normal() {
        return *v;
    }
    // The power of two of the greatest component, and a number whose unit in the last place is the
    // step.
    let power = f64::from_bits(most.to_bits() & (0x7ff << 52));
    let shift = power * 1.5 * (1u64 << (52 - bits)) as f64;
    match shift.is_finite() {
        true => v.map(|x| (x + shift) - shift),
        false => *v,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every number is read back bit for bit, but for the sign of zero.
    #[test]
    fn a_number_has_one_text() {
        let texts = [
            (1.0, "0x1p0"),
            (-0.0, "0x0p0"),
            (0.1, "0x1.999999999999ap-4"),
            (-2.5, "-0x1.4p1"),
            (f64::MIN_POSITIVE / 4.0, "0x0.4p-1022"),
            (f64::MAX, "0x1.fffffffffffffp1023"),
        ];
        for (x, text) in texts {
            assert_eq!(hex(x), text);
        }
    }

    #[test]
    fn a_rounded_vector_is_near_and_short() {
        let v = Vector3::new(0.6123456789, -0.0001234, 0.7123456789);
        let short = rounded(&v, 12);
        assert!((short - v).amax() <= 0.5 / 4096.0, "{short}");
        assert!(
            short.iter().all(|x| hex(*x).len() <= 11),
            "{:?}",
            hexes(short.as_slice())
        );
        assert_eq!(rounded(&Vector3::zeros(), 12), Vector3::zeros());
    }
}
