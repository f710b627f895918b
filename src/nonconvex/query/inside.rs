//! Inside or outside of a closed mesh, by exact winding numbers, and the triangles that a segment
//! passes through, by exact predicates.
//!
//! A segment from the point to a place outside the bounding box crosses the mesh; crossings count
//! +1 outward and -1 inward, right for parts that overlap or lie in each other, for which
//! parity and the normal of the nearest triangle are wrong. Every sign is an exact predicate; if
//! a sign is zero, another segment is taken.
//!
//! Source: the winding number by signed crossings is classical; orientation predicates: Shewchuk
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

/// Segments tried for a winding number. A first zero is rare already, and the ends are in general
/// position against anything made of round numbers.
const SEGMENTS: usize = 24;

impl Mesh {
    /// Returns the winding number about a point in stored coordinates that does not lie on the
    /// surface. `None` if every segment met an edge or passed through a vertex.
    pub(crate) fn winding(&self, point: &Vector3<f64>) -> Option<i32> {
        self.winding_of(point, |_| true)
    }

    /// Returns the winding number of some of the triangles, which close a surface on which the
    /// point does not lie.
    pub(crate) fn winding_of(&self, point: &Vector3<f64>, counts: impl Fn(u32) -> bool) -> Option<i32> {
        let flush = power_of_two(exponent_of(self.radius) - FLUSH_EXPONENT);
        let p = point.map(|x| if x.abs() < flush { 0.0 } else { x });
        if (0..3).any(|k| !(p[k] >= self.low[k] && p[k] <= self.high[k])) {
            return Some(0);
        }
        (0..SEGMENTS).find_map(|k| self.crossings(&p, &self.outside(&p, k), &counts))
    }

    /// Returns a place outside the bounding box, near the side that is nearest.
    fn outside(&self, p: &Vector3<f64>, attempt: usize) -> Vector3<f64> {
        let (up, down) = (self.high - p, p - self.low);
        let (x, y) = (up.imin(), down.imin());
        let (axis, way, room) = if up[x] < down[y] {
            (x, 1.0, up[x])
        } else {
            (y, -1.0, down[y])
        };
        let size = largest(&(self.high - self.low));
        // Slants that no round number divides, another for each attempt.
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

    /// Signed crossings of a segment with the mesh; `None` if a sign is zero.
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

    /// Returns whether the surface is certainly farther than `error` from a point in stored
    /// coordinates.
    fn is_clear_of(&self, point: &Vector3<f64>, error: f64) -> bool {
        !self.tree.any_near(point, error, |t| {
            let (square, _) = triangle::nearest(point, &self.corners(t));
            !(square > 4.0 * error * error)
        })
    }

    /// Returns whether a point that may be off its place by `doubt`, both in stored units, is
    /// inside a solid, or on a surface; `None` if the mesh is as near as the doubt, or if every
    /// segment to the outside met an edge.
    pub(crate) fn held_by_rounding(&self, point: &Vector3<f64>, doubt: f64) -> Option<bool> {
        if !self.is_clear_of(point, doubt) {
            return None;
        }
        if !self.is_solid() {
            return Some(false);
        }
        self.winding(point).map(|w| w != 0)
    }

    /// Returns whether a point that may be off its place by `doubt`, both in stored units, is
    /// inside a solid; `None` if the surface is as near as the doubt, or if every segment to the
    /// outside met an edge.
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
    /// Returns whether a segment certainly passes through a triangle from which its first end is
    /// no nearer than `skin`.
    pub(crate) fn is_crossed(&self, from: &Vector3<f64>, to: &Vector3<f64>, skin: f64) -> bool {
        self.any_along(from, to, 0.0, |t| {
            let corners = self.corners(t);
            is_crossed(&corners, from, to) && triangle::nearest(from, &corners).0 >= skin * skin
        })
    }

    /// Returns the part of a segment before it first meets a triangle, or an edge of one, farther
    /// along than the part `least`, right up to rounding; triangles in whose plane the segment lies
    /// are left out.
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

    /// Asks about the triangles whose boxes a segment may meet, the points of which may be off by
    /// `error`, until an answer is true.
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

/// +1 if the segment leaves through a triangle, -1 if it enters, 0 if it misses; `None` if it meets
/// an edge or the plane at an end. A triangle whose corners are on a line is missed.
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
        // Without area: what it might close, its neighbours close along the same line.
        return Some(0);
    }
    let doubtful = turns.iter().chain(&ends).any(|x| *x == 0.0);
    (!doubtful).then_some(if ends[0] < 0.0 { 1 } else { -1 })
}

/// Returns the part of a segment before it meets a triangle, edges counted.
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

/// A segment in the tree's coordinates: its middle and half its length as a vector.
struct Segment {
    middle: Vector3<f64>,
    half: Vector3<f64>,
    /// By how much the points may be off.
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

    /// Returns whether the segment certainly misses a box: apart along one of its axes, or along
    /// the normal of one and the segment.
    fn misses(&self, b: &OrientedBox) -> bool {
        let offset = self.middle - b.centre();
        let (mut m, mut e) = (Vector3::zeros(), Vector3::zeros());
        for k in 0..3 {
            (m[k], e[k]) = (b.axis(k).dot(&offset), b.axis(k).dot(&self.half));
        }
        // Axes as stored are orthonormal within 8 UNIT_SINGLE.
        let length = m.abs().sum() + e.abs().sum();
        let slack = 32.0 * UNIT_SINGLE * (length + 1.0) + 4.0 * self.error;
        let h = b.half().add_scalar(slack);
        let crossed = |i: usize, j: usize| {
            (m[i] * e[j] - m[j] * e[i]).abs() > h[i] * e[j].abs() + h[j] * e[i].abs() + slack * length
        };
        (0..3).any(|k| m[k].abs() > h[k] + e[k].abs()) || crossed(0, 1) || crossed(1, 2) || crossed(2, 0)
    }
}
