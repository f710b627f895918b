//! Queries of two geometries.

mod at_poses;
mod bodies;
pub(crate) mod cast;
mod closest;
mod contacts;
mod overlap;
mod pose_batch;

pub(crate) use at_poses::distances;
#[cfg(feature = "bench")]
pub(crate) use at_poses::rust_loop;
pub(crate) use cast::{Cast, StartContact};
pub(crate) use closest::Closest;
pub(crate) use contacts::Penetration;
pub(crate) use overlap::OverlapVolume;
pub(crate) use pose_batch::{closest_batch, contacts_batch, overlap_batch, penetration_batch};

use lin_canny::{Decision, PairTracker as Tracker, QueryOptions};
use pyo3::prelude::*;

use crate::errors::undecided_error;
use crate::geometry::Geometry;
use crate::pose::{Pose, relative};

/// Queries of two geometries, which begin at the closest features of the last query.
///
/// One tracker for each pair makes queries of a moving pair cheap; a tracker that was used with
/// another pair only costs time. What is kept changes the time of a query, never the answer beyond
/// the bounds. A tracker is used by one thread at a time.
///
/// Poses: an array of shape (4, 4); (position, quaternion xyzw) as a tuple, or as an array of shape
/// (7,); (position, scipy Rotation); `pinocchio.SE3`, scipy's `RigidTransform`; None is the
/// identity. Quaternions are x, y, z, w. Both poses are in one frame, the world, and so are the
/// points and normals of the answers.
#[pyclass(module = "lin_canny")]
pub(crate) struct PairTracker {
    pub(crate) tracker: Tracker,
}

/// Returns a decision as a bool.
fn decided(decision: Decision) -> PyResult<bool> {
    match decision {
        Decision::Yes => Ok(true),
        Decision::No => Ok(false),
        _ => Err(undecided_error(
            "rounding or the budget of the query leaves the answer open",
        )),
    }
}

#[pymethods]
impl PairTracker {
    #[new]
    fn new() -> Self {
        Self {
            tracker: Tracker::new(),
        }
    }

    /// Returns the closest points, with bounds of the signed distance: positive apart, negative by
    /// the penetration depth if two convex geometries overlap, zero if others do.
    #[pyo3(signature = (a, b, pose_a=None, pose_b=None))]
    fn closest(
        &mut self,
        a: &Bound<'_, Geometry>,
        b: &Bound<'_, Geometry>,
        pose_a: Option<Pose>,
        pose_b: Option<Pose>,
    ) -> PyResult<Closest> {
        let pose = relative(pose_a, pose_b)?;
        let answer = self.tracker.closest(&a.get().0, &b.get().0, &pose);
        Ok(Closest::new(answer, pose))
    }

    /// Returns the signed distance, as `closest` does.
    #[pyo3(signature = (a, b, pose_a=None, pose_b=None))]
    fn distance(
        &mut self,
        a: &Bound<'_, Geometry>,
        b: &Bound<'_, Geometry>,
        pose_a: Option<Pose>,
        pose_b: Option<Pose>,
    ) -> PyResult<f64> {
        let pose = relative(pose_a, pose_b)?;
        Ok(self.tracker.distance(&a.get().0, &b.get().0, &pose).value)
    }

    /// Returns whether the geometries share a point; touching counts. Exact for polyhedra, rounded
    /// or not. Raises UndecidedError if a Bézier surface leaves the answer open.
    #[pyo3(signature = (a, b, pose_a=None, pose_b=None))]
    fn intersects(
        &mut self,
        a: &Bound<'_, Geometry>,
        b: &Bound<'_, Geometry>,
        pose_a: Option<Pose>,
        pose_b: Option<Pose>,
    ) -> PyResult<bool> {
        self.within(a, b, 0.0, pose_a, pose_b)
    }

    /// Returns whether the geometries are at most `d` apart, `d` a length; no for a negative `d`.
    /// Exact for polyhedra, rounded or not. Raises UndecidedError if a Bézier surface leaves
    /// the answer open.
    #[pyo3(signature = (a, b, d, pose_a=None, pose_b=None))]
    fn within(
        &mut self,
        a: &Bound<'_, Geometry>,
        b: &Bound<'_, Geometry>,
        d: f64,
        pose_a: Option<Pose>,
        pose_b: Option<Pose>,
    ) -> PyResult<bool> {
        let pose = relative(pose_a, pose_b)?;
        decided(
            self.tracker
                .decide_within(&a.get().0, &b.get().0, &pose, d, &QueryOptions::default()),
        )
    }

    /// Returns the closest two triangles of a mesh that share no vertex, in the frame of the mesh;
    /// None if any two share one. `parts` are the triangles.
    fn self_closest(&mut self, mesh: &Bound<'_, Geometry>) -> PyResult<Option<Closest>> {
        let pose = relative(None, None)?;
        let found = self.tracker.self_closest(mesh.get().own_mesh()?);
        Ok(found.map(|answer| Closest::new(answer, pose)))
    }

    /// Returns whether two triangles of a mesh that share no vertex are at most `d` apart; for a
    /// `d` of zero, whether the mesh intersects itself. Exact.
    fn self_within(&mut self, mesh: &Bound<'_, Geometry>, d: f64) -> PyResult<bool> {
        Ok(self.tracker.self_within(mesh.get().own_mesh()?, d))
    }

    /// Returns all pairs of triangles of a mesh that share no vertex and are at most `d` apart,
    /// each once and in no order; `parts` are the triangles. Exact.
    fn self_pairs(&mut self, mesh: &Bound<'_, Geometry>, d: f64) -> PyResult<Vec<Closest>> {
        let pose = relative(None, None)?;
        let found = self.tracker.self_pairs(mesh.get().own_mesh()?, d);
        Ok(found.into_iter().map(|answer| Closest::new(answer, pose)).collect())
    }

    /// Returns a View of two geometries and their closest points. See `lin_canny.show`.
    #[pyo3(signature = (a, b, pose_a=None, pose_b=None))]
    fn show<'py>(
        this: &Bound<'py, Self>,
        a: &Bound<'py, Geometry>,
        b: &Bound<'py, Geometry>,
        pose_a: Option<Bound<'py, PyAny>>,
        pose_b: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let closest = this.call_method1("closest", (a, b, &pose_a, &pose_b))?;
        crate::view::call(this.py(), "pair", (a, b, pose_a, pose_b, closest))
    }

    fn __repr__(&self) -> &'static str {
        "<PairTracker>"
    }

    /// A tracker that was pickled starts again.
    fn __reduce__<'py>(&self, py: Python<'py>) -> (Bound<'py, PyAny>, ()) {
        (py.get_type::<Self>().into_any(), ())
    }
}
