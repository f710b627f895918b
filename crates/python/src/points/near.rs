//! Subshapes near a point.

use lin_canny::nalgebra::Point3;
use lin_canny::{PointError, PointOutcome, PointQuery};
use pyo3::prelude::*;

use super::POINT;
use crate::array::{structured, vector};
use crate::errors::refused;
use crate::geometry::Geometry;

/// Returns subshapes as a structured array.
fn records<'py>(py: Python<'py>, found: Result<Vec<PointOutcome>, PointError>) -> PyResult<Bound<'py, PyAny>> {
    let row = |near: &PointOutcome| {
        let ([x, y, z], [nx, ny, nz]): ([f64; 3], [f64; 3]) = (near.point.into(), (*near.normal).into());
        // Indices are below 2^32, so exact as f64.
        let part = f64::from(near.location.subshape);
        [near.distance, near.lower, near.upper, part, x, y, z, nx, ny, nz]
    };
    let rows = found.map_err(refused)?.iter().map(row).collect();
    let [distance, lower, upper] = ["distance", "lower", "upper"].map(|name| (name, "f8", 1));
    let [point, normal] = ["point", "normal"].map(|name| (name, "f8", 3));
    structured(py, rows, &[distance, lower, upper, ("part", "i8", 1), point, normal])
}

/// Returns the `k` triangles, faces, pieces or elements of a geometry that are nearest to a point.
///
/// Any other geometry is one. The distance of a piece or element is signed; that of a triangle or
/// face is not: no point is inside.
///
/// Parameters
/// ----------
/// geometry : Geometry
/// point : array_like, shape (3,)
///     In the frame of the geometry.
/// k : int
///
/// Returns
/// -------
/// numpy.ndarray, shape (at most k,)
///     A structured array with the fields `distance`, `lower`, `upper`; `part`, the index of the
///     triangle, face, piece or element; `point`, the closest point, and `normal`, both of shape
///     (3,), in the frame of the geometry. In ascending order of `upper`, then of `part`.
#[pyfunction]
pub(crate) fn nearest_features<'py>(
    py: Python<'py>,
    geometry: &Bound<'py, Geometry>,
    point: &Bound<'py, PyAny>,
    k: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let point = Point3::from(vector(point, POINT)?);
    let body = &geometry.get().0;
    let found = py.detach(|| PointQuery::new(body).nearest_features(&point, k));
    records(py, found)
}

/// Returns all triangles, faces, pieces or elements of a geometry that may be at most `d` from a
/// point.
///
/// One is left out if its lower bound is above `d`, so ties count as within. The result is that of
/// `nearest_features`.
#[pyfunction]
pub(crate) fn within<'py>(
    py: Python<'py>,
    geometry: &Bound<'py, Geometry>,
    point: &Bound<'py, PyAny>,
    d: f64,
) -> PyResult<Bound<'py, PyAny>> {
    if d.is_nan() {
        return Err(refused("d is NaN (expected a length)"));
    }
    let point = Point3::from(vector(point, POINT)?);
    let body = &geometry.get().0;
    let found = py.detach(|| PointQuery::new(body).within(&point, d));
    records(py, found)
}
