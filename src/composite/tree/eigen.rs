//! Axes of a spread of points.

use nalgebra::{Matrix3, Vector3};

use crate::base::num::scalar::sqrt;

/// Sweeps after which a symmetric matrix of three is diagonal to rounding: convergence is
/// quadratic. Not a matter of soundness.
const SWEEPS: usize = 6;

/// Returns the eigenvectors of a symmetric matrix as orthonormal rows by falling eigenvalue, and
/// the eigenvalues (Jacobi's rotations, 1846).
pub(super) fn axes(matrix: &Matrix3<f64>) -> ([Vector3<f64>; 3], [f64; 3]) {
    let (mut m, mut v) = (*matrix, Matrix3::identity());
    for _ in 0..SWEEPS {
        let off = m[(0, 1)].abs() + m[(0, 2)].abs() + m[(1, 2)].abs();
        if !(off > f64::EPSILON * m.trace().abs()) {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut m, &mut v, p, q);
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| m[(j, j)].total_cmp(&m[(i, i)]));
    (order.map(|k| v.column(k).into_owned()), order.map(|k| m[(k, k)]))
}

/// One rotation in the plane of axes p and q that makes their entry zero.
fn rotate(m: &mut Matrix3<f64>, v: &mut Matrix3<f64>, p: usize, q: usize) {
    let off = m[(p, q)];
    if off == 0.0 {
        return;
    }
    let theta = (m[(q, q)] - m[(p, p)]) / (2.0 * off);
    let t = 1.0 / (theta.abs() + sqrt(theta * theta + 1.0));
    let t = if theta < 0.0 { -t } else { t };
    if !t.is_finite() {
        return;
    }
    let c = 1.0 / sqrt(t * t + 1.0);
    let s = t * c;
    let r = 3 - p - q;
    let (a, b) = (m[(r, p)], m[(r, q)]);
    m[(p, p)] -= t * off;
    m[(q, q)] += t * off;
    (m[(p, q)], m[(q, p)]) = (0.0, 0.0);
    (m[(r, p)], m[(p, r)]) = (c * a - s * b, c * a - s * b);
    (m[(r, q)], m[(q, r)]) = (s * a + c * b, s * a + c * b);
    for k in 0..3 {
        let (a, b) = (v[(k, p)], v[(k, q)]);
        (v[(k, p)], v[(k, q)]) = (c * a - s * b, s * a + c * b);
    }
}
