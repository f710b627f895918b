//! Axis-aligned boxes of a posed body, for a broad phase.
//!
//! The vertices of a small body are scanned, four at a time in `f32` (SIMD). For a larger body the
//! caller keeps the six extreme vertices as hints, and hill climbing starts there (Cohen, Lin,
//! Manocha and Ponamgi 1995, section 4.2, the dynamic box). Both results are rounded outward by a
//! bound of all rounding, so the box contains the posed body. On each side it is too large by at
//! most `1e-6 r` if the vertices are scanned, and by `1e-14 (r + |t|)` if hill climbing is used.

use alloc::vec::Vec;

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use wide::f32x4;

use crate::base::num::each::Each;
use crate::base::pose::rotation_matrix;
use crate::base::tolerance::{BOX, BOX_SCANNED, POSE_UNIT};
use crate::body::polyhedron::support::SCANNED;
use crate::body::polyhedron::{ConvexPolyhedron, VertexId};

/// The extreme vertices of one body at its last pose, where [`ConvexPolyhedron::aabb_at`] starts.
///
/// An outdated hint, or one of another body, costs time but never makes a box too small.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BoxHint([VertexId; 6]);

impl Default for BoxHint {
    fn default() -> Self {
        Self([VertexId(0); 6])
    }
}

/// Vertex coordinates in `f32`, axis by axis, in groups of four; the last group repeats a vertex.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scan(Vec<[f32x4; 3]>);

impl Scan {
    /// Packs the vertices of a body small enough to be scanned; empty for larger bodies.
    pub(crate) fn new(points: &[Vector3<f64>]) -> Self {
        if points.len() > SCANNED {
            return Self::default();
        }
        let group = |g: &[Vector3<f64>]| {
            [0, 1, 2].each(|axis| f32x4::new(core::array::from_fn(|k| g[k.min(g.len() - 1)][axis] as f32)))
        };
        Self(points.chunks(4).map(group).collect())
    }

    /// Returns the bytes on the heap.
    pub(crate) fn memory_usage(&self) -> usize {
        size_of_val(&self.0[..])
    }

    /// Returns the least and greatest coordinates of the rotated vertices, not yet rounded outward.
    #[inline]
    fn span(&self, matrix: &Matrix3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let rows: [[f32x4; 3]; 3] =
            core::array::from_fn(|r| core::array::from_fn(|c| f32x4::splat(matrix[(r, c)] as f32)));
        let mut low = [f32x4::splat(f32::INFINITY); 3];
        let mut high = [f32x4::splat(f32::NEG_INFINITY); 3];
        for [x, y, z] in &self.0 {
            for k in 0..3 {
                let [a, b, c] = rows[k];
                let along = *x * a + *y * b + *z * c;
                low[k] = low[k].fast_min(along);
                high[k] = high[k].fast_max(along);
            }
        }
        let low = across(low, f32x4::fast_min);
        let high = across(high, f32x4::fast_max);
        (low, high)
    }
}

/// Folds the four lanes of each of three vectors to one number, all three vectors in parallel.
#[inline(always)]
fn across([x, y, z]: [f32x4; 3], fold: impl Fn(f32x4, f32x4) -> f32x4) -> Vector3<f64> {
    let [a, b, c, d] = f32x4::transpose([x, y, z, z]);
    let [x, y, z, _] = fold(fold(a, b), fold(c, d)).to_array();
    Vector3::new(x, y, z).map(f64::from)
}

impl ConvexPolyhedron {
    /// Returns the axis-aligned box of the body at a pose, rounded outward.
    ///
    /// The result is the least and greatest corner, in the frame to which the pose leads. `hint`
    /// keeps the extreme vertices from one frame to the next.
    ///
    /// If the pose is not finite, the box is not finite either; a broad phase rejects it with an
    /// error that names the body.
    #[doc(alias = "compute_aabb")]
    pub fn aabb_at(&self, pose: &Isometry3<f64>, hint: &mut BoxHint) -> (Point3<f64>, Point3<f64>) {
        let matrix = matrix(pose);
        let (low, high, error) = if self.scan.0.is_empty() {
            let (low, high) = self.climbed_span(&matrix, hint);
            (low, high, BOX * self.radius)
        } else {
            let (low, high) = self.scan.span(&matrix);
            (low, high, BOX_SCANNED * self.radius)
        };
        let t = pose.translation.vector;
        let around = |center: Vector3<f64>, low, high, margin| {
            (
                Point3::from(center + low - margin),
                Point3::from(center + high + margin),
            )
        };
        if self.is_unscaled {
            return around(t, low, high, (t.abs() * BOX).add_scalar(error));
        }
        let (center, far) = self.origin_at(&matrix, &t);
        let unit = self.unit();
        around(center, low * unit, high * unit, far.add_scalar(error * unit))
    }

    /// Returns a cube that contains the body in every orientation.
    ///
    /// The cube is centred at the origin of the body or, for a body far from its origin, at its
    /// middle: the fixed box of Cohen et al. 1995. It is cheaper and larger than
    /// [`aabb_at`](Self::aabb_at), so more pairs have to be tested.
    #[must_use]
    pub fn cube_at(&self, pose: &Isometry3<f64>) -> (Point3<f64>, Point3<f64>) {
        let matrix = matrix(pose);
        let (center, far) = self.origin_at(&matrix, &pose.translation.vector);
        let half = far.add_scalar(self.radius * self.unit() * (1.0 + BOX));
        (Point3::from(center - half), Point3::from(center + half))
    }

    /// Returns the posed stored origin and a bound of its error by axis. The error of a matrix
    /// entry is absolute, even if the entry is small.
    #[cold]
    fn origin_at(&self, matrix: &Matrix3<f64>, t: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let far = t.abs().add_scalar(self.origin.abs().sum()) * BOX;
        (matrix * self.origin + t, far)
    }

    /// Climbs to the least and greatest vertex along each axis. Not inlined: the scan needs fewer
    /// saved registers.
    #[inline(never)]
    fn climbed_span(&self, matrix: &Matrix3<f64>, hint: &mut BoxHint) -> (Vector3<f64>, Vector3<f64>) {
        let (mut low, mut high) = (Vector3::zeros(), Vector3::zeros());
        for k in 0..3 {
            let up = Vector3::new(matrix[(k, 0)], matrix[(k, 1)], matrix[(k, 2)]);
            for (slot, n, end) in [(2 * k, -up, &mut low[k]), (2 * k + 1, up, &mut high[k])] {
                let known = hint.0[slot];
                let start = if known.index() < self.points.len() {
                    known
                } else {
                    VertexId(0)
                };
                // An empty or outdated hint climbs from the cube map if that is higher.
                let top = if self.is_local_maximum(&n, start) {
                    start
                } else {
                    self.support_climb(&n, self.start_vertex(&n, start))
                };
                hint.0[slot] = top;
                *end = up.dot(&self.points[top.index()]);
            }
        }
        (low, high)
    }
}

/// Returns the rotation matrix `R(q) / |q|^2` of a pose.
#[inline]
fn matrix(pose: &Isometry3<f64>) -> Matrix3<f64> {
    let q = pose.rotation.coords;
    let n = q.norm_squared();
    // For a unit quaternion `2 - n` is `1 / n` to 1e-24, and nothing waits for a division.
    let inverse = if (n - 1.0).abs() <= POSE_UNIT { 2.0 - n } else { 1.0 / n };
    rotation_matrix(&[q.x, q.y, q.z, q.w], 2.0 * inverse)
}
