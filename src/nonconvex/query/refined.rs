//! Bounds of the distance of a point from a triangle that are as close as rounding permits.
//!
//! A search bounds the distance along one direction, that to a foot. Where the point is close to an
//! edge or to a plane, this direction errs by much more than a rounding, and so does the bound
//! ([`bound_four`](super::near)). Here each direction has twice the precision:
//!
//! 1. The foot is on a corner, on an edge or in the plane. All seven are computed.
//! 2. Upper bound: the distance of the nearest foot in the triangle.
//! 3. Lower bound: along each direction to a foot, the least height of the corners. The largest
//!    counts, since any direction is a proof.
//!
//! If the closest point is on an edge, the direction to it is perpendicular to the edge up to one
//! rounding, so the lower bound is less than the distance by roundings alone. The same holds for a
//! corner and for the plane.

use nalgebra::Vector3;

use crate::base::num::double_double::DoubleDouble;
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::{Scalar, Vec3, cross, dot, magnitude, neg, scaled, sqrt, sub};
use crate::base::tolerance::POINT_HEIGHT;
use crate::nonconvex::query::triangle::Triangle;

type Fine = Vec3<DoubleDouble>;

/// Returns a lower and an upper bound of the distance of a point from a triangle; see
/// [`POINT_HEIGHT`].
#[cold]
pub(super) fn distance(point: &Vector3<f64>, corners: &Triangle) -> (f64, f64) {
    let size = corners.iter().fold(0.0, |most: f64, x| most.larger((x - point).amax()));
    // Products of lengths stay in range.
    let unit = magnitude(size);
    let fine = corners.each(|x| [0, 1, 2].each(|k: usize| DoubleDouble::sum(x[k] / unit, -point[k] / unit)));
    let apart = fine.each(rounded);
    let reach = apart.iter().fold(0.0, |most: f64, x| most.larger(x.norm_squared()));
    let error = sqrt(reach) * POINT_HEIGHT;
    let (mut lower, mut upper) = (0.0f64, f64::INFINITY);
    let mut try_foot = |foot: &Fine, direction: &Fine| {
        upper = upper.smaller(sqrt(rounded(*foot).norm_squared()) + error);
        let d = rounded(*direction);
        let d = d / magnitude(d.amax());
        let least = apart.iter().fold(f64::INFINITY, |least, x| least.smaller(d.dot(x)));
        let length = sqrt(d.norm_squared());
        if length > 0.0 {
            lower = lower.larger(least / length - error);
        }
    };
    let (zero, one) = (DoubleDouble::from(0.0), DoubleDouble::from(1.0));
    let is_positive = |x: DoubleDouble| x.value() > 0.0;
    for k in 0..3 {
        let (from, to) = (&fine[k], &fine[(k + 1) % 3]);
        try_foot(from, from);
        let along = sub(to, from);
        let square = dot(&along, &along);
        if !is_positive(square) {
            continue;
        }
        let part = -dot(from, &along) / square;
        if part > zero && part < one {
            let foot = sum(from, &scaled(&along, part));
            try_foot(&foot, &foot);
        }
    }
    let [a, b, c] = &fine;
    let (ab, ac) = (sub(b, a), sub(c, a));
    let n = cross(&ab, &ac);
    let square = dot(&n, &n);
    let weights = [(c, a), (a, b)].each(|(x, y)| dot(&n, &cross(x, y)));
    let rest = square - weights[0] - weights[1];
    if is_positive(square) && [weights[0], weights[1], rest].iter().all(|w| *w >= zero) {
        let [along_b, along_c] = weights.each(|w| w / square);
        let foot = sum(a, &sum(&scaled(&ab, along_b), &scaled(&ac, along_c)));
        let is_ahead = dot(&n, a) > zero;
        try_foot(&foot, &if is_ahead { n } else { neg(&n) });
    }
    (lower * unit, upper * unit)
}

fn sum(a: &Fine, b: &Fine) -> Fine {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn rounded(x: Fine) -> Vector3<f64> {
    Vector3::from(x.each(Scalar::value))
}
