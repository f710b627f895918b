//! Flat round faces: tries the axes of caps and bases.
//!
//! As the direction crosses the axis, the support point of a rim jumps around the circle. So the
//! axis itself is tried. If the support point of the other core is over the face, the bounds then
//! agree.

use super::best_bounds::ProvenBounds;
use super::posed::{DifferencePoint, PlaneStep, PosedCores, Toward, tangent, values};
use crate::base::num::scalar::{Scalar, Vec3, neg, sub};
use crate::body::shape::{Disc, Support};

/// Flat round faces that a solve has tried: at most one per core.
#[derive(Clone, Copy)]
pub(super) struct Flush {
    tried: [bool; 2],
}

impl Flush {
    pub(super) fn new() -> Self {
        Self { tried: [false; 2] }
    }
}

/// Returns the flat round face of core `side` (0 for A, 1 for B) that faces along a direction.
#[inline(always)]
fn disc<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    toward: &Toward<T>,
    side: usize,
) -> Option<Disc> {
    if side == 0 {
        posed.a.disc(&values(&toward.n).into())
    } else {
        posed.b.disc(&values(&toward.m).into())
    }
}

/// Returns the squared length of the part of `v` perpendicular to the z axis, and the dot product
/// of this part with the same part of `d`.
#[inline(always)]
fn off_axis<T: Scalar>(v: &Vec3<T>, d: &Vec3<T>) -> [f64; 2] {
    let (v, d) = (values(v), values(d));
    [v[0] * v[0] + v[1] * v[1], v[0] * d[0] + v[1] * d[1]]
}

/// Tries, once each, the axes that a step crosses or whose squared sine with the direction is below
/// `around`. Returns the nearest points found if they are nearer than the known ones.
#[inline(always)]
pub(super) fn near<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    best: &mut ProvenBounds<T>,
    toward: &Toward<T>,
    step: &PlaneStep<T>,
    flush: &mut Flush,
    around: f64,
) -> Option<DifferencePoint<T>> {
    let mut found = None;
    for side in [0, 1] {
        if disc(posed, toward, side).is_none() {
            continue;
        }
        let d = tangent(toward, step);
        let [off, turn] = if side == 0 {
            off_axis(&toward.n, &d)
        } else {
            off_axis(&toward.m, &neg(&posed.frame.direction(&d)))
        };
        if off < around || off + turn < 0.0 {
            found = of_side(posed, best, toward, side, flush).or(found);
        }
    }
    found
}

/// Tries, once, the axis of the flat round face of core `side` that faces along the direction.
/// Returns the nearest points found if they are nearer than the known ones.
#[inline(never)]
pub(super) fn of_side<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    best: &mut ProvenBounds<T>,
    toward: &Toward<T>,
    side: usize,
    flush: &mut Flush,
) -> Option<DifferencePoint<T>> {
    let disc = disc(posed, toward, side).filter(|_| !flush.tried[side])?;
    flush.tried[side] = true;
    let axis = [T::from(0.0), T::from(0.0), T::from(disc.side)];
    let along = if side == 0 {
        axis
    } else {
        neg(&posed.frame.vector(&axis))
    };
    let toward = posed.toward(along);
    let support = posed.support(&toward, best.set.first());
    best.prove(&toward, &support);
    let (mut on_a, mut on_b) = (support.on_a, support.on_b);
    if side == 0 {
        on_a = disc.foot(&posed.at(&on_b));
    } else {
        let t = posed.frame.translation;
        on_b = disc.foot(&posed.frame.direction(&sub(&on_a, &t)));
    }
    let (known, piece) = (best.upper, posed.piece(support.of, on_a, on_b));
    best.point(&piece);
    let is_nearer = best.upper < known;
    if is_nearer {
        best.set.lie(side);
    }
    is_nearer.then_some(piece)
}
