//! What of a body is near a point: the search down a tree, and the triangles of a mesh that may be
//! closest.
//!
//! 1. A node is taken off the stack, and eight nodes below it are bounded at once
//!    ([`TreePoint::squares`]). Those that may be nearer than the level return to the stack, the
//!    nearest on top.
//! 2. The triangles of a leaf are bounded four at once ([`bound_four`]). Each gets an interval of
//!    its distance, of roundings alone.
//! 3. The least upper bound is the level. All triangles whose lower bound is not above it are
//!    returned: one of them is the closest, and every triangle that contains a closest point is
//!    among them.
//! 4. If the bounds of the closest are wide, those of the triangles returned are
//!    [refined](super::refined).
//!
//! Source: best-first search with oriented boxes, as for two trees (see
//! [`nonconvex`](crate::nonconvex)).

use alloc::vec::Vec;
use core::ops::Range;

use nalgebra::Vector3;
use wide::{f32x8, f64x4};

use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::{cross, dot, sqrt};
use crate::base::tolerance::{POINT_BOX, POINT_BOX_SQUARE, POINT_HEIGHT, UNIT};
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::query::box_gaps::EightBoxes;
use crate::nonconvex::query::refined;
use crate::nonconvex::query::triangle::Triangle;
use crate::nonconvex::tree::{Below, Tree, up};

/// Distance from the origin of a tree, in its unit, beyond which boxes are bounded in double
/// precision. Rounding hides a thousandth of the tree from single precision there.
pub(super) const FAR_BOX: f64 = 512.0;

/// Width of bounds above which they are refined, in units of the distance and the radius of the
/// tree. Triangles that are small against these, and whose direction to the point does not err,
/// have bounds of 32 UNIT.
const WIDE: f64 = 48.0 * UNIT;

/// A point in the coordinates of a tree.
pub(crate) struct TreePoint<'a> {
    tree: &'a Tree,
    place: Vector3<f64>,
    pub(super) single: [f32; 3],
    /// Error of a height over a box in single precision.
    pub(super) slack: f32,
    /// Error of the place in double precision.
    shift: f64,
    is_far: bool,
}

impl<'a> TreePoint<'a> {
    /// Returns a point in stored coordinates of the body, each with this error.
    pub(crate) fn new(tree: &'a Tree, point: &Vector3<f64>, error: f64) -> Self {
        let place = (point - tree.centre) / tree.unit();
        // The shift errs by a rounding of the coordinates, far from the origin of the body.
        let shift = 4.0 * (error + UNIT * (point.amax() + tree.centre.amax())) / tree.unit();
        let size = place.abs().sum() + f64::from(tree.reach);
        Self {
            tree,
            place,
            single: [place.x as f32, place.y as f32, place.z as f32],
            slack: up(POINT_BOX * size + shift),
            shift,
            is_far: !(size < FAR_BOX),
        }
    }

    /// Returns lower bounds of the squared distances of eight nodes, in units of the tree, and the
    /// mask of those that are not above a level.
    ///
    /// Far from the tree, single precision would hide which node is nearer.
    #[inline(always)]
    fn squares(&self, nodes: [u32; 8], most: f64) -> ([f64; 8], u32) {
        if self.is_far {
            let squares = nodes.each(|node| self.square_of_far(node));
            let open = (0..8).fold(0, |open, k| open | u32::from(squares[k] <= most) << k);
            return (squares, open);
        }
        let EightBoxes { axes, centre, half } = EightBoxes::new(nodes.each(|n| &self.tree.boxes[n as usize]), 1.0);
        let (slack, zero) = (f32x8::splat(self.slack), f32x8::splat(0.0));
        let from = self.single.each(f32x8::splat);
        let apart = [from[0] - centre[0], from[1] - centre[1], from[2] - centre[2]];
        let over = |k: usize| (dot(&axes[k], &apart).abs() - half[k] - slack).fast_max(zero);
        let [x, y, z] = [over(0), over(1), over(2)];
        let squares = (x * x + y * y + z * z) * f32x8::splat(1.0 - POINT_BOX_SQUARE as f32);
        let open = squares.simd_le(f32x8::splat(up(most))).to_bitmask();
        (squares.to_array().each(f64::from), open)
    }

    /// Returns a lower bound of the squared distance of a node, by the height of its box along the
    /// line of the centres.
    #[cold]
    fn square_of_far(&self, node: u32) -> f64 {
        let b = &self.tree.boxes[node as usize];
        let (apart, half) = (self.place - b.centre(), b.half());
        let length = sqrt(apart.norm_squared());
        let along = |k: usize| half[k] * b.axis(k).dot(&apart).abs();
        let reach = (along(0) + along(1) + along(2)) / length;
        let lower = (length - reach - 2.0 * POINT_HEIGHT * length - self.shift).at_least(0.0);
        lower * lower
    }

    /// Calls `leaf` with the items of each leaf that may be nearer than a level.
    ///
    /// The level is the distance that the last call returned, at the start `level`, in stored units
    /// of the body. Leaves farther than the level are skipped; so are all after a negative level.
    #[inline(always)]
    pub(crate) fn descend(&self, stack: &mut Vec<(f64, u32)>, level: f64, mut leaf: impl FnMut(Range<u32>) -> f64) {
        let per_unit = 1.0 / self.tree.unit();
        let most_at = |level: f64| {
            let most = level * per_unit;
            if most < 0.0 {
                -1.0
            } else {
                most * most * (1.0 + 8.0 * UNIT)
            }
        };
        let mut most = most_at(level);
        stack.clear();
        stack.push((0.0, 0));
        while let Some((square, node)) = stack.pop() {
            if square > most {
                continue;
            }
            if let Below::Leaf(first, count) = self.tree.below(node) {
                most = most_at(leaf(first..first + count));
                continue;
            }
            let (nodes, count) = self.tree.eight_below(node);
            let (squares, open) = self.squares(nodes, most);
            let mut open = open & ((1 << count) - 1);
            // The nearest comes on top. To sort the others takes longer than it saves.
            let (first, mut nearest) = (stack.len(), f64::INFINITY);
            while open != 0 {
                let k = open.trailing_zeros() as usize;
                open &= open - 1;
                stack.push((squares[k], nodes[k]));
                nearest = nearest.smaller(squares[k]);
            }
            let top = stack.len().saturating_sub(1);
            if let Some(k) = (first..top).find(|k| stack[*k].0 == nearest) {
                stack.swap(k, top);
            }
        }
    }
}

/// Bounds of the distances of four triangles from a point.
struct FourBounds {
    lower: [f64; 4],
    upper: [f64; 4],
}

/// Returns bounds of the distances of four triangles from a point; see [`POINT_HEIGHT`].
///
/// Returns `None` if all lower bounds are above `level`.
///
/// Upper: the distance of a foot, which is a combination of the corners with clamped weights, so a
/// point of the triangle. Lower: the least height of the corners along a direction. Any direction
/// is a proof: that to the foot, or for a point near the plane the normal as rounded.
#[inline(always)]
fn bound_four(point: &Vector3<f64>, triangles: [Triangle; 4], level: f64) -> Option<FourBounds> {
    let (zero, one) = (f64x4::splat(0.0), f64x4::splat(1.0));
    let tiny = f64x4::splat(f64::MIN_POSITIVE);
    let [a, b, c] = [0, 1, 2].each(|k| {
        [0, 1, 2].each(|i| {
            let [p, q, r, s] = triangles.each_ref().each(|t| t[k][i]);
            f64x4::new([p, q, r, s]) - f64x4::splat(point[i])
        })
    });
    let sub = |x: &[f64x4; 3], y: &[f64x4; 3]| [x[0] - y[0], x[1] - y[1], x[2] - y[2]];
    let (ab, bc, ca) = (sub(&b, &a), sub(&c, &b), sub(&a, &c));
    let on = |x: &[f64x4; 3], e: &[f64x4; 3]| {
        let t = (-dot(x, e) / dot(e, e).fast_max(tiny)).fast_max(zero).fast_min(one);
        let f = [x[0] + e[0] * t, x[1] + e[1] * t, x[2] + e[2] * t];
        (dot(&f, &f), f)
    };
    let nearer = |(d, f): (f64x4, [f64x4; 3]), (e, g): (f64x4, [f64x4; 3])| {
        let wins = e.simd_lt(d);
        let pick = |k: usize| wins.select(g[k], f[k]);
        (wins.select(e, d), [pick(0), pick(1), pick(2)])
    };
    let of_edges = nearer(nearer(on(&a, &ab), on(&b, &bc)), on(&c, &ca));
    let n = cross(&ab, &bc);
    let nn = dot(&n, &n);
    // Twice the areas of the triangles with the foot, times the length of the normal.
    let (wc, wa, wb) = (
        dot(&n, &cross(&a, &b)),
        dot(&n, &cross(&b, &c)),
        dot(&n, &cross(&c, &a)),
    );
    let (sum, area) = (wa + wb + wc, nn.simd_gt(tiny));
    let inside = wa.simd_ge(zero) & wb.simd_ge(zero) & wc.simd_ge(zero) & area & sum.simd_gt(tiny);
    let sum = sum.fast_max(tiny);
    let (wb, wc) = (wb / sum, wc / sum);
    let flat = [0, 1, 2].each(|k: usize| a[k] + ab[k] * wb - ca[k] * wc);
    let square = inside.select(dot(&flat, &flat), f64x4::splat(f64::INFINITY));
    let (square, foot) = nearer(of_edges, (square, flat));
    let reach = dot(&a, &a).fast_max(dot(&b, &b)).fast_max(dot(&c, &c)).sqrt();
    let error = reach * f64x4::splat(POINT_HEIGHT);
    let length = square.sqrt();
    let heights = |d: &[f64x4; 3]| [dot(d, &a), dot(d, &b), dot(d, &c)];
    let [x, y, z] = heights(&foot);
    let by_foot = x.fast_min(y).fast_min(z) / length.fast_max(tiny);
    if (by_foot - error).simd_gt(f64x4::splat(level)).all() {
        return None;
    }
    let [x, y, z] = heights(&n);
    let (low, high) = (x.fast_min(y).fast_min(z), x.fast_max(y).fast_max(z));
    let by_plane = area.select(low.fast_max(-high) / nn.fast_max(tiny).sqrt(), zero);
    let lower = (by_foot.fast_max(by_plane) - error).fast_max(zero);
    Some(FourBounds {
        lower: lower.to_array(),
        upper: (length + error).to_array(),
    })
}

/// A triangle and bounds of its distance, in stored units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearTriangle {
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    pub(crate) item: u32,
}

impl NearTriangle {
    /// A triangle that is not before any other.
    const FARTHEST: Self = Self {
        lower: 0.0,
        upper: f64::INFINITY,
        item: 0,
    };

    /// Returns whether the upper bound is less than that of another triangle, or the item if the
    /// bounds are equal.
    fn is_before(&self, other: &Self) -> bool {
        self.upper < other.upper || self.upper == other.upper && self.item < other.item
    }
}

/// Room of searches from points, reused from search to search.
#[derive(Clone, Debug, Default)]
pub(crate) struct NearMemory {
    stack: Vec<(f64, u32)>,
    /// The triangles that may be closest, after a search.
    pub(crate) found: Vec<NearTriangle>,
    /// Number of leaves that the last search visited.
    pub(crate) leaves: usize,
    /// The item with which the next search starts. Its distance is the first level.
    pub(crate) start: Option<u32>,
}

impl Mesh {
    /// Returns the closest triangle and bounds of the distance, and leaves all triangles that may
    /// be closest in the memory.
    ///
    /// All lengths are in stored units. The search ends early if a triangle is no farther than
    /// `enough`; then the lower bound is zero.
    pub(crate) fn nearest_triangle(&self, point: &Vector3<f64>, enough: f64, memory: &mut NearMemory) -> NearTriangle {
        let NearMemory {
            stack,
            found,
            leaves,
            start,
        } = memory;
        found.clear();
        *leaves = 0;
        let known = start.filter(|item| (*item as usize) < self.triangles.len());
        let mut level = known.map_or(f64::INFINITY, |item| self.near_triangle(point, item).upper);
        let mut limit = 32;
        TreePoint::new(&self.tree, point, 0.0).descend(stack, level, |items| {
            *leaves += 1;
            let Some(bounds) = self.bounds_of(point, &items, level) else {
                return level;
            };
            let count = items.len();
            level = bounds.upper[..count].iter().fold(level, |least, x| least.smaller(*x));
            for (k, item) in items.enumerate() {
                let (lower, upper) = (bounds.lower[k], bounds.upper[k]);
                if lower <= level {
                    found.push(NearTriangle { lower, upper, item });
                }
            }
            if found.len() > limit {
                found.retain(|t| t.lower <= level);
                // Doubled, or a search with many ties would scan the list at each leaf.
                limit = limit.max(2 * found.len());
            }
            if level <= enough { -1.0 } else { level }
        });
        found.retain(|t| t.lower <= level);
        // A mesh has a triangle, and its bounds are finite.
        let nearest = |best: NearTriangle, t: &NearTriangle| if t.is_before(&best) { *t } else { best };
        let best = found.iter().fold(NearTriangle::FARTHEST, nearest);
        let least = found.iter().fold(level, |least, t| least.smaller(t.lower));
        *start = Some(best.item);
        NearTriangle {
            lower: if level <= enough { 0.0 } else { least },
            ..best
        }
    }

    /// Returns bounds of the distance of one triangle.
    pub(crate) fn near_triangle(&self, point: &Vector3<f64>, item: u32) -> NearTriangle {
        let bounds = self.bounds_of(point, &(item..item + 1), f64::INFINITY);
        let [lower, upper] = bounds.map_or([0.0, f64::INFINITY], |b| [b.lower[0], b.upper[0]]);
        NearTriangle { lower, upper, item }
    }

    #[inline(always)]
    fn bounds_of(&self, point: &Vector3<f64>, items: &Range<u32>, level: f64) -> Option<FourBounds> {
        let last = items.end - 1;
        let four = [0, 1, 2, 3].each(|k| self.corners((items.start + k).min(last)));
        bound_four(point, four, level)
    }
}

/// Returns the closest triangle with bounds as close as rounding permits.
///
/// `best` is the closest of `found`, which are all triangles that may be closest. `size` bounds
/// the lengths of the body.
#[inline]
pub(crate) fn refined(
    point: &Vector3<f64>,
    size: f64,
    best: NearTriangle,
    found: &[NearTriangle],
    corners: impl Fn(u32) -> Triangle,
) -> NearTriangle {
    let level = best.upper - WIDE * (best.upper + size);
    if best.lower >= level {
        return best;
    }
    let refine = |t: &NearTriangle| {
        if t.lower >= level {
            return *t;
        }
        let (lower, upper) = refined::distance(point, &corners(t.item));
        NearTriangle {
            lower: lower.larger(t.lower),
            upper: upper.smaller(t.upper),
            item: t.item,
        }
    };
    // All other triangles are farther than the upper bound of the search.
    let (mut lower, mut nearest) = (best.upper, best);
    for t in found.iter().map(refine) {
        lower = lower.smaller(t.lower);
        if t.is_before(&nearest) {
            nearest = t;
        }
    }
    NearTriangle { lower, ..nearest }
}

/// Returns the closest of the triangles that contain the first vertex of a convex polygon and an
/// edge, with bounds of the polygon's distance.
///
/// Leaves the triangles that may be closest in `found`. The item of a triangle is the index of the
/// first end of the edge. `size` bounds the lengths of the body.
pub(crate) fn nearest_of_fan(
    point: &Vector3<f64>,
    size: f64,
    rim: &[Vector3<f64>],
    found: &mut Vec<NearTriangle>,
) -> NearTriangle {
    let corners = |k: u32| [rim[0], rim[k as usize], rim[k as usize + 1]];
    let end = (rim.len() as u32).saturating_sub(1);
    let mut best = NearTriangle::FARTHEST;
    found.clear();
    for first in (1..end).step_by(4) {
        let four = [0, 1, 2, 3].each(|k| corners((first + k).min(end - 1)));
        let Some(bounds) = bound_four(point, four, best.upper) else {
            continue;
        };
        for (k, item) in (first..end).take(4).enumerate() {
            let (lower, upper) = (bounds.lower[k], bounds.upper[k]);
            let new = NearTriangle { lower, upper, item };
            found.push(new);
            if new.is_before(&best) {
                best = new;
            }
        }
    }
    found.retain(|t| t.lower <= best.upper);
    let lower = found.iter().fold(best.upper, |least, t| least.smaller(t.lower));
    refined(point, size, NearTriangle { lower, ..best }, found, corners)
}
