//! Signs of sums of products, and bounds of heights.

use super::{Climb, UNIT, climb, length, unit, vectors};
use crate::kernels::signs;
use crate::number::{Number, Vector, dot, sub};
use crate::traced::Traced;

pub(super) const ALL: &[Climb] = &[
    climb("EDGE_SIGN", "", 9, edge_sign),
    climb("STEEPER", "", 15, steeper),
    climb("SIDE_ERROR", "", 12, side_error),
    climb("ORIENTATION", "", 12, orientation),
    climb("VOLUME", "rounding", 9, volume),
    climb("FOOT", "side", 12, foot),
    climb("CELL", "", 6, cell),
    climb("HEIGHT", "", 9, height),
    climb("EDGE_BOUND", "", 14, edge_bound),
];

fn edge_sign(x: &[f64]) -> f64 {
    let [p, q, n] = vectors(x);
    let (value, size) = signs::rise(n, sub(q, p));
    value.error.abs() / size.truth() / UNIT
}

fn steeper(x: &[f64]) -> f64 {
    let [n, m, p, q, r] = vectors(x);
    let (value, size) = signs::slopes([n, m], [sub(q, p), sub(r, p)]);
    value.error.abs() / size.truth() / UNIT
}

fn side_error(x: &[f64]) -> f64 {
    let [a, b, c, p] = vectors(x);
    let (u, w, d) = (sub(b, a), sub(c, a), sub(p, a));
    let size = dot(signs::products(u, w), d.map(Number::abs));
    signs::side([u, w, d]).error.abs() / size.truth() / UNIT
}

fn volume(x: &[f64]) -> f64 {
    let [a, b, c] = vectors(x);
    signs::volume([a, b, c]).error.abs() / (length(a) * length(b) * length(c)) / UNIT
}

/// Half, as the code takes `|u|^2 + |v|^2` for `2 |u| |v|`.
fn orientation(x: &[f64]) -> f64 {
    let [from, to, apex, _] = vectors(x);
    let size = length(sub(from, to)) * length(sub(apex, to)) * length(to);
    0.5 * signs::pyramid_side([from, to, apex]).1.error.abs() / size / UNIT
}

fn foot(x: &[f64]) -> f64 {
    let [a, b, p, _] = vectors(x);
    let n: Vector<f64> = unit(&x[9..]);
    let (edge, to) = (sub(b, a), sub(p, a));
    signs::over_side(Traced::vector(&n), edge, to).error.abs() / (length(edge) * length(to)) / UNIT
}

fn cell(x: &[f64]) -> f64 {
    let [n, p] = vectors(x);
    2.0 * dot(n, p).error.abs() / (length(n) * length(p)) / UNIT
}

/// Over the 1-norm of the direction, for points no farther than one from the middle.
fn height(x: &[f64]) -> f64 {
    let [n, p, middle] = vectors(x);
    let size = length(n) * length(p).max(length(middle)).max(length(sub(p, middle)));
    signs::height_over(n, p, middle).error.abs() / size / UNIT
}

/// What the bound of the code without its error term is below the true one, in the term's weights.
fn edge_bound(x: &[f64]) -> f64 {
    let [mut n, mut left, mut right]: [Vector<f64>; 3] = [unit(x), unit(&x[3..]), unit(&x[6..])];
    if x[13] > 0.0 {
        // A thin body.
        let thin = 2f64.powi((-30.0 * x[12].abs()) as i32);
        right = unit(&[0, 1, 2].map(|k| thin * right[k] - left[k]));
    }
    if x[12] > 0.0 {
        // The rest along an axis: its 1-norm is its length.
        n = unit(&[0.0, n[1], n[2]]);
        left = unit(&[left[0], n[1] * left[1].abs(), n[2] * left[1].abs()]);
    }
    let weights = [x[9].abs(), if x[10] > 0.0 { x[10] } else { 0.0 }];
    let m = [0, 1, 2].map(|k| left[k] * weights[0] + right[k] * weights[1]);
    let scale = dot(n, n) / dot(m, n);
    let traced = |v: Vector<f64>| Traced::vector::<3>(&v);
    let settle = Traced::input;
    // A vertex along the rest, and offsets just above its heights.
    let rest = [0, 1, 2].map(|k| n[k] - m[k] * scale);
    let size = rest.iter().map(|x| x * x).sum::<f64>().sqrt();
    let vertex = rest.map(|r| r / size * (1.0 + x[11].abs()));
    let square = dot(traced(vertex), traced(vertex));
    let near = square.truth().sqrt();
    let excess = Traced::input(near) * Traced::input(near) - square;
    let radius = if excess.truth() < 0.0 { near.next_up() } else { near };
    let offset = |plane: &Vector<f64>| {
        let h = signs::rise(traced(*plane), traced(vertex)).0;
        let near = h.truth();
        if (h.value - near) + h.error > 0.0 {
            near.next_up()
        } else {
            near
        }
    };
    let planes = [
        (traced(left), settle(offset(&left))),
        (traced(right), settle(offset(&right))),
    ];
    let parts = signs::two_planes(traced(n), planes, weights.map(settle), settle(scale));
    let bound = signs::two_planes_bound(&parts, 0.0, settle(radius));
    let truth = signs::rise(traced(n), traced(vertex)).0;
    let short = (truth.value - bound.value) + truth.error;
    if scale > 0.0 {
        short / (scale * (weights[0] + weights[1]) * radius) / UNIT
    } else {
        0.0
    }
}
