//! Point inside a closed mesh, by exact winding numbers, and triangles that a segment passes
//! through, by exact predicates.
//!
//! 1. A ray along an axis leads from the point to the nearest side of the bounding box.
//! 2. Each crossing of the ray with the mesh counts +1 outward and -1 inward. The sum is right even
//!    if components overlap or contain each other. Parity and the normal of the nearest triangle
//!    are wrong in these cases.
//! 3. The ray starts at the point moved by an infinitesimal (e, e^2) perpendicular to the axis, so
//!    it meets no edge and no vertex, and one ray is enough.
//! 4. Every sign is exact ([`ExactSigns`]). A point on the surface is found on the way: the ray
//!    starts in the box of the triangle that contains it.
//!
//! Sources: the winding number by signed crossings is classical; orientation predicates, Shewchuk
//! 1997; simulation of simplicity, Edelsbrunner and Muecke 1990.

use alloc::vec;
use nalgebra::Vector3;
use wide::f32x8;

use crate::base::num::each::Each;
use crate::base::num::scalar::dot;
use crate::base::num::sign;
use crate::base::tolerance::{FLUSH_EXPONENT, POINT_BOX, UNIT_SINGLE};
use crate::body::polyhedron::{exponent_of, power_of_two};
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::query::box_gaps::EightBoxes;
use crate::nonconvex::query::near::{FAR_BOX, TreePoint};
use crate::nonconvex::query::triangle::{self, Triangle};
use crate::nonconvex::tree::{Below, OrientedBox, Tree, up};

/// Exact signs of a point in stored coordinates of a mesh.
pub(crate) trait ExactSigns {
    /// Returns the rounded point, and the largest error of a coordinate.
    fn rounded(&self) -> (Vector3<f64>, f64);

    /// Returns the sign of the height of the point above the plane of a triangle.
    fn height(&self, corners: &Triangle) -> i32;

    /// Returns 1 if the point is left of the edge from `a` to `b`, and -1 if right.
    ///
    /// The sides are seen from the positive end of `axis`. Returns 0 if the edge hides the point.
    fn turn(&self, axis: usize, a: &Vector3<f64>, b: &Vector3<f64>) -> i32;

    /// Returns the sides of the three edges on which the point is.
    fn turns(&self, axis: usize, [a, b, c]: &Triangle) -> [i32; 3] {
        [(a, b), (b, c), (c, a)].each(|(x, y)| self.turn(axis, x, y))
    }

    /// Returns whether a triangle contains a point of its plane.
    ///
    /// A triangle without area contains none: its neighbours cover what it might cover.
    fn is_on(&self, corners: &Triangle) -> bool {
        let [a, b, c] = corners;
        sign::projection(a, b, c).is_some_and(|axis| !are_mixed(&self.turns(axis, corners)))
    }
}

/// A point whose stored coordinates are exact ([`Mesh::flushed`]).
impl ExactSigns for Vector3<f64> {
    fn rounded(&self) -> (Vector3<f64>, f64) {
        (*self, 0.0)
    }

    #[inline]
    fn height(&self, [a, b, c]: &Triangle) -> i32 {
        sign::sign(sign::side(a, b, c, self))
    }

    #[inline]
    fn turn(&self, axis: usize, a: &Vector3<f64>, b: &Vector3<f64>) -> i32 {
        sign::sign(sign::turn(axis, a, b, self))
    }
}

fn are_mixed(turns: &[i32; 3]) -> bool {
    turns.contains(&1) && turns.contains(&-1)
}

/// Returns the turn of a triangle around the point moved by (e, e^2) perpendicular to the axis.
///
/// Returns 0 if the triangle does not hide the moved point.
fn moved(axis: usize, corners: &Triangle, turns: [i32; 3]) -> i32 {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let turn = |k: usize| {
        let (a, b) = (&corners[k], &corners[(k + 1) % 3]);
        match turns[k] {
            // The signs of the derivatives along u, then along v.
            0 if a[v] != b[v] => sign::sign(a[v] - b[v]),
            0 => sign::sign(b[u] - a[u]),
            turn => turn,
        }
    };
    let first = turn(0);
    if turn(1) == first && turn(2) == first { first } else { 0 }
}

/// A ray along an axis, in the coordinates of a tree.
struct AxisRay<'a> {
    from: TreePoint<'a>,
    axis: usize,
    /// 1 or -1.
    way: f32,
}

impl AxisRay<'_> {
    /// Returns which of eight boxes the ray may meet, as bits.
    ///
    /// The ray and a box are separated across the ray along an axis of the world, or along an axis
    /// of the box turned by a right angle about the ray. A box contains exactly the combinations of
    /// its axes as stored, so only roundings count: below `4 u |q| + 12 u R`, with the point q, the
    /// radius R of the tree and u = UNIT_SINGLE ([`TreePoint::slack`] has 32 of both).
    fn meets(&self, boxes: [&OrientedBox; 8]) -> u32 {
        let (u, v) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        let EightBoxes { axes, centre, half } = EightBoxes::new(boxes, 1.0);
        let (slack, from) = (f32x8::splat(self.from.slack), self.from.single.map(f32x8::splat));
        let reach = |x: f32x8, y: f32x8, z: f32x8| half[0] * x.abs() + half[1] * y.abs() + half[2] * z.abs() + slack;
        let wide = |i: usize| reach(axes[0][i], axes[1][i], axes[2][i]);
        let apart = |i: usize| centre[i] - from[i];
        let (du, dv) = (apart(u), apart(v));
        let ahead = apart(self.axis) * f32x8::splat(self.way) + wide(self.axis);
        let mut open = du.abs().simd_le(wide(u)) & dv.abs().simd_le(wide(v)) & ahead.simd_ge(f32x8::splat(0.0));
        for turned in &axes {
            let height = |x: f32x8, y: f32x8| turned[v] * x - turned[u] * y;
            let own = reach(
                height(axes[0][u], axes[0][v]),
                height(axes[1][u], axes[1][v]),
                height(axes[2][u], axes[2][v]),
            );
            open &= height(du, dv).abs().simd_le(own + slack);
        }
        open.to_bitmask() & 0xff
    }
}

impl Mesh {
    /// Returns a point whose coordinates below 2^-200 of the size are zero, as those of the
    /// vertices.
    ///
    /// Products of three smaller differences would leave the range of f64.
    pub(crate) fn flushed(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let flush = power_of_two(exponent_of(self.radius) - FLUSH_EXPONENT);
        point.map(|x| if x.abs() < flush { 0.0 } else { x })
    }

    /// Returns the winding number of a point in stored coordinates.
    ///
    /// Returns `None` if the point is on the surface.
    pub(crate) fn winding(&self, point: &Vector3<f64>) -> Option<i32> {
        self.winding_of(point, |_| true)
    }

    /// Returns the winding number of the triangles for which `counts` returns true.
    ///
    /// These triangles must form a closed surface. Returns `None` if it contains the point.
    pub(crate) fn winding_of(&self, point: &Vector3<f64>, counts: impl Fn(u32) -> bool) -> Option<i32> {
        self.winding_about(&self.flushed(point), counts)
    }

    /// Returns the winding number of some triangles about a point with exact signs.
    ///
    /// Returns `None` if the point is on one of them.
    pub(crate) fn winding_about(&self, point: &impl ExactSigns, mut counts: impl FnMut(u32) -> bool) -> Option<i32> {
        let (p, error) = point.rounded();
        // Written so that a point too far for f64, which is not finite, is outside.
        if (0..3).any(|k| !(p[k] >= self.low[k] - error && p[k] <= self.high[k] + error)) {
            return Some(0);
        }
        let (up, down) = (self.high - p, p - self.low);
        let (x, y) = (up.imin(), down.imin());
        let (axis, way) = if up[x] < down[y] { (x, 1) } else { (y, -1) };
        let across = [(axis + 1) % 3, (axis + 2) % 3];
        let mut winding = 0;
        let mut is_on = |t: u32| {
            let corners = self.corners(t);
            let is_beside = |k: usize| {
                let [a, b, c] = corners.each(|x| x[k]);
                let (above, below) = (p[k] + error, p[k] - error);
                a > above && b > above && c > above || a < below && b < below && c < below
            };
            if across.into_iter().any(is_beside) || !counts(t) {
                return false;
            }
            let turns = point.turns(axis, &corners);
            if are_mixed(&turns) {
                return false;
            }
            let height = point.height(&corners);
            if height == 0 {
                return point.is_on(&corners);
            }
            let moved = moved(axis, &corners, turns);
            if height * moved * way < 0 {
                winding += moved * way;
            }
            false
        };
        let from = TreePoint::new(&self.tree, &p, error);
        let way = way as f32;
        let ray = AxisRay { from, axis, way };
        let mut stack = vec![0];
        while let Some(node) = stack.pop() {
            if let Below::Leaf(first, count) = self.tree.below(node) {
                if (first..first + count).any(&mut is_on) {
                    return None;
                }
                continue;
            }
            let (nodes, count) = self.tree.eight_below(node);
            let open = ray.meets(nodes.each(|n| &self.tree.boxes[n as usize]));
            stack.extend((0..count).filter(|k| open >> k & 1 == 1).map(|k| nodes[k]));
        }
        Some(winding)
    }

    /// Returns whether the surface is proven farther than `error` from a point.
    ///
    /// The point and `error` are in stored units.
    fn is_clear_of(&self, point: &Vector3<f64>, error: f64) -> bool {
        !self.tree.any_near(point, error, |t| {
            let (square, _) = triangle::nearest(point, &self.corners(t));
            !(square > 4.0 * error * error)
        })
    }

    /// Returns whether a point with a position error of `doubt` is inside a solid; false for open
    /// meshes.
    ///
    /// Both are in stored units. Returns `None` if the surface, of a solid or of an open mesh, is
    /// no farther than `doubt`, or if the point is on it.
    pub(crate) fn held_by_rounding(&self, point: &Vector3<f64>, doubt: f64) -> Option<bool> {
        if !self.is_clear_of(point, doubt) {
            return None;
        }
        if !self.is_solid() {
            return Some(false);
        }
        self.winding(point).map(|w| w != 0)
    }

    /// Returns whether a point with a position error of `doubt` is inside a solid; false for open
    /// meshes.
    ///
    /// Both are in stored units. Returns `None` if the surface of a solid is no farther than
    /// `doubt`, or if the point is on it.
    pub(crate) fn holds_point(&self, point: &Vector3<f64>, doubt: f64) -> Option<bool> {
        if !self.is_solid() {
            return Some(false);
        }
        if doubt > 0.0 && !self.is_clear_of(point, doubt) {
            return None;
        }
        self.winding(point).map(|w| w != 0)
    }
}

impl Mesh {
    /// Returns whether a segment certainly passes through a triangle that is at least `skin` from
    /// its start.
    pub(crate) fn is_crossed(&self, from: &Vector3<f64>, to: &Vector3<f64>, skin: f64) -> bool {
        self.any_along(from, to, |t| {
            let corners = self.corners(t);
            is_crossed(&corners, from, to) && triangle::nearest(from, &corners).0 >= skin * skin
        })
    }

    /// Returns the fraction of a segment before it first meets a triangle or an edge of one.
    ///
    /// Meetings at fractions up to `least` are ignored, and so are triangles whose plane contains
    /// the segment. The fraction is right up to rounding.
    pub(super) fn first_meeting(&self, from: &Vector3<f64>, to: &Vector3<f64>, least: f64) -> Option<f64> {
        let mut first = None;
        self.along(from, to, 0.0, |t| {
            if let Some(part) = meeting(&self.corners(t), from, to)
                && part > least
                && first.is_none_or(|f| part < f)
            {
                first = Some(part);
            }
            first.unwrap_or(1.0)
        });
        first
    }

    /// Returns whether `is_found` returns true for a triangle whose box the segment may meet.
    fn any_along(&self, from: &Vector3<f64>, to: &Vector3<f64>, mut is_found: impl FnMut(u32) -> bool) -> bool {
        let mut found = false;
        self.along(from, to, 0.0, |t| {
            found = is_found(t);
            if found { -1.0 } else { 1.0 }
        });
        found
    }

    /// Calls `visit` with each triangle whose box the segment may meet, near boxes first.
    ///
    /// A call returns the part of the segment that is left to search: boxes after this part are
    /// skipped, and a negative part ends the search. The points of the segment may be off by
    /// `error`.
    pub(crate) fn along(&self, from: &Vector3<f64>, to: &Vector3<f64>, error: f64, mut visit: impl FnMut(u32) -> f64) {
        let tree = &self.tree;
        let segment = Segment::new(tree, from, to, error);
        let mut most = segment.reach(1.0);
        let mut stack = vec![(f32::NEG_INFINITY, 0)];
        while let Some((near, node)) = stack.pop() {
            if near > most {
                continue;
            }
            if let Below::Leaf(first, count) = tree.below(node) {
                for t in first..first + count {
                    let part = visit(t);
                    if part < 0.0 {
                        return;
                    }
                    most = segment.reach(part);
                }
                continue;
            }
            let (nodes, count) = tree.eight_below(node);
            let (open, near) = segment.meets(nodes.each(|n| &tree.boxes[n as usize]));
            let bottom = stack.len();
            for k in (0..count).filter(|k| open >> k & 1 == 1) {
                // Inserted in descending order.
                let mut at = stack.len();
                stack.push((near[k], nodes[k]));
                while at > bottom && stack[at - 1].0 < near[k] {
                    stack.swap(at, at - 1);
                    at -= 1;
                }
            }
        }
    }
}

/// Returns whether a segment certainly passes through a triangle.
fn is_crossed(corners: &triangle::Triangle, from: &Vector3<f64>, to: &Vector3<f64>) -> bool {
    matches!(crossing(corners, from, to), Some(1 | -1))
}

/// Returns +1 if the segment leaves through a triangle, -1 if it enters, and 0 if it misses.
///
/// Returns `None` if the segment meets an edge, or if an end lies on the plane. A triangle whose
/// vertices are collinear is missed.
pub(super) fn crossing([a, b, c]: &triangle::Triangle, from: &Vector3<f64>, to: &Vector3<f64>) -> Option<i32> {
    let turns = [
        sign::side(from, to, a, b),
        sign::side(from, to, b, c),
        sign::side(from, to, c, a),
    ];
    if turns.iter().any(|t| *t > 0.0) && turns.iter().any(|t| *t < 0.0) {
        return Some(0);
    }
    let ends = [sign::side(a, b, c, from), sign::side(a, b, c, to)];
    if ends[0] * ends[1] > 0.0 || ends[0] > 0.0 && ends[1] > 0.0 || ends[0] < 0.0 && ends[1] < 0.0 {
        return Some(0);
    }
    if ends == [0.0; 2] && sign::projection(a, b, c).is_none() {
        // No area: its neighbours cover what it might cover, along the same line.
        return Some(0);
    }
    let doubtful = turns.iter().chain(&ends).any(|x| *x == 0.0);
    (!doubtful).then_some(if ends[0] < 0.0 { 1 } else { -1 })
}

/// Returns the fraction of a segment before it meets a triangle, edges included.
fn meeting([a, b, c]: &triangle::Triangle, from: &Vector3<f64>, to: &Vector3<f64>) -> Option<f64> {
    let turns = [
        sign::side(from, to, a, b),
        sign::side(from, to, b, c),
        sign::side(from, to, c, a),
    ];
    if turns.iter().any(|t| *t > 0.0) && turns.iter().any(|t| *t < 0.0) {
        return None;
    }
    let ends = [sign::side(a, b, c, from), sign::side(a, b, c, to)];
    if ends[0] > 0.0 && ends[1] > 0.0 || ends[0] < 0.0 && ends[1] < 0.0 || ends == [0.0; 2] {
        return None;
    }
    let n = triangle::normal(&[*a, *b, *c]);
    Some(n.dot(&(a - from)) / n.dot(&(to - from)))
}

/// A segment in the coordinates of a tree.
struct Segment {
    from: Vector3<f64>,
    middle: Vector3<f64>,
    /// Half of the segment as a vector.
    half: Vector3<f64>,
    /// Position error of the points.
    error: f64,
    /// Error of a height over a box in single precision: that of a point, and as much for the half
    /// segment.
    slack: f64,
    is_far: bool,
}

impl Segment {
    fn new(tree: &Tree, from: &Vector3<f64>, to: &Vector3<f64>, error: f64) -> Self {
        let place = |p: &Vector3<f64>| (p - tree.centre) / tree.unit();
        let (from, to) = (place(from), place(to));
        let error = error / tree.unit();
        let size = from.abs().sum() + to.abs().sum() + f64::from(tree.reach);
        Self {
            middle: (from + to) * 0.5,
            half: (to - from) * 0.5,
            from,
            error,
            slack: 2.0 * POINT_BOX * size + 4.0 * error,
            is_far: !(size < FAR_BOX),
        }
    }

    /// Returns the height of the end of a part of the segment along the segment, not less.
    fn reach(&self, part: f64) -> f32 {
        let square = self.half.norm_squared() * 4.0;
        // The start errs by `slack` along the segment, too.
        up(square * part + 2.0 * self.slack * self.half.abs().sum())
    }

    /// Returns which of eight boxes the segment may meet, as bits, and lower bounds of the heights
    /// of the boxes along the segment.
    ///
    /// The segment and a box are separated along an axis of the box, or along the cross product of
    /// an axis and the segment. Heights are measured from the start of the segment, times its
    /// length.
    fn meets(&self, boxes: [&OrientedBox; 8]) -> (u32, [f32; 8]) {
        if self.is_far {
            let open = (0..8)
                .filter(|k| !self.misses(boxes[*k]))
                .fold(0, |bits, k| bits | 1 << k);
            return (open, [f32::NEG_INFINITY; 8]);
        }
        let EightBoxes { axes, centre, half } = EightBoxes::new(boxes, 1.0);
        let single = |v: &Vector3<f64>| [v.x, v.y, v.z].each(|x| f32x8::splat(x as f32));
        let (from, middle, way) = (single(&self.from), single(&self.middle), single(&self.half));
        let slack = f32x8::splat(up(self.slack));
        let apart = |p: &[f32x8; 3]| [centre[0] - p[0], centre[1] - p[1], centre[2] - p[2]];
        let offset = apart(&middle);
        let m = [0, 1, 2].each(|k: usize| dot(&axes[k], &offset));
        let e = [0, 1, 2].each(|k: usize| dot(&axes[k], &way));
        let h = half.each(|x| x + slack);
        let wide = e.each(|x| x.abs());
        let length = m[0].abs() + m[1].abs() + m[2].abs() + wide[0] + wide[1] + wide[2];
        let touches = |k: usize| m[k].abs().simd_le(h[k] + wide[k]);
        let crosses = |i: usize, j: usize| {
            let twist = (m[i] * e[j] - m[j] * e[i]).abs();
            twist.simd_le(h[i] * wide[j] + h[j] * wide[i] + slack * length)
        };
        let open = touches(0) & touches(1) & touches(2) & crosses(0, 1) & crosses(1, 2) & crosses(2, 0);
        let reach = h[0] * wide[0] + h[1] * wide[1] + h[2] * wide[2];
        let two = f32x8::splat(2.0);
        let near = two * (dot(&way, &apart(&from)) - reach - slack * (way[0].abs() + way[1].abs() + way[2].abs()));
        (open.to_bitmask() & 0xff, near.to_array())
    }

    /// Returns whether the segment certainly misses a box.
    fn misses(&self, b: &OrientedBox) -> bool {
        let offset = self.middle - b.centre();
        let (mut m, mut e) = (Vector3::zeros(), Vector3::zeros());
        for k in 0..3 {
            (m[k], e[k]) = (b.axis(k).dot(&offset), b.axis(k).dot(&self.half));
        }
        // The axes as stored are orthonormal within 8 UNIT_SINGLE.
        let length = m.abs().sum() + e.abs().sum();
        let slack = 32.0 * UNIT_SINGLE * (length + 1.0) + 4.0 * self.error;
        let h = b.half().add_scalar(slack);
        let crossed = |i: usize, j: usize| {
            (m[i] * e[j] - m[j] * e[i]).abs() > h[i] * e[j].abs() + h[j] * e[i].abs() + slack * length
        };
        (0..3).any(|k| m[k].abs() > h[k] + e[k].abs()) || crossed(0, 1) || crossed(1, 2) || crossed(2, 0)
    }
}
