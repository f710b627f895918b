//! Transforms of the nodes of COLLADA and glTF: affine maps as matrices of three rows and four
//! columns.

use std::f64::consts::PI;

/// An affine map: the last column is the translation.
pub(crate) type Matrix = [[f64; 4]; 3];

pub(crate) const IDENTITY: Matrix = scaling([1.0; 3]);

pub(crate) const fn scaling([x, y, z]: [f64; 3]) -> Matrix {
    [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0]]
}

pub(crate) const fn translation([x, y, z]: [f64; 3]) -> Matrix {
    [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]]
}

/// Returns the matrix of 16 numbers, row by row; `None` if the last row is not `0 0 0 1`.
pub(crate) fn from_rows(numbers: &[f64]) -> Option<Matrix> {
    let [x, y, z, last] = numbers.as_chunks::<4>().0 else {
        return None;
    };
    (*last == [0.0, 0.0, 0.0, 1.0]).then_some([*x, *y, *z])
}

/// Returns the map that applies `b` first and then `a`.
pub(crate) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let mut all = [[0.0; 4]; 3];
    for (row, out) in a.iter().zip(&mut all) {
        for (k, entry) in out.iter_mut().enumerate() {
            *entry = row[0] * b[0][k] + row[1] * b[1][k] + row[2] * b[2][k];
        }
        out[3] += row[3];
    }
    all
}

pub(crate) fn apply(m: &Matrix, [x, y, z]: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * x + row[1] * y + row[2] * z + row[3])
}

/// Least absolute value of [`orientation`] of a map that does not flatten; less is rounding.
pub(crate) const FLAT: f64 = 1e-14;

/// Returns the determinant, up to a positive factor: a negative sign is a mirror, zero is a map that
/// flattens. `NaN` if an entry is not finite.
pub(crate) fn orientation(m: &Matrix) -> f64 {
    // Rows are scaled to one, because products of very large or small numbers are lost.
    let [a, b, c] = m.map(|row| {
        let largest = largest([row[0], row[1], row[2]]);
        let scale = if largest > 0.0 { largest } else { 1.0 };
        [row[0] / scale, row[1] / scale, row[2] / scale]
    });
    if m.iter().flatten().all(|x| x.is_finite()) {
        dot(a, cross(b, c))
    } else {
        f64::NAN
    }
}

/// Returns the rotation about an axis by an angle in degrees; `None` for an axis of length zero.
///
/// For a quarter turn its entries are closer to whole numbers than those of a quaternion.
pub(crate) fn rotation(axis: [f64; 3], degrees: f64) -> Option<Matrix> {
    let u = unit(axis)?;
    let (sine, cosine) = libm::sincos(degrees.to_radians());
    let rest = 1.0 - cosine;
    let diagonal = u.map(|x| x * x + (1.0 - x * x) * cosine);
    let [xy, xz, yz] = [u[0] * u[1] * rest, u[0] * u[2] * rest, u[1] * u[2] * rest];
    let s = u.map(|x| x * sine);
    Some([
        [diagonal[0], xy - s[2], xz + s[1], 0.0],
        [xy + s[2], diagonal[1], yz - s[0], 0.0],
        [xz - s[1], yz + s[0], diagonal[2], 0.0],
    ])
}

/// Returns the rotation of a quaternion `x y z w` of any length; `None` for the length zero.
pub(crate) fn from_quaternion(q: [f64; 4]) -> Option<Matrix> {
    let square: f64 = q.iter().map(|x| x * x).sum();
    if !(square > 0.0 && square.is_finite()) {
        return None;
    }
    let [x, y, z, w] = q;
    let s = 2.0 / square;
    Some([
        [1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y), 0.0],
        [s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x), 0.0],
        [s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y), 0.0],
    ])
}

/// Returns the pose of an eye that looks along -z at a point, with y up; `None` if the eye is at
/// the point, or looks along `up`.
pub(crate) fn look_at(eye: [f64; 3], at: [f64; 3], up: [f64; 3]) -> Option<Matrix> {
    let back = unit(subtract(eye, at))?;
    let right = unit(cross(unit(up)?, back))?;
    let up = cross(back, right);
    let row = |k: usize| [right[k], up[k], back[k], eye[k]];
    Some([row(0), row(1), row(2)])
}

/// Returns the shear that turns the direction `turned` by an angle in degrees towards `along` by
/// moving points parallel to `along`, as in RenderMan; `None` if the two are not perpendicular, or
/// the angle is 90 degrees or more.
pub(crate) fn skew(degrees: f64, turned: [f64; 3], along: [f64; 3]) -> Option<Matrix> {
    let (d, e) = (unit(turned)?, unit(along)?);
    let angle = degrees.to_radians();
    if !(dot(d, e).abs() < 1e-6 && angle.abs() < 0.5 * PI) {
        return None;
    }
    let (sine, cosine) = libm::sincos(angle);
    let mut all = IDENTITY;
    for (row, e) in all.iter_mut().zip(e) {
        for (entry, d) in row.iter_mut().zip(d) {
            *entry += sine / cosine * e * d;
        }
    }
    Some(all)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Returns the largest absolute value of a vector.
fn largest(v: [f64; 3]) -> f64 {
    let larger = |most: f64, x: f64| if x > most { x } else { most };
    v.map(f64::abs).into_iter().fold(0.0, larger)
}

/// Returns the vector of length one; `None` for the zero vector.
fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let largest = largest(v);
    if largest == 0.0 {
        return None;
    }
    // Squares of very large or small numbers are lost.
    let v = v.map(|x| x / largest);
    let length = dot(v, v).sqrt();
    Some(v.map(|x| x / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: [f64; 3], b: [f64; 3]) -> bool {
        subtract(a, b).iter().all(|x| x.abs() < 1e-12)
    }

    #[test]
    fn a_quarter_turn_about_z_moves_x_to_y() {
        for axis in [[0.0, 0.0, 1.0], [0.0, 0.0, 1e-200], [0.0, 0.0, 1e200]] {
            let turn = rotation(axis, 90.0).expect("an axis");
            assert!(near(apply(&turn, [1.0, 0.0, 5.0]), [0.0, 1.0, 5.0]));
        }
        assert_eq!(rotation([0.0; 3], 90.0), None);
    }

    #[test]
    fn a_rotation_about_any_axis_keeps_the_axis_and_lengths() {
        for k in 0..200 {
            let f = f64::from(k);
            let axis = [libm::sin(1.1 * f), libm::cos(0.7 * f), libm::sin(0.3 * f)];
            let turn = rotation(axis, 37.0 * f).expect("an axis");
            let p = [libm::cos(f), libm::sin(f), 0.5];
            assert!(near(apply(&turn, axis), axis));
            assert!((dot(apply(&turn, p), apply(&turn, p)) - dot(p, p)).abs() < 1e-12);
            assert!(orientation(&turn) > 0.0);
            let twice = product(&turn, &turn);
            let expected = rotation(axis, 74.0 * f).expect("an axis");
            assert!(near(apply(&twice, p), apply(&expected, p)));
        }
    }

    #[test]
    fn a_quaternion_of_any_length_is_its_rotation() {
        for k in 1..100 {
            let degrees = 3.6 * f64::from(k);
            let (sine, cosine) = libm::sincos(0.5 * degrees.to_radians());
            let scale = 0.01 * f64::from(k);
            let q = [2.0 / 3.0, -2.0 / 3.0, 1.0 / 3.0, 0.0].map(|x| x * sine * scale);
            let turn = from_quaternion([q[0], q[1], q[2], cosine * scale]).expect("a rotation");
            let expected = rotation([2.0, -2.0, 1.0], degrees).expect("an axis");
            assert!(near(apply(&turn, [1.0, 2.0, 3.0]), apply(&expected, [1.0, 2.0, 3.0])));
        }
        assert_eq!(from_quaternion([0.0; 4]), None);
    }

    #[test]
    fn an_eye_stands_at_its_position_and_looks_along_its_negative_z() {
        let pose = look_at([1.0, 2.0, 3.0], [1.0, 2.0, 8.0], [0.0, 4.0, 1.0]).expect("a pose");
        assert!(near(apply(&pose, [0.0; 3]), [1.0, 2.0, 3.0]));
        assert!(near(apply(&pose, [0.0, 0.0, -5.0]), [1.0, 2.0, 8.0]));
        assert!(near(apply(&pose, [0.0, 1.0, 0.0]), [1.0, 3.0, 3.0]));
        assert!(orientation(&pose) > 0.0);
        assert_eq!(look_at([1.0; 3], [1.0; 3], [0.0, 1.0, 0.0]), None);
        assert_eq!(look_at([0.0; 3], [0.0, 2.0, 0.0], [0.0, 1.0, 0.0]), None);
    }

    #[test]
    fn a_skew_of_45_degrees_moves_x_by_y() {
        let shear = skew(45.0, [0.0, 2.0, 0.0], [3.0, 0.0, 0.0]).expect("a shear");
        assert!(near(apply(&shear, [1.0, 2.0, 3.0]), [3.0, 2.0, 3.0]));
        assert_eq!(skew(90.0, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]), None);
        assert_eq!(skew(45.0, [1.0, 1.0, 0.0], [1.0, 0.0, 0.0]), None);
    }

    #[test]
    fn the_orientation_of_extreme_scales_is_known() {
        assert!(orientation(&scaling([1e-200, 1e200, 1e-200])) > 0.0);
        assert!(orientation(&scaling([1e-200, -1e-200, 1e-200])) < 0.0);
        assert!(orientation(&scaling([1.0, 0.0, 1.0])) == 0.0);
        assert!(orientation(&scaling([1.0, f64::INFINITY, 1.0])).is_nan());
    }
}
