//! Faces that cancel: triangles on each other in one plane that face opposite ways.
//!
//! ```text
//!     wall            ----->-----+----->-----      outer face
//!     window (cavity)   --<--    |                 its end, in the same plane
//! ```

use nalgebra::Vector3;

use super::Mesh;
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::ONE_PLANE;
use crate::composite::meet::triangle::{self, Triangle};

impl Mesh {
    /// Returns whether two triangles cancel over an area, up to the rounding of coordinates.
    pub(super) fn cancel(&self, p: &Triangle, q: &Triangle) -> bool {
        let (m, n) = (triangle::normal(p), triangle::normal(q));
        if !(m.dot(&n) < 0.0) {
            return false;
        }
        // The plane of the larger one is the better known.
        let (large, normal, small) = if m.norm_squared() < n.norm_squared() {
            (q, n, p)
        } else {
            (p, m, q)
        };
        let (doubt, length) = (ONE_PLANE * self.radius, sqrt(normal.norm_squared()));
        let is_off = |x: &Vector3<f64>| !(normal.dot(&(x - large[0])).abs() <= doubt * length);
        if small.iter().any(is_off) {
            return false;
        }
        let is_beside = |x: &Triangle, y: &Triangle, out: f64| {
            (0..3).any(|i| {
                let side = (x[(i + 1) % 3] - x[i]).cross(&normal) * out;
                let length = sqrt(side.norm_squared());
                y.iter().all(|v| side.dot(&(v - x[i])) >= -doubt * length)
            })
        };
        !(is_beside(large, small, 1.0) || is_beside(small, large, -1.0))
    }
}
