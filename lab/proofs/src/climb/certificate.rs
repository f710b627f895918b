//! Both bounds of a distance, in either precision: poses, feature pairs, support points, combinations.
//!
//! Inputs of a pair: two quaternions, two translations, then points of the bodies and directions. A vertex of the other
//! body has a rival, level with it along the direction that the code looks along; along the true one the rival is lower.

use super::{Climb, UNIT, climb, factor_of, rare, relative_rotation, unit};
use crate::kernels::certificate::{self, Placing};
use crate::kernels::poses;
use crate::measured::{Measured, TracedTwice};
use crate::number::{Vector, cross, dot, scaled, sub};
use crate::traced::{Traced, two_sum};
use crate::vectors::Coordinates;

type Single = Coordinates<Traced>;
pub(super) type Posed = Placing<Single>;

pub(super) const ALL: &[Climb] = &[
    climb("CERTIFICATE", "1, a squared norm", 4, squared_norm),
    climb("CERTIFICATE", "2, factor", 8, factor),
    climb("CERTIFICATE", "2, matrix", 4, entries),
    climb("CERTIFICATE", "vertices, lower", 34, |x| vertices(x)[0]),
    climb("CERTIFICATE", "vertices, upper", 34, |x| vertices(x)[1]),
    climb("CERTIFICATE", "face of A, lower", 34, |x| face(&of_a(x))[0]),
    climb("CERTIFICATE", "face of A, upper", 34, |x| face(&of_a(x))[1]),
    climb("CERTIFICATE", "edge of A, lower", 34, |x| edge(&of_a(x))[0]),
    climb("CERTIFICATE", "edge of A, upper", 34, |x| edge(&of_a(x))[1]),
    climb("CERTIFICATE", "face of B, lower", 34, |x| face(&of_b(x))[0]),
    climb("CERTIFICATE", "face of B, upper", 34, |x| face(&of_b(x))[1]),
    climb("CERTIFICATE", "edge of B, lower", 34, |x| edge(&of_b(x))[0]),
    climb("CERTIFICATE", "edge of B, upper", 34, |x| edge(&of_b(x))[1]),
    climb("CERTIFICATE", "edges, lower", 34, |x| edges(x)[0]),
    climb("CERTIFICATE", "edges, upper", 34, |x| edges(x)[1]),
    climb("CERTIFICATE", "supports", 34, supports),
    climb("CERTIFICATE", "solver, lower", 34, |x| {
        height(&posed(x), x, of_translation(x))
    }),
    climb("CERTIFICATE", "solver, upper", 38, |x| {
        combined(&posed(x), x, of_translation(x))
    }),
    rare("CERTIFICATE", "solver in double-double, lower", 44, 4, |x| {
        height(&posed_twice(x), x, of_origins(x))
    }),
    rare("CERTIFICATE", "solver in double-double, upper", 44, 4, |x| {
        combined(&posed_twice(x), x, of_origins(x))
    }),
    rare(
        "CERTIFICATE",
        "origins of stored frames, in double-double",
        44,
        4,
        origins,
    ),
];

fn squared_norm(x: &[f64]) -> f64 {
    let n = poses::squared_norm(Traced::vector(x));
    (n.error / n.truth()).abs() / UNIT
}

/// Of both poses, relative to the factor, which is about two.
fn factor(x: &[f64]) -> f64 {
    let norms = [x, &x[4..]].map(|x| poses::squared_norm(Traced::vector(&unit::<4>(x))));
    let s = factor_of(&norms, poses::rotation_factor(norms[0].value, norms[1].value));
    (s.error / s.truth()).abs() / UNIT
}

fn entries(x: &[f64]) -> f64 {
    let m = poses::matrix(Traced::vector(&unit::<4>(x)), Traced::input(2.0));
    super::spectral(m.map(|row| row.map(|x| x.error))) / UNIT
}

/// The relative pose, as computed and true.
pub(super) fn posed(x: &[f64]) -> Posed {
    let a = unit::<4>(x).map(Traced::input);
    let norm = poses::squared_norm(a);
    let one = factor_of(&[norm], poses::translation_factor(norm.value));
    let offset = sub(Traced::vector(&x[11..]), Traced::vector(&x[8..]));
    Placing {
        rotation: relative_rotation(x),
        translation: poses::rotated_to_a(a, offset, one),
    }
}

/// The same in double-double, of bodies whose stored frames have origins of their own.
pub(super) fn posed_twice(x: &[f64]) -> Placing<Coordinates<TracedTwice>> {
    let both = [0, 4].map(|k| {
        let [x, y, z, w] = unit::<4>(&x[k..]).map(TracedTwice::input);
        let s = TracedTwice::input(2.0).over(x * x + y * y + z * z + w * w);
        certificate::rotation([x, y, z, w], s)
    });
    let origins = [38, 41].map(|k| TracedTwice::vector(&x[k..]));
    let difference = [0, 1, 2].map(|k| TracedTwice::of(two_sum(x[11 + k], -x[8 + k])));
    Placing {
        rotation: certificate::rotation_between::<Coordinates<TracedTwice>>(both),
        translation: certificate::shift::<Coordinates<TracedTwice>>(both, origins, difference),
    }
}

pub(super) fn size(v: &[f64]) -> f64 {
    v[..3].iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The distance of the origins.
pub(super) fn of_translation(x: &[f64]) -> f64 {
    size(&[0, 1, 2].map(|k| x[11 + k] - x[8 + k]))
}

/// The distance of the stored frames' origins, and theirs from the bodies' own.
pub(super) fn of_origins(x: &[f64]) -> f64 {
    let t = posed_twice(x).translation.map(TracedTwice::truth);
    size(&t) + size(&x[38..]) + size(&x[41..])
}

fn origins(x: &[f64]) -> f64 {
    let t = posed_twice(x).translation;
    size(&t.map(TracedTwice::error)) / of_origins(x) / TracedTwice::UNIT
}

/// What a point is displaced by at right angles to a direction, so that it is level with another along it.
fn level<N: Measured>(n: Vector<N>, with: &[f64], point: &[f64]) -> [f64; 3] {
    let n = n.map(N::truth);
    let by = (0..3).map(|k| n[k] * (point[k] - with[k])).sum::<f64>() / n.iter().map(|x| x * x).sum::<f64>();
    [0, 1, 2].map(|k| point[k] - n[k] * by)
}

/// By how much a rival is lower along the true direction than a vertex with which it is level along the computed one,
/// and the greater distance of both.
pub(super) fn rivalry<N: Measured>(n: Vector<N>, vertex: &[f64], rival: &[f64]) -> (f64, f64) {
    let rival = level(n, vertex, rival);
    let lower: f64 = (0..3).map(|k| n[k].error() * (vertex[k] - rival[k])).sum();
    (lower, size(vertex).max(size(&rival)))
}

/// The true height of a vector along a direction as computed.
fn along<N: Measured>(direction: Vector<N>, v: Vector<N>) -> N {
    let d = direction.map(N::computed);
    dot(d, v).over(N::length(d))
}

fn vertices(x: &[f64]) -> [f64; 2] {
    let placing = posed(x);
    let v = placing.between_vertices([Traced::vector(&x[14..]), Traced::vector(&x[17..])]);
    let d = Traced::length(v);
    let turned = placing.turned_to_b(v.map(Measured::computed));
    let (lower, radius) = rivalry(turned, &x[17..], &x[20..]);
    let size = size(&x[14..]) + radius + of_translation(x);
    [
        (d.above(along(v, v)) + lower / d.value) / size / UNIT,
        d.error / size / UNIT,
    ]
}

/// A vertex of the other body in the frame of one, whose points are two.
struct Beside<'a> {
    x: &'a [f64],
    vertex: Vector<Traced>,
    /// A direction of the frame in that of the other body.
    turned: fn(&Posed, Vector<Traced>) -> Vector<Traced>,
}

fn of_a(x: &[f64]) -> Beside<'_> {
    Beside {
        x,
        vertex: posed(x).in_a(Traced::vector(&x[17..])),
        turned: Posed::turned_to_b,
    }
}

fn of_b(x: &[f64]) -> Beside<'_> {
    Beside {
        x,
        vertex: posed(x).in_b(Traced::vector(&x[17..])),
        turned: Posed::turned_to_a,
    }
}

impl Beside<'_> {
    /// In UNIT of the size: bounds by which a lower one is too high, along a direction, and an upper one too low.
    fn told(&self, direction: Vector<Traced>, [lower, upper]: [f64; 2]) -> [f64; 2] {
        let d = direction.map(Measured::computed);
        let turned = (self.turned)(&posed(self.x), d);
        let (rival, radius) = rivalry(turned, &self.x[17..], &self.x[20..]);
        let own = size(&self.x[14..]).max(size(&self.x[23..]));
        let per = UNIT * (own + radius + of_translation(self.x));
        [(lower + rival / Traced::length(d).value) / per, upper / per]
    }

    fn ends(&self) -> [Vector<Traced>; 2] {
        [14, 23].map(|k| Traced::vector(&self.x[k..]))
    }
}

/// The stored normal is the nearest to a true one.
fn normal(x: &[f64]) -> Vector<Traced> {
    let v: Vector<Traced> = Traced::vector(x);
    v.map(|c| c.over(Traced::length(v))).map(super::held)
}

/// Over the plane of a face by its offset, over its corner, and from a point of an edge.
fn face(at: &Beside) -> [f64; 2] {
    let (n, [p, q]) = (normal(&at.x[29..]), at.ends());
    let stored = n.map(Measured::computed);
    let offset = Traced::input(dot(stored, p).truth());
    let height = certificate::over_plane::<Single>(stored, at.vertex, offset);
    let lower = height.above(height.over(Traced::length(stored)));
    let foot = certificate::over_corner::<Single>(n, at.vertex, p).error;
    let part = Traced::input(0.5 * at.x[32].abs());
    let grazed = Traced::length(certificate::from_edge::<Single>(at.vertex, [p, q], part)).error;
    at.told(n, [lower, foot.abs().max(grazed)])
}

/// By the vector from the edge that was made right once more.
fn edge(at: &Beside) -> [f64; 2] {
    let (vertex, [p, q]) = (at.vertex, at.ends());
    let [u, r] = certificate::along_edge::<Single>(vertex.map(Measured::computed), [p, q]);
    let inverse = Traced::input(1.0 / dot(u, u).value);
    let s = Traced::input((dot(r, u) * inverse).value);
    let d = certificate::less::<Single>(r, u, s);
    let correction = Traced::input((dot(d, u) * inverse).value);
    let d = certificate::less::<Single>(d, u, correction);
    let s = Traced::input((s + correction).value);
    let length = Traced::length(d);
    if length.value <= 16.0 * UNIT * size(&at.x[14..]) {
        return [0.0; 2];
    }
    let lower = [p, q].map(|end| length.above(along(d, sub(vertex, end))));
    let witness = Traced::length(certificate::from_edge::<Single>(vertex, [p, q], s));
    let upper = if (0.0..=1.0).contains(&s.value) {
        -length.above(witness)
    } else {
        0.0
    };
    at.told(d, [lower[0].max(lower[1]), upper])
}

fn edges(x: &[f64]) -> [f64; 2] {
    let placing = posed(x);
    let ([p1, q1], [p2, q2]) = ([14, 23].map(|k| Traced::vector(&x[k..])), {
        [17, 26].map(|k| Traced::vector(&x[k..]))
    });
    let of = placing.edges([p1, q1], [p2, q2]);
    let [u, w, r] = [of.u, of.w, of.between].map(|v| v.map(|c| c.value));
    let (uu, ww) = (dot(u, u), dot(w, w));
    let mut n = cross(u, w);
    if dot(n, n) < uu * ww / 16.0 {
        let part = dot(n, u) / uu;
        n = sub(n, scaled(u, part));
    }
    if dot(n, n) <= 256.0 * UNIT * UNIT * uu * ww {
        return [0.0; 2];
    }
    let per_square = 1.0 / dot(n, n);
    let claimed = Traced::input(dot(r, n).abs() * (dot(n, n).sqrt() * per_square));
    let n = Traced::vector(&if dot(r, n) < 0.0 { n.map(|x| -x) } else { n });
    let heights = [p1, q1].map(|a| [p2, q2].map(|b| claimed.above(along(n, sub(placing.in_a(b), a)))));
    let lower = heights.as_flattened().iter().fold(f64::NEG_INFINITY, |m, x| m.max(*x));
    let parts = [32, 33].map(|k| Traced::input(0.5 * x[k].abs()));
    let upper = Traced::length(of.between_witnesses(p1, parts)).error;
    let longest = |a: usize, b: usize| size(&x[a..]).max(size(&x[b..]));
    let per = UNIT * (longest(14, 23) + longest(17, 26) + of_translation(x));
    [lower / per, upper / per]
}

/// Along a direction that was divided by its length.
fn supports(x: &[f64]) -> f64 {
    let v: Vector<Traced> = Traced::vector(&x[29..]);
    let n = v.map(|c| c.over(Traced::length(v)).computed());
    let distance = posed(x).support_distance(n, [Traced::vector(&x[14..]), Traced::vector(&x[17..])]);
    let size = size(&x[14..]) + size(&x[17..]) + of_translation(x);
    distance.above(distance.over(Traced::length(n))).abs() / size / UNIT
}

/// The height of the support points of a solver, each with a rival.
fn height<N: Measured>(placing: &Placing<Coordinates<N>>, x: &[f64], distance: f64) -> f64 {
    let d = N::vector(&x[29..]);
    let turned = placing.turned_to_b(d);
    // What the search takes for the highest, as rounded, and what is.
    let missed = |n: Vector<N>, vertex: &[f64], rival: &[f64]| {
        let rival = level(n, vertex, rival);
        let [of_vertex, of_rival] = [vertex, &rival].map(|v| dot(n, N::vector(v)));
        let is_found = of_vertex.above(of_rival.computed()) >= 0.0;
        let missed = of_rival.error() - of_vertex.error() - of_vertex.above(of_rival.computed());
        let radius = size(vertex).max(size(&rival));
        (if is_found { missed.max(0.0) } else { 0.0 }, radius)
    };
    let (of_a, a) = missed(d.map(|c| -c), &x[14..], &x[23..]);
    let (of_b, b) = missed(turned, &x[17..], &x[20..]);
    let w = placing.difference([N::vector(&x[14..]), N::vector(&x[17..])]);
    let claimed = dot(d, w).over(N::length(d)).computed();
    let above = claimed.above(along(d, w)) + (of_a + of_b) / N::length(d).truth();
    above / (a + b + distance) / N::UNIT
}

/// Of three points, by weights over their sum.
fn combined<N: Measured>(placing: &Placing<Coordinates<N>>, x: &[f64], distance: f64) -> f64 {
    let [p, q] = [[14, 23, 29], [17, 20, 26]].map(|at| at.map(|k| N::vector(&x[k..])));
    let points = [0, 1, 2].map(|k| placing.difference([p[k], q[k]]));
    let parts = [32, 33, 34].map(|k| N::input(x[k].abs()));
    let sum = parts[0] + parts[1] + parts[2];
    let v = certificate::combined::<Coordinates<N>>(&points, &parts.map(|part| part.over(sum)));
    let longest = |at: [usize; 3]| at.map(|k| size(&x[k..])).into_iter().fold(0.0, f64::max);
    let size = longest([14, 23, 29]) + longest([17, 20, 26]) + distance;
    N::length(v).error().abs() / size / N::UNIT
}
