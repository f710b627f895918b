//! The model of the height near a direction, and its maximum.
//!
//! With the direction turned by `d` in the tangent plane, piece `i` has height `c_i + g_i . d` less
//! the bend `d . M d / 2`, where `M` is the weighted sum of the second derivatives of all pieces
//! and `mu` times the identity. The model is the least over the pieces. Its greatest value over `d`
//! is, by duality, the least over the weights `l` (not negative, of sum one) of
//! `l . c + |sum of l_i y_i|^2 / 2`, with `y_i = L^-1 g_i` and `M = L L^T`: a least-norm problem in
//! the plane, in which at most three weights are positive.

use super::posed::Tangent;
use crate::num::scalar::Scalar;

/// Most pieces of a model.
pub(super) const MOST: usize = 4;

/// One piece as the model sees it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Plane<T> {
    /// Height along the direction.
    pub(super) c: T,
    /// Its slope in the tangent plane.
    pub(super) g: Tangent<T>,
    /// Its second derivative: entries 00, 01, 11.
    pub(super) bend: [T; 3],
}

/// The maximum of the model.
#[derive(Clone, Copy, Debug)]
pub(super) struct Top<T> {
    pub(super) weights: [T; MOST],
    pub(super) step: Tangent<T>,
}

/// `M = L D L^T`: the entry of `L` below its unit diagonal, and the inverse of `D`. No root is
/// taken, so that lengths scaled by a power of two scale all results.
fn factor<T: Scalar>(m: &[T; 3]) -> Option<(T, [T; 2])> {
    let zero = T::from(0.0);
    if !(m[0] > zero) {
        return None;
    }
    let l = m[1] / m[0];
    let rest = m[2] - l * m[1];
    let one = T::from(1.0);
    // Not rounding alone.
    (rest.value() > crate::tolerance::PIVOT * m[2].value()).then(|| (l, [one / m[0], one / rest]))
}

/// The maximum, of `M` from the weights `prior`; none if `M` is not positive.
pub(super) fn top<T: Scalar>(planes: &[Plane<T>], prior: &[T; MOST], mu: T) -> Option<Top<T>> {
    let zero = T::from(0.0);
    let mut m = [mu, zero, mu];
    for (plane, &weight) in planes.iter().zip(prior) {
        for (entry, &bend) in m.iter_mut().zip(&plane.bend) {
            *entry = *entry + bend * weight;
        }
    }
    let (l, inverse) = factor(&m)?;
    let mut y = [[zero; 2]; MOST];
    for (y, plane) in y.iter_mut().zip(planes) {
        *y = [plane.g[0], plane.g[1] - l * plane.g[0]];
    }
    let (weights, at) = least_norm(planes, &y, &inverse);
    let second = at[1] * inverse[1];
    let step = [at[0] * inverse[0] - l * second, second];
    Some(kink(planes, &m, &weights).unwrap_or(Top { weights, step }))
}

/// Step and weights of two or three pieces from the kink where they are equally high. The sum of
/// the `y` loses what they have opposite to each other, over a `mu` that vanishes with the height;
/// the kink does not.
fn kink<T: Scalar>(planes: &[Plane<T>], m: &[T; 3], kept: &[T; MOST]) -> Option<Top<T>> {
    let (zero, one) = (T::from(0.0), T::from(1.0));
    let mut positive = (0..planes.len()).filter(|&k| kept[k] > zero);
    let (i, j, k) = (positive.next()?, positive.next()?, positive.next());
    let dot = |a: &Tangent<T>, b: &Tangent<T>| a[0] * b[0] + a[1] * b[1];
    let sub = |a: &Tangent<T>, b: &Tangent<T>| [a[0] - b[0], a[1] - b[1]];
    let bent = |d: &Tangent<T>| [m[0] * d[0] + m[1] * d[1], m[1] * d[0] + m[2] * d[1]];
    let clamp = |x: T| if x > zero { x } else { zero };
    let mut weights = [zero; MOST];
    let step;
    if let Some(k) = k {
        let (u, v) = (sub(&planes[i].g, &planes[k].g), sub(&planes[j].g, &planes[k].g));
        let area = u[0] * v[1] - u[1] * v[0];
        let (p, q) = (planes[k].c - planes[i].c, planes[k].c - planes[j].c);
        step = [(p * v[1] - q * u[1]) / area, (q * u[0] - p * v[0]) / area];
        let off = sub(&bent(&step), &planes[k].g);
        weights[i] = clamp((off[0] * v[1] - off[1] * v[0]) / area);
        weights[j] = clamp((u[0] * off[1] - u[1] * off[0]) / area);
        weights[k] = clamp(one - weights[i] - weights[j]);
        let sum = weights[i] + weights[j] + weights[k];
        weights = weights.map(|weight| weight / sum);
    } else {
        let (g, h) = (&planes[i].g, &planes[j].g);
        let e = sub(g, h);
        let (squared, along) = (dot(&e, &e), [-e[1], e[0]]);
        let share = (planes[j].c - planes[i].c) / squared;
        let start = [e[0] * share, e[1] * share];
        let by = (dot(&along, g) - dot(&along, &bent(&start))) / dot(&along, &bent(&along));
        step = [start[0] + along[0] * by, start[1] + along[1] * by];
        let weight = clamp(dot(&sub(&bent(&step), h), &e) / squared);
        weights[i] = if weight < one { weight } else { one };
        weights[j] = one - weights[i];
    }
    step.iter()
        .all(|x| x.value().is_finite())
        .then_some(Top { weights, step })
}

/// The weights of least `l . c + y . D^-1 y / 2`, `y` the weighted sum, and that sum.
fn least_norm<T: Scalar>(planes: &[Plane<T>], y: &[Tangent<T>; MOST], d: &[T; 2]) -> ([T; MOST], Tangent<T>) {
    let (zero, one) = (T::from(0.0), T::from(1.0));
    let base = planes[0].c;
    let c = |i: usize| planes[i].c - base;
    let dot = |a: &Tangent<T>, b: &Tangent<T>| a[0] * b[0] * d[0] + a[1] * b[1] * d[1];
    let sub = |a: &Tangent<T>, b: &Tangent<T>| [a[0] - b[0], a[1] - b[1]];
    let mut best = (T::from(f64::INFINITY), [zero; MOST], [zero; 2]);
    let mut take = |parts: &[(usize, T)]| {
        let (mut value, mut at, mut weights) = (zero, [zero; 2], [zero; MOST]);
        for &(i, weight) in parts {
            value = value + c(i) * weight;
            at = [at[0] + y[i][0] * weight, at[1] + y[i][1] * weight];
            weights[i] = weight;
        }
        let value = value + dot(&at, &at) * T::from(0.5);
        if value < best.0 {
            best = (value, weights, at);
        }
    };
    for i in 0..planes.len() {
        take(&[(i, one)]);
        for j in 0..i {
            let e = sub(&y[i], &y[j]);
            let share = (c(j) - c(i) - dot(&y[j], &e)) / dot(&e, &e);
            if share > zero && share < one {
                take(&[(i, share), (j, one - share)]);
            }
            for k in 0..j {
                let (u, v) = (sub(&y[i], &y[k]), sub(&y[j], &y[k]));
                let area = u[0] * v[1] - u[1] * v[0];
                // The place where all three are equally high, from its products with u and v.
                let (p, q) = (c(k) - c(i), c(k) - c(j));
                let at = [
                    (p * v[1] - q * u[1]) / (area * d[0]),
                    (q * u[0] - p * v[0]) / (area * d[1]),
                ];
                let off = sub(&at, &y[k]);
                let first = (off[0] * v[1] - off[1] * v[0]) / area;
                let second = (u[0] * off[1] - u[1] * off[0]) / area;
                let third = one - first - second;
                if first > zero && second > zero && third > zero {
                    take(&[(i, first), (j, second), (k, third)]);
                }
            }
        }
    }
    (best.1, best.2)
}
