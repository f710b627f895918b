//! Exact orientation signs of points, by the adaptive predicates of Shewchuk (1997) in the crate
//! `robust`.
//!
//! Exact as long as no product of three coordinate differences leaves the range of f64, which the
//! stored coordinates of a body guarantee (see `cloud`).

use nalgebra::Vector3;
use robust::{Coord, Coord3D};

#[inline]
fn coord(p: &Vector3<f64>) -> Coord3D<f64> {
    Coord3D { x: p.x, y: p.y, z: p.z }
}

/// Returns a positive number if `p` lies above the plane of `a, b, c`, which turn counter-clockwise
/// seen from above; 0 on the plane.
#[inline]
pub(crate) fn side(a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>, p: &Vector3<f64>) -> f64 {
    -robust::orient3d(coord(a), coord(b), coord(c), coord(p))
}

/// Returns a positive number if `a, b, c` turn counter-clockwise in the projection along `axis`,
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
