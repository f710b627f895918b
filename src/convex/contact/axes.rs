//! Local coordinates of a contact: plane coordinates perpendicular to the normal, and heights along
//! it.

use nalgebra::Vector3;

use crate::body::polyhedron::{ConvexPolyhedron, FaceId};

/// Contact axes in a body's stored frame: two directions perpendicular to the normal, the normal,
/// and the body's witness as the origin.
pub(super) struct Axes {
    pub(super) tangents: [Vector3<f64>; 2],
    pub(super) normal: Vector3<f64>,
    pub(super) witness: Vector3<f64>,
    /// Rounding of a plane coordinate.
    pub(super) noise: f64,
}

impl Axes {
    /// Returns plane coordinates and height of a stored point.
    #[inline(always)]
    pub(super) fn to_local(&self, p: &Vector3<f64>) -> [f64; 3] {
        let d = p - self.witness;
        [self.tangents[0].dot(&d), self.tangents[1].dot(&d), self.normal.dot(&d)]
    }

    /// Returns the stored point at given plane coordinates and height.
    #[inline(always)]
    pub(super) fn point(&self, [x, y]: [f64; 2], height: f64) -> Vector3<f64> {
        self.witness + self.tangents[0] * x + self.tangents[1] * y + self.normal * height
    }
}

/// Plane of a face as a height field over the contact plane: height at the witness, and the descent
/// along both axes.
#[derive(Clone, Copy, Default)]
pub(super) struct FacePlane2 {
    level: f64,
    fall: [f64; 2],
}

impl FacePlane2 {
    /// Returns the plane of a face; the face must not be parallel to the normal.
    #[inline(always)]
    pub(super) fn new(body: &ConvexPolyhedron, f: FaceId, axes: &Axes) -> Self {
        let t = &body.topology;
        let m = &body.planes[f.index()].normal;
        let vertex = body.points[t.half_edge(t.rim_half_edge(f)).to.index()];
        let up = 1.0 / m.dot(&axes.normal);
        Self {
            level: m.dot(&(vertex - axes.witness)) * up,
            fall: axes.tangents.map(|e| m.dot(&e) * up),
        }
    }

    #[inline(always)]
    pub(super) fn height(&self, [x, y]: [f64; 2]) -> f64 {
        self.level - self.fall[0] * x - self.fall[1] * y
    }
}
