//! Model of the support value near a direction, and the maximum of the model.
//!
//! If the direction moves by `d` in the tangent plane, branch pair `i` has the height
//! `c_i + g_i . d - d . M d / 2`. `M` is the weighted sum of the second derivatives of all pairs,
//! plus `mu` times the identity. The model is the minimum over the pairs. By duality, its maximum
//! over `d` is the minimum of `l . c + |sum of l_i y_i|^2 / 2` over weights `l` that are not
//! negative and sum to one, with `y_i = L^-1 g_i` and `M = L L^T`. This is a least-norm problem in
//! the plane, so at most three weights are positive.

use super::posed::PlaneStep;
use crate::base::num::each::Each;
use crate::base::num::scalar::Scalar;

/// Largest number of branch pairs in a model.
pub(super) const MOST: usize = 4;

/// One branch pair of the model.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ModelPlane<T> {
    /// Height along the direction.
    pub(super) c: T,
    /// Slope of the height in the tangent plane.
    pub(super) g: PlaneStep<T>,
    /// Second derivative: entries 00, 01, 11.
    pub(super) bend: [T; 3],
}

/// Maximum of the model.
#[derive(Clone, Copy, Debug)]
pub(super) struct Top<T> {
    pub(super) weights: [T; MOST],
    pub(super) step: PlaneStep<T>,
}

/// Factors `M = L D L^T`; returns the entry of `L` below the unit diagonal and the inverse of `D`.
/// No square root is taken, so if lengths are scaled by a power of two, all results scale exactly.
fn factor<T: Scalar>(m: &[T; 3]) -> Option<(T, [T; 2])> {
    let zero = T::from(0.0);
    if !(m[0] > zero) {
        return None;
    }
    let l = m[1] / m[0];
    let rest = m[2] - l * m[1];
    let one = T::from(1.0);
    // The pivot exceeds rounding.
    (rest.value() > crate::base::tolerance::PIVOT * m[2].value()).then(|| (l, [one / m[0], one / rest]))
}

/// Returns the weighted sum of the second derivatives and `mu` times the identity.
#[inline(always)]
fn matrix<T: Scalar>(planes: &[ModelPlane<T>], prior: &[T], mu: T) -> [T; 3] {
    let mut m = [mu, T::from(0.0), mu];
    for (plane, &weight) in planes.iter().zip(prior) {
        for (entry, &bend) in m.iter_mut().zip(&plane.bend) {
            *entry = *entry + bend * weight;
        }
    }
    m
}

/// Returns the step of Newton's method for one branch pair. If `M` is not positive definite, the
/// step is not finite or leads to a minimum.
#[inline(always)]
pub(super) fn newton<T: Scalar>(plane: &ModelPlane<T>, mu: T) -> PlaneStep<T> {
    let ([b, off, e], g) = (plane.bend, &plane.g);
    let (b, e) = (b + mu, e + mu);
    let inverse = T::from(1.0) / (b * e - off * off);
    [(e * g[0] - off * g[1]) * inverse, (b * g[1] - off * g[0]) * inverse]
}

/// Returns the maximum, with `M` from the weights `prior`, or `None` if `M` is not positive
/// definite.
pub(super) fn top<T: Scalar>(planes: &[ModelPlane<T>], prior: &[T; MOST], mu: T) -> Option<Top<T>> {
    let zero = T::from(0.0);
    let m = matrix(planes, prior, mu);
    let (l, inverse) = factor(&m)?;
    let mut y = [[zero; 2]; MOST];
    for (y, plane) in y.iter_mut().zip(planes) {
        *y = [plane.g[0], plane.g[1] - l * plane.g[0]];
    }
    let (weights, at) = least_norm(planes, &y, &inverse);
    let second = at[1] * inverse[1];
    let step = [at[0] * inverse[0] - l * second, second];
    Some(at_kink(planes, &m, &weights).unwrap_or(Top { weights, step }))
}

/// Returns step and weights of the two or three weighted branch pairs, from the kink where they are
/// equally high. The weighted sum of the `y` cancels, and is divided by a `mu` that vanishes with
/// the height; the kink has neither problem.
fn at_kink<T: Scalar>(planes: &[ModelPlane<T>], m: &[T; 3], kept: &[T; MOST]) -> Option<Top<T>> {
    let zero = T::from(0.0);
    let mut positive = (0..planes.len()).filter(|&k| kept[k] > zero);
    let (i, j, k) = (positive.next()?, positive.next()?, positive.next());
    let (step, found) = match k {
        Some(k) => between_three([&planes[i], &planes[j], &planes[k]], m),
        None => between_two([&planes[i], &planes[j]], m),
    };
    let found = found.each(|x| if x > zero { x } else { zero });
    let (mut weights, sum) = ([zero; MOST], found[0] + found[1] + found[2]);
    for (at, weight) in [Some(i), Some(j), k].into_iter().zip(found) {
        if let Some(at) = at {
            weights[at] = weight / sum;
        }
    }
    step.iter()
        .all(|x| x.value().is_finite())
        .then_some(Top { weights, step })
}

#[inline(always)]
fn plane_dot<T: Scalar>(a: &PlaneStep<T>, b: &PlaneStep<T>) -> T {
    a[0] * b[0] + a[1] * b[1]
}

#[inline(always)]
fn plane_sub<T: Scalar>(a: &PlaneStep<T>, b: &PlaneStep<T>) -> PlaneStep<T> {
    [a[0] - b[0], a[1] - b[1]]
}

#[inline(always)]
fn bent<T: Scalar>(m: &[T; 3], d: &PlaneStep<T>) -> PlaneStep<T> {
    [m[0] * d[0] + m[1] * d[1], m[1] * d[0] + m[2] * d[1]]
}

/// Returns the highest point on the kink of two branch pairs, and weights that sum to one.
#[inline(always)]
fn between_two<T: Scalar>([p, q]: [&ModelPlane<T>; 2], m: &[T; 3]) -> (PlaneStep<T>, [T; 3]) {
    let (g, h) = (&p.g, &q.g);
    let e = plane_sub(g, h);
    let (inverse, along) = (T::from(1.0) / plane_dot(&e, &e), [-e[1], e[0]]);
    let share = (q.c - p.c) * inverse;
    let start = [e[0] * share, e[1] * share];
    let by = (plane_dot(&along, g) - plane_dot(&along, &bent(m, &start))) / plane_dot(&along, &bent(m, &along));
    let step = [start[0] + along[0] * by, start[1] + along[1] * by];
    let weight = plane_dot(&plane_sub(&bent(m, &step), h), &e) * inverse;
    (step, [weight, T::from(1.0) - weight, T::from(0.0)])
}

/// Returns the point at which three branch pairs are equally high, and weights that sum to one.
#[inline(always)]
fn between_three<T: Scalar>([p, q, r]: [&ModelPlane<T>; 3], m: &[T; 3]) -> (PlaneStep<T>, [T; 3]) {
    let (u, v) = (plane_sub(&p.g, &r.g), plane_sub(&q.g, &r.g));
    let inverse = T::from(1.0) / (u[0] * v[1] - u[1] * v[0]);
    let (s, t) = (r.c - p.c, r.c - q.c);
    let step = [(s * v[1] - t * u[1]) * inverse, (t * u[0] - s * v[0]) * inverse];
    let off = plane_sub(&bent(m, &step), &r.g);
    let first = (off[0] * v[1] - off[1] * v[0]) * inverse;
    let second = (u[0] * off[1] - u[1] * off[0]) * inverse;
    (step, [first, second, T::from(1.0) - first - second])
}

/// Returns the weights that minimise `l . c + y . D^-1 y / 2`, and `y`, the weighted sum.
fn least_norm<T: Scalar>(planes: &[ModelPlane<T>], y: &[PlaneStep<T>; MOST], d: &[T; 2]) -> ([T; MOST], PlaneStep<T>) {
    let (zero, one) = (T::from(0.0), T::from(1.0));
    let base = planes[0].c;
    let c = |i: usize| planes[i].c - base;
    let dot = |a: &PlaneStep<T>, b: &PlaneStep<T>| a[0] * b[0] * d[0] + a[1] * b[1] * d[1];
    let sub = plane_sub;
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
                // The point at which all three are equally high, in terms of the products with u
                // and v.
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
