//! Balls inside both cores: upper bounds of the signed distance of an overlap.
//!
//! If A contains a ball of radius `rA` about `cA` and B a ball of radius `rB` about `cB`, the
//! signed distance is at most `|cB - cA| - rA - rB`. Balls that touch the surfaces at the deepest
//! points prove the depth. At a vertex or a rim no ball touches; on a flat or straight part of a
//! surface any other point of the part is as deep, and the points are moved to the middle of the
//! parts.

use super::best::{BranchSet, ProvenBounds};
use super::posed::{DifferencePoint, PosedCores, Toward, values};
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::{Scalar, Vec3, dot, root, sub};
use crate::base::tolerance::AGREE_CURVED;
use crate::body::polyhedron::VertexId;
use crate::body::shape::Support;
use crate::convex::minimum::simplex::Simplex;
use crate::pair::difference::MinkowskiPoint;
use crate::pair::transform::ErrorScale;

/// Takes balls at the weighted points of the pieces; if the bounds do not agree, also balls in the
/// middle of the flat or straight parts about the points. The points prove the bound alone: equal
/// balls may touch the surfaces on different sides, so witnesses are the work of `opposite`.
pub(super) fn take<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    toward: &Toward<T>,
    (pieces, weights): (&[DifferencePoint<T>], &[T]),
    best: &mut ProvenBounds<T>,
) {
    let (mut on_a, mut on_b) = ([0.0; 3], [0.0; 3]);
    let mut set = BranchSet::default();
    for (piece, weight) in pieces.iter().zip(weights) {
        let weight = weight.value();
        for k in 0..3 {
            on_a[k] += piece.on_a[k].value() * weight;
            on_b[k] += piece.on_b[k].value() * weight;
        }
        if weight > 0.0 {
            set.add(piece.of);
        }
    }
    let points = [on_a, on_b];
    let mut upper = upper_at(posed, toward, &points);
    if (upper - best.lower).value() > AGREE_CURVED * posed.size
        && let Some(places) = middles(posed, toward, pieces, &points)
    {
        let moved = upper_at(posed, toward, &places);
        upper = if moved < upper { moved } else { upper };
    }
    if upper < best.upper {
        (best.upper, best.set) = (upper, set);
    }
}

/// Returns the upper bound of the balls that touch the surfaces at two points.
fn upper_at<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    toward: &Toward<T>,
    [on_a, on_b]: &[Vec3<f64>; 2],
) -> T {
    let (n, m) = (values(&toward.n), values(&toward.m));
    let (ca, ra) = posed.a.inner_ball(&(*on_a).into(), &n.into());
    let (cb, rb) = posed.b.inner_ball(&(*on_b).into(), &m.into());
    let lift = |v: [f64; 3]| v.map(T::from);
    let between = posed.piece([0; 2], lift(ca.into()), lift(cb.into())).w;
    root(dot(&between, &between)) - T::from(ra) - T::from(rb)
}

/// Returns points of the flat or straight parts about two points, opposite each other near the
/// middle of the parts; `None` if no part faces along the direction.
fn middles<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    toward: &Toward<T>,
    pieces: &[DifferencePoint<T>],
    [on_a, on_b]: &[Vec3<f64>; 2],
) -> Option<[Vec3<f64>; 2]> {
    let (n, m) = (values(&toward.n).into(), values(&toward.m).into());
    let (of_a, of_b) = (posed.a.flat(&n), posed.b.flat(&m));
    let to_a = |p: &Vec3<f64>| values(&posed.at(&p.map(T::from)));
    let to_b = |p: &Vec3<f64>| {
        let off = sub(&p.map(T::from), &posed.frame.translation);
        values(&posed.frame.direction(&off))
    };
    let b = match (&of_a, &of_b) {
        (_, Some(flat)) => flat.middle(),
        (Some(flat), None) => to_b(&flat.middle()),
        (None, None) => return None,
    };
    let a = match &of_a {
        Some(flat) => flat.foot(&to_a(&b)),
        None => nearest(pieces.iter().map(|p| values(&p.on_a)), &to_a(&b)).unwrap_or(*on_a),
    };
    let b = match &of_b {
        Some(flat) => flat.foot(&to_b(&a)),
        None => nearest(pieces.iter().map(|p| values(&p.on_b)), &to_b(&a)).unwrap_or(*on_b),
    };
    Some([a, b])
}

/// Returns the point nearest to a place between up to three points.
fn nearest(points: impl Iterator<Item = Vec3<f64>>, place: &Vec3<f64>) -> Option<Vec3<f64>> {
    let mut list = [[0.0; 3]; 3];
    let mut simplex: Option<Simplex<f64>> = None;
    for (k, point) in points.take(3).enumerate() {
        list[k] = point;
        let corner = MinkowskiPoint {
            a: VertexId(k as u32),
            b: VertexId(0),
            w: sub(&point, place),
        };
        match &mut simplex {
            None => simplex = Some(Simplex::vertex(corner)),
            Some(simplex) => {
                let size = place.iter().chain(&point).fold(0.0f64, |size, x| size.larger(x.abs()));
                simplex.add(corner, ErrorScale { size, shared: 0.0 });
            }
        }
    }
    let simplex = simplex?;
    let mut sum = [0.0; 3];
    for (corner, weight) in simplex.points().iter().zip(simplex.weights()) {
        for k in 0..3 {
            sum[k] += list[corner.a.index() % 3][k] * weight;
        }
    }
    Some(sum)
}
