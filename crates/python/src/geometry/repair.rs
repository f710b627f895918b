//! What a repair of a mesh has changed.

use lin_canny::MeshRepair as Report;
use pyo3::prelude::*;

/// What `Geometry.repaired_mesh` has changed. Indices are those given.
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct MeshRepair(pub(super) Box<Report>);

#[pymethods]
impl MeshRepair {
    /// Number of points that moved to another one within the tolerance.
    #[getter]
    fn welded(&self) -> usize {
        self.0.welded
    }

    /// Triangles that were inverted.
    #[getter]
    fn turned(&self) -> Vec<u32> {
        self.0.turned.clone()
    }

    /// Edges, as pairs of points, at which triangles do not agree, whichever way they are inverted: the
    /// surface has one side, as a Moebius strip has.
    #[getter]
    fn one_sided_edges(&self) -> Vec<[u32; 2]> {
        self.0.one_sided_edges.clone()
    }

    /// The loop of points that each cap closes.
    #[getter]
    fn caps(&self) -> Vec<Vec<u32>> {
        self.0.caps.iter().map(|cap| cap.corners.clone()).collect()
    }

    /// Area of the caps as a share of the area of the repaired mesh, from 0 to 1.
    #[getter]
    fn cap_share(&self) -> f64 {
        self.0.cap_share
    }

    /// Number of points of the longest loop; 0 without caps.
    #[getter]
    fn longest_loop(&self) -> usize {
        self.0.longest_loop()
    }

    /// Whether the triangles cancel in pairs, so that nothing is inside.
    #[getter]
    fn is_empty(&self) -> bool {
        self.0.is_empty
    }

    fn __repr__(&self) -> String {
        format!("<MeshRepair: {}>", self.0)
    }
}
