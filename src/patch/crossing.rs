//! A proof that two patches share a point.
//!
//! With one of the four parameters fixed, `F(z) = b - a = 0` is a system of three equations in
//! three unknowns. Let C be any matrix, and B the ball of radius rho about z0 in the maximum norm.
//! If `|C F(z0)| <= rho / 2` and `|I - C F'(z)| <= 1/2` for all z in B, then `z - C F(z)` maps B
//! into itself and has a fixed point by Brouwer's theorem; C is not singular, since `I - C F'` is
//! shorter than one; so F has a zero in B (Krawczyk 1969; Neumaier 1990, "Interval Methods for
//! Systems of Equations", section 5.1). B must lie inside the patches.

use nalgebra::{Matrix3, Vector3};

use super::closest::{Meeting, PatchPair};
use super::net::Patch;
use crate::base::num::extremes::{Bounded, Extremes, largest};
use crate::base::tolerance::PATCH_SLOPE;

/// Ways along the curve of intersection at which the proof is tried, for points near a border.
const ASIDE: [f64; 5] = [0.0, 0.0625, -0.0625, 0.25, -0.25];

/// Returns whether two patches are proven to share a point near two points that all but coincide.
pub(super) fn crosses(pair: &PatchPair, meeting: &Meeting, upper: f64) -> bool {
    let [p, q, r, s] = meeting.tangents;
    let columns = [-p, -q, r, s];
    // The parameters move along the curve by the null vector of the derivative.
    let volume = |i: usize, j: usize, k: usize| columns[i].dot(&columns[j].cross(&columns[k]));
    let null = [volume(1, 2, 3), -volume(0, 2, 3), volume(0, 1, 3), -volume(0, 1, 2)];
    let longest = null.iter().fold(0.0_f64, |m, x| m.larger(x.abs()));
    if !(longest > 0.0) {
        return false;
    }
    ASIDE.iter().any(|way| {
        let at = core::array::from_fn(|k| (meeting.at[k] + way * null[k] / longest).clamped(0.0, 1.0));
        let moved = if *way == 0.0 {
            *meeting
        } else {
            pair.descend(meeting.patches, at).0
        };
        moved.distance <= upper && (0..4).any(|fixed| shares(pair, &moved, fixed))
    })
}

/// Returns whether a zero is proven with one parameter fixed.
fn shares(pair: &PatchPair, meeting: &Meeting, fixed: usize) -> bool {
    let [p, q, r, s] = meeting.tangents;
    let columns = [-p, -q, r, s];
    let mut free = (0..4).filter(|&k| k != fixed);
    let free: [usize; 3] = core::array::from_fn(|_| free.next().unwrap_or(0));
    let slope = Matrix3::from_columns(&free.map(|k| columns[k]));
    let Some(c) = slope.try_inverse() else { return false };
    let off = meeting.w.abs().add_scalar(pair.frame.error + pair.frame.points);
    let eta = largest(&(c.abs() * off));
    let rho = 2.0 * eta;
    let [of_a, of_b] = [bends(pair.a), bends(pair.b)];
    let bend = of_a.1.larger(of_b.1);
    let error = PATCH_SLOPE * of_a.0.larger(of_b.0);
    // A derivative moves by two second derivatives at most; one more covers roundings.
    let change = 3.0 * (3.0 * bend * rho + error);
    let residual = (Matrix3::identity() - c * slope).abs() * Vector3::repeat(1.0);
    let shift = c.abs() * Vector3::repeat(change);
    let is_inside = free
        .iter()
        .all(|&k| meeting.at[k] - rho >= 0.0 && meeting.at[k] + rho <= 1.0);
    // NaN fails the comparison.
    is_inside && largest(&(residual + shift)) < 0.49
}

/// Returns bounds of all first and second derivatives of a patch. With R the reach, d the sum of
/// the degrees and omega the ratio of the weights, for `x = N / w`: `|N_u| <= 2 d R` and `|w_u| <=
/// d`, in units of the largest weight, give `|x_u| <= 3 d R omega`; the same once more `14 d^2 R
/// omega^2`.
fn bends(patch: &Patch) -> (f64, f64) {
    let weights = || patch.net.iter().map(|h| h[3]);
    let ratio = weights().fold(0.0, f64::larger) / weights().fold(f64::INFINITY, f64::smaller);
    let d = (patch.degrees[0] + patch.degrees[1]) as f64 * ratio;
    (3.0 * d * patch.reach, 14.0 * d * d * patch.reach)
}
