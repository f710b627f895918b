//! A ray and a mesh: where the ray first meets a triangle.
//!
//! A ray meets a closed triangle if its line passes no edge on one side and another edge on the
//! other. So a ray through an edge meets both triangles of the edge, and none is missed. Signs and
//! distances come from floating point if rounding leaves no doubt, else from integers: the ray is
//! the one that the caller gave, to the bit.

use nalgebra::Vector3;

use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{RAY_PLANE, RAY_SIDE};
use crate::composite::meet::triangle::{self, Triangle};
use crate::composite::mesh::Mesh;
#[cfg(feature = "exact")]
use crate::composite::meet::exact_ray::ExactRay;

/// A part of a ray, in stored coordinates of a mesh. Distances from the origin of the ray are the
/// caller's.
pub(crate) struct MeshRay {
    /// The ends of the part, up to `error`.
    pub(crate) ends: [Vector3<f64>; 2],
    pub(crate) error: f64,
    /// The direction, off by at most 80 UNIT.
    pub(crate) direction: Vector3<f64>,
    /// How far the ends are from the origin.
    pub(crate) span: (f64, f64),
    /// How far the ray goes.
    pub(crate) length: f64,
    /// By how much a distance may be off.
    pub(crate) width: f64,
    #[cfg(feature = "exact")]
    pub(crate) exact: ExactRay,
}

/// What the ray meets.
pub(crate) enum Met {
    Nothing,
    /// Nothing up to the first distance, something up to the second.
    Between(f64, f64),
}

/// A ray and a triangle.
pub(super) enum RayTriangle {
    Miss,
    Between(f64, f64),
    /// Rounding hides the answer.
    Unclear,
}

impl Mesh {
    /// Returns what a ray meets first, unless the origin is on the mesh. `None` if rounding hides
    /// it: never with the feature `exact`.
    pub(crate) fn first_met(&self, ray: &MeshRay) -> Option<Met> {
        let (mut met, mut is_clear) = (None, true);
        let [from, to] = &ray.ends;
        self.any_along(from, to, ray.error, |t| {
            match ray.meets(self, t) {
                RayTriangle::Miss => {}
                RayTriangle::Between(low, high) => {
                    let (safe, hit) = met.unwrap_or((low, high));
                    met = Some((low.min(safe), high.min(hit)));
                }
                RayTriangle::Unclear => is_clear = false,
            }
            !is_clear
        });
        is_clear.then(|| met.map_or(Met::Nothing, |(safe, hit)| Met::Between(safe, hit)))
    }
}

impl MeshRay {
    fn meets(&self, mesh: &Mesh, t: u32) -> RayTriangle {
        let corners = mesh.corners(t);
        let sides = self.sides(&corners);
        if sides.contains(&Some(1)) && sides.contains(&Some(-1)) {
            return RayTriangle::Miss;
        }
        if let [Some(_), Some(_), Some(_)] = sides
            && let Some((low, high)) = self.between(&corners)
        {
            return self.clipped(low, high).unwrap_or_else(|| self.exactly(mesh, t, sides));
        }
        self.exactly(mesh, t, sides)
    }

    /// Returns on which sides of the edges of a triangle the line passes: `None` if rounding hides
    /// it.
    fn sides(&self, corners: &Triangle) -> [Option<i32>; 3] {
        let from = &self.ends[0];
        let seen = corners.map(|x| x - from);
        [0, 1, 2].map(|k| {
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

    /// Returns two distances between which the line meets the plane of a triangle; `None` if
    /// rounding hides more than the width.
    fn between(&self, corners: &Triangle) -> Option<(f64, f64)> {
        let [from, to] = &self.ends;
        let (seen, way) = (corners[0] - from, to - from);
        let (u, v) = (corners[1] - corners[0], corners[2] - corners[0]);
        let n = triangle::normal(corners);
        let (height, rise) = (n.dot(&seen), n.dot(&way));
        let part = height / rise;
        let length = self.span.1 - self.span.0;
        let (own, size) = (sqrt(n.norm_squared()), u.abs().sum() * v.abs().sum());
        let error = |x: &Vector3<f64>| own * self.error + RAY_PLANE * size * x.abs().sum();
        let (of_height, of_rise) = (error(&seen), 2.0 * error(&way));
        let off = (of_height + part.abs() * of_rise) * length;
        // Written so that NaN is too wide.
        if !(off < self.width * (rise.abs() - of_rise) * 0.75) {
            return None;
        }
        let low = self.span.0 + part * length - self.width;
        Some((low, low + self.width * 2.0))
    }

    /// Returns the bracket of a distance if its ends leave no doubt that the ray gets there.
    fn clipped(&self, low: f64, high: f64) -> Option<RayTriangle> {
        if high < 0.0 || low > self.length {
            return Some(RayTriangle::Miss);
        }
        (low > 0.0 && high <= self.length).then(|| RayTriangle::Between(low, high.min(self.span.1)))
    }

    #[cfg(feature = "exact")]
    #[cold]
    fn exactly(&self, mesh: &Mesh, t: u32, sides: [Option<i32>; 3]) -> RayTriangle {
        self.exact.meets(mesh, t, sides, self.length)
    }

    #[cfg(not(feature = "exact"))]
    fn exactly(&self, _: &Mesh, _: u32, _: [Option<i32>; 3]) -> RayTriangle {
        RayTriangle::Unclear
    }
}
