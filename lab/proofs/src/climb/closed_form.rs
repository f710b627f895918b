//! Distances of features in closed form, and the signs that prove the features the closest.
//!
//! Inputs: two quaternions, two translations, then a point of each body, two edges, and more points.

use super::certificate::{posed, size};
use super::{Climb, UNIT, climb, length, unit};
use crate::kernels::{certificate, closed_form};
use crate::measured::{Measured, TracedTwice};
use crate::number::{Vector, cross, dot, sub};
use crate::traced::{Traced, two_sum};
use crate::vectors::Coordinates;

type Double = Coordinates<TracedTwice>;

pub(super) const ALL: &[Climb] = &[
    climb("CLOSED_FORM", "vertices", 20, |x| {
        told(&Placed::new(x), TracedTwice::length)
    }),
    climb("CLOSED_FORM", "vertex and edge", 23, |x| {
        let u = TracedTwice::vector(&x[20..]);
        told(&Placed::new(x), |w| {
            let area = cross(w, u);
            dot(area, area).over(dot(u, u)).root()
        })
    }),
    climb("CLOSED_FORM", "vertex and face", 26, |x| {
        over_plane(x, [20, 23].map(|k| TracedTwice::vector(&x[k..])))
    }),
    climb("CLOSED_FORM", "edges", 26, |x| {
        let [u, v] = [20, 23].map(|k| TracedTwice::vector(&x[k..]));
        over_plane(x, [u, closed_form::turned::<Double>(Placed::new(x).rotations, v)])
    }),
    climb("CLEAR_SIGN", "a vertex falls", 26, falls),
    climb("CLEAR_SIGN", "a point beside an edge", 18, |x| {
        let [a, b, c] = [0, 6, 12].map(|k| between(&x[k..]));
        dot(a, cross(b, c)).error.abs() / (length(a) * length(b) * length(c)) / UNIT
    }),
];

/// A point of each body, placed.
struct Placed {
    rotations: [[Vector<TracedTwice>; 3]; 2],
    w: Vector<TracedTwice>,
    /// The size of the pair.
    size: f64,
}

impl Placed {
    fn new(x: &[f64]) -> Self {
        let rotations = [0, 4].map(|k| {
            let [x, y, z, w] = unit::<4>(&x[k..]).map(TracedTwice::input);
            let s = TracedTwice::input(2.0).over(x * x + y * y + z * z + w * w);
            certificate::rotation([x, y, z, w], s)
        });
        let points = [14, 17].map(|k| TracedTwice::vector(&x[k..]));
        let apart = [0, 1, 2].map(|k| TracedTwice::of(two_sum(x[11 + k], -x[8 + k])));
        Self {
            rotations,
            w: certificate::shift::<Double>(rotations, points, apart),
            size: size(&x[14..]) + size(&x[17..]) + size(&apart.map(TracedTwice::truth)),
        }
    }
}

/// The error of a length, per size.
fn told(of: &Placed, distance: impl Fn(Vector<TracedTwice>) -> TracedTwice) -> f64 {
    distance(of.w).error().abs() / of.size / TracedTwice::UNIT
}

/// The error of a height, per size and per the lengths of the edges over that of their normal.
fn over_plane(x: &[f64], edges: [Vector<TracedTwice>; 2]) -> f64 {
    let of = Placed::new(x);
    let (n, _) = closed_form::height::<Double>(of.w, edges);
    let length = |v: Vector<TracedTwice>| size(&v.map(TracedTwice::truth));
    let sine = length(n) / (length(edges[0]) * length(edges[1]));
    let height = |w| closed_form::height::<Double>(w, edges).1.over(TracedTwice::length(n));
    told(&of, height) * sine
}

/// A difference of two points.
fn between(x: &[f64]) -> Vector<Traced> {
    sub(Traced::vector(x), Traced::vector(&x[3..]))
}

/// Along a rounded direction, turned into the other frame.
fn falls(x: &[f64]) -> f64 {
    let [n, e] = [14, 20].map(|k| between(&x[k..]));
    let value = dot(posed(x).turned_to_b(n), e);
    let lengths = length(n) * e.iter().map(|c| c.truth().abs()).sum::<f64>();
    value.error.abs() / lengths / UNIT
}
