//! Exact signs of two surfaces, of which B is moved by a symbolic shift that leaves no tie.
//!
//! B is moved by `d = (e, e^2, e^3)` with an infinitesimal `e`, everywhere the same. Two predicates
//! are enough, and both are affine in `d`, with `N` the normal of a triangle:
//!
//! - the side of a point of one surface at a triangle of the other, `N . (p - a)`, minus `N . d` if
//!   the triangle is of B, plus `N . d` if the point is of B;
//! - the sense of two lines, `det(q - p, a - p, b - a) + d . ((b - a) x (q - p))`.
//!
//! A zero takes the sign of the first component of the linear part that is not zero. This part
//! vanishes only for a triangle without area and for parallel lines, and neither is ever crossed.
//! All signs are those of one true position, that of B moved by `d` for every small `e`.
//!
//! Source: simulation of simplicity, Edelsbrunner and Muecke 1990. Departure: all points of one
//! surface have one shift, so the shift changes a volume by as little as it moves the body.

use nalgebra::Vector3;

use crate::base::num::double_double::{Expansion, two_sum};
use crate::base::num::sign::{self, sign};
use crate::base::pose::Operand;
use crate::base::tolerance::{SIDE_ERROR, TURN_ERROR};
use crate::nonconvex::query::triangle::Triangle;

/// Returns the sign of the first component of a triangle's normal that is not zero.
///
/// Returns 0 for a triangle without area.
pub(super) fn first_of_normal([a, b, c]: &Triangle) -> i32 {
    let component = |axis: usize| sign(sign::turn(axis, a, b, c));
    (0..3).map(component).find(|s| *s != 0).unwrap_or(0)
}

/// The plane of a triangle, for the signs that rounding leaves without doubt.
pub(super) struct Facet {
    corner: Vector3<f64>,
    /// The normal, up to rounding, and the sums of the absolute products of which it consists.
    normal: Vector3<f64>,
    size: Vector3<f64>,
}

impl Facet {
    pub(super) fn new(corners: &Triangle) -> Self {
        let (u, v) = (corners[1] - corners[0], corners[2] - corners[0]);
        let size = |i: usize, j: usize| (u[i] * v[j]).abs() + (u[j] * v[i]).abs();
        Self {
            corner: corners[0],
            normal: u.cross(&v),
            size: Vector3::new(size(1, 2), size(2, 0), size(0, 1)),
        }
    }

    /// Returns the side of a point if rounding leaves no doubt, else 0.
    #[inline]
    pub(super) fn side(&self, p: &Vector3<f64>) -> i32 {
        let apart = p - self.corner;
        let height = self.normal.dot(&apart);
        // Nothing underflows, because coordinates are multiples of `2^-357`.
        let bound = SIDE_ERROR * self.size.dot(&apart.abs());
        i32::from(height > bound) - i32::from(height < -bound)
    }
}

/// Returns the side of a point at a triangle of the other surface: 1 in front of it, -1 behind.
///
/// `of` is the body of the triangle, `first` the sign of the first component of its normal. Returns
/// 0 if and only if the triangle has no area.
#[inline]
pub(super) fn side(p: &Vector3<f64>, t: &Triangle, of: Operand, first: impl FnOnce() -> i32) -> i32 {
    let [a, b, c] = t;
    // Equal points are a tie without arithmetic.
    let found = if p == a || p == b || p == c {
        0
    } else {
        sign(sign::side(a, b, c, p))
    };
    match (found, of) {
        (0, Operand::A) => first(),
        (0, Operand::B) => -first(),
        _ => found,
    }
}

/// Returns the sense in which a line of A from `p` to `q` passes a line of B from `a` to `b`.
///
/// Returns 0 only for parallel lines.
#[inline]
pub(super) fn sense([p, q]: [&Vector3<f64>; 2], [a, b]: [&Vector3<f64>; 2]) -> i32 {
    let found = if p == a || p == b || q == a || q == b {
        0
    } else {
        sign(sign::side(p, q, a, b))
    };
    if found != 0 {
        return found;
    }
    let component = |k: usize| component_of_cross([a, b], [p, q], (k + 1) % 3, (k + 2) % 3);
    (0..3).map(component).find(|s| *s != 0).unwrap_or(0)
}

/// Returns the sign of `(b - a)_i (q - p)_j - (b - a)_j (q - p)_i`.
fn component_of_cross([a, b]: [&Vector3<f64>; 2], [p, q]: [&Vector3<f64>; 2], i: usize, j: usize) -> i32 {
    let (x, y) = ((b[i] - a[i]) * (q[j] - p[j]), (b[j] - a[j]) * (q[i] - p[i]));
    let size = x.abs() + y.abs();
    // A product is zero only if a difference is zero exactly.
    if (x - y).abs() > TURN_ERROR * size || size == 0.0 {
        return sign(x - y);
    }
    let mut sum = Expansion::<16>::new();
    let mut add = |[a, b]: [f64; 2], [p, q]: [f64; 2], sense: f64| {
        let (u, v) = (two_sum(b, -a), two_sum(q, -p));
        for x in [u.0, u.1] {
            for y in [v.0, v.1] {
                sum.add_product(sense * x, y);
            }
        }
    };
    add([a[i], b[i]], [p[j], q[j]], 1.0);
    add([a[j], b[j]], [p[i], q[i]], -1.0);
    sum.sign()
}
