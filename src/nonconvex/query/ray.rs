//! A ray and a mesh: where the ray first meets a triangle.
//!
//! A ray meets a closed triangle if its line does not pass one edge on one side and another edge on
//! the other side. So a ray through an edge meets both triangles of the edge, and none is missed.
//! Signs and distances come from floating point if rounding leaves no doubt. Otherwise they come
//! from integers, which represent the caller's ray without rounding.

use nalgebra::Vector3;

use crate::base::num::each::Each;
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{RAY_PLANE, RAY_SIDE};
use crate::nonconvex::mesh::Mesh;
#[cfg(feature = "exact")]
use crate::nonconvex::query::exact::ExactRay;
use crate::nonconvex::query::triangle::{self, Triangle};

/// A part of a ray, in stored coordinates of a mesh or of a polyhedron.
///
/// Distances are measured from the origin of the ray, in the caller's unit.
pub(crate) struct MeshRay {
    /// The ends of the part, with a position error of at most `error`.
    pub(crate) ends: [Vector3<f64>; 2],
    pub(crate) error: f64,
    /// The direction, with an error of at most 80 UNIT.
    pub(crate) direction: Vector3<f64>,
    /// The distances of the ends from the origin.
    pub(crate) span: [f64; 2],
    /// The length of the ray.
    pub(crate) length: f64,
    /// Largest error of a distance.
    pub(crate) width: f64,
    #[cfg(feature = "exact")]
    pub(crate) exact: ExactRay,
}

/// What the ray meets first.
#[derive(Clone, Copy)]
pub(crate) enum Met {
    Nothing,
    /// Nothing before the first distance, something before or at the second.
    Between(f64, f64),
}

/// Where a ray meets a triangle.
pub(crate) enum RayTriangle {
    Miss,
    Between(f64, f64),
    /// Rounding hides the answer.
    #[cfg_attr(feature = "exact", allow(dead_code, reason = "integers always answer"))]
    Unclear,
}

impl Mesh {
    /// Returns what a ray meets first, and the triangle whose bracket ends first, unless the origin
    /// is on the mesh.
    ///
    /// Returns `None` if rounding hides it, never with the feature `exact`.
    pub(crate) fn first_met(&self, ray: &mut MeshRay) -> Option<(Met, Option<u32>)> {
        let (mut met, mut first, mut is_clear) = (Met::Nothing, None, true);
        let ([from, to], error) = (ray.ends, ray.error);
        let (mut last, span) = (f64::INFINITY, ray.span[1] - ray.span[0]);
        self.along(&from, &to, error, |t| {
            is_clear = met.add(ray.meets(&self.corners(t), self.frame.exponent));
            if !is_clear {
                return -1.0;
            }
            if let Met::Between(_, hit) = met
                && hit < last
            {
                (first, last) = (Some(t), hit);
            }
            // A triangle beyond has a bracket that begins after the end of this one.
            let part = (last + 4.0 * ray.width - ray.span[0]) / span;
            // Written so that NaN leaves the whole segment.
            if part < 1.0 { part.at_least(0.0) } else { 1.0 }
        });
        is_clear.then_some((met, first))
    }
}

impl Met {
    /// Adds another triangle; returns false if rounding hides the answer.
    pub(crate) fn add(&mut self, triangle: RayTriangle) -> bool {
        match (triangle, *self) {
            (RayTriangle::Unclear, _) => return false,
            (RayTriangle::Miss, _) => {}
            (RayTriangle::Between(low, high), Self::Nothing) => *self = Self::Between(low, high),
            (RayTriangle::Between(low, high), Self::Between(safe, hit)) => {
                *self = Self::Between(low.smaller(safe), high.smaller(hit));
            }
        }
        true
    }
}

impl MeshRay {
    /// Returns where the ray meets a triangle; a stored length times `2^exponent` is the caller's
    /// length.
    pub(crate) fn meets(&mut self, corners: &Triangle, exponent: i32) -> RayTriangle {
        let sides = self.sides(corners);
        if sides.contains(&Some(1)) && sides.contains(&Some(-1)) {
            return RayTriangle::Miss;
        }
        if let [Some(_), Some(_), Some(_)] = sides
            && let Some((at, off)) = self.to_plane(corners)
            && off < 0.75 * self.width
        {
            let low = at - self.width;
            let clipped = self.clipped(low, low + self.width * 2.0);
            return clipped.unwrap_or_else(|| self.exactly(corners, exponent, sides));
        }
        self.exactly(corners, exponent, sides)
    }

    /// Returns whether the ray certainly passes through a triangle between two distances.
    pub(crate) fn passes(&self, corners: &Triangle, [from, until]: [f64; 2]) -> bool {
        let sides = self.sides(corners);
        let is_through = sides == [Some(1); 3] || sides == [Some(-1); 3];
        let noise = 0.25 * self.width;
        is_through
            && self
                .to_plane(corners)
                .is_some_and(|(at, off)| at - off - noise > from && at + off + noise < until)
    }

    /// Returns the sides on which the line passes the edges of a triangle; `None` for a doubtful
    /// side.
    fn sides(&self, corners: &Triangle) -> [Option<i32>; 3] {
        let from = &self.ends[0];
        let seen = corners.each(|x| x - from);
        [0, 1, 2].each(|k| {
            let along = corners[(k + 1) % 3] - corners[k];
            let side = self.direction.dot(&seen[k].cross(&along));
            let size = seen[k].abs().sum();
            let bound = along.abs().sum() * (RAY_SIDE * size + 2.0 * self.error) + f64::MIN_POSITIVE;
            // Written so that NaN is unclear.
            if side > bound {
                Some(1)
            } else if side < -bound {
                Some(-1)
            } else {
                None
            }
        })
    }

    /// Returns the distance at which the line meets the plane of a triangle, and its error.
    ///
    /// The error is without the rounding of the distance itself.
    fn to_plane(&self, corners: &Triangle) -> Option<(f64, f64)> {
        let [from, to] = &self.ends;
        let (seen, way) = (corners[0] - from, to - from);
        let (u, v) = (corners[1] - corners[0], corners[2] - corners[0]);
        let n = triangle::normal(corners);
        let (height, rise) = (n.dot(&seen), n.dot(&way));
        let part = height / rise;
        let length = self.span[1] - self.span[0];
        let (own, size) = (sqrt(n.norm_squared()), u.abs().sum() * v.abs().sum());
        let error = |x: &Vector3<f64>| own * self.error + RAY_PLANE * size * x.abs().sum();
        let (of_height, of_rise) = (error(&seen), 2.0 * error(&way));
        let least = rise.abs() - of_rise;
        // Written so that NaN returns `None`.
        (least > 0.0).then(|| {
            let off = (of_height + part.abs() * of_rise) * length / least;
            (self.span[0] + part * length, off)
        })
    }

    /// Returns the bracket of a distance, or a miss.
    ///
    /// Returns `None` if an end of the ray is within the bracket.
    fn clipped(&self, low: f64, high: f64) -> Option<RayTriangle> {
        if high < 0.0 || low > self.length {
            return Some(RayTriangle::Miss);
        }
        (low > 0.0 && high <= self.length).then(|| RayTriangle::Between(low, high.smaller(self.span[1])))
    }

    #[cfg(feature = "exact")]
    #[cold]
    fn exactly(&mut self, corners: &Triangle, exponent: i32, sides: [Option<i32>; 3]) -> RayTriangle {
        match self.exact.meets(corners, exponent, sides, self.length) {
            // The lower bound is `width` before the surface, as in floating point. So a point at
            // this distance is before the surface even after rounding.
            RayTriangle::Between(low, high) if low > self.width => RayTriangle::Between(low - self.width, high),
            found => found,
        }
    }

    #[cfg(not(feature = "exact"))]
    fn exactly(&self, _: &Triangle, _: i32, _: [Option<i32>; 3]) -> RayTriangle {
        RayTriangle::Unclear
    }
}
