//! The volume that two solids share.

use lin_canny::nalgebra::Point3;
use lin_canny::{OverlapVolume as Volume, PairTracker as Tracker, RelativePose};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use super::PairTracker;
use crate::array::triple;
use crate::errors::pair_error;
use crate::geometry::Geometry;
use crate::pose::{Pose, relative};

/// The volume that two solids share, with proven bounds.
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct OverlapVolume {
    found: Volume,
    bodies: [Py<Geometry>; 2],
    pose: RelativePose,
}

#[pymethods]
impl OverlapVolume {
    /// Lower bound of the volume; it may be negative by rounding.
    #[getter]
    fn lower(&self) -> f64 {
        self.found.lower
    }

    /// Upper bound of the volume.
    #[getter]
    fn upper(&self) -> f64 {
        self.found.upper
    }

    /// The centre of mass of the common part in the world, shape (3,); None unless the volume is
    /// certainly positive.
    #[getter]
    fn centroid<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let centroid = self.found.centroid?;
        Some(triple(py, (self.pose.poses().0 * centroid).coords.into()))
    }

    /// Bound of the error of each coordinate of the centroid; 0 without a centroid.
    #[getter]
    fn centroid_error(&self) -> f64 {
        self.found.centroid_error
    }

    /// Whether a body was found to cover points twice, or to face inward: the volume counts each
    /// point by both winding numbers then.
    #[getter]
    fn covers_itself(&self) -> bool {
        self.found.covers_itself
    }

    /// The curves in which the surfaces cross: closed polylines in the world, each of shape (N, 3).
    /// They are computed on access, and do not depend continuously on the poses.
    #[getter]
    fn loops<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
        let [a, b] = self.bodies.each_ref().map(|body| &body.get().0);
        let found = py.detach(|| Tracker::new().overlap_loops(a, b, &self.pose));
        let place = |p: &Point3<f64>| (self.pose.poses().0 * p).coords.as_slice().to_vec();
        let loops = found.map_err(pair_error)?.loops;
        let array = |points: &Vec<Point3<f64>>| {
            let rows: Vec<Vec<f64>> = points.iter().map(place).collect();
            Ok(PyArray2::from_vec2(py, &rows)?)
        };
        loops.iter().map(array).collect()
    }

    fn __repr__(&self) -> String {
        format!(
            "<OverlapVolume in [{:.15e}, {:.15e}]>",
            self.found.lower, self.found.upper
        )
    }
}

#[pymethods]
impl PairTracker {
    /// Returns bounds of the volume that two solids share, its centre of mass, and the curves in which
    /// their surfaces cross.
    ///
    /// The solids are polyhedra, closed meshes, and unions of polyhedra that do not overlap each other.
    /// The bounds hold for all ties: equal bodies, flush faces, edges on edges. Bodies that share no
    /// volume may still touch: ask `intersects`.
    ///
    /// Raises PairError for other geometries. It names the body and the reason; an open mesh is closed by
    /// `Geometry.repaired_mesh`.
    #[pyo3(signature = (a, b, pose_a=None, pose_b=None))]
    fn overlap(
        &mut self,
        py: Python<'_>,
        a: &Bound<'_, Geometry>,
        b: &Bound<'_, Geometry>,
        pose_a: Option<Pose>,
        pose_b: Option<Pose>,
    ) -> PyResult<OverlapVolume> {
        let pose = relative(pose_a, pose_b)?;
        let (x, y) = (&a.get().0, &b.get().0);
        let found = py.detach(|| self.tracker.overlap(x, y, &pose));
        Ok(OverlapVolume {
            found: found.map_err(pair_error)?,
            bodies: [a, b].map(|body| body.clone().unbind()),
            pose,
        })
    }
}
