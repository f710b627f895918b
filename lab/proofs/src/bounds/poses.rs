//! Relative poses: the certificate, boxes, balls.

use super::{Bound, once, root, units};
use crate::factor::{Factor, Positive};
use crate::kernels::poses;
use crate::majorant::{DOUBLE, Majorant, SINGLE, power, rounding, unit};
use crate::norm::length;
use crate::number::{Number, Vector, cross, dot, named, sum};
use crate::polynomial::Polynomial;
use dashu_ratio::RBig;
use truth::rational::exact;

/// Deviation of the squared norm of a pose from one (`POSE_UNIT`), and room for its rounding.
fn off_unit() -> RBig {
    exact(1.01e-12)
}

fn exactly<const K: usize>(letter: char) -> [Majorant; K] {
    Majorant::vector(letter, &RBig::ZERO)
}

fn size(vector: &[Majorant], lengths: &[(char, RBig)]) -> RBig {
    let errors: Vec<&Polynomial> = vector.iter().map(|x| x.error()).collect();
    length(&errors, lengths)
}

pub(super) fn bounds() -> Vec<Bound> {
    let whole = Bound::whole;
    let certificate = |error, kernel, part, allowed| whole("CERTIFICATE", kernel, error).part(part, allowed);
    vec![
        certificate(quaternion(), "num::packed::quotient", "1, quaternion", 8.0),
        certificate(squared_norm(), "pose::PoseBits::of", "1, a squared norm", 4.0),
        certificate(factor(), "pose::packed_rotation", "2, factor", 11.0),
        certificate(entries(), "num::packed::of", "2, matrix", 19.0),
        certificate(rotation(), "pose::packed_rotation", "1 and 2, rotation", 71.0),
        certificate(translation(), "pose::rotated_to_a", "3, translation", 31.0),
        certificate(product(), "num::packed::combined", "4, product", 6.0),
        whole("BOX", "polyhedron::bounds", boxed()),
        whole("PLACED_PIVOT", "nalgebra turn", turned()).part("rounding", 24.0),
        // A quaternion off unit length by x in the square turns wrong by twice as much; twice, with one difference.
        whole(
            "PLACED_PIVOT",
            "motion::steady::pose",
            RBig::from(2) * (units(52.0) + turned() + unit()),
        ),
        // Off unit length by 2.5 roundings, which are common, and by one of each coordinate; then the sum.
        whole(
            "CENTRE",
            "scene::ball::at",
            exact(4.0) * units(2.51) + root(20) * unit() + turned() + unit(),
        ),
        whole("BOX_TURNED", "polyhedron::bounds", boxed() + units(24.0)),
        Bound::single("BOX_SCANNED", "polyhedron::aabb::Scan", scanned()),
        whole("DISPLACEMENT", "motion::way", displacement_by_radius()).case("per radius"),
        whole("DISPLACEMENT", "motion::way", displacement_by_middle()).case("per middle"),
        whole("DISPLACEMENT", "motion::way", displacement_by_distance()).case("per distance"),
        whole("SLAB_HEIGHT", "nonconvex::placed", along_axis()),
        whole("TILT", "separation::plane", tilt()),
    ]
}

/// The product of two quaternions of length one.
fn quaternion() -> RBig {
    quaternion_of(poses::quotient)
}

/// Of one way to write it.
pub(super) fn quaternion_of(of: impl Fn([Majorant; 4], [Majorant; 4]) -> [Majorant; 4]) -> RBig {
    size(&of(exactly('a'), exactly('b')), &[])
}

/// The sum of four squares, relative to itself.
pub(super) fn squared_norm() -> RBig {
    let square = || Factor::input().squared();
    ((square() + square()) + (square() + square())).error()
}

/// The factor `2 (2 - |a|^2) (2 - |b|^2)` against `2 / (|a|^2 |b|^2)`: `(2 - x) x = 1 - (1 - x)^2`.
fn factor() -> RBig {
    let inverse = &squared_norm() + once() * (RBig::ONE + off_unit() * RBig::from(2)) + off_unit() * off_unit();
    let inverse = inverse * (RBig::ONE + RBig::from(3) * off_unit());
    let both = (RBig::ONE + &inverse) * (RBig::ONE + inverse) - RBig::ONE;
    (RBig::ONE + both) * (RBig::ONE + once()) - RBig::ONE
}

/// The entries of the matrix of a unit quaternion for a given factor, times a unit vector. The Frobenius norm of the
/// matrix is the root of three.
pub(super) fn entries() -> RBig {
    entries_of(&poses::matrix(exactly('q'), Majorant::exact(2.0)))
}

/// Of one way to write them.
pub(super) fn entries_of(rows: &[Vector<Majorant>; 3]) -> RBig {
    let turned = rows.map(|row| {
        (0..3u8).fold(Polynomial::default(), |total, k| {
            let v = Polynomial::variable('v', k);
            total.plus(&row[k as usize].error().times(&v))
        })
    });
    // The last roundings are relative to the entries: one matrix of nine, as a vector.
    let matrix = |row: &Polynomial, i: u8| {
        let entry = |k| Polynomial::variable('m', 3 * i + k);
        ['i', 'j', 'k'].iter().fold(row.clone(), |p, c| p.with(*c, entry))
    };
    let turned = [0, 1, 2].map(|i| matrix(&turned[i], i as u8));
    length(&turned.each_ref(), &[('m', root(3))])
}

/// The matrix of a relative pose against the exact rotation, as a spectral norm.
///
/// With `k = s |q|^2 / 2` the matrix is `(1 - k) I + k R`, and `|R - I| <= 2`: an error of s counts twice, one of q
/// twice at right angles to q and four times along it. Poses are unit up to `POSE_UNIT`.
pub fn rotation() -> RBig {
    let off = RBig::from(2) * factor() + root(20) * quaternion() + entries();
    off * (RBig::ONE + exact(1e-11)) + units(1000.0) * unit()
}

/// A matrix of a rotation times a vector of length one.
pub fn product() -> RBig {
    product_in(DOUBLE)
}

/// The same in a precision.
pub fn product_in(precision: u32) -> RBig {
    let exactly = |c| [0, 1, 2].map(|k| Majorant::input_in(precision, c, k, &RBig::ZERO));
    let m = ['i', 'j', 'k'].map(exactly);
    let image = poses::product(m, exactly('v')).map(|x| x.error().clone());
    let one_matrix = |k: usize| {
        ['i', 'j', 'k'].iter().fold(image[k].clone(), |p, c| {
            p.with(*c, |j| Polynomial::variable('m', 3 * k as u8 + j))
        })
    };
    let image = [0, 1, 2].map(one_matrix);
    length(&image.each_ref(), &[('m', root(3))])
}

/// An offset of length one in A's frame: the factor errs by the squared norm and a difference.
pub(super) fn translation() -> RBig {
    let offset = Majorant::vector('o', &once());
    let two = Polynomial::constant(RBig::from(2));
    let off = squared_norm() + once() * (RBig::ONE + off_unit() * RBig::from(2)) + off_unit() * off_unit();
    let factor = Majorant::with_error(53, two.clone(), two.scaled(&off));
    let error = size(
        &poses::rotated_to_a(exactly('q'), offset, factor),
        &[('f', RBig::from(2))],
    );
    error * (RBig::ONE + exact(1e-11))
}

/// A vector of length one times a unit quaternion of nalgebra.
pub(super) fn turned() -> RBig {
    let two = RBig::from(2);
    let r = poses::turned(exactly('q'), exactly('v'));
    size(&r, &[('g', two.clone()), ('h', two)])
}

/// A row of a matrix whose factor errs by the squared norm and a quotient, times a vertex, and two sums.
fn boxed() -> RBig {
    RBig::from(2) * units(4.01) + entries() + product() + units(2.0)
}

/// A row of a matrix and a vertex, both rounded to single precision, relative to the absolute terms, which sum up to no
/// more than the radius; the matrix in double precision is off by far less than a tenth of a rounding.
fn scanned() -> RBig {
    let off = rounding(SINGLE);
    let vector = |c| [0, 1, 2].map(|k| Majorant::input_in(SINGLE, c, k, &off));
    dot(vector('m'), vector('v')).relative() + units(64.0)
}

/// The difference of two rotations by the Frobenius norm, over the root of two; norms and sums err by four of twice
/// the value.
fn displacement_by_radius() -> RBig {
    root(6) * rotation() + units(8.0)
}

/// A posed middle at each of two poses.
fn displacement_by_middle() -> RBig {
    RBig::from(2) * (rotation() + product() + unit()) + units(8.0)
}

/// The distance of the origins at one of the poses.
fn displacement_by_distance() -> RBig {
    rotation() + product() + translation() + units(6.0)
}

/// A height along a rounded axis that may be longer than one by four roundings, and twice that: a point of three.
fn along_axis() -> RBig {
    let height = dot(exactly('n'), exactly('p'));
    let longer = RBig::ONE + units(4.0);
    length(&[height.error()], &[]) * &longer + units(4.0) + power(-100)
}

/// The length of a cross product of a unit vector with a difference of two.
fn tilt() -> RBig {
    let difference = sum(exactly('w'), exactly('v'));
    let difference = named('d', difference);
    let c: Vector<Majorant> = named('c', cross(exactly('n'), difference));
    size(&c, &[('w', RBig::ONE), ('v', RBig::ONE)]) + units(4.0)
}
