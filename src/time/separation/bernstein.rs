//! The first root of a cubic, bounded from below by the hull of its Bernstein coefficients.
//!
//! A polynomial on [0, 1] lies in the convex hull of the points (k / 3, coefficient k) (Farouki
//! 2012, "The Bernstein polynomial basis: a centennial retrospective", section 3). So it has no
//! root before the hull of these points reaches zero.

use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::tolerance::{BERNSTEIN, ROOT};

/// Rounds in which the remainder beyond the bound of a root is cut off and bounded again.
///
/// The bound converges quadratically, so a few rounds reach rounding.
pub(super) const ROUNDS: u32 = 4;

/// Returns a number in 0..=1 such that the cubic is positive before it, rounding included.
///
/// Returns 1 if the whole cubic is positive.
#[inline]
pub(super) fn positive_until(coefficients: [f64; 4]) -> f64 {
    let largest = coefficients.iter().fold(0.0f64, |m, c| m.larger(c.abs()));
    let mut c = coefficients.each(|c| c - BERNSTEIN * largest);
    // Written so that a NaN in any coefficient returns zero.
    if !(coefficients.iter().all(|c| c.is_finite()) && c[0] > 0.0) {
        return 0.0;
    }
    let mut from = 0.0;
    for _ in 0..ROUNDS {
        let x = hull_until(&c);
        if x >= 1.0 {
            return 1.0;
        }
        from += (1.0 - from) * x;
        c = rest(&c, x);
        if !(c[0] > 0.0) || x < 1.0 / 4096.0 {
            break;
        }
    }
    from * (1.0 - ROOT)
}

/// Returns the result of [`positive_until`] for a straight line with these values at 0 and at 1.
#[inline]
pub(super) fn line_positive_until(first: f64, last: f64) -> f64 {
    let margin = BERNSTEIN * first.abs().at_least(last.abs());
    let (first, last) = (first - margin, last - margin);
    // Written so that NaN returns zero.
    if !(first > 0.0 && last.is_finite()) {
        0.0
    } else if last >= 0.0 {
        1.0
    } else {
        first / (first - last) * (1.0 - ROOT)
    }
}

/// Returns the position at which the hull of the points reaches zero.
///
/// This is the least crossing over all pairs of points, not only over the pairs with the first
/// point.
#[inline]
fn hull_until(c: &[f64; 4]) -> f64 {
    let mut least: f64 = 1.0;
    for j in 1..4 {
        if c[j] >= 0.0 {
            continue;
        }
        for i in 0..j {
            if c[i] >= 0.0 {
                let x = (i as f64 + (j - i) as f64 * (c[i] / (c[i] - c[j]))) * (1.0 / 3.0);
                least = least.smaller(x * (1.0 - ROOT));
            }
        }
    }
    least
}

/// Returns the coefficients over [x, 1] (de Casteljau).
#[inline]
pub(crate) fn rest(c: &[f64; 4], x: f64) -> [f64; 4] {
    let y = 1.0 - x;
    let (p, q, r) = (y * c[0] + x * c[1], y * c[1] + x * c[2], y * c[2] + x * c[3]);
    let (s, t) = (y * p + x * q, y * q + x * r);
    [y * s + x * t, t, r, c[3]]
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::rng::Rng;

    fn value(c: &[f64; 4], x: f64) -> f64 {
        rest(c, x)[0]
    }

    /// Compares the bound with a dense search for the first sign change.
    ///
    /// The middle coefficients of the cubics dip below the ends.
    #[test]
    fn no_root_comes_before_the_bound() {
        let mut rng = Rng::new(7);
        let (mut whole, mut tight, mut dips) = (0, 0, 0);
        for _ in 0..20_000 {
            let c = [
                rng.log_range(1e-9, 1.0),
                rng.range(-1.0, 1.0),
                rng.range(-1.0, 1.0),
                rng.range(-1.0, 1.0),
            ];
            let bound = positive_until(c);
            let root = (0..=1000).map(|k| f64::from(k) / 1000.0).find(|&x| value(&c, x) <= 0.0);
            let root = root.unwrap_or(1.0);
            assert!(bound <= root, "{c:?}: {bound} exceeds {root}");
            whole += u32::from(bound == 1.0);
            tight += u32::from(root < 1.0 && root - bound < 0.01);
            dips += u32::from(root < 1.0 && c[3] > 0.0);
        }
        assert!(whole > 3000 && tight > 5000 && dips > 300, "{whole} {tight} {dips}");
    }

    /// The bound of a line equals that of the cubic with the line's coefficients, except for
    /// rounding.
    #[test]
    fn a_line_is_a_cubic() {
        let mut rng = Rng::new(8);
        let mut whole = 0;
        for _ in 0..20_000 {
            let (first, last) = (rng.log_range(1e-9, 1.0), rng.range(-1.0, 1.0));
            let bound = line_positive_until(first, last);
            let cubic = positive_until([0.0, 1.0, 2.0, 3.0].map(|k| first + (last - first) * (k / 3.0)));
            assert!(
                (bound - cubic).abs() <= 1e-10 * cubic,
                "{first} {last}: {bound} {cubic}"
            );
            if bound < 1.0 {
                assert!(first * (1.0 - bound) + last * bound > 0.0, "{first} {last}: {bound}");
            }
            whole += u32::from(bound == 1.0);
        }
        assert!((8000..12_000).contains(&whole), "{whole}");
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(line_positive_until(bad, 1.0), 0.0);
            assert_eq!(line_positive_until(1.0, bad), 0.0);
            assert_eq!(line_positive_until(bad, -1.0), 0.0);
        }
        assert_eq!(line_positive_until(0.0, 1.0), 0.0);
    }

    /// The crossing of the second and the last point comes before those of the first point here.
    #[test]
    fn the_hull_is_that_of_all_pairs() {
        let c = [1.0, 0.01, 0.6, -1.0];
        assert!(hull_until(&c) < 0.35, "{}", hull_until(&c));
        for k in 0..4 {
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut c = [1.0; 4];
                c[k] = bad;
                assert_eq!(positive_until(c), 0.0, "{c:?}");
            }
        }
        assert_eq!(positive_until([0.0, 1.0, 1.0, 1.0]), 0.0);
    }
}
