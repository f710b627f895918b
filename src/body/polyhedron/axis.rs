//! The axis of a fan: a direction along which all edges of a vertex rise, exactly.

use nalgebra::Vector3;

use crate::base::num::double_double::{DoubleDouble, Expansion};
use crate::base::num::sign::{edge_sign, exact_dot};
use crate::body::polyhedron::cycle::Cycle;
use crate::body::polyhedron::topology::Topology;
use crate::body::polyhedron::{HalfEdgeId, Plane, VertexId};

/// The axis `m` of a fan: a direction along which all its edges rise, each coordinate a sum of
/// parts of falling magnitude.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    parts: [[f64; Self::PARTS]; 3],
    /// Whether f64 is certain that all edges rise along the first parts; then all other parts are
    /// zero.
    pub(super) is_plain: bool,
}

impl Axis {
    /// Number of parts. One part is enough but for an apex no higher than rounding over a base of
    /// thousands of vertices.
    const PARTS: usize = 4;

    #[cfg(test)]
    pub(super) fn new(parts: [[f64; Self::PARTS]; 3]) -> Self {
        Self { parts, is_plain: false }
    }

    /// Returns minus the mean normal of the faces at `v`, if f64 is certain that all edges of `v`
    /// rise along it.
    pub(super) fn from_normals(t: &Topology, points: &[Vector3<f64>], planes: &[Plane], v: VertexId) -> Option<Self> {
        let normals = t.fan(v).iter().map(|h| planes[t.half_edge(h).face.index()].normal);
        let m = -normals.sum::<Vector3<f64>>() / t.fan(v).len() as f64;
        let rises = |w: VertexId| edge_sign(&m, &(points[w.index()] - points[v.index()])) > 0;
        let parts = [0, 1, 2].map(|k| core::array::from_fn(|part| if part == 0 { m[k] } else { 0.0 }));
        t.neighbours(v).all(rises).then_some(Self { parts, is_plain: true })
    }

    /// Returns minus the sum of the exact normals of two faces at `v` without a common edge: all
    /// edges of `v` rise along this sum. `None` if the sum has too many parts.
    pub(super) fn from_exact_normals(t: &Topology, points: &[Vector3<f64>], v: VertexId) -> Option<Self> {
        let (fan, p) = (t.fan(v), points[v.index()]);
        let to = |h: HalfEdgeId| points[t.half_edge(h).to.index()];
        let faces = [0, fan.len() / 2].map(|k| [k, k + 1].map(|k| to(fan.at(k))));
        let coordinate = |k: usize| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let mut sum = Expansion::<{ 24 + Self::PARTS }>::new();
            for [q, r] in faces {
                // (r - p) x (q - p) without differences, which may be rounded.
                for (x, y) in [(r, q), (q, p), (p, r)] {
                    sum.add_product(x[i], y[j]);
                    sum.add_product(-x[j], y[i]);
                }
            }
            sum.leading()
        };
        let (parts, is_plain) = ([0, 1, 2].map(coordinate), false);
        let axis = Self { parts, is_plain };
        let rises = |w: VertexId| axis.rise(&p, &points[w.index()]).sign() > 0;
        t.neighbours(v).all(rises).then_some(axis)
    }

    /// Returns the axis rounded to f64.
    pub(crate) fn rounded(&self) -> Vector3<f64> {
        Vector3::from(self.parts.map(|p| p[0]))
    }

    /// Returns the first two parts of each coordinate, as double-double.
    pub(super) fn doubled(&self) -> [DoubleDouble; 3] {
        self.parts.map(|[hi, lo, ..]| DoubleDouble { hi, lo })
    }

    /// Returns all parts of each coordinate.
    #[cfg(feature = "exact")]
    pub(crate) fn parts(&self) -> &[[f64; Self::PARTS]; 3] {
        &self.parts
    }

    /// Returns `m . (q - p)` without rounding.
    pub(super) fn rise(&self, p: &Vector3<f64>, q: &Vector3<f64>) -> Expansion<{ 12 * Self::PARTS }> {
        exact_dot(&self.parts, p, q)
    }
}
