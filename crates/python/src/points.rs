//! Points and one geometry: signed distances, sides, closest points, near subshapes, grids.

mod grid;
mod near;
mod tracker;

pub(crate) use grid::signed_distance_grid;
pub(crate) use near::{nearest_features, within};
pub(crate) use tracker::{ClosestPoint, PointTracker};

use lin_canny::nalgebra::Point3;
use lin_canny::{PointOutcome, PointQuery};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use crate::array::{Argument, points};
use crate::batch::{BLOCK, Batch, Run};
use crate::errors::{geometry_error, refused};
use crate::geometry::Geometry;

const POINTS: Argument = Argument {
    name: "points",
    error: refused,
};
const POINT: Argument = Argument {
    name: "point",
    ..POINTS
};

/// Largest number of points that are put in order at once, so that neighbours follow each other.
/// At 10 microseconds per point, it ends within a third of a second.
const MOST: usize = 1 << 15;

/// The outcome of a point as numbers: signed distance, its bounds, the closest point, the subshape,
/// and whether the geometry contains the point, or its winding number.
type Row = [f64; 8];

fn row(found: &PointOutcome) -> Row {
    let [x, y, z] = found.point.into();
    let subshape = f64::from(found.location.subshape);
    let is_in = f64::from(u8::from(found.is_contained()));
    [found.distance, found.lower, found.upper, x, y, z, subshape, is_in]
}

/// What is computed of a point.
#[derive(Clone, Copy, PartialEq)]
enum Asked {
    All,
    Side,
    Winding,
}

/// The winding number on the surface, which has none: the least of the array.
const ON_SURFACE: i32 = i32::MIN;

/// The points of a call, in the frame of the geometry.
struct Points<'a> {
    query: PointQuery<'a>,
    points: &'a [Point3<f64>],
    asked: Asked,
}

impl Batch for Points<'_> {
    type State = ();
    type Row = Row;
    const CLOCK_STRIDE: usize = MOST;

    fn block(&self, count: usize, threads: usize) -> usize {
        count.div_ceil(threads).clamp(BLOCK, MOST)
    }

    fn start(&self) -> PyResult<()> {
        Ok(())
    }

    fn answer(&self, (): &mut (), first: usize, rows: &mut [Row]) -> PyResult<()> {
        let points = &self.points[first..first + rows.len()];
        match self.asked {
            Asked::Side => {
                let held = self.query.contains_each(points).map_err(geometry_error)?;
                let held = held.into_iter().map(|is_in| f64::from(u8::from(is_in)));
                rows.iter_mut().zip(held).for_each(|(to, is_in)| to[7] = is_in);
            }
            Asked::Winding => {
                let found = self.query.winding_numbers(points).map_err(geometry_error)?;
                let found = found.into_iter().map(|w| f64::from(w.unwrap_or(ON_SURFACE)));
                rows.iter_mut().zip(found).for_each(|(to, winding)| to[7] = winding);
            }
            Asked::All => {
                let found = self.query.closest_points(points).map_err(geometry_error)?;
                rows.iter_mut().zip(&found).for_each(|(to, found)| *to = row(found));
            }
        }
        Ok(())
    }
}

fn rows(
    py: Python<'_>,
    geometry: &Bound<'_, Geometry>,
    given: &Bound<'_, PyAny>,
    threads: usize,
    progress: Option<&Bound<'_, PyAny>>,
    asked: Asked,
) -> PyResult<Vec<Row>> {
    let given = points(given, POINTS)?;
    let body = &geometry.get().0;
    // Checked first: the error names the index in the whole array.
    let is_bad = |p: &Point3<f64>| !p.iter().all(|x| x.abs() < 1e116);
    if let Some(index) = given.iter().position(is_bad) {
        let value: [f64; 3] = given[index].into();
        return Err(refused(format!(
            "points: point {index} is not finite or farther than 1e116: {value:?}"
        )));
    }
    let batch = Points {
        query: match asked {
            Asked::All => py.detach(|| PointQuery::new(body).prepared_for(given.len())),
            Asked::Side | Asked::Winding => PointQuery::new(body),
        },
        points: &given,
        asked,
    };
    let mut rows = vec![[0.0; 8]; given.len()];
    Run::new(py, rows.len(), threads, progress)?.rows(py, &batch, &mut rows)?;
    Ok(rows)
}

/// Returns the signed distances of points and a geometry: negative inside.
///
/// points: shape (N, 3), in the frame of the geometry. The result has the shape (N,). With
/// `bounds=True` it is a tuple (distance, lower, upper) of such arrays. The sign is exact for
/// polyhedra, closed meshes and half-spaces. The bits do not depend on the number of threads.
#[pyfunction]
#[pyo3(signature = (geometry, points, *, bounds=false, threads=1, progress=None))]
pub(crate) fn signed_distance<'py>(
    py: Python<'py>,
    geometry: &Bound<'py, Geometry>,
    points: &Bound<'py, PyAny>,
    bounds: bool,
    threads: usize,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let rows = rows(py, geometry, points, threads, progress, Asked::All)?;
    let column = |k: usize| PyArray1::from_iter(py, rows.iter().map(|row| row[k]));
    if bounds {
        return Ok((column(0), column(1), column(2)).into_pyobject(py)?.into_any());
    }
    Ok(column(0).into_any())
}

/// Returns for each point whether the geometry contains it; the surface counts.
///
/// points: shape (N, 3), in the frame of the geometry. The result is a bool array of shape (N,).
#[pyfunction]
#[pyo3(signature = (geometry, points, *, threads=1, progress=None))]
pub(crate) fn contains<'py>(
    py: Python<'py>,
    geometry: &Bound<'py, Geometry>,
    points: &Bound<'py, PyAny>,
    threads: usize,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray1<bool>>> {
    let rows = rows(py, geometry, points, threads, progress, Asked::Side)?;
    Ok(PyArray1::from_iter(py, rows.iter().map(|row| row[7] != 0.0)))
}

/// Returns how many times the surface of a polyhedron or a closed mesh winds around each point.
///
/// points: shape (N, 3), in the frame of the geometry. The result is an int32 array of shape (N,): 0
/// outside, 1 inside a solid, 2 where two components overlap, negative where one is inside out, and the
/// least int32 on the surface. The numbers are exact. A mesh with holes needs a repair first:
/// `Geometry.repaired_mesh`.
#[pyfunction]
#[pyo3(signature = (geometry, points, *, threads=1, progress=None))]
pub(crate) fn winding_number<'py>(
    py: Python<'py>,
    geometry: &Bound<'py, Geometry>,
    points: &Bound<'py, PyAny>,
    threads: usize,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray1<i32>>> {
    let rows = rows(py, geometry, points, threads, progress, Asked::Winding)?;
    Ok(PyArray1::from_iter(py, rows.iter().map(|row| row[7] as i32)))
}

/// The closest points, the signed distances and the subshapes.
type ClosestPoints<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<i64>>,
);

/// Returns the points of the surface closest to points, the signed distances, and the indices of the
/// triangles, pieces, elements or patches: shapes (N, 3), (N,) and (N,).
///
/// points: shape (N, 3), in the frame of the geometry.
#[pyfunction]
#[pyo3(signature = (geometry, points, *, threads=1, progress=None))]
pub(crate) fn closest_points<'py>(
    py: Python<'py>,
    geometry: &Bound<'py, Geometry>,
    points: &Bound<'py, PyAny>,
    threads: usize,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<ClosestPoints<'py>> {
    let rows = rows(py, geometry, points, threads, progress, Asked::All)?;
    let places = rows.iter().flat_map(|row| [row[3], row[4], row[5]]);
    let places = PyArray1::from_iter(py, places).reshape([rows.len(), 3])?;
    let distances = PyArray1::from_iter(py, rows.iter().map(|row| row[0]));
    // Indices are below 2^32, so exact as f64.
    let subshapes = PyArray1::from_iter(py, rows.iter().map(|row| row[6] as i64));
    Ok((places, distances, subshapes))
}
