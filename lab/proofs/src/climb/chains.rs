//! Chains of scalars, planes of faces, the columns of the broad phase, nets that are cut.

use super::{Climb, UNIT, climb, off, rare, relative, unit};
use crate::measured::{Measured, TracedTwice};
use crate::number::{Number, Vector, cross, dot, sub};
use crate::traced::{Traced, two_sum};

const UNIT_SINGLE: f64 = f32::EPSILON as f64 / 2.0;

pub(super) const ALL: &[Climb] = &[
    climb("UNIT_DOUBLE_DOUBLE", "quotient", 4, quotient),
    climb("RADIUS_UP", "", 4, scaled_length),
    climb("RADIUS_UP", "reach of a solid", 4, reach),
    climb("ROUND_DOWN", "", 7, least_distance),
    climb("ODOMETER", "", 5, odometer),
    rare("TICK", "", 1, 1 << 12, ticks),
    climb("REGION", "", 2, region),
    climb("DISC", "absolute", 12, turned_off),
    climb("CROSS_CANCELLED", "of a direction", 11, cancelled),
    climb("NORMAL_ERROR", "", 11, normal),
    climb("PLANE_OFFSET", "product, in UNIT^2", 6, offset),
    climb("NEAR_PLANE", "", 9, near_plane),
    climb("COLUMN_SUM", "", 2, column_sum),
    climb("COLUMN_MOVE", "", 4, column_move),
    climb("COLUMN_SEARCH", "", 2, column_search),
    climb("COLUMN_REACH", "", 2, column_reach),
    climb("NET_STEP", "a thousand, with NET", 9, halves),
    climb("NET_CUT", "degrees 7 and 7, with NET", 20, cuts),
];

fn quotient(x: &[f64]) -> f64 {
    let [a, b] = [0, 2].map(|k| TracedTwice::of(two_sum(x[k], x[k + 1] * UNIT)));
    let q = a.over(b);
    (q.error / q.truth()).abs() / (UNIT * UNIT)
}

fn scaled_length(x: &[f64]) -> f64 {
    let [a, b, c, scale] = Traced::vector(x);
    relative(Traced::length([a, b, c].map(|x| x.over(scale))) * scale)
}

fn reach(x: &[f64]) -> f64 {
    let [a, b, c, radius] = Traced::vector(x);
    relative(Traced::length([a, b, c]) + radius.abs())
}

/// With the product and the difference of the radii, of balls that are apart.
fn least_distance(x: &[f64]) -> f64 {
    let [a, b] = [x, &x[3..]].map(Traced::vector::<3>);
    let apart = Traced::length(sub(a, b));
    let radii = Traced::input(0.5 * x[6].abs() * apart.value);
    let left = apart * Traced::input(1.0 - 8.0 * UNIT) - radii;
    left.error.abs() / apart.truth() / UNIT
}

/// The sum at which a pair wakes, and a later sum of odometers.
fn odometer(x: &[f64]) -> f64 {
    let [a, b, slack, c, d] = Traced::vector(x).map(Number::abs);
    let end = a + b + slack;
    relative(end - Traced::input(8.0 * UNIT) * end) + relative(c + d)
}

/// A clock that adds up a million ticks.
fn ticks(x: &[f64]) -> f64 {
    let tick = Traced::input(x[0].abs());
    relative((1..1 << 20).fold(tick, |clock, _| clock + tick))
}

fn region(x: &[f64]) -> f64 {
    let (a, b) = (x[0].abs().min(x[1].abs()), x[0].abs().max(x[1].abs()));
    let part = Traced::input(a).over(Traced::input(b));
    (Traced::exact(1.0) - part).error.abs() / UNIT
}

/// Two unit vectors, each off by 16 UNIT, and half as much again.
fn turned_off(x: &[f64]) -> f64 {
    let [n, m] = [0, 6].map(|k| {
        let (v, by): ([f64; 3], [f64; 3]) = (unit(&x[k..]), unit(&x[k + 3..]));
        [0, 1, 2].map(|i| Traced {
            value: v[i],
            error: 16.0 * UNIT * by[i],
        })
    });
    1.5 * off(cross(n, m)) / UNIT
}

/// The cross product of two edges of a face, nearly parallel ones among them; none if too much cancels.
fn across([a, b, c]: [[f64; 3]; 3]) -> Option<Vector<TracedTwice>> {
    let edge = |to: [f64; 3]| [0, 1, 2].map(|k| TracedTwice::of(two_sum(to[k], -a[k])));
    let (u, v) = (edge(b), edge(c));
    let n = cross(u, v);
    let largest = |v: &[TracedTwice; 3]| v.iter().fold(0.0f64, |m, x| m.max(x.truth().abs()));
    let terms = |i: usize, j: usize| (u[i].truth() * v[j].truth()).abs();
    let size = (0..3).flat_map(|i| (0..3).map(move |j| (i, j))).filter(|(i, j)| i != j);
    let size = size.map(|(i, j)| terms(i, j)).fold(0.0, f64::max);
    (largest(&n) >= 2f64.powi(-40) * size && size > 0.0).then_some(n)
}

/// A triangle whose third corner is off the line through the others by a part of any size.
fn corners(x: &[f64]) -> [[f64; 3]; 3] {
    let [a, b, w] = [0, 3, 6].map(|k| [x[k], x[k + 1], x[k + 2]]);
    let part = 2f64.powi((-42.0 * x[10].abs()) as i32);
    [a, b, [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * x[9] + part * w[k])]
}

fn cancelled(x: &[f64]) -> f64 {
    let Some(n) = across(corners(x)) else { return 0.0 };
    let length = |v: Vector<f64>| dot(v, v).sqrt();
    length(n.map(|x| x.error)) / length(n.map(TracedTwice::truth)) / UNIT
}

/// The stored normal, and the true one.
fn stored(n: Vector<TracedTwice>) -> Vector<Traced> {
    let square = dot(n, n);
    let y = 1.0 / square.value.0[0].sqrt();
    let one = TracedTwice::exact(1.0);
    let near = TracedTwice::input(y);
    let rest = one - square * (near * near);
    let inverse = TracedTwice::of(two_sum(y, 0.5 * y * rest.value.0[0]));
    // What is left of one tells how far the true inverse root is.
    let left = one - square * (inverse * inverse);
    let inverse = TracedTwice {
        error: 0.5 * y * left.truth(),
        ..inverse
    };
    n.map(|x| {
        let product = x * inverse;
        Traced {
            value: product.value.0[0],
            error: product.value.0[1] + product.error,
        }
    })
}

fn normal(x: &[f64]) -> f64 {
    across(corners(x)).map_or(0.0, |n| off(stored(n)) / UNIT)
}

/// An exact product of each coordinate, and their sum.
fn height(n: [f64; 3], p: [f64; 3]) -> TracedTwice {
    dot(n.map(TracedTwice::input), p.map(TracedTwice::input))
}

fn offset(x: &[f64]) -> f64 {
    let p = [x[3], x[4], x[5]];
    let size = dot(p, p).sqrt();
    height(unit(x), p).error.abs() / size / (UNIT * UNIT)
}

/// How far a corner of a face is below the stored offset, over the radius.
fn near_plane(x: &[f64]) -> f64 {
    let points = [0, 3, 6].map(|k| [x[k], x[k + 1], x[k + 2]]);
    let Some(n) = across(points) else { return 0.0 };
    let n = stored(n).map(|x| x.value);
    let radius = points.iter().map(|p| dot(*p, *p).sqrt()).fold(0.0, f64::max);
    let factor = 1.0625 * UNIT * (1.0 + 8.0 * UNIT) + 64.0 * UNIT * UNIT;
    let slack = (radius + dot(points[0], points[0]).sqrt()) * factor;
    let offset = (height(n, points[0]) + TracedTwice::input(slack)).value.0[0].next_up();
    (offset - dot(n, points[1])).max(offset - dot(n, points[2])) / radius / UNIT
}

/// What single precision makes of a number, in its roundings of another.
fn off_single(single: f32, truth: f64, per: f64) -> f64 {
    (f64::from(single) - truth).abs() / per / UNIT_SINGLE
}

fn column_sum(x: &[f64]) -> f64 {
    let [a, b] = [x[0] as f32, x[1] as f32];
    off_single(a + b, f64::from(a) + f64::from(b), (a.abs() + b.abs()).into())
}

/// Two moves, each a raised difference.
fn column_move(x: &[f64]) -> f64 {
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| x[k] as f32);
    let factor = 1.0 + 8.0 * f32::EPSILON;
    let [p, q] = [(a, b), (c, d)].map(|(x, y)| ((x - y).abs(), (f64::from(x) - f64::from(y)).abs()));
    let truth = (p.1 + q.1) * f64::from(factor);
    off_single(p.0 * factor + q.0 * factor, truth, truth)
}

/// The begin of a search, of a bound and the longest box.
fn column_search(x: &[f64]) -> f64 {
    let [low, longest] = [x[0] as f32, x[1].abs() as f32];
    let (factor, slack) = (1.000_01f32, 8.0 * f32::EPSILON * low.abs());
    let truth = f64::from(low) - f64::from(longest) * f64::from(factor) - f64::from(slack);
    off_single(low - longest * factor - slack, truth, (low.abs() + longest).into())
}

/// A raised difference.
fn column_reach(x: &[f64]) -> f64 {
    let [a, b] = [x[0] as f32, x[1] as f32];
    let factor = 1.000_01f32;
    let truth = (f64::from(a) - f64::from(b)) * f64::from(factor);
    off_single((a - b) * factor, truth, truth.abs())
}

/// A curve of control points before or behind a place.
fn cut(points: &mut [Traced], by: impl Fn(Traced, Traced) -> Traced, is_before: bool) {
    let n = points.len();
    let mut kept = points.to_vec();
    for level in 1..n {
        for i in 0..n - level {
            kept[i] = by(kept[i], kept[i + 1]);
        }
        if is_before {
            points[level] = kept[0];
        } else {
            points[n - 1 - level] = kept[n - 1 - level];
        }
    }
}

/// The points of numerator and denominator over their weights, over the largest distance of a control point.
fn quotients([above, below]: [Vec<Traced>; 2], largest: f64) -> f64 {
    let off = |(a, b): (&Traced, &Traced)| a.over(*b).error.abs() / largest / UNIT;
    above.iter().zip(&below).map(off).fold(0.0, f64::max)
}

/// Products of weight and coordinate, and the weights.
fn homogeneous(x: &[f64], weights: &[f64]) -> [Vec<Traced>; 2] {
    let weights: Vec<Traced> = weights.iter().map(|w| Traced::input(0.5 + 0.25 * w.abs())).collect();
    let points = x.iter().zip(&weights).map(|(x, w)| Traced::input(*x) * *w);
    [points.collect(), weights]
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// Halves of a cubic, as often as they still change.
fn halves(x: &[f64]) -> f64 {
    let mut nets = homogeneous(&x[..4], &x[4..8]);
    let which = x[8].to_bits();
    for k in 0..52 {
        let middle = |a, b| Number::times_power(a + b, -1);
        nets.iter_mut().for_each(|net| cut(net, middle, which >> k & 1 == 0));
    }
    quotients(nets, largest(&x[..4]))
}

/// Two cuts in each of two directions of degree seven, all along one curve.
fn cuts(x: &[f64]) -> f64 {
    let mut nets = homogeneous(&x[..8], &x[8..16]);
    for (k, at) in x[16..20].iter().enumerate() {
        let t = Traced::input(0.5 * at.abs());
        let s = Traced::exact(1.0) - t;
        nets.iter_mut()
            .for_each(|net| cut(net, |a, b| s * a + t * b, k % 2 == 0));
    }
    quotients(nets, largest(&x[..8]))
}
