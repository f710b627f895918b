//! Both bounds of a distance, of ellipsoids, half-spaces and surfaces, with inputs as those of [`certificate`].
//!
//! [`certificate`]: super::certificate

use super::certificate::{of_origins, of_translation, posed, posed_twice, rivalry, size};
use super::{Climb, UNIT, climb, rare};
use crate::factor::Positive;
use crate::kernels::certificate::{self, Placing};
use crate::kernels::curved;
use crate::measured::Measured;
use crate::number::{Vector, dot, sum};
use crate::traced::Traced;
use crate::vectors::Coordinates;

pub(super) const ALL: &[Climb] = &[
    climb("CERTIFICATE", "curved, lower", 34, |x| {
        lower(&posed(x), x, of_translation(x))
    }),
    climb("CERTIFICATE", "curved, upper", 34, |x| {
        upper(&posed(x), x, of_translation(x))
    }),
    rare("CERTIFICATE", "curved in double-double, lower", 44, 4, |x| {
        lower(&posed_twice(x), x, of_origins(x))
    }),
    rare("CERTIFICATE", "curved in double-double, upper", 44, 4, |x| {
        upper(&posed_twice(x), x, of_origins(x))
    }),
    climb("CERTIFICATE", "half-space, lower", 34, |x| half_space(x)[0]),
    climb("CERTIFICATE", "half-space, upper", 34, |x| half_space(x)[1]),
    climb("CERTIFICATE", "surfaces, gap of two nets", 34, nets),
];

/// A direction divided by its length, exact as such.
fn divided<N: Measured + Positive>(x: &[f64]) -> Vector<N> {
    let v = N::vector(x);
    let inverse = N::input(1.0) / N::length(v);
    v.map(|c| (c * inverse).computed())
}

fn axes<N: Measured>(x: &[f64]) -> Vector<N> {
    [0, 1, 2].map(|k| N::input(x[k].abs()))
}

fn longest(x: &[f64]) -> f64 {
    x[14..17].iter().fold(0.0f64, |m, x| m.max(x.abs())) + x[17..20].iter().fold(0.0f64, |m, x| m.max(x.abs()))
}

/// The support points along a direction, and the direction in the frame of B.
fn supports<N: Measured + Positive>(
    placing: &Placing<Coordinates<N>>,
    x: &[f64],
    n: Vector<N>,
) -> ([Vector<N>; 2], Vector<N>) {
    let m = placing.turned_to_b(n).map(|c| -c);
    let points = [
        curved::on_ellipsoid(&axes(&x[14..]), &n),
        curved::on_ellipsoid(&axes(&x[17..]), &m),
    ];
    (points, m)
}

/// The height of the support points, and the least over both ellipsoids.
fn lower<N: Measured + Positive>(placing: &Placing<Coordinates<N>>, x: &[f64], distance: f64) -> f64 {
    let n = divided::<N>(&x[29..]);
    let (points, m) = supports(placing, x, n);
    let claimed = -dot(n, placing.difference(points)).computed();
    let support = |axes: Vector<N>, n: Vector<N>| N::length([0, 1, 2].map(|k| axes[k] * n[k]));
    let high = support(axes(&x[14..]), n) + support(axes(&x[17..]), m);
    let truth = (dot(n, placing.translation) - high) / N::length(n);
    claimed.above(truth) / (longest(x) + distance) / N::UNIT
}

/// The distance of mixtures of points along two directions: any points of both ellipsoids.
fn upper<N: Measured + Positive>(placing: &Placing<Coordinates<N>>, x: &[f64], distance: f64) -> f64 {
    let [p, q] = [20, 29].map(|k| {
        let n = divided::<N>(&x[k..]);
        let m = placing.turned_to_b(n).map(|c| -c.computed());
        [(14, n), (17, m)].map(|(k, n)| curved::on_ellipsoid(&axes(&x[k..]), &n))
    });
    let weights = [32, 33].map(|k| N::input(x[k].abs()));
    let mixed = [0, 1].map(|body| {
        [0, 1, 2].map(|k| {
            let [total, sum] = curved::mixed(&[p[body][k], q[body][k]], &weights);
            total * (N::input(1.0) / sum)
        })
    });
    N::length(placing.difference(mixed)).error().abs() / (longest(x) + distance) / N::UNIT
}

/// A vertex of a body whose stored origin is apart from its own, over a plane.
fn half_space(x: &[f64]) -> [f64; 2] {
    let placing = posed(x);
    let n = divided::<Traced>(&x[29..]);
    let [vertex, origin]: [Vector<Traced>; 2] = [17, 23].map(|k| Traced::vector(&x[k..]));
    let place = placing.in_a(sum(vertex, origin));
    let height = certificate::over_plane::<Coordinates<Traced>>(n, place, Traced::input(x[33]));
    let above = height.above(height.over(Traced::length(n)));
    let (rival, radius) = rivalry(placing.turned_to_b(n), &x[17..], &x[20..]);
    let per = UNIT * (radius + size(&x[23..]) + x[33].abs() + of_translation(x));
    [(above + rival) / per, -above / per]
}

fn nets(x: &[f64]) -> f64 {
    let (placing, n) = (posed(x), divided::<Traced>(&x[29..]));
    let m = placing.turned_to_b(n).map(|c| -c);
    let [high_a, high_b] = [(n, 14), (m, 17)].map(|(n, k)| dot(n, Traced::vector(&x[k..])));
    let gap = certificate::between_nets::<Coordinates<Traced>>(n, placing.translation, [high_a, high_b]);
    let per = UNIT * (size(&x[14..]) + size(&x[17..]) + of_translation(x));
    gap.above(gap.over(Traced::length(n))).abs() / per
}
