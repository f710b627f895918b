//! A proof of the depth without growing: the deepest facet covers what the surface is short of.
//!
//! A surface that was close to the border at one pose is a little beneath it at the next, and where faces lie upon faces it is
//! so after any motion at all. Let its triangles be seen from behind, let `r` be the height of a facet F of the difference P along
//! its normal `n`, and call *weak* the triangles that are not beyond `r`. Then P holds the ball of radius `r` about the origin if
//! F holds a disc about its foot, `r n`, of the radius given below.
//!
//! Proof. Let `x` of the ball be none of P. The way from the origin to `x` leaves the surface at a point `y` of a triangle, which is weak,
//! since `y` is nearer than `r`. For a unit vector `m` along which that triangle is `p` high at least, `y = a m + v` with `v` across `m`,
//! `p <= a <= r` and `|v|^2 <= r^2 - p^2`. So `y` is no further from the axis along `n` than `r |m x n| + sqrt(r^2 - p^2)`, and `x`
//! no further than `r / p` times that; `rho` is the largest such number. Where `m` is within sixty degrees of `n` and `rho` below half of
//! every triangle's height, `y`, and so `x`, is above height zero along `n`: `n . y >= p / 2 - |v| sin 60`, and `|v| <= rho`. P holds
//! `x` moved along `n` into F, whose disc has the radius `rho`, and `x` moved along `n` down to height zero, which is nearer to the
//! origin than any triangle: and `x` between the two.

use nalgebra::Vector3;

use crate::num::scalar::{Vec3, cross, dot, sqrt, sub};
use crate::pair::difference::MinkowskiPoint;
use crate::pair::posed::PosedPair;
use crate::pair::transform::Transform;
use crate::polyhedron::{ConvexPolyhedron, Feature, FeaturePair};
use crate::tolerance::{AGREE_DEPTH, CERTIFICATE, DISC, DISC_MOST, UNIT};

use crate::depth::direction::{least, unit};
use crate::depth::foot::{Witnesses, some_of};
use crate::depth::result::Best;
use crate::pair::difference::support;
use crate::tuning::depth::EXCHANGES;

/// Three points of the facet that the axis pierces, from a triangle, counter-clockwise seen from outside, that it pierces; none where
/// it does not. What `known` holds spares looking for points of the bodies.
pub(super) fn pierced(
    posed: &PosedPair,
    frame: &Transform<f64>,
    axis: &Vec3<f64>,
    known: impl Iterator<Item = MinkowskiPoint<f64>> + Clone,
    mut at: [MinkowskiPoint<f64>; 3],
) -> Option<[MinkowskiPoint<f64>; 3]> {
    let is_left = |p: &MinkowskiPoint<f64>, q: &MinkowskiPoint<f64>| dot(axis, &cross(&p.w, &q.w)) >= 0.0;
    if !(is_left(&at[0], &at[1]) && is_left(&at[1], &at[2]) && is_left(&at[2], &at[0])) {
        return None;
    }
    for _ in 0..EXCHANGES {
        let [i, j, k] = at;
        let n = unit(&cross(&sub(&j.w, &i.w), &sub(&k.w, &i.w)));
        let flat = dot(&n, &i.w) + AGREE_DEPTH * posed.size();
        let mut top = i;
        let mut height = flat;
        for c in known.clone() {
            let h = dot(&n, &c.w);
            if h > height {
                (top, height) = (c, h);
            }
        }
        if height == flat {
            top = support(posed, frame, &n, &i);
            if !(dot(&n, &top.w) > flat) {
                return Some(at);
            }
        }
        at = if is_left(&j, &top) && !is_left(&i, &top) {
            [i, j, top]
        } else if is_left(&k, &top) && !is_left(&j, &top) {
            [j, k, top]
        } else {
            [k, i, top]
        };
    }
    None
}

/// The radius of the disc that the facet must hold; none where a weak triangle is too far beneath it or turned too far from it.
pub(super) fn radius(weak: impl Iterator<Item = [Vec3<f64>; 3]>, best: &Best<f64>, size: f64) -> Option<f64> {
    let margin = 2.0 * CERTIFICATE * UNIT * size;
    let r = best.height - AGREE_DEPTH * size;
    let (mut nearest, mut rho) = (r, 0.0);
    for w in weak {
        let m = unit(&cross(&sub(&w[1], &w[0]), &sub(&w[2], &w[0])));
        let p = least(&m, &w) - margin;
        // Comparisons are written so that NaN covers nothing.
        if !(p > 0.0 && dot(&m, &best.normal) > 0.5) {
            return None;
        }
        let turned = cross(&m, &best.normal);
        let off = r * sqrt(dot(&turned, &turned)) + sqrt((r * r - p * p).max(0.0));
        (nearest, rho) = (p.min(nearest), (off * r / p).max(rho));
    }
    let rho = rho * DISC + margin;
    (rho < DISC_MOST * nearest).then_some(rho)
}

/// What a point of a facet may be off the height that is taken for it, within the [`AGREE_DEPTH`] that is left below that.
fn play(posed: &PosedPair) -> f64 {
    0.25 * AGREE_DEPTH * posed.size()
}

/// Whether the facet, at its height but for rounding, holds the disc of that radius about its foot.
pub(super) fn holds_disc(
    posed: &PosedPair,
    facet: FeaturePair,
    (p, q): &Witnesses,
    (normal, height): &(Vec3<f64>, f64),
    rho: f64,
) -> bool {
    let (p, q, n) = (p.coords, q.coords, Vector3::from(*normal));
    match (facet.a, facet.b) {
        (Feature::Face(f), Feature::Vertex(_)) => face_holds(posed.a, f.0, &p, rho, play(posed)),
        (Feature::Vertex(_), Feature::Face(f)) => face_holds(posed.b, f.0, &q, rho, play(posed)),
        (Feature::Edge(e), Feature::Edge(g)) => {
            let ends = |body: &ConvexPolyhedron, h: u32| {
                let t = &body.topology;
                [t.from(h), t.half_edge(h).to].map(|v| body.points[v as usize])
            };
            let ([p0, p1], of_b) = (ends(posed.a, e.0), ends(posed.b, g.0));
            let ([q0, q1], q) = (of_b.map(|q| posed.point_in_a(&q)), posed.point_in_a(&q));
            let lowest = n.dot(&p0).min(n.dot(&p1)) - n.dot(&q0).max(n.dot(&q1));
            let (across_a, across_b) = (n.cross(&(p1 - p0)), n.cross(&(q1 - q0)));
            // From the sides of the parallelogram that are parallel to the one edge and to the other.
            let is_clear = |x: Vector3<f64>, across: &Vector3<f64>| across.dot(&x).abs() >= rho * across.abs().sum();
            lowest >= height - 2.0 * play(posed)
                && is_clear(p - p0, &across_b)
                && is_clear(p1 - p, &across_b)
                && is_clear(q - q0, &across_a)
                && is_clear(q1 - q, &across_a)
        }
        _ => false,
    }
}

/// Whether a face holds a disc about a point in its plane, by all its corners or, of a large one, by some.
fn face_holds(body: &ConvexPolyhedron, f: u32, x: &Vector3<f64>, rho: f64, play: f64) -> bool {
    let (t, plane) = (&body.topology, &body.planes[f as usize]);
    let corner = |h: u32| body.points[t.from(h) as usize];
    let mut corners = some_of(body, f).map(corner);
    let Some(first) = corners.next() else { return false };
    let mut from = first;
    let mut is_inside = |to: Vector3<f64>| {
        let side = plane.normal.cross(&(to - from));
        let inside = side.dot(&(x - from)) >= rho * side.abs().sum();
        from = to;
        inside && plane.normal.dot(&to) >= plane.offset - play
    };
    plane.normal.dot(x) <= plane.offset + play && corners.all(&mut is_inside) && is_inside(first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::depth::facet::height_of;
    use crate::depth::foot::foot;
    use crate::{Class, RelativePose, Tracker};
    use alloc::vec::Vec;
    use lab::rng::Rng;
    use nalgebra::{Isometry3, Point3, UnitQuaternion};

    /// Of random triangles a little beneath a ball: where a ray through one leaves the ball is no further from the axis than told.
    #[test]
    fn what_weak_triangles_lack_is_near_the_axis() {
        let mut rng = Rng::new(91);
        let (mut met, mut closest) = (0, f64::INFINITY);
        for _ in 0..4000 {
            let size = [1e-6, 1e-4, 1e-2][rng.below(3)];
            let corner = |rng: &mut Rng| {
                [
                    rng.range(-1.0, 1.0),
                    rng.range(-1.0, 1.0),
                    1.0 - size * rng.range(0.0, 1.0),
                ]
            };
            let w: [Vec3<f64>; 3] = core::array::from_fn(|_| corner(&mut rng));
            let best = Best {
                normal: [0.0, 0.0, 1.0],
                height: 1.0,
                features: None,
            };
            let right = dot(&cross(&sub(&w[1], &w[0]), &sub(&w[2], &w[0])), &best.normal) > 0.0;
            let w = if right { w } else { [w[1], w[0], w[2]] };
            let Some(rho) = radius([w].into_iter(), &best, 4.0) else {
                continue;
            };
            for _ in 0..400 {
                let (s, t) = (rng.range(0.0, 1.0), rng.range(0.0, 1.0));
                let y: Vec3<f64> =
                    core::array::from_fn(|k| (1.0 - s) * w[0][k] + s * ((1.0 - t) * w[1][k] + t * w[2][k]));
                let length = sqrt(dot(&y, &y));
                if length < 1.0 {
                    let off = sqrt(y[0] * y[0] + y[1] * y[1]) / length;
                    (met, closest) = (met + 1, closest.min(rho - off));
                }
            }
        }
        assert!(met > 500 && closest >= 0.0, "{met} {closest}");
    }

    fn hull(n: usize, rng: &mut Rng) -> ConvexPolyhedron {
        let points: Vec<Point3<f64>> = (0..n).map(|_| Point3::from(rng.unit())).collect();
        ConvexPolyhedron::from_points(&points).expect("a solid")
    }

    /// B moved by a point of the disc still meets A: the point is one of the difference.
    #[test]
    fn a_facet_holds_the_disc_it_says() {
        let mut rng = Rng::new(92);
        let mut told = [[0; 2]; 3];
        for _ in 0..600 {
            let (a, b) = (hull(6, &mut rng), hull(6, &mut rng));
            let turn = UnitQuaternion::from_scaled_axis(Vector3::from(rng.unit()) * rng.range(0.0, 3.0));
            let at = |by: Vector3<f64>| Isometry3::from_parts((Vector3::from([0.3, 0.1, 0.0]) + by).into(), turn);
            let pose = RelativePose::from_isometry(&at(Vector3::zeros())).expect("a pose");
            let o = Tracker::new().closest(&a, &b, &pose);
            let posed = PosedPair::new(&a, &b, &pose).ok().expect("near");
            let Some((n, height)) = height_of(&posed, &Transform::of(&posed), o.features) else {
                continue;
            };
            let Some(witnesses) = foot(&posed, o.features, &(n, height)) else {
                continue;
            };
            for k in 1..8 {
                let rho = 0.5_f64.powi(k);
                let holds = holds_disc(&posed, o.features, &witnesses, &(n, height), rho);
                let kind = o.features.a.dimension();
                told[kind][usize::from(holds)] += 1;
                let normal = Vector3::from(n);
                for _ in 0..if holds { 20 } else { 0 } {
                    let aside = normal.cross(&Vector3::from(rng.unit())).normalize() * rho;
                    let moved = RelativePose::from_isometry(&at(normal * height * (1.0 - 1e-12) + aside));
                    let there = Tracker::new().distance(&a, &b, &moved.expect("a pose"));
                    assert!(
                        there.class == Class::Overlapping || there.lower <= 1e-12,
                        "{there:?} {o:?} {rho}"
                    );
                }
            }
        }
        assert!(told.iter().flatten().all(|&count| count > 100), "{told:?}");
    }
}
