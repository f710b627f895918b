//! The minimum-norm search with exact signs.

use alloc::vec;
use alloc::vec::Vec;
use core::cmp::Ordering;

use dashu_base::Signed;
use dashu_int::IBig;

use crate::exact::integer::{Big3, cross, dot, is_zero, neg, sub};

/// A point of the set searched: its names and its place.
#[derive(Clone, Debug)]
pub(super) struct ExactPoint {
    pub(super) a: u32,
    pub(super) b: u32,
    pub(super) w: Big3,
}

/// The point of a simplex nearest to the origin.
#[derive(Clone, Debug)]
pub(super) struct Nearest {
    /// The corners whose hull holds it in its relative interior.
    pub(super) kept: Vec<ExactPoint>,
    /// Their weights, positive, as parts of `sum`.
    pub(super) weights: Vec<IBig>,
    pub(super) sum: IBig,
    /// A positive multiple of the point; zero where it is the origin.
    pub(super) direction: Big3,
}

impl Nearest {
    /// The squared distance from the origin as a fraction.
    pub(super) fn squared(&self) -> (IBig, IBig) {
        let w = |k: usize| &self.kept[k].w;
        match self.kept.len() {
            1 => (dot(w(0), w(0)), IBig::ONE),
            2 => {
                let d = sub(w(1), w(0));
                let area = cross(w(0), &d);
                (dot(&area, &area), dot(&d, &d))
            }
            _ => {
                let n = &self.direction;
                let height = dot(n, w(0));
                (&height * &height, dot(n, n))
            }
        }
    }
}

pub(super) fn sign(x: &IBig) -> i32 {
    match x.cmp(&IBig::ZERO) {
        Ordering::Less => -1,
        Ordering::Equal => 0,
        Ordering::Greater => 1,
    }
}

/// The weights and the direction of the nearest point of the affine hull of some corners, if it lies in the relative
/// interior of their hull.
fn inside(s: &[&ExactPoint]) -> Option<(Vec<IBig>, IBig, Big3)> {
    let positive = |w: &[IBig]| w.iter().all(|x| x.is_positive() && !x.is_zero());
    match s {
        [p] => Some((vec![IBig::ONE], IBig::ONE, p.w.clone())),
        [p, q] => {
            let d = sub(&q.w, &p.w);
            let w = vec![dot(&q.w, &d), -dot(&p.w, &d)];
            positive(&w).then(|| {
                let n = [0, 1, 2].map(|k| &w[0] * &p.w[k] + &w[1] * &q.w[k]);
                (w, dot(&d, &d), n)
            })
        }
        [p, q, r] => {
            let n = cross(&sub(&q.w, &p.w), &sub(&r.w, &p.w));
            let w = vec![
                dot(&n, &cross(&q.w, &r.w)),
                dot(&n, &cross(&r.w, &p.w)),
                dot(&n, &cross(&p.w, &q.w)),
            ];
            positive(&w).then(|| {
                let (sum, height) = (dot(&n, &n), sign(&dot(&n, &p.w)));
                let n = match height {
                    0 => [IBig::ZERO, IBig::ZERO, IBig::ZERO],
                    1 => n,
                    _ => neg(&n),
                };
                (w, sum, n)
            })
        }
        [p, q, r, t] => {
            let det = |x: &ExactPoint, y: &ExactPoint, z: &ExactPoint| dot(&x.w, &cross(&y.w, &z.w));
            let mut w = vec![det(q, r, t), -det(p, r, t), det(p, q, t), -det(p, q, r)];
            let mut sum = &w[0] + &w[1] + &w[2] + &w[3];
            if sign(&sum) < 0 {
                sum = -sum;
                w.iter_mut().for_each(|x| *x = -&*x);
            }
            positive(&w).then_some((w, sum, [IBig::ZERO, IBig::ZERO, IBig::ZERO]))
        }
        _ => None,
    }
}

/// The nearest point of the hull of one to four corners.
///
/// A subset holds it if the point lies in the subset's relative interior and no corner is beyond the plane through it
/// (the optimality condition of the minimum-norm point), so the first subset that passes is the answer.
pub(super) fn nearest(corners: &[ExactPoint]) -> Option<Nearest> {
    let n = corners.len();
    for size in 1..=n.min(4) {
        for mask in (1u32..1 << n).filter(|m| m.count_ones() as usize == size) {
            let chosen = |k: &usize| mask & 1 << k != 0;
            let subset: Vec<&ExactPoint> = (0..n).filter(chosen).map(|k| &corners[k]).collect();
            let Some((weights, sum, direction)) = inside(&subset) else {
                continue;
            };
            let base = dot(&direction, &subset[0].w);
            let supports = is_zero(&direction) || (0..n).all(|k| chosen(&k) || dot(&direction, &corners[k].w) >= base);
            if supports {
                let kept = subset.into_iter().cloned().collect();
                return Some(Nearest {
                    kept,
                    weights,
                    sum,
                    direction,
                });
            }
        }
    }
    None
}

/// The point of a convex set nearest to the origin; `lowest(n)` is a corner of the set least along `n`. Ends because
/// each round is strictly nearer and there are finitely many simplices.
pub(super) fn minimize(start: Vec<ExactPoint>, lowest: &dyn Fn(&Big3) -> ExactPoint) -> Option<Nearest> {
    let mut corners = start;
    loop {
        let now = nearest(&corners)?;
        if is_zero(&now.direction) {
            return Some(now);
        }
        let next = lowest(&now.direction);
        if dot(&now.direction, &next.w) >= dot(&now.direction, &now.kept[0].w) {
            return Some(now);
        }
        corners = now.kept;
        corners.push(next);
    }
}
