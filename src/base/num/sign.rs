//! Signs of dot products (if rounding leaves no doubt, or exactly), and exact orientation signs of
//! points.
//!
//! The orientation signs use the adaptive predicates of Shewchuk (1997) in the crate `robust`.
//!
//! They are exact if no product of three coordinate differences leaves the range of f64, which the
//! stored coordinates of a body guarantee (see `cloud`).

use nalgebra::Vector3;
use robust::{Coord, Coord3D};

use crate::base::num::double_double::Expansion;
use crate::base::num::scalar::Scalar;
use crate::base::tolerance::{EDGE_SIGN, LEAST_RISE};

#[inline]
fn coord(p: &Vector3<f64>) -> Coord3D<f64> {
    Coord3D { x: p.x, y: p.y, z: p.z }
}

/// Returns a positive number if `p` lies above the plane of `a, b, c`, and 0 on the plane.
///
/// Above is the side from which `a, b, c` are counter-clockwise.
#[inline]
pub(crate) fn side(a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>, p: &Vector3<f64>) -> f64 {
    -robust::orient3d(coord(a), coord(b), coord(c), coord(p))
}

/// Returns a positive number if `a, b, c` are counter-clockwise in the projection along `axis`,
/// seen from its positive end.
#[inline]
pub(crate) fn turn(axis: usize, a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>) -> f64 {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let flat = |p: &Vector3<f64>| Coord { x: p[u], y: p[v] };
    robust::orient2d(flat(a), flat(b), flat(c))
}

/// Returns an axis along which `a, b, c` project to a triangle; `None` if exactly collinear.
pub(crate) fn projection(a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>) -> Option<usize> {
    (0..3).find(|&axis| turn(axis, a, b, c) != 0.0)
}

/// Returns the sign of `n . e` if rounding leaves no doubt, else 0.
///
/// `e` must be a rounded difference of two stored points.
#[inline]
pub(crate) fn edge_sign(n: &Vector3<f64>, e: &Vector3<f64>) -> i32 {
    let (value, bound) = rise(n, e);
    i32::from(value > bound) - i32::from(value < -bound)
}

/// Returns `n . e`, and the bound of its error.
#[inline(always)]
pub(crate) fn rise(n: &Vector3<f64>, e: &Vector3<f64>) -> (f64, f64) {
    let (x, y, z) = (n.x * e.x, n.y * e.y, n.z * e.z);
    (x + y + z, EDGE_SIGN * (x.abs() + y.abs() + z.abs()) + LEAST_RISE)
}

/// Returns the sign of a number: -1, 0 or 1.
pub(crate) fn sign(x: f64) -> i32 {
    i32::from(x > 0.0) - i32::from(x < 0.0)
}

/// Returns whether each product of `n . e` has a factor of zero, so that the sum is zero exactly.
#[inline]
pub(crate) fn is_level<T: Scalar>(n: &[T; 3], e: &[T; 3]) -> bool {
    n.iter().zip(e).all(|(x, y)| x.value() == 0.0 || y.value() == 0.0)
}

/// Returns `n . e` and the sum of the magnitudes of its terms.
#[inline]
pub(crate) fn dot_and_size<T: Scalar>(n: &[T; 3], e: &[T; 3]) -> (T, f64) {
    let terms = [n[0] * e[0], n[1] * e[1], n[2] * e[2]];
    let size = terms.iter().fold(0.0, |s, x| s + x.value().abs());
    (terms[0] + terms[1] + terms[2], size)
}

/// Returns `n . (q - p)` without rounding, for a direction of `K` numbers per coordinate.
///
/// `N` must be `12 K`.
pub(crate) fn exact_dot<const K: usize, const N: usize>(
    n: &[[f64; K]; 3],
    p: &Vector3<f64>,
    q: &Vector3<f64>,
) -> Expansion<N> {
    let mut sum = Expansion::new();
    for k in 0..3 {
        for &part in &n[k] {
            sum.add_product(part, q[k]);
            sum.add_product(-part, p[k]);
        }
    }
    sum
}
