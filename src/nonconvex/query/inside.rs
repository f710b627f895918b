//! Point inside a closed mesh, by exact winding numbers, and triangles that a segment passes
//! through, by exact predicates.
//!
//! 1. A segment leads from the point to a position outside the bounding box.
//! 2. Each crossing of the segment with the mesh counts +1 outward and -1 inward. The sum is right
//!    even if components overlap or contain each other. Parity and the normal of the nearest
//!    triangle are wrong in these cases.
//! 3. Every sign is an exact predicate. If a sign is zero, another segment is tried.
//!
//! Sources: the winding number by signed crossings is classical; orientation predicates, Shewchuk
//! 1997.

use alloc::vec;
use nalgebra::Vector3;

use crate::base::num::extremes::largest;
use crate::base::num::sign;
use crate::base::tolerance::{FLUSH_EXPONENT, UNIT_SINGLE};
use crate::body::polyhedron::{exponent_of, power_of_two};
use crate::nonconvex::mesh::Mesh;
use crate::nonconvex::query::triangle;
use crate::nonconvex::tree::{Below, OrientedBox, Tree};

/// Number of segments tried for a winding number.
///
/// A zero sign is rare even at the first segment, because the ends of the segments are in general
/// position to anything made of round numbers.
const SEGMENTS: usize = 24;

impl Mesh {
    /// Returns the winding number of a point in stored coordinates that is not on the surface.
    ///
    /// Returns `None` if every segment met an edge or a vertex.
    pub(crate) fn winding(&self, point: &Vector3<f64>) -> Option<i32> {
        self.winding_of(point, |_| true)
    }

    /// Returns the winding number of the triangles for which `counts` returns true.
    ///
    /// These triangles must form a closed surface that does not contain the point.
    pub(crate) fn winding_of(&self, point: &Vector3<f64>, counts: impl Fn(u32) -> bool) -> Option<i32> {
        let flush = power_of_two(exponent_of(self.radius) - FLUSH_EXPONENT);
        let p = point.map(|x| if x.abs() < flush { 0.0 } else { x });
        if (0..3).any(|k| !(p[k] >= self.low[k] && p[k] <= self.high[k])) {
            return Some(0);
        }
        (0..SEGMENTS).find_map(|k| self.crossings(&p, &self.outside(&p, k), &counts))
    }

    /// Returns a position outside the bounding box, near the side that is nearest to `p`.
    fn outside(&self, p: &Vector3<f64>, attempt: usize) -> Vector3<f64> {
        let (up, down) = (self.high - p, p - self.low);
        let (x, y) = (up.imin(), down.imin());
        let (axis, way, room) = if up[x] < down[y] {
            (x, 1.0, up[x])
        } else {
            (y, -1.0, down[y])
        };
        let size = largest(&(self.high - self.low));
        // No round number divides these slopes, and they differ for each attempt.
        let slant = 0.137 + 0.618_033_988 * attempt as f64;
        let (s, t) = (
            slant - libm::floor(slant) - 0.5,
            0.5 - slant * 0.381_966 + libm::floor(slant * 0.381_966),
        );
        let along = room * 1.0625 + size * 0.015_625;
        let mut step = Vector3::zeros();
        step[axis] = way * along;
        step[(axis + 1) % 3] = s * along;
        step[(axis + 2) % 3] = t * along;
        p + step
    }

    /// Returns the sum of the signed crossings of a segment with the mesh; `None` if a sign is
    /// zero.
    fn crossings(&self, from: &Vector3<f64>, to: &Vector3<f64>, counts: impl Fn(u32) -> bool) -> Option<i32> {
        let mut sum = 0;
        let is_doubtful = self.any_along(from, to, 0.0, |t| {
            let crossing = if counts(t) {
                crossing(&self.corners(t), from, to)
            } else {
                Some(0)
            };
            sum += crossing.unwrap_or(0);
            crossing.is_none()
        });
        (!is_doubtful).then_some(sum)
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
    /// no farther than `doubt`, or if every segment to the outside met an edge.
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
    /// `doubt`, or if every segment to the outside met an edge.
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
        self.any_along(from, to, 0.0, |t| {
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
        self.any_along(from, to, 0.0, |t| {
            if let Some(part) = meeting(&self.corners(t), from, to)
                && part > least
                && first.is_none_or(|f| part < f)
            {
                first = Some(part);
            }
            false
        });
        first
    }

    /// Calls `is_found` with each triangle whose box the segment may meet, until a call returns
    /// true.
    ///
    /// The points of the segment may be off by `error`. Returns whether a call returned true.
    pub(super) fn any_along(
        &self,
        from: &Vector3<f64>,
        to: &Vector3<f64>,
        error: f64,
        mut is_found: impl FnMut(u32) -> bool,
    ) -> bool {
        let segment = Segment::new(&self.tree, from, to, error);
        let mut stack = vec![0];
        while let Some(node) = stack.pop() {
            if segment.misses(&self.tree.boxes[node as usize]) {
                continue;
            }
            match self.tree.below(node) {
                Below::Children(c) => stack.extend([c, c + 1]),
                Below::Leaf(first, count) => {
                    if (first..first + count).any(&mut is_found) {
                        return true;
                    }
                }
            }
        }
        false
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

/// A segment in the tree's coordinates: its middle, and half of it as a vector.
struct Segment {
    middle: Vector3<f64>,
    half: Vector3<f64>,
    /// Position error of the points.
    error: f64,
}

impl Segment {
    fn new(tree: &Tree, from: &Vector3<f64>, to: &Vector3<f64>, error: f64) -> Self {
        let place = |p: &Vector3<f64>| (p - tree.centre) / tree.unit();
        let (from, to) = (place(from), place(to));
        Self {
            middle: (from + to) * 0.5,
            half: (to - from) * 0.5,
            error: error / tree.unit(),
        }
    }

    /// Returns whether the segment certainly misses a box.
    ///
    /// They are separated along an axis of the box, or along the cross product of an axis and the
    /// segment.
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
