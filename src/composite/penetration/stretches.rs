//! The middle of a stretch of an edge of one solid that lies inside the other.
//!
//! ```text
//!     +---------------+
//!     |  other body   |
//!   --x-------m-------x---  edge: it enters and leaves at x, and no vertex is inside
//!     |               |
//!     +---------------+
//! ```
//!
//! Where edges cross and no vertex is inside, such a middle is a point that both bodies hold. It is
//! a proposal: crossings are found in rounded arithmetic, and the caller proves a depth by convex
//! parts about the point.

use alloc::vec::Vec;
use nalgebra::{Point3, Vector3};

use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::composite::front::NodePair;
use crate::composite::meet::bounds::{BoundAim, WIDTH, bounds};
use crate::composite::meet::frame::split_pair;
use crate::composite::meet::state::PosedTrees;
use crate::composite::meet::triangle::{self, Triangle};
use crate::composite::mesh::Mesh;
use crate::composite::parts::{Parted, PartsRef};

/// Middles of stretches of edges that are looked at for a start of the depth. Not measured.
const DEEP_STRETCHES: usize = 128;

/// Pairs of leaves in which edges that cross the other mesh are sought. A pin in a slot has some
/// tens; meshes in one place have one for each pair of neighbours. Not measured.
const CROSSED_LEAVES: usize = 1 << 14;

/// A point of both bodies in A's frame, about how deep it is in one of them, and the winding
/// numbers taken; lengths in the caller's unit.
pub(super) type InnerMiddle = (Option<(Point3<f64>, f64)>, u64);

/// An edge by its vertices, the lower one first, a part of its length, and the unit normal of a
/// triangle at the edge.
type EdgePart = ([u32; 2], f64, Vector3<f64>);

/// Returns the deepest middle of a stretch of an edge inside the other body; `None` if a body has
/// curved pieces.
pub(super) fn deepest_middle<A: Parted, B: Parted>(a: &A, b: &B, pose: &RelativePose) -> InnerMiddle {
    match (a.by_kind(), b.by_kind()) {
        (PartsRef::Mesh(a), PartsRef::Mesh(b)) => of_meshes(a, b, pose),
        (PartsRef::Mesh(a), PartsRef::Pieces(b)) => b.to_mesh().map_or((None, 0), |b| of_meshes(a, &b, pose)),
        (PartsRef::Pieces(a), PartsRef::Mesh(b)) => a.to_mesh().map_or((None, 0), |a| of_meshes(&a, b, pose)),
        (PartsRef::Pieces(a), PartsRef::Pieces(b)) => match (a.to_mesh(), b.to_mesh()) {
            (Ok(a), Ok(b)) => of_meshes(&a, &b, pose),
            _ => (None, 0),
        },
    }
}

fn of_meshes(a: &Mesh, b: &Mesh, pose: &RelativePose) -> InnerMiddle {
    let Some(posed) = PosedTrees::new(a, b, pose) else {
        return (None, 0);
    };
    let [of_a, of_b] = crossings(&posed);
    let (frame, mut windings) = (&posed.frame, 0);
    let mut best: Option<(Vector3<f64>, Vector3<f64>, f64)> = None;
    let in_b = middles(a, of_a).into_iter().map(|(p, inward)| (p, inward, true));
    let in_a = middles(b, of_b)
        .into_iter()
        .map(|(p, inward)| (frame.point(&p), inward, false));
    for (on_a, inward, is_of_a) in in_b.chain(in_a) {
        let (outer, scale) = if is_of_a { (b, frame.scale) } else { (a, 1.0) };
        let place = if is_of_a { posed.back(&on_a) } else { on_a };
        let least = (best.map_or(0.0, |b| b.2) + 2.0 * frame.error) / scale;
        let depth = sqrt(outer.nearest_beyond(&place, least).square);
        if depth > least {
            windings += 1;
            if outer.winding(&place).is_some_and(|w| w != 0) {
                best = Some((on_a, inward, depth * scale));
            }
        }
    }
    // Off the surface of the body of the edge, by at most half the depth.
    let given = |(p, inward, depth): (Vector3<f64>, Vector3<f64>, f64)| {
        (a.given(&(p + inward * (0.5 * depth))), depth * a.unit())
    };
    (best.map(given), windings)
}

/// Returns where edges of A and of B pass through triangles of the other mesh, up to rounding.
fn crossings(posed: &PosedTrees<Mesh, Mesh>) -> [Vec<EdgePart>; 2] {
    let (a, b, frame) = (posed.a, posed.b, &posed.frame);
    let (of_a, of_b) = (&a.tree, &b.tree);
    let aim = BoundAim::to(frame.single.error.next_up());
    let (mut stack, mut found, mut leaves) = (alloc::vec![[0, 0]], [Vec::new(), Vec::new()], 0);
    while !stack.is_empty() && leaves < CROSSED_LEAVES {
        let batch = stack.split_off(stack.len().saturating_sub(WIDTH));
        let gaps = bounds(&frame.single, (of_a, of_b), &batch, &aim);
        for (&pair, gap) in batch.iter().zip(gaps.gap) {
            if gap > frame.single.error {
                continue;
            }
            match split_pair((of_a, of_b), frame, pair) {
                Some(two) => stack.extend(two),
                None => {
                    leaves += 1;
                    of_leaves(posed, pair, &mut found);
                }
            }
        }
    }
    found
}

fn of_leaves(posed: &PosedTrees<Mesh, Mesh>, [x, y]: NodePair, found: &mut [Vec<EdgePart>; 2]) {
    let (a, b) = (posed.a, posed.b);
    let [(i, m), (j, n)] = [a.tree.range(x), b.tree.range(y)];
    for u in j..n {
        let q = b.corners(u).map(|p| posed.frame.point(&p));
        for t in i..m {
            let p = a.corners(t);
            through((a.triangles[t as usize], &p), &q, &mut found[0]);
            through((b.triangles[u as usize], &q), &p, &mut found[1]);
        }
    }
}

/// Adds where edges of a triangle pass through another one, its boundary with it.
fn through((vertices, x): ([u32; 3], &Triangle), [a, b, c]: &Triangle, found: &mut Vec<EdgePart>) {
    let normal = (b - a).cross(&(c - a));
    let heights = x.map(|p| normal.dot(&(p - a)));
    for i in 0..3 {
        let k = (i + 1) % 3;
        if !(heights[i] * heights[k] <= 0.0 && heights[i] != heights[k]) {
            continue;
        }
        let along = x[k] - x[i];
        let turn = |p: &Vector3<f64>, q: &Vector3<f64>| (p - x[i]).cross(&(q - x[i])).dot(&along);
        let turns = [turn(a, b), turn(b, c), turn(c, a)];
        if turns.iter().all(|t| *t >= 0.0) || turns.iter().all(|t| *t <= 0.0) {
            let (part, own) = (heights[i] / (heights[i] - heights[k]), triangle::normal(x));
            let own = own / sqrt(own.norm_squared());
            found.push(if vertices[i] < vertices[k] {
                ([vertices[i], vertices[k]], part, own)
            } else {
                ([vertices[k], vertices[i]], 1.0 - part, own)
            });
        }
    }
}

/// Returns the middles of all stretches between crossings of an edge, ends included, in stored
/// coordinates, with a direction inward in the frame of the crossings; of some of them if there are
/// many.
fn middles(mesh: &Mesh, mut crossings: Vec<EdgePart>) -> Vec<(Vector3<f64>, Vector3<f64>)> {
    crossings.sort_unstable_by(|x, y| x.0.cmp(&y.0).then(x.1.total_cmp(&y.1)));
    let mut all = Vec::new();
    for on_edge in crossings.chunk_by(|x, y| x.0 == y.0) {
        let [from, to] = on_edge[0].0.map(|v| mesh.points[v as usize]);
        // By the normals of both triangles at the edge.
        let inward = -on_edge.iter().map(|x| x.2).sum::<Vector3<f64>>() / on_edge.len() as f64;
        let mut last = 0.0;
        for part in on_edge.iter().map(|x| x.1).chain([1.0]) {
            if part > last {
                all.push((from + (to - from) * (0.5 * (last + part)), inward));
            }
            last = part;
        }
    }
    let step = all.len().div_ceil(DEEP_STRETCHES).max(1);
    all.into_iter().step_by(step).collect()
}
