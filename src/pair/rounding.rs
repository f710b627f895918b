//! From the signed distance of two cores to the signed distance of the rounded bodies.
//!
//! `s = s_core - rA - rB` on both sides of contact.

use crate::base::num::double_double::two_sum;
use crate::base::tolerance::UNIT;

/// Returns a signed distance minus both radii, rounded twice to nearest.
#[inline]
pub(crate) fn less(s: f64, radii: [f64; 2]) -> f64 {
    let (high, low) = two_sum(radii[0], radii[1]);
    (s - high) - low
}

/// Returns bounds minus both radii, rounded outward. Bounds of bodies that are not rounded do not
/// change.
///
/// Each of the two differences has an error of at most `UNIT` times its magnitude, and so has each
/// operation here. A difference that is subnormal is exact, and so is zero.
#[inline]
pub(crate) fn bounds([lower, upper]: [f64; 2], radii: [f64; 2]) -> [f64; 2] {
    if radii == [0.0; 2] {
        return [lower, upper];
    }
    let (high, low) = two_sum(radii[0], radii[1]);
    let out = |s: f64| {
        let (first, last) = (s - high, (s - high) - low);
        (last, (first.abs() + last.abs()) * (4.0 * UNIT))
    };
    let ((lower, below), (upper, above)) = (out(lower), out(upper));
    [lower - below, upper + above]
}
