//! A point that moves little from query to query.

use lin_canny::nalgebra::Point3;
use lin_canny::{PointOutcome, PointQuery, PointTracker as Tracker};
use numpy::PyArray1;
use pyo3::prelude::*;

use super::POINT;
use crate::array::{triple, vector};
use crate::errors::refused;
use crate::geometry::Geometry;
use crate::pickle::{Pickled, pickled};

/// The closest point of a geometry to a point, with proven bounds of the signed distance.
///
/// Points and directions are in the frame of the geometry.
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct ClosestPoint(PointOutcome);

#[pymethods]
impl ClosestPoint {
    /// The signed distance: negative inside.
    #[getter]
    fn distance(&self) -> f64 {
        self.0.distance
    }

    /// Lower bound of the signed distance.
    #[getter]
    fn lower(&self) -> f64 {
        self.0.lower
    }

    /// Upper bound of the signed distance.
    #[getter]
    fn upper(&self) -> f64 {
        self.0.upper
    }

    /// The proven side: "separated" (outside), "touching" (on the surface), "overlapping" (inside)
    /// or "undecided".
    #[getter]
    fn state(&self) -> &'static str {
        self.0.state.name()
    }

    /// The point of the surface that is closest, shape (3,).
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        triple(py, self.0.point.coords.into())
    }

    /// The unit vector in which the signed distance grows, shape (3,).
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        triple(py, (*self.0.normal).into())
    }

    /// The index of the triangle, piece, element or patch that is closest; 0 for a convex geometry.
    #[getter]
    fn part(&self) -> u32 {
        self.0.location.subshape
    }

    /// The feature that is closest, such as "v3": vertex 3.
    #[getter]
    fn feature(&self) -> String {
        self.0.location.feature.to_string()
    }

    fn __repr__(&self) -> String {
        let PointOutcome {
            distance, lower, upper, ..
        } = self.0;
        format!(
            "<ClosestPoint {}: {distance:.6} in [{lower:.15}, {upper:.15}]>",
            self.state()
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py>> {
        pickled::<Self>(py, postcard::to_stdvec(&self.0))
    }

    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        postcard::from_bytes(bytes).map(Self).map_err(refused)
    }
}

/// Queries of a point that moves little, which begin at the last closest triangle.
///
/// What is kept changes the time of a query, never the answer: that of `signed_distance` and
/// `closest_points`. For many points at once, pass an array to those. A tracker is used by one
/// thread at a time.
#[pyclass(module = "lin_canny")]
pub(crate) struct PointTracker(Tracker);

#[pymethods]
impl PointTracker {
    #[new]
    fn new() -> Self {
        Self(Tracker::new())
    }

    /// Returns the closest point of the surface, with bounds of the signed distance.
    ///
    /// point: shape (3,), in the frame of the geometry.
    fn closest_point(&mut self, geometry: &Bound<'_, Geometry>, point: &Bound<'_, PyAny>) -> PyResult<ClosestPoint> {
        let point = Point3::from(vector(point, POINT)?);
        let query = PointQuery::new(&geometry.get().0);
        let found = self.0.closest_point(&query, &point);
        found.map(ClosestPoint).map_err(refused)
    }

    fn __repr__(&self) -> &'static str {
        "<PointTracker>"
    }

    /// A tracker that was pickled starts again.
    fn __reduce__<'py>(&self, py: Python<'py>) -> (Bound<'py, PyAny>, ()) {
        (py.get_type::<Self>().into_any(), ())
    }
}
