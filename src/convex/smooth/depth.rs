//! Depth of an overlap of curved cores, and its witness points.
//!
//! 1. From the best known direction, the main solver finds the nearest local minimum of the depth.
//! 2. Balls inside both cores may prove that this minimum is global.
//! 3. For cylinders and cones about parallel axes, the depth is that of two polygons.
//! 4. Otherwise a polytope around the origin bounds the depth ([`polytope`]).
//!
//! # Balls inside both cores
//!
//! If A contains a ball of radius `rA` about `cA`, and B a ball of radius `rB` about `cB`, the
//! depth is at least `rA + rB - |cB - cA|`. So the signed distance is at most `|cB - cA| - rA - rB`
//! ([`take_balls`]). Balls that touch the surfaces at the deepest points prove the depth if the sum
//! of their radii exceeds it. At a vertex or a rim no ball touches. On a flat or straight part of a
//! surface every point is equally deep, and the points are moved to the middle of the part.
//!
//! # Parallel axes
//!
//! A cylinder or a cone is swept by its meridian, a polygon that rotates about the axis. If the
//! axes are parallel, the difference of two such bodies is swept by the sum of both meridians,
//! which also rotates about an axis. A point inside is nearest to an edge of the meridian in its
//! half-plane, and the normal of this edge is the normal of an edge of one of the two meridians. So
//! the depth is the least height along six normals. No search is needed, even if the best
//! directions form a circle.
//!
//! If the axis of B is tilted, B differs from the body about the parallel axis by at most the chord
//! of the tilt times the radius of B. The bound adds this difference twice: once for the depth and
//! once for the heights.
//!
//! # Witness points
//!
//! The witness points of an overlap are the points at which the cores touch after B has been moved
//! out ([`witnesses`]).
//!
//! The depth is the length of the shortest translation that separates the cores. Its direction is
//! the normal. If B moves by the depth plus a gap `g`, the cores are separated, and their closest
//! points `a` and `b` are found as for any pair. Let `s` be the distance of the moved cores. At the
//! given pose, `b - a` equals the normal times the signed distance, with an error of `s - g` along
//! the normal, and perpendicular to it of `s` times the sine of the angle between both normals. If
//! the normal belongs to a local minimum of the depth, `s = g`.
//!
//! ```text
//!      A        B             A         B moved
//!    ____________           _____
//!   |     |b  a| |         |    a|<-g->|b
//!   |_____|____|_|         |_____|
//! ```
//!
//! Points of balls or facets that prove the depth are not witness points, because equally deep
//! points may lie on different sides of a core.

use alloc::vec::Vec;

use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::{Scalar, Vec3, cross, dot, neg, root, scaled, sub};
use crate::base::tolerance::{AGREE_CURVED, CERTIFICATE, DEPTH_GOAL, PARALLEL_AXES, UNIT};
use crate::body::shape::Support;
use crate::convex::minimum::simplex::{Indexed, Simplex};
use crate::convex::smooth::best_bounds::{BranchSet, ProvenBounds};
use crate::convex::smooth::cores::{Any, CoreKind};
use crate::convex::smooth::gjk::{Around, Frozen, SolveGoal};
use crate::convex::smooth::ladder::search;
use crate::convex::smooth::newton_gjk::SolverRun;
use crate::convex::smooth::posed::{DifferencePoint, PosedCores, Toward, add, unit, values};
use crate::convex::smooth::{gjk, polytope};
use crate::pair::outcome::{DepthMode, Solver};
use crate::pair::transform::{ErrorScale, Transform};

/// Bounds of the depth of cores that overlap or seem to overlap.
pub(super) struct Deep {
    pub(super) best: ProvenBounds<f64>,
    /// Whether four points of the difference are proven to contain the origin.
    pub(super) inside: bool,
    /// Whether a polytope was grown.
    pub(super) grown: bool,
}

/// Searches the depth from a direction and branches. Grows a polytope only if `corners` around the
/// origin are given and the bounds are not tight enough for `until`.
pub(super) fn deepen<A: CoreKind, B: CoreKind>(
    posed: &PosedCores<A, B, f64>,
    known: &ProvenBounds<f64>,
    corners: Option<Around<f64>>,
    until: DepthMode,
) -> Deep {
    let mut best = ProvenBounds {
        upper: f64::INFINITY,
        ..*known
    };
    local(posed, known.n, &known.set, &mut best);
    let is_known = best.closes(posed) || (until == DepthMode::Local && is_enough(posed, &best, until));
    if !is_known {
        posed.with_any(|any| prove_parallel(any, &mut best));
    }
    let mut deep = Deep {
        best,
        inside: corners.is_some_and(|c| c.points().len() == 4),
        grown: false,
    };
    let is_local = until == DepthMode::Local && deep.inside && best.lower < 0.0;
    let is_done = is_local || is_enough(posed, &best, until);
    if until == DepthMode::Local && !is_done && corners.is_none() && best.lower < 0.0 {
        posed.with_any(|any| prove_overlap(any, &mut deep));
    }
    let Some(corners) = corners.filter(|_| !is_done) else {
        return deep;
    };
    posed.with_any(|any| grow(any, &corners, &mut deep));
    deep
}

/// Grows a polytope from corners that contain the origin, to bound the depth.
#[cold]
#[inline(never)]
fn grow(posed: &PosedCores<Any, Any, f64>, corners: &Around<f64>, deep: &mut Deep) {
    deep.grown = true;
    let best = &mut deep.best;
    let Some(found) = polytope::deepen(posed, corners.points(), best) else {
        from_faces(posed, corners.points(), best);
        return;
    };
    deep.inside = true;
    let mut set = BranchSet::default();
    found.of.into_iter().for_each(|of| set.add(of));
    local(posed, found.n, &set, best);
    if best.upper > -found.least {
        (best.upper, best.set) = (-found.least, set);
    }
}

/// Searches for four points of the difference around the origin. Needed for a local depth of two
/// rims or edges, where no balls prove that the cores overlap.
#[inline(never)]
fn prove_overlap(posed: &PosedCores<Any, Any, f64>, deep: &mut Deep) {
    let mut apart = ProvenBounds::new();
    if let Frozen::Inside(corners) = gjk::solve(posed, deep.best.n, SolveGoal::Approach, &mut apart) {
        deep.inside = corners.points().len() == 4;
    }
    deep.best.evaluations += apart.evaluations;
}

/// Searches the depth from the normals of flat faces and of the triangles between the corners.
///
/// If the origin is within rounding of the boundary of the difference, no polytope can be proven.
/// The origin then lies in the hull of corners that are all on the supporting plane through the
/// origin. If this plane supports a flat face of a core, the face contains branches of these
/// corners. Otherwise three corners are close to the plane.
fn from_faces(posed: &PosedCores<Any, Any, f64>, corners: &[DifferencePoint<f64>], best: &mut ProvenBounds<f64>) {
    let mut prove = |n: Vec3<f64>, of: [u32; 2]| {
        let toward = posed.toward(n);
        best.prove(&toward, &posed.support(&toward, of));
    };
    for piece in corners {
        let of = piece.of;
        posed.a.flat_faces(of[0], &mut |n| prove(n, of));
        posed
            .b
            .flat_faces(of[1], &mut |m| prove(neg(&posed.frame.vector(&m)), of));
    }
    let mut starts = Vec::from([best.n]);
    for k in 0..corners.len() {
        let [p, q, r] = [1, 2, 3].each(|by| corners[(k + by) % corners.len()].w);
        let n = unit(&cross(&sub(&q, &p), &sub(&r, &p)));
        starts.extend(n.iter().flat_map(|n| [*n, neg(n)]));
    }
    for n in starts {
        local(posed, n, &BranchSet::default(), best);
    }
}

/// Returns whether the bounds are tight enough for the requested depth.
///
/// Bounds that agree are always enough. Otherwise an overlap must be proven, and, unless a local
/// depth is requested, the width must be at most [`DEPTH_GOAL`] times L.
pub(super) fn is_enough<A: Support, B: Support>(
    posed: &PosedCores<A, B, f64>,
    best: &ProvenBounds<f64>,
    until: DepthMode,
) -> bool {
    let is_overlap = best.upper < -CERTIFICATE * UNIT * posed.size;
    let is_near = until == DepthMode::Local || best.upper - best.lower <= DEPTH_GOAL * posed.size;
    best.closes(posed) || (is_overlap && is_near)
}

/// Runs the main solver for the depth from one direction.
pub(super) fn local<A: Support, B: Support>(
    posed: &PosedCores<A, B, f64>,
    n: [f64; 3],
    set: &BranchSet,
    best: &mut ProvenBounds<f64>,
) {
    let deep = true;
    SolverRun { posed, best, deep }.run(n, set);
}

/// Bounds the depth by balls at the weighted points of the branch pairs.
///
/// If the bounds do not agree, also tries balls in the middle of the flat or straight parts at
/// these points. The points only prove the bound. Equal balls may touch the surfaces on different
/// sides, so the points are not [`witnesses`].
pub(super) fn take_balls<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    toward: &Toward<T>,
    pieces: &[DifferencePoint<T>],
    weights: &[T],
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
    let lift = |v: [f64; 3]| v.each(T::from);
    let between = posed.piece([0; 2], lift(ca.into()), lift(cb.into())).w;
    root(dot(&between, &between)) - T::from(ra) - T::from(rb)
}

/// Returns points of the flat or straight parts at two points, opposite each other near the middle
/// of the parts. Returns `None` if no such part faces along the direction.
fn middles<A: Support, B: Support, T: Scalar>(
    posed: &PosedCores<A, B, T>,
    toward: &Toward<T>,
    pieces: &[DifferencePoint<T>],
    [on_a, on_b]: &[Vec3<f64>; 2],
) -> Option<[Vec3<f64>; 2]> {
    let (n, m) = (values(&toward.n).into(), values(&toward.m).into());
    let (of_a, of_b) = (posed.a.flat(&n), posed.b.flat(&m));
    let to_a = |p: &Vec3<f64>| values(&posed.at(&p.each(T::from)));
    let to_b = |p: &Vec3<f64>| {
        let off = sub(&p.each(T::from), &posed.frame.translation);
        values(&posed.frame.direction(&off))
    };
    let b = match (&of_a, &of_b) {
        (_, Some(flat)) => flat.middle(),
        (Some(flat), None) => to_b(&flat.middle()),
        (None, None) => return None,
    };
    let a = match &of_a {
        Some(flat) => flat.foot(&to_a(&b)),
        None => nearest(pieces, |p| &p.on_a, &to_a(&b)).unwrap_or(*on_a),
    };
    let b = match &of_b {
        Some(flat) => flat.foot(&to_b(&a)),
        None => nearest(pieces, |p| &p.on_b, &to_b(&a)).unwrap_or(*on_b),
    };
    Some([a, b])
}

/// Returns the point nearest to `place` in the hull of up to three points.
#[inline(never)]
fn nearest<T: Scalar>(
    pieces: &[DifferencePoint<T>],
    point: fn(&DifferencePoint<T>) -> &Vec3<T>,
    place: &Vec3<f64>,
) -> Option<Vec3<f64>> {
    let mut list = [[0.0; 3]; 3];
    let mut simplex: Option<Simplex<f64, Indexed<f64, usize>>> = None;
    for (k, piece) in pieces.iter().take(3).enumerate() {
        let point = values(point(piece));
        list[k] = point;
        let corner = Indexed {
            index: k,
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
            sum[k] += list[corner.index % 3][k] * weight;
        }
    }
    Some(sum)
}

/// Bounds the depth of two cylinders or cones whose axes are parallel, or tilted by less than the
/// accuracy of a depth.
#[inline(never)]
fn prove_parallel(posed: &PosedCores<Any, Any, f64>, best: &mut ProvenBounds<f64>) {
    let (Some(of_a), Some(of_b)) = (posed.a.meridian(), posed.b.meridian()) else {
        return;
    };
    let [x, y, z] = posed.frame.vector(&[0.0, 0.0, 1.0]);
    // The chord of an angle of at most 90 degrees is at most sqrt(2) < 3/2 times the sine.
    let tilt = 1.5 * root(x * x + y * y) + PARALLEL_AXES;
    let off = 2.0 * tilt * posed.b.reach();
    if !(off <= DEPTH_GOAL * posed.size) {
        return;
    }
    let [tx, ty, _] = posed.frame.translation;
    let apart = root(tx * tx + ty * ty);
    let aside = if apart > 0.0 {
        [tx / apart, ty / apart]
    } else {
        [1.0, 0.0]
    };
    let side = if z < 0.0 { 1.0 } else { -1.0 };
    let of_b = of_b.each(|[out, up]| [out, side * up]);
    let (mut top, mut set) = (f64::NEG_INFINITY, BranchSet::default());
    for [out, up] in of_a.into_iter().chain(of_b) {
        let toward = posed.toward([out * aside[0], out * aside[1], up]);
        let piece = posed.support(&toward, [0; 2]);
        let height = best.prove(&toward, &piece);
        if height > top {
            (top, set) = (height, BranchSet::default());
            set.add(piece.of);
        }
    }
    let upper = top + off;
    // Only for a point inside is it certain that an edge is nearest.
    if upper < -CERTIFICATE * UNIT * posed.size && upper < best.upper {
        (best.upper, best.set) = (upper, set);
    }
}

/// Gap between the moved cores, times L. Small compared with the cores, and large compared with the
/// rounding of the normal between the moved cores. A heuristic.
const GAP: f64 = 1.0 / (1u64 << 20) as f64;

/// A distance of the moved cores that exceeds the gap by less than this times L counts as the gap.
/// Does not affect soundness.
const NEAR: f64 = 1.0 / (1u64 << 34) as f64;

/// Largest number of directions that are tried: a heuristic.
const TRIES: u32 = 16;

/// Returns the closest points of the cores after B has been moved out along the best direction.
///
/// If the distance of the moved cores exceeds the gap, the direction between them is less deep. The
/// next direction is the local minimum of the depth from there.
#[inline(never)]
pub(super) fn witnesses<A: Support, B: Support>(
    posed: &PosedCores<A, B, f64>,
    deep: &mut ProvenBounds<f64>,
) -> ProvenBounds<f64> {
    let gap = GAP * posed.size;
    let mut found = moved_apart(posed, deep, gap);
    for _ in 1..TRIES {
        if found.upper - gap <= NEAR * posed.size {
            break;
        }
        let before = deep.lower;
        local(posed, found.n, &found.set, deep);
        if deep.lower <= before {
            break;
        }
        found = moved_apart(posed, deep, gap);
    }
    found
}

/// Returns the closest points of the cores after B has been moved out along the best direction, to
/// a gap.
fn moved_apart<A: Support, B: Support>(
    posed: &PosedCores<A, B, f64>,
    deep: &mut ProvenBounds<f64>,
    gap: f64,
) -> ProvenBounds<f64> {
    let out = scaled(&deep.n, gap - deep.lower);
    let moved = PosedCores {
        frame: Transform {
            translation: add(&posed.frame.translation, &out),
            ..posed.frame
        },
        ..*posed
    };
    let mut found = ProvenBounds::new();
    (found.n, found.set) = (deep.n, deep.set);
    search(&moved, true, &mut found, &mut Solver::default(), &mut |_, _| false);
    deep.evaluations += found.evaluations;
    found
}
