//! A segment and a mesh: the triangles that the segment passes through, by exact predicates.
//!
//! Source: orientation predicates: Shewchuk 1997.

use alloc::vec;
use nalgebra::Vector3;

use crate::base::num::sign;
use crate::base::tolerance::UNIT_SINGLE;
use crate::composite::meet::triangle;
use crate::composite::mesh::Mesh;
use crate::composite::tree::{Below, OrientedBox, Tree};

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
    pub(in crate::composite) fn first_meeting(
        &self,
        from: &Vector3<f64>,
        to: &Vector3<f64>,
        least: f64,
    ) -> Option<f64> {
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
    pub(in crate::composite) fn any_along(
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
pub(in crate::composite) fn crossing(
    [a, b, c]: &triangle::Triangle,
    from: &Vector3<f64>,
    to: &Vector3<f64>,
) -> Option<i32> {
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
