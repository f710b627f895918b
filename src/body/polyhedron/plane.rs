//! Supporting planes of faces: a unit normal that is accurate to about the last bit, and an offset
//! that provably bounds the body.

use nalgebra::Vector3;

use crate::base::num::double_double::{DoubleDouble, Expansion, two_sum};
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::{Scalar, sqrt};
use crate::base::tolerance::{CROSS_CANCELLED, PLANE_OFFSET};
use crate::body::polyhedron::Plane;
use crate::body::polyhedron::build::cloud::{exponent_of, power_of_two};

/// Returns three vertices of a face far from collinear: all triples of an exactly planar face span
/// one plane.
pub(crate) fn widest_corners(points: &[Vector3<f64>], rim: &[u32]) -> [u32; 3] {
    let at = |v: u32| points[v as usize];
    if let [a, b, c] = *rim {
        return [a, b, c];
    }
    let a = rim[0];
    // Largest coordinates, not squares: squares of the smallest faces would underflow.
    let b = most(&rim[1..], |v| (at(v) - at(a)).amax());
    let chord = at(b) - at(a);
    let c = most(&rim[1..], |v| chord.cross(&(at(v) - at(a))).amax());
    let place = |v: u32| rim.iter().position(|&r| r == v);
    if place(b) < place(c) { [a, b, c] } else { [a, c, b] }
}

/// Returns the first vertex of the largest measure.
fn most(rim: &[u32], measure: impl Fn(u32) -> f64) -> u32 {
    let better = |best: (u32, f64), v: u32| {
        let m = measure(v);
        if m > best.1 { (v, m) } else { best }
    };
    rim.iter().copied().fold((0, f64::NEG_INFINITY), better).0
}

/// Returns the plane through three points of a body, and twice the area of the triangle. All
/// vertices of the body must lie within `radius` of the stored origin and exactly below the plane.
///
/// For a vertex x and the true normal N, `N . (x - a) <= 0` exactly; the stored normal n differs by
/// at most `NORMAL_ERROR`, so `n . x <= n . a + NORMAL_ERROR |x - a|`, and
/// `|x - a| <= radius + |a|`. No search is needed.
pub(crate) fn plane(a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>, radius: f64) -> (Plane, f64) {
    let (cross, exponent) = cross(a, b, c);
    let squares = cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2];
    let area = sqrt(squares.value()) * power_of_two(exponent);
    if area == 0.0 {
        return (
            Plane {
                normal: Vector3::zeros(),
                offset: 0.0,
            },
            0.0,
        );
    }
    let inverse = inverse_root(squares);
    let parallel_to_axis = cross.iter().filter(|x| x.value() != 0.0).count() == 1;
    let normal = Vector3::from_fn(|k, _| {
        let x = cross[k];
        if parallel_to_axis {
            x.value().signum() * (x.value() != 0.0) as u8 as f64
        } else {
            (x * inverse).value()
        }
    });
    if parallel_to_axis {
        return (
            Plane {
                normal,
                offset: normal.dot(a),
            },
            area,
        );
    }
    let reach = radius + a.norm();
    let slack = reach * PLANE_OFFSET;
    let at = |k: usize| DoubleDouble::product(normal[k], a[k]);
    let offset = at(0) + at(1) + at(2) + DoubleDouble::from(slack);
    (
        Plane {
            normal,
            offset: offset.value().next_up(),
        },
        area,
    )
}

/// Returns `1 / sqrt(x)` in double-double: a Newton step past the f64 value.
fn inverse_root(x: DoubleDouble) -> DoubleDouble {
    let y = 1.0 / sqrt(x.value());
    let rest = DoubleDouble::from(1.0) - x * DoubleDouble::product(y, y);
    DoubleDouble::sum(y, 0.5 * y * rest.value())
}

/// Returns `(b - a) x (c - a)` times a power of two, in double-double, and the exponent that undoes
/// the power.
///
/// The product is taken at the vertex opposite the longest edge, which keeps the terms small.
fn cross(a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>) -> ([DoubleDouble; 3], i32) {
    let (ab, bc, ca) = ((b - a).norm_squared(), (c - b).norm_squared(), (a - c).norm_squared());
    let (a, b, c) = if ab >= bc && ab >= ca {
        (c, a, b)
    } else if ca >= bc {
        (b, c, a)
    } else {
        (a, b, c)
    };
    let ((u, i), (v, j)) = (edge(a, b), edge(a, c));
    let mut exponent = i + j;
    let mut size = 0.0f64;
    let mut cross = [DoubleDouble::default(); 3];
    for k in 0..3 {
        let (p, q) = (u[(k + 1) % 3] * v[(k + 2) % 3], u[(k + 2) % 3] * v[(k + 1) % 3]);
        size = size.larger(p.value().abs()).larger(q.value().abs());
        cross[k] = p - q;
    }
    let largest = |x: &[DoubleDouble; 3]| x.iter().fold(0.0f64, |m, x| m.larger(x.value().abs()));
    if largest(&cross) < CROSS_CANCELLED * size {
        cross =
            core::array::from_fn(|k| exact_difference(u[(k + 1) % 3], v[(k + 2) % 3], u[(k + 2) % 3], v[(k + 1) % 3]));
    }
    let most = largest(&cross);
    if most > 0.0 {
        let k = exponent_of(most);
        let scale = power_of_two(-k);
        cross = cross.each(|x| DoubleDouble {
            hi: x.hi * scale,
            lo: x.lo * scale,
        });
        exponent += k;
    }
    (cross, exponent)
}

/// Returns `b - a` exactly, times the power of two that brings the largest coordinate into [1, 2).
fn edge(a: &Vector3<f64>, b: &Vector3<f64>) -> ([DoubleDouble; 3], i32) {
    let k = exponent_of((b - a).amax());
    let scale = power_of_two(-k);
    let part = |i: usize| {
        let (hi, lo) = two_sum(b[i], -a[i]);
        DoubleDouble {
            hi: hi * scale,
            lo: lo * scale,
        }
    };
    ([part(0), part(1), part(2)], k)
}

/// Returns `a b - c d` with one rounding to double-double.
fn exact_difference(a: DoubleDouble, b: DoubleDouble, c: DoubleDouble, d: DoubleDouble) -> DoubleDouble {
    let mut sum = Expansion::<16>::new();
    for (x, y) in [(a, b), (-c, d)] {
        for (x, y) in [(x.hi, y.hi), (x.hi, y.lo), (x.lo, y.hi), (x.lo, y.lo)] {
            sum.add_product(x, y);
        }
    }
    let parts = sum.parts().iter();
    parts.fold(DoubleDouble::default(), |sum, &part| sum + DoubleDouble::from(part))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::tolerance::UNIT;
    use crate::body::polyhedron::solids;
    use alloc::vec::Vec;

    #[test]
    fn cancelled_products_are_exact() {
        let tiny = 2f64.powi(-60);
        let a = DoubleDouble::sum(1.0, tiny);
        let b = DoubleDouble::sum(1.0, -tiny);
        // (1 + t)(1 - t) - 1 = -t^2
        let x = exact_difference(a, b, DoubleDouble::from(1.0), DoubleDouble::from(1.0));
        assert_eq!((x.hi, x.lo), (-tiny * tiny, 0.0));
    }

    #[test]
    fn normals_of_slivers_are_right() {
        let a = Vector3::new(0.0, 0.0, 0.0);
        let b = Vector3::new(1.0, 1.0, 1.0);
        let c = Vector3::new(1.0, 1.0 + f64::EPSILON, 1.0);
        let (p, area) = plane(&a, &b, &c, 2.0);
        let root = 0.5f64.sqrt();
        assert!((p.normal - Vector3::new(-root, 0.0, root)).amax() < 2e-16, "{p:?}");
        assert!((area / f64::EPSILON - 2f64.sqrt()).abs() < 1e-15);
        assert!(p.offset > 0.0 && p.offset < 1e-15);
        let (p, _) = plane(&a, &Vector3::new(0.0, 1.0, 0.0), &Vector3::new(1e-300, 0.0, 0.0), 2.0);
        assert_eq!((p.normal, p.offset), (Vector3::new(0.0, 0.0, -1.0), 0.0));
    }

    /// Returns `n . x - offset`, exactly, to the nearest f64.
    fn excess(plane: &Plane, x: &Vector3<f64>) -> f64 {
        let mut sum = Expansion::<7>::new();
        for k in 0..3 {
            sum.add_product(plane.normal[k], x[k]);
        }
        sum.add(-plane.offset);
        sum.parts().last().copied().unwrap_or(0.0)
    }

    #[test]
    fn planes_bound_every_vertex_exactly_and_tightly() {
        let mut bodies = Vec::new();
        for (seed, z) in [1.0, 0.1, 1e-3, 1e-6, 1e-12].into_iter().enumerate() {
            bodies.push(solids::random_hull(300, Vector3::new(1.0, 0.7, z), seed as u64).unwrap());
            bodies.push(solids::random_hull(40, Vector3::new(1.0, z, z), seed as u64).unwrap());
        }
        bodies.push(solids::prism(100, 0.1, 3.0).unwrap());
        bodies.push(solids::cone(64, 5e-10, 1.0).unwrap());
        bodies.push(solids::dodecahedron(2.0).unwrap());
        for body in &bodies {
            for plane in &body.planes {
                let worst = body
                    .points
                    .iter()
                    .map(|x| excess(plane, x))
                    .fold(f64::NEG_INFINITY, f64::max);
                assert!(
                    worst <= 0.0 && worst >= -5.0 * UNIT * body.radius,
                    "{worst:e} for {}",
                    body.report()
                );
                assert!((plane.normal.norm() - 1.0).abs() < 4.0 * UNIT);
            }
            assert!(body.points.iter().all(|p| p.norm() <= body.radius));
        }
        let cube = solids::cuboid(Vector3::new(0.1, 0.2, 0.3)).unwrap();
        assert!(
            cube.planes
                .iter()
                .all(|p| p.offset == p.normal.abs().dot(&Vector3::new(0.1, 0.2, 0.3)))
        );
    }
}
