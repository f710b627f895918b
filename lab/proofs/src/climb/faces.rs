//! Signs over faces and edges, and vertices on straight paths.

use super::{Climb, UNIT, climb, divided, held, length, off, relative_rotation, unit};
use crate::kernels::certificate;
use crate::kernels::{paths, poses, signs};
use crate::measured::Measured;
use crate::number::{Number, Vector, cross, dot, one_norm, scaled, sub};
use crate::traced::Traced;
use crate::vectors::{Coordinates, Vectors};

type Traces = Coordinates<Traced>;

pub(super) const ALL: &[Climb] = &[
    climb("VOLUME", "", 18, volume),
    climb("ORIENTATION", "height of a side as a quotient", 9, side_of_pyramid),
    climb("FOOT", "", 15, foot),
    climb("FLANK", "on A", 12, flank_on_a),
    climb("FLANK", "on B", 20, flank_on_b),
    climb("DIFFERENCE", "weights of faces at an edge", 12, weights),
    climb("ON_BOUNDARY", "part along an edge", 6, along_edge),
    climb("PATH_GAP", "", 27, gap),
    climb("PATH_VOLUME", "", 38, path_volume),
    climb("PATH_AREA", "at an end", 41, area_at_an_end),
    climb("PATH_AREA", "between", 41, area_between),
];

fn vector(x: &[f64]) -> Vector<Traced> {
    Traced::vector(x)
}

/// Of vertices that are displaced by 128 UNIT of the longest.
fn volume(x: &[f64]) -> f64 {
    let most = [0, 3, 6]
        .map(|k| length(vector(&x[k..])))
        .into_iter()
        .fold(0.0, f64::max);
    let displaced = |k: usize| {
        let by: [f64; 3] = unit(&x[9 + k..]);
        [0, 1, 2].map(|i| Traced {
            value: x[k + i],
            error: 128.0 * UNIT * most * by[i],
        })
    };
    signs::volume([0, 3, 6].map(displaced)).error.abs() / most.powi(3) / UNIT
}

/// A distance that is too great before anything is taken off, in the weights of what is.
fn side_of_pyramid(x: &[f64]) -> f64 {
    let (n, height) = signs::pyramid_side([0, 3, 6].map(|k| vector(&x[k..])));
    let exact = height.over(Measured::length(n)).abs();
    let low = height.computed();
    let n_squared = dot(n.map(Measured::computed), n.map(Measured::computed)).computed();
    let distance = (low * low).computed().over(n_squared).computed().root();
    let [u, v] = [(0, 3), (6, 3)].map(|(i, j)| length(sub(vector(&x[i..]), vector(&x[j..]))));
    let size = length(vector(&x[3..]));
    distance.above(exact) * length(n) / (2.0 * u * v * size) / UNIT
}

/// The side of a point, and the foot itself.
fn foot(x: &[f64]) -> f64 {
    let n = divided(vector(&x[9..])).map(held);
    let [a, b, p] = [0, 3, 6].map(|k| vector(&x[k..]));
    let (edge, to) = (sub(b, a), sub(p, a));
    let side = signs::over_side(n, edge, to).error.abs() / (length(edge) * length(to));
    let q = vector(&x[12..]);
    let on = signs::foot(q, n, dot(n, q).computed());
    (side + off(on) / length(q)) / UNIT
}

/// A direction from two edges, made right to the first if they are nearly parallel.
fn perpendicular([u, w]: [Vector<f64>; 2]) -> Vector<Traced> {
    let (mut n, uu) = (cross(u, w), dot(u, u));
    if dot(n, n) < uu * dot(w, w) / 16.0 {
        n = sub(n, scaled(u, dot(n, u) / uu));
    }
    vector(&n)
}

/// The true normal of a face at an edge, as the code holds it.
fn normal(edge: Vector<Traced>, x: &[f64]) -> Vector<Traced> {
    divided(cross(edge, vector(x))).map(held)
}

/// How far a direction rises along the inward direction of the face at an edge, per length of the edge.
fn inward(n: Vector<Traced>, normal: Vector<Traced>, edge: Vector<Traced>) -> Vector<Traced> {
    cross(normal, edge).map(|x| x.over(dot(n, n)))
}

/// The edge of A is a rounded difference.
fn flank_on_a(x: &[f64]) -> f64 {
    let (u, w) = (sub(vector(&x[3..]), vector(x)), vector(&x[6..]));
    let face = normal(u, &x[9..]);
    let n = perpendicular([u, w].map(|v| v.map(|x| x.value)));
    let weight = dot(w, face.map(Measured::computed)).computed();
    let rise = dot(n, inward(u, face, u));
    weight.above(-rise).abs() / length(w) / UNIT
}

/// The edge of B is turned by a pose, and that of A the other way.
fn flank_on_b(x: &[f64]) -> f64 {
    let m = relative_rotation(&x[12..]);
    let (u, w) = (sub(vector(&x[3..]), vector(x)), vector(&x[6..]));
    let face = normal(w, &x[9..]);
    let n = perpendicular([u, poses::product(m, w)].map(|v| v.map(|x| x.value)));
    let other = poses::product(Traces::transposed(m), u.map(Measured::computed)).map(Measured::computed);
    let weight = dot(other, face.map(Measured::computed)).computed();
    let rise = dot(n, poses::product(m, inward(w, face, w)));
    weight.above(rise).abs() / length(u) / UNIT
}

fn weights(x: &[f64]) -> f64 {
    let (u, d) = (sub(vector(&x[3..]), vector(x)), vector(&x[6..]));
    let n = divided(vector(&x[9..])).map(held);
    dot(n, cross(u, d)).error.abs() / (length(u) * length(d)) / UNIT
}

fn along_edge(x: &[f64]) -> f64 {
    let (r, u) = (vector(x), vector(&x[3..]));
    let inverse = Traced::input(1.0 / dot(u, u).value);
    let s = (dot(r, u) * inverse).computed();
    let d = certificate::less::<Traces>(r, u, s).map(Measured::computed);
    dot(d, u).truth().abs() / (length(r) * length(u)) / UNIT
}

/// The places of a vertex at the begin and at the end of a path, by their differences from another vertex.
fn ends(x: &[f64]) -> [Vector<Traced>; 2] {
    let half = |x: f64| Traced::input(0.25 * x);
    let other = |k: usize| Traced::input(if x[k] > 0.0 { 0.25 } else { -0.25 });
    [[0, 1, 2], [3, 4, 5]].map(|at| at.map(|k: usize| half(x[k]) - other(k)))
}

fn places<const K: usize>(x: &[f64], time: f64) -> [Vector<Traced>; K] {
    let time = Traced::input(0.5 * time.abs());
    let shares = [Traced::exact(1.0) - time, time];
    std::array::from_fn(|i| {
        let [begin, end] = ends(&x[6 * i..]);
        [0, 1, 2].map(|k| paths::place([begin[k], end[k]], shares))
    })
}

/// Per the sum of the magnitudes of a direction; coordinates are below a half.
fn per_direction(error: f64, n: Vector<Traced>, degree: i32) -> f64 {
    error.abs() * 2f64.powi(degree) / one_norm(n).value / UNIT
}

fn gap(x: &[f64]) -> f64 {
    let (n, [p, q]) = (vector(&x[24..]), places(&x[..12], x[12]));
    per_direction(paths::gap(n, [p, q]).error, n, 1)
}

fn path_volume(x: &[f64]) -> f64 {
    let [a, b, c] = places::<3>(x, x[36]);
    let [d, e, f] = places::<3>(&x[18..], x[37]);
    let [x, y, z] = [[d, b, c], [a, e, c], [a, b, f]].map(paths::volume);
    (paths::thrice([x, y, z]).over(Traced::exact(3.0))).error.abs() * 8.0 / UNIT
}

fn area_at_an_end(x: &[f64]) -> f64 {
    let n = vector(&x[38..]);
    per_direction(paths::end(places(x, x[36]), n).error, n, 2)
}

fn area_between(x: &[f64]) -> f64 {
    let n = vector(&x[38..]);
    let at = [places(x, x[36]), places(&x[18..], x[37])];
    per_direction(paths::middle(at, n).error, n, 2)
}
