//! Inside or outside of a closed mesh, by exact winding numbers.
//!
//! A segment from the point to a place outside the bounding box crosses the mesh; crossings count
//! +1 outward and -1 inward, right for parts that overlap or lie in each other, for which
//! parity and the normal of the nearest triangle are wrong. Every sign is an exact predicate; if
//! a sign is zero, another segment is taken.
//!
//! Source: the winding number by signed crossings is classical; orientation predicates: Shewchuk
//! 1997.

use nalgebra::Vector3;

use crate::base::num::extremes::largest;
use crate::base::tolerance::FLUSH_EXPONENT;
use crate::body::polyhedron::{exponent_of, power_of_two};
use crate::composite::meet::segment::crossing;
use crate::composite::meet::triangle;
use crate::composite::mesh::Mesh;

/// Segments tried for a winding number. A first zero is rare already, and the ends are in general
/// position against anything made of round numbers.
const SEGMENTS: usize = 24;

impl Mesh {
    /// Returns the winding number about a point in stored coordinates that does not lie on the
    /// surface. `None` if every segment met an edge or passed through a vertex.
    pub(in crate::composite) fn winding(&self, point: &Vector3<f64>) -> Option<i32> {
        self.winding_of(point, |_| true)
    }

    /// Returns the winding number of some of the triangles, which close a surface on which the
    /// point does not lie.
    pub(in crate::composite) fn winding_of(&self, point: &Vector3<f64>, counts: impl Fn(u32) -> bool) -> Option<i32> {
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
    pub(in crate::composite) fn is_clear_of(&self, point: &Vector3<f64>, error: f64) -> bool {
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
