//! Unit directions and triangle normals at every magnitude.

use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::{Scalar, Vec3, cross, dot, root, sub};
use crate::base::tolerance::SQUARE_MIN;

/// Returns the unit vector along `v`; zero if `v` has no direction.
#[inline]
pub(super) fn unit<T: Scalar>(v: &Vec3<T>) -> Vec3<T> {
    let squared = dot(v, v);
    if squared.value() > SQUARE_MIN && squared.value() < 1.0 / SQUARE_MIN {
        let by = T::from(1.0) / root(squared);
        return v.map(|x| x * by);
    }
    let largest = v.iter().fold(0.0f64, |m, x| m.larger(x.value().abs()));
    if !(largest > 0.0 && largest < f64::INFINITY) {
        return [T::from(0.0); 3];
    }
    let v = v.map(|x| x / T::from(largest));
    let norm = root(dot(&v, &v));
    v.map(|x| x / norm)
}

/// Returns the least height of three points along a direction.
#[inline]
pub(super) fn min_height<T: Scalar>(n: &Vec3<T>, w: &[Vec3<T>; 3]) -> T {
    let h = w.map(|w| dot(n, &w));
    let low = if h[1] < h[0] { h[1] } else { h[0] };
    if h[2] < low { h[2] } else { low }
}

/// Returns the unit normal of a triangle, from the two shorter edges.
#[inline]
pub(super) fn normal<T: Scalar>(w: &[Vec3<T>; 3]) -> Vec3<T> {
    let edges = [sub(&w[1], &w[0]), sub(&w[2], &w[1]), sub(&w[0], &w[2])];
    let length = edges.map(|e| dot(&e, &e).value());
    let (u, v) = if length[0] >= length[1] && length[0] >= length[2] {
        (&edges[1], &edges[2])
    } else if length[1] >= length[2] {
        (&edges[2], &edges[0])
    } else {
        (&edges[0], &edges[1])
    };
    let n = cross(u, v);
    // The product of the shortest edges may underflow.
    if dot(&n, &n).value() > SQUARE_MIN {
        return unit(&n);
    }
    let by_size = |e: &Vec3<T>| {
        let m = e.iter().fold(0.0f64, |m, x| m.larger(x.value().abs()));
        if m > 0.0 { e.map(|x| x / T::from(m)) } else { *e }
    };
    unit(&cross(&by_size(u), &by_size(v)))
}
