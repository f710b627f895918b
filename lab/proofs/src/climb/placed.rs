//! Points placed by quaternions and by matrices.

use super::{Climb, UNIT, climb, divided, factor_of, length, off, relative_rotation, unit};
use crate::kernels::poses;
use crate::measured::Measured;
use crate::number::{Number, Vector, dot, scaled, sub, sum};
use crate::traced::Traced;
use crate::vectors::{Coordinates, Vectors};

type Traces = Coordinates<Traced>;

pub(super) const ALL: &[Climb] = &[
    climb("PLACED_PIVOT", "", 8, placed_pivot),
    climb("PLACED_BALL", "", 8, placed_ball),
    climb("CENTRE", "", 10, centre),
    climb("BOX_TURNED", "", 17, box_turned),
    climb("DISPLACEMENT", "per radius", 16, by_radius),
    climb("DISPLACEMENT", "per middle", 19, by_middle),
    climb("DISPLACEMENT", "per distance", 11, by_distance),
    climb("RAY", "a mesh", 17, place_on_ray),
    climb("ARM_PLACE", "", 16, arm_place),
    climb("CARRIED", "a pose", 18, carried),
    climb("PARALLEL_AXES", "with CERTIFICATE, twice", 14, parallel),
];

fn vector(x: &[f64]) -> Vector<Traced> {
    Traced::vector(x)
}

/// By how much a point is off that is placed by a quaternion as it is, and not by the rotation.
fn placed_off(q: [Traced; 4], v: Vector<Traced>, t: Vector<Traced>) -> f64 {
    let place = |q| sum(poses::turned(q, v), t);
    let (ours, truth) = (place(q.map(Measured::computed)), place(divided(q)));
    let off = [0, 1, 2].map(|k| ours[k].above(truth[k]));
    dot(off, off).sqrt()
}

/// A quaternion longer than one by so much.
fn longer(x: &[f64], by: f64) -> [Traced; 4] {
    unit::<4>(x).map(|x| Traced::input(x * (1.0 + by)))
}

/// Twice, for a quaternion whose square is off one by 26 UNIT.
fn placed_pivot(x: &[f64]) -> f64 {
    let (q, v) = (longer(x, 5.5 * UNIT * x[7]), vector(&x[4..]));
    2.0 * placed_off(q, v, vector(&[0.0; 3])) / length(v) / UNIT
}

/// For one that is off by `POSE_UNIT`.
fn placed_ball(x: &[f64]) -> f64 {
    let (q, v) = (longer(x, 0.249e-12 * x[7]), vector(&x[4..]));
    placed_off(q, v, vector(&[0.0; 3])) / length(v) / UNIT
}

fn centre(x: &[f64]) -> f64 {
    let q = divided(Traced::vector::<4>(x));
    let (c, t) = (vector(&x[4..]), vector(&x[7..]));
    off(sum(poses::turned(q, c), t)) / (length(c) + length(t)) / UNIT
}

/// A corner of a piece, which is placed itself.
fn box_turned(x: &[f64]) -> f64 {
    let of_piece = divided(Traced::vector::<4>(&x[4..]));
    let (v, place, t) = (vector(&x[8..]), vector(&x[11..]), vector(&x[14..]));
    let corner = sum(poses::turned(of_piece, v), place);
    let at = poses::product(matrix(x), corner)[0] + t[0];
    at.error.abs() / (length(v) + length(place) + length(t)) / UNIT
}

/// The matrix of one quaternion.
fn matrix(x: &[f64]) -> [Vector<Traced>; 3] {
    let q = unit::<4>(x).map(Traced::input);
    let norm = poses::squared_norm(q);
    poses::matrix(q, factor_of(&[norm], 2.0 / norm.value))
}

/// An offset in the frame of A.
fn translation(x: &[f64], offset: Vector<Traced>) -> Vector<Traced> {
    let q = unit::<4>(x).map(Traced::input);
    let norm = poses::squared_norm(q);
    poses::rotated_to_a(q, offset, factor_of(&[norm], poses::translation_factor(norm.value)))
}

fn by_radius(x: &[f64]) -> f64 {
    let (m, n) = (relative_rotation(x), relative_rotation(&x[8..]));
    let all: [Traced; 9] = std::array::from_fn(|k| m[k / 3][k % 3] - n[k / 3][k % 3]);
    let squares = all[1..].iter().fold(all[0] * all[0], |s, x| s + *x * *x);
    Number::times_power(squares, -1).root().error.abs() / UNIT
}

fn by_middle(x: &[f64]) -> f64 {
    let c = vector(&x[16..]);
    let [p, q] = [0, 8].map(|k| poses::product(relative_rotation(&x[k..]), c));
    Traced::length(sub(p, q)).error.abs() / length(c) / UNIT
}

/// As a body of A sees it; at the other pose the origins are in one place.
fn by_distance(x: &[f64]) -> f64 {
    let t = translation(x, vector(&x[8..]));
    let seen = poses::product(Traces::transposed(relative_rotation(x)), t.map(|x| -x));
    Traced::length(seen).error.abs() / length(t) / UNIT
}

fn place_on_ray(x: &[f64]) -> f64 {
    let (origin, corner) = (vector(&x[4..]), vector(&x[7..]));
    let (d, n) = (divided(vector(&x[10..])), divided(vector(&x[13..])));
    let at = sum(origin, scaled(d, Traced::input(x[16])));
    let height = dot(n, sub(translation(x, at), corner));
    height.error.abs() / (length(origin) + length(corner) + x[16].abs()) / UNIT
}

/// The origin of a link, with the value of a prismatic joint.
fn arm_place(x: &[f64]) -> f64 {
    let q = divided(Traced::vector::<4>(x)).map(Measured::computed);
    let [from, to, time] = [x[4], x[5], 0.5 * x[6].abs()].map(Traced::input);
    let axis = unit::<3>(&x[7..]).map(Traced::input);
    let value = from + (to - from) * time;
    let (origin, t) = (vector(&x[10..]), vector(&x[13..]));
    let v = sum(origin, scaled(axis, value));
    let size = length(origin) + x[4].abs().max(x[5].abs()) + length(t);
    placed_off(q, v, t) / size / UNIT
}

/// A height of a middle, and the turned direction with the radius.
fn carried(x: &[f64]) -> f64 {
    let (c, m) = (vector(&x[11..]), relative_rotation(x));
    let n = divided(vector(&x[14..]));
    let t = translation(x, vector(&x[8..]));
    let height = dot(n, sum(poses::product(m, c), t));
    let turned = off(poses::product(Traces::transposed(m), n));
    let radius = x[17].abs();
    (height.error.abs() + radius * turned) / (length(c) + length(t) + radius) / UNIT
}

/// A vertex, the axis by the matrix against that of a rotation, and a height.
fn parallel(x: &[f64]) -> f64 {
    let (m, v) = (relative_rotation(x), vector(&x[8..]));
    let vertex = off(poses::product(m, v)) / length(v);
    let [a, b] = [0, 4].map(|k| unit::<4>(&x[k..]).map(Traced::input));
    let q = poses::quotient(a, b).map(Measured::computed);
    let own = poses::matrix(q, Traced::exact(2.0));
    let axis = off([0, 1, 2].map(|k| own[k][2]));
    let height = dot(divided(vector(&x[11..])), v).error.abs() / length(v);
    (vertex + 2.0 * axis + height) / UNIT
}
