//! The minimum-norm search with exact signs.

use crate::base::num::each::Each;
use alloc::vec;
use alloc::vec::Vec;

use dashu_base::Signed;
use dashu_int::IBig;

use crate::body::polyhedron::VertexId;
use crate::convex::exact::integer::{Big3, cross, dot, is_zero, neg, sign, sub};

/// A point of the searched set: vertex numbers and position.
#[derive(Clone, Debug)]
pub(super) struct ExactPoint {
    pub(super) a: VertexId,
    pub(super) b: VertexId,
    pub(super) w: Big3,
}

/// The point of a simplex nearest to the origin.
#[derive(Clone, Debug)]
pub(super) struct NearestPoint {
    /// Simplex vertices whose hull contains the nearest point in its relative interior.
    pub(super) kept: Vec<ExactPoint>,
    /// Barycentric coordinates of the nearest point, positive, as numerators over `sum`.
    pub(super) weights: Vec<IBig>,
    pub(super) sum: IBig,
    /// A positive multiple of the nearest point; zero if the nearest point is the origin.
    pub(super) direction: Big3,
}

impl NearestPoint {
    /// Returns the squared distance from the origin as a fraction.
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

/// Returns barycentric coordinates, their sum, and the direction of the affine hull's nearest
/// point, if the point lies in the relative interior of the convex hull.
fn inside(s: &[&ExactPoint]) -> Option<(Vec<IBig>, IBig, Big3)> {
    let positive = |w: &[IBig]| w.iter().all(|x| x.is_positive() && !x.is_zero());
    match s {
        [p] => Some((vec![IBig::ONE], IBig::ONE, p.w.clone())),
        [p, q] => {
            let d = sub(&q.w, &p.w);
            let w = vec![dot(&q.w, &d), -dot(&p.w, &d)];
            positive(&w).then(|| {
                let n = [0, 1, 2].each(|k| &w[0] * &p.w[k] + &w[1] * &q.w[k]);
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

/// Returns the nearest point of the hull of one to four points.
///
/// A subset is optimal if the nearest point of its affine hull lies in the subset's relative
/// interior and no point is beyond the plane through the nearest point (the optimality condition of
/// the minimum-norm point), so the first subset to pass is the answer.
pub(super) fn nearest(vertices: &[ExactPoint]) -> Option<NearestPoint> {
    let n = vertices.len();
    for size in 1..=n.min(4) {
        for mask in (1u32..1 << n).filter(|m| m.count_ones() as usize == size) {
            let chosen = |k: &usize| mask & 1 << k != 0;
            let subset: Vec<&ExactPoint> = (0..n).filter(chosen).map(|k| &vertices[k]).collect();
            let Some((weights, sum, direction)) = inside(&subset) else {
                continue;
            };
            let base = dot(&direction, &subset[0].w);
            let supports = is_zero(&direction) || (0..n).all(|k| chosen(&k) || dot(&direction, &vertices[k].w) >= base);
            if supports {
                let kept = subset.into_iter().cloned().collect();
                return Some(NearestPoint {
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

/// Returns the point of a convex set nearest to the origin; `lowest(n)` must return an extreme
/// point least along `n`. Terminates because each round is strictly nearer and the number of
/// simplices is finite.
pub(super) fn minimize(start: Vec<ExactPoint>, lowest: &dyn Fn(&Big3) -> ExactPoint) -> Option<NearestPoint> {
    let mut vertices = start;
    loop {
        let now = nearest(&vertices)?;
        if is_zero(&now.direction) {
            return Some(now);
        }
        let next = lowest(&now.direction);
        if dot(&now.direction, &next.w) >= dot(&now.direction, &now.kept[0].w) {
            return Some(now);
        }
        vertices = now.kept;
        vertices.push(next);
    }
}
