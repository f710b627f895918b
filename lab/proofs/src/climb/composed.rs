//! Kernels made of several: casts, motions, quotients and roots, curved surfaces.

use super::{Climb, UNIT, climb, divided, factor_of, length, off, relative, root_of_squares, unit};
use crate::kernels::planes::{self, Turning};
use crate::kernels::{patches, poses};
use crate::number::{Number, Vector, cross, dot, scaled, sub, sum};
use crate::traced::Traced;
use crate::vectors::Coordinates;

type Traces = Coordinates<Traced>;

pub(super) const ALL: &[Climb] = &[
    climb("EXACT_FILTER", "", 10, exact_filter),
    climb("SLANT", "", 6, slant),
    climb("BOX", "", 7, boxed),
    climb("SLAB_HEIGHT", "", 6, along_axis),
    climb("TILT", "", 9, tilt),
    climb("ARM_VALUE", "", 3, between),
    climb("ROOT", "one crossing", 2, crossing),
    climb("PLATEAU", "", 6, plateau),
    climb("DISC", "", 6, disc),
    climb("ROUND_UP", "", 3, norm),
    climb("LENGTH", "", 3, norm),
    climb("BOX_DISTANCE_DOWN", "", 6, distance),
    climb("WAY", "", 15, way),
    climb("INNER", "", 9, inner_ball),
    climb("TURN", "steady", 9, steady),
    climb("TURN", "nlerp", 9, interpolated),
    climb("NORMALISED", "", 4, normalised),
    climb("PLANE", "", 24, plane),
    climb("BALLS", "a square, and the root", 7, balls),
    climb("RAY", "a ball", 6, ball_of_ray),
    climb("PLACED", "", 10, placed),
    climb("ARM_TURN", "", 13, arm_turn),
    climb("SHAPE_POINT", "", 11, shape_point),
    climb("KNOTS", "", 18, knots),
    climb("RAISED", "", 4, raised),
    climb("NET", "", 2, homogeneous),
    climb("CURVATURE", "", 4, curvature),
    climb("TAYLOR", "", 10, taylor),
    climb("PATCH_SLOPE", "", 34, patch_slope),
    climb("BENT", "", 78, bent),
];

fn inputs<const K: usize>(x: &[f64]) -> [Traced; K] {
    Traced::vector(x)
}

/// A vector of length one as the code holds it, without an error.
fn direction<const K: usize>(x: &[f64]) -> [Traced; K] {
    inputs(&unit::<K>(x))
}

/// A rotation matrix without an error.
fn matrix(x: &[f64]) -> [Vector<Traced>; 3] {
    poses::matrix(direction(x), Traced::input(2.0)).map(|row| row.map(|x| Traced::input(x.value)))
}

fn exact_filter(x: &[f64]) -> f64 {
    let (n, v) = (direction::<3>(x), inputs(&x[3..]));
    dot(n, poses::product(matrix(&x[6..]), v)).error.abs() / length(v) / UNIT
}

/// Two slants of a gradient of three quarters, and their difference.
fn slant(x: &[f64]) -> f64 {
    let g = unit::<3>(x).map(|x| Traced::input(0.75 * x));
    let u = inputs::<3>(&x[3..]);
    let height = dot(g, u);
    2.0 * (height * height).over(dot(u, u)).error.abs() / UNIT
}

fn boxed(x: &[f64]) -> f64 {
    let (q, v) = (direction::<4>(x), inputs::<3>(&x[4..]));
    let norm = poses::squared_norm(q);
    let m = poses::matrix(q, factor_of(&[norm], 2.0 / norm.value));
    let row = poses::product(m, v)[0];
    row.error.abs() / length(v) / UNIT
}

fn along_axis(x: &[f64]) -> f64 {
    let p = inputs::<3>(&x[3..]);
    dot(direction(x), p).error.abs() / length(p) / UNIT
}

fn tilt(x: &[f64]) -> f64 {
    let [w, v] = [&x[3..], &x[6..]].map(inputs::<3>);
    off(cross(direction(x), sub(w, v))) / length(w).max(length(v)) / UNIT
}

fn between(x: &[f64]) -> f64 {
    let [a, b, t] = inputs(&[x[0], x[1], 0.5 * x[2].abs()]);
    (a + (b - a) * t).error.abs() / x[0].abs().max(x[1].abs()) / UNIT
}

/// The last of the three pieces, whose place is the largest: relative to the place.
fn crossing(x: &[f64]) -> f64 {
    let [p, q] = inputs(&[x[0].abs(), -x[1].abs()]);
    let third: f64 = 1.0 / 3.0;
    let error = (-third).mul_add(3.0, 1.0) / 3.0;
    relative(p.over(p - q) * Traced { value: third, error })
}

fn plateau(x: &[f64]) -> f64 {
    let [n, p] = [x, &x[3..]].map(inputs::<3>);
    let size: f64 = (0..3).map(|k| (x[k] * x[3 + k]).abs()).sum();
    2.0 * dot(n, p).error.abs() / size / UNIT
}

/// Of positive numbers, as its radius is.
fn disc(x: &[f64]) -> f64 {
    let [a, b, c, d, e, f] = inputs(x).map(Number::abs);
    let off = a * (b * b + c * c).root() + d.root();
    relative((off * e).over(f) * a)
}

fn norm(x: &[f64]) -> f64 {
    relative(root_of_squares(inputs::<3>(x)))
}

fn distance(x: &[f64]) -> f64 {
    let [a, b] = [x, &x[3..]].map(inputs::<3>);
    relative(root_of_squares(sub(a, b)))
}

fn way(x: &[f64]) -> f64 {
    let four: [Traced; 4] = inputs(x);
    let [p, q] = [&x[4..], &x[8..]].map(inputs::<4>);
    let turn = four[0].abs() * root_of_squares::<4>(std::array::from_fn(|k| p[k] - q[k]));
    relative(turn + root_of_squares::<3>(inputs(&x[12..])))
}

/// `c^2 / (n . s)`, with the support point of products of the code's own.
fn inner_ball(x: &[f64]) -> f64 {
    let [axes, n, c] = [x, &x[3..], &x[6..]].map(|x| inputs::<3>(x).map(Number::abs));
    let scaled = [0, 1, 2].map(|k| axes[k] * n[k]);
    let size = root_of_squares(scaled);
    let support = [0, 1, 2].map(|k| (axes[k] * axes[k] * n[k]).over(size));
    relative(c[0] * c[0].over(dot(n, support)) * c[1])
}

/// A turn about an axis of three inputs, for a sine and a cosine of two without an error.
fn spun(x: &[f64]) -> [Traced; 4] {
    planes::spun(divided(inputs::<3>(x)), direction(&x[3..]), Traced::input(0.0))
}

/// Four times the error of the quaternion: an angle is twice as much, and so are two poses.
fn steady(x: &[f64]) -> f64 {
    4.0 * off(planes::composed(spun(x), direction::<4>(&x[5..]))) / UNIT
}

/// At a time between two rotations that are not opposite.
fn interpolated(x: &[f64]) -> f64 {
    let (p, q) = (direction::<4>(x), direction::<4>(&x[4..]));
    let facing = (0..4).map(|k| p[k].value * q[k].value).sum::<f64>() >= 0.0;
    let t = Traced::input(0.5 * x[8].abs());
    let s = Traced::exact(1.0) - t;
    let sum: [Traced; 4] = std::array::from_fn(|k| p[k] * s + if facing { q[k] } else { -q[k] } * t);
    // The length does not turn: what counts is the error at right angles.
    let (rounded, length) = (divided(sum), length(sum));
    let along: f64 = rounded
        .iter()
        .zip(&sum)
        .map(|(r, s)| r.error * s.truth() / length)
        .sum();
    let across = rounded
        .iter()
        .zip(&sum)
        .map(|(r, s)| r.error - along * s.truth() / length);
    4.0 * across.map(|x| x * x).sum::<f64>().sqrt() / UNIT
}

fn normalised(x: &[f64]) -> f64 {
    let rounded = divided(inputs::<4>(x)).map(|x| Traced::input(x.value));
    let squares = rounded.map(|x| x * x);
    let sum = ((squares[0] + squares[1]) + squares[2]) + squares[3];
    ((sum.value - 1.0) + sum.error).abs() / UNIT
}

/// All coefficients of the gap, over the square of the angles and the sum of the lengths.
fn plane(x: &[f64]) -> f64 {
    let (n, two) = (direction::<3>(x), Traced::exact(2.0));
    let at = |k: usize| inputs::<3>(&x[3 * k..]);
    let (spin, rate, support) = (at(1), at(2), at(6));
    let turning = Turning::<Traces> { normal: n, spin, rate };
    let derivatives = planes::derivatives(&turning, two);
    let (all, half) = (Traced::exact(1.0), Traced::exact(0.5));
    let [near, far] = planes::directions::<Traces>(n, derivatives, [half, all]);
    let [f0, f1, f2] = planes::way(&turning, [at(3), at(4), at(5)], two);
    let (m, none) = (matrix(&x[20..]), [Traced::exact(0.0); 3]);
    let height = |along| planes::height::<Traces>(m, along, none, support);
    let b0 = f0 - height(n);
    let b1 = f0 + f1 * half - height(near);
    let b2 = f0 + (f1 + f2 * half) * all - height(far);
    let third = Traced::input(1.0 / 3.0);
    let off = [b0, (b0 + two * b1) * third, (two * b1 + b2) * third, b2];
    let q = 1.0 + length(spin) + length(rate);
    let size: f64 = (3..7).map(|k| length(at(k))).sum();
    off.iter().fold(0.0f64, |m, x| m.max(x.error.abs())) / (q * q * size) / UNIT
}

/// Both parts, in lengths and velocities of one.
fn balls(x: &[f64]) -> f64 {
    let [from, velocity] = [x, &x[3..]].map(inputs::<3>);
    let radius = Traced::input(x[6].abs());
    let more = Traced::input(2f64.powi(-40));
    let [above, _, speed, root] = planes::approach::<Traces>(from, velocity, radius, more);
    let size = length(from).max(radius.value).powi(2);
    2.0 * (above.error.abs() / size + root.error.abs() / (size * speed.value)) / UNIT
}

/// The place along the ray, and the distance from the ray.
fn ball_of_ray(x: &[f64]) -> f64 {
    let (way, d) = (inputs::<3>(x), divided(inputs::<3>(&x[3..])));
    let along = dot(way, d);
    let aside = sub(way, scaled(d, along));
    let apart = root_of_squares(aside).error.abs();
    (along.error.abs() + if apart.is_finite() { apart } else { 0.0 }) / length(way) / UNIT
}

fn placed(x: &[f64]) -> f64 {
    let q = divided(inputs::<4>(x));
    let (v, t) = (inputs(&x[4..]), inputs(&x[7..]));
    off(sum(poses::turned(q, v), t)) / (length(v) + length(t)) / UNIT
}

fn arm_turn(x: &[f64]) -> f64 {
    let fixed = planes::composed(direction(x), spun(&x[4..]));
    2.0 * off(planes::composed(direction::<4>(&x[9..]), fixed)) / UNIT
}

fn shape_point(x: &[f64]) -> f64 {
    let q = divided(planes::composed(direction(x), direction(&x[4..])));
    let v = inputs(&x[8..]);
    off(poses::turned(q, v)) / length(v) / UNIT
}

/// Degree seven in one direction, over ordered knots.
fn knots(x: &[f64]) -> f64 {
    let mut at = [0.0; 9];
    for k in 0..8 {
        at[k + 1] = at[k] + x[8 + k].abs();
    }
    let t = Traced::input(at[4] + (at[5] - at[4]) * 0.5 * x[16].abs());
    let points = x[..8].iter().map(|x| Traced::input(x.abs())).collect();
    let value = patches::blossom(points, |level, i| {
        let (low, high) = (at[i.saturating_sub(level).min(4)], at[(i + 1).max(5)]);
        let (low, high) = (Traced::input(low), Traced::input(high));
        let width = high - low;
        [(high - t).over(width), (t - low).over(width)]
    });
    relative(value)
}

/// From degree one to seven.
fn raised(x: &[f64]) -> f64 {
    let mut points: Vec<Traced> = x[..2].iter().map(|x| Traced::input(x.abs())).collect();
    for n in 1..7usize {
        let part = |j: usize| Traced::input(j as f64).over(Traced::input((n + 1) as f64));
        points = patches::raise(points, |j| [part(n + 1 - j), part(j)]);
    }
    points.into_iter().map(relative).fold(0.0, f64::max)
}

/// A product of weight and coordinate, over the weight.
fn homogeneous(x: &[f64]) -> f64 {
    let [p, w] = inputs(x).map(Number::abs);
    relative((p * w).over(w))
}

/// Second differences of degrees seven and one, over 64.
fn curvature(x: &[f64]) -> f64 {
    let [a, b, c, _] = inputs(x);
    let most = x.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let second = a - Number::times_power(b, 1) + c;
    let factor = Traced::input(42.0);
    (second * factor).error.abs() / (64.0 * most) / UNIT
}

/// The value and a first derivative of degrees one and four, over 25.
fn taylor(x: &[f64]) -> f64 {
    let points: Vec<Traced> = x[..5].iter().map(|x| Traced::input(*x)).collect();
    let t = Traced::input(0.5 * x[9].abs());
    let s = Traced::exact(1.0) - t;
    let most = x[..5].iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let value = patches::end(points.clone(), s, t);
    let slope = patches::first(points, s, t) * Traced::exact(4.0);
    (value.error.abs() + slope.error.abs()) / (25.0 * most) / UNIT
}

/// A first derivative of degrees three and three, over its bound.
fn patch_slope(x: &[f64]) -> f64 {
    let weights: Vec<Traced> = x[16..32].iter().map(|w| Traced::input(0.5 + 0.25 * w.abs())).collect();
    let points: Vec<Traced> = x[..16]
        .iter()
        .zip(&weights)
        .map(|(p, w)| Traced::input(*p) * *w)
        .collect();
    let [u, v] = [32, 33].map(|k| Traced::input(0.5 * x[k].abs()));
    let ends = |t| (Traced::exact(1.0) - t, t);
    let along_u = |net: &[Traced]| {
        let (s, t) = ends(v);
        let row = |i: usize| patches::end(net[4 * i..][..4].to_vec(), s, t);
        let rows: Vec<Traced> = (0..4).map(row).collect();
        let (s, t) = ends(u);
        let slope = patches::first(rows.clone(), s, t) * Traced::exact(3.0);
        (patches::end(rows, s, t), slope)
    };
    let ((above, above_u), (below, below_u)) = (along_u(&points), along_u(&weights));
    let slope = (above_u - above.over(below) * below_u).over(below);
    let reach = x[..16].iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let ratio = |of: fn(f64, f64) -> f64| weights.iter().map(|w| w.value).reduce(of).expect("sixteen");
    slope.error.abs() / (18.0 * reach * ratio(f64::max) / ratio(f64::min)) / UNIT
}

/// The coefficient in the middle of a height above a bowl, degrees three and three: control points, weights, point of
/// contact, normal, and a form whose gradient is at most one.
fn bent(x: &[f64]) -> f64 {
    let (n, at) = (direction::<3>(&x[64..]), inputs::<3>(&x[67..]));
    let e = divided(cross(n, inputs(&x[70..]))).map(|x| Traced::input(x.value));
    let f = cross(n, e).map(|x| Traced::input(x.value));
    let size = |v: &[f64]| v[..3].iter().map(|x| x * x).sum::<f64>().sqrt();
    let reach = (0..16).map(|k| size(&x[3 * k..])).fold(0.0, f64::max) + size(&x[67..]);
    let form = [73, 74, 75].map(|k| Traced::input(0.25 * x[k] / reach));
    let half = Traced::exact(0.5);
    let binomial = [1.0, 3.0, 3.0, 1.0];
    let rows: Vec<[Traced; 6]> = (0..16)
        .map(|k| {
            let w = Traced::input(0.5 + 0.25 * x[48 + k].abs());
            let point = inputs::<3>(&x[3 * k..]).map(|p| p * w);
            let place = sub(point, scaled(at, w));
            let (s, t) = (dot(e, place), dot(f, place));
            let scale = Traced::exact(binomial[k / 4] * binomial[k % 4]);
            let images = [form[0] * s + form[1] * t, form[1] * s + form[2] * t].map(|x| half * x);
            [dot(n, place), s, t, images[0], images[1], w].map(|x| scale * x)
        })
        .collect();
    // The middle of degrees six and six lies between the third and the fourth of each row: (3, 3).
    let pairs = (0..16).map(|k| (&rows[k], &rows[15 - k]));
    let none = [Traced::exact(0.0); 2];
    let [above, below] = pairs.fold(none, |[above, below], (i, j)| {
        let height = i[0] * j[5] + i[1] * j[3] + i[2] * j[4];
        [above + height, below + i[5] * j[5]]
    });
    above.over(below).error.abs() / reach / UNIT
}
