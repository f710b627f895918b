//! The class `Cloud`: one convex geometry at many points.

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::{Cloud as Body, CloudElement, CloudError, Geometry as AnyBody};
use lin_canny_formats::Points;
use numpy::{PyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use super::Geometry;
use crate::array::{Argument, contiguous, numbers, of_triples, refuse_mask, rows, shape_text, vector};
use crate::errors::geometry_error;
use crate::pickle::{Pickled, pickled};

const POINTS: Argument = Argument {
    name: "points",
    error: |why| geometry_error(why),
};
const RADII: Argument = Argument {
    name: "radius",
    ..POINTS
};
const HALF_EXTENTS: Argument = Argument { name: "box", ..POINTS };
const CELLS: Argument = Argument {
    name: "cells",
    ..POINTS
};
const SIZE: Argument = Argument { name: "size", ..POINTS };
const OCCUPIED: Argument = Argument {
    name: "occupied",
    ..POINTS
};
const ORIGIN: Argument = Argument {
    name: "origin",
    ..POINTS
};

/// A cloud: the union of one convex geometry at many points, such as the points of a depth camera
/// or the occupied cells of a grid.
///
/// A cloud is a Geometry, and every query takes it. The elements are never rotated relative to the
/// frame of the points. In the answers, `Closest.parts` has the number of the point. Give exactly
/// one of radius, box and shape.
///
/// Parameters
/// ----------
/// points : array_like, shape (N, 3)
///     float32 arrays are stored as such, in 29 bytes per point with the tree; float64 takes 41.
/// radius : float or array_like of shape (N,), optional
///     Balls of one radius, or of a radius per point; zero for the point itself.
/// box : array_like, shape (3,), optional
///     Boxes with these half extents along the axes of the cloud.
/// shape : Geometry, optional
///     Any convex geometry.
///
/// Raises
/// ------
/// GeometryError
///     If a point or a radius is invalid: names its index.
#[pyclass(frozen, extends = Geometry, module = "lin_canny")]
pub(crate) struct Cloud;

/// Returns whether an object is an array of float32.
fn is_single(obj: &Bound<'_, PyAny>) -> bool {
    let name = obj.getattr("dtype").and_then(|dtype| dtype.getattr("name"));
    name.and_then(|name| name.extract::<String>())
        .is_ok_and(|name| name == "float32")
}

/// Returns points in the precision of the array.
fn points_of(obj: &Bound<'_, PyAny>) -> PyResult<Points> {
    if is_single(obj) {
        let array = contiguous::<f32>(obj, POINTS)?;
        return Ok(Points::F32(rows::<f32, 3>(&array, POINTS)?.to_vec()));
    }
    let array = contiguous::<f64>(obj, POINTS)?;
    Ok(Points::F64(rows::<f64, 3>(&array, POINTS)?.to_vec()))
}

fn element(
    radius: Option<&Bound<'_, PyAny>>,
    block: Option<&Bound<'_, PyAny>>,
    shape: Option<&Bound<'_, Geometry>>,
) -> PyResult<CloudElement> {
    match (radius, block, shape) {
        (Some(radius), None, None) => {
            let numpy = radius.py().import("numpy")?;
            let dimension: usize = numpy.call_method1("ndim", (radius,))?.extract()?;
            Ok(match dimension {
                0 => CloudElement::Ball(radius.extract()?),
                _ => CloudElement::Balls(numbers(radius, RADII)?),
            })
        }
        (None, Some(half), None) => Ok(CloudElement::Box(vector(half, HALF_EXTENTS)?)),
        (None, None, Some(shape)) => {
            let shape = &shape.get().0;
            let convex = shape.as_convex().ok_or_else(|| {
                geometry_error(format!("the shape is a {} (expected a convex geometry)", shape.kind()))
            })?;
            Ok(CloudElement::Shape(convex.into_owned()))
        }
        _ => Err(geometry_error("give exactly one of radius, box and shape")),
    }
}

/// Returns the sides of a cell: one number, or three.
fn sides(size: &Bound<'_, PyAny>) -> PyResult<Vector3<f64>> {
    match size.extract::<f64>() {
        Ok(side) => Ok(Vector3::repeat(side)),
        Err(_) => vector(size, SIZE),
    }
}

fn origin_of(origin: Option<&Bound<'_, PyAny>>) -> PyResult<Point3<f64>> {
    let origin = origin.map(|origin| vector(origin, ORIGIN)).transpose()?;
    Ok(origin.unwrap_or_default().into())
}

fn of_body<'py>(py: Python<'py>, body: Result<Body, CloudError>) -> PyResult<Bound<'py, Cloud>> {
    Bound::new(py, initializer(body)?)
}

fn initializer(body: Result<Body, CloudError>) -> PyResult<PyClassInitializer<Cloud>> {
    let geometry = Geometry(body.map_err(geometry_error)?.into());
    Ok(PyClassInitializer::from(geometry).add_subclass(Cloud))
}

#[pymethods]
impl Cloud {
    #[new]
    #[pyo3(signature = (points, *, radius=None, r#box=None, shape=None))]
    fn new(
        py: Python<'_>,
        points: &Bound<'_, PyAny>,
        radius: Option<&Bound<'_, PyAny>>,
        r#box: Option<&Bound<'_, PyAny>>,
        shape: Option<&Bound<'_, Geometry>>,
    ) -> PyResult<PyClassInitializer<Self>> {
        let (points, element) = (points_of(points)?, element(radius, r#box, shape)?);
        let body = py.detach(|| match points {
            Points::F32(points) => Body::from_f32(&points, element),
            Points::F64(points) => {
                let points: Vec<_> = points.into_iter().map(Point3::from).collect();
                Body::new(&points, element)
            }
        });
        initializer(body)
    }

    /// Returns the cloud of boxes of the occupied cells of a grid: voxels, of 19 bytes each.
    ///
    /// The points of this cloud have an order of their own: see `cells`.
    ///
    /// Parameters
    /// ----------
    /// cells : array_like of integers, shape (N, 3)
    ///     Indices from 0 to 65,535 along x, y and z.
    /// size : float or array_like of shape (3,)
    ///     The sides of a cell.
    /// origin : array_like, shape (3,), optional
    ///     The least corner of the cell (0, 0, 0); zero by default.
    #[staticmethod]
    #[pyo3(signature = (cells, *, size, origin=None))]
    fn from_cells<'py>(
        py: Python<'py>,
        cells: &Bound<'py, PyAny>,
        size: &Bound<'py, PyAny>,
        origin: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, Self>> {
        let array = contiguous::<i64>(cells, CELLS)?;
        let given = rows::<i64, 3>(&array, CELLS)?;
        let mut cells = Vec::with_capacity(given.len());
        for (k, cell) in given.iter().enumerate() {
            let mut indices = [0; 3];
            for (to, &index) in indices.iter_mut().zip(cell) {
                *to = u16::try_from(index).map_err(|_| {
                    geometry_error(format!(
                        "an index of cell {k} is out of range: {index} (expected 0..=65535)"
                    ))
                })?;
            }
            cells.push(indices);
        }
        let (size, origin) = (sides(size)?, origin_of(origin)?);
        of_body(py, py.detach(|| Body::from_cells(origin, size, &cells)))
    }

    /// Returns the cloud of boxes of a grid with a flag for each cell.
    ///
    /// Parameters
    /// ----------
    /// occupied : array_like of bool, shape (I, J, K)
    ///     Whether the cell (i, j, k) is occupied; axes are x, y and z.
    /// size, origin
    ///     As for `from_cells`.
    #[staticmethod]
    #[pyo3(signature = (occupied, *, size, origin=None))]
    fn from_mask<'py>(
        py: Python<'py>,
        occupied: &Bound<'py, PyAny>,
        size: &Bound<'py, PyAny>,
        origin: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, Self>> {
        refuse_mask(occupied, OCCUPIED)?;
        let numpy = py.import("numpy")?;
        let mask = numpy.call_method1("ascontiguousarray", (occupied,))?;
        let mask: numpy::PyReadonlyArrayDyn<'_, bool> = mask.extract().map_err(|_| {
            let dtype = mask.getattr("dtype").map(|d| d.to_string());
            geometry_error(format!(
                "occupied: dtype is {} (expected bool)",
                dtype.unwrap_or_default()
            ))
        })?;
        let &[i, j, k] = mask.shape() else {
            let shape = shape_text(mask.shape());
            return Err(geometry_error(format!(
                "occupied: shape is {shape} (expected (I, J, K))"
            )));
        };
        let (flags, size, origin) = (mask.as_slice()?.to_vec(), sides(size)?, origin_of(origin)?);
        of_body(py, py.detach(|| Body::from_mask(origin, size, [i, j, k], &flags)))
    }

    /// The points in the order of their numbers, float64 of shape (N, 3).
    #[getter]
    fn points<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points = body(slf)?.points();
        of_triples(slf.py(), points.into_iter().map(|p| p.coords.into()).collect())
    }

    /// The cells in the order of their numbers, uint16 of shape (N, 3); None unless the cloud is of
    /// `from_cells` or `from_mask`.
    #[getter]
    fn cells<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyArray2<u16>>>> {
        let body = body(slf)?;
        let cells: Option<Vec<[u16; 3]>> = (0..body.len()).map(|k| body.cell(k)).collect();
        cells.map(|cells| of_triples(slf.py(), cells)).transpose()
    }

    /// Bytes of the points and the tree.
    #[getter]
    fn memory_usage(slf: &Bound<'_, Self>) -> PyResult<usize> {
        Ok(body(slf)?.memory_usage())
    }

    /// The number of points.
    fn __len__(slf: &Bound<'_, Self>) -> PyResult<usize> {
        Ok(body(slf)?.len())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Pickled<'py>> {
        pickled::<Self>(slf.py(), postcard::to_stdvec(body(slf)?))
    }

    #[staticmethod]
    fn _from_bytes<'py>(py: Python<'py>, bytes: &[u8]) -> PyResult<Bound<'py, Self>> {
        let body: Body = postcard::from_bytes(bytes).map_err(geometry_error)?;
        of_body(py, Ok(body))
    }
}

fn body<'a>(cloud: &'a Bound<'_, Cloud>) -> PyResult<&'a Body> {
    match &cloud.as_super().get().0 {
        AnyBody::Cloud(body) => Ok(body),
        other => Err(geometry_error(format!("a {} is not a cloud", other.kind()))),
    }
}
