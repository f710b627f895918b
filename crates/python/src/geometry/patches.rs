//! Surfaces of curved patches.

use lin_canny::nalgebra::Point3;
use lin_canny::surface::{BezierPatch, BezierSurface, Nurbs, SurfaceError};
use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;

use super::Geometry;
use crate::array::{Argument, contiguous, shape_text};
use crate::errors::geometry_error;

const NET: Argument = Argument {
    name: "control points",
    error: |why| geometry_error(why),
};
const WEIGHTS: Argument = Argument { name: "weights", ..NET };
const KNOTS: Argument = Argument { name: "knots", ..NET };

/// A net of control points: rows, columns, and the points row by row.
struct Net {
    size: [usize; 2],
    points: Vec<Point3<f64>>,
}

fn net(obj: &Bound<'_, PyAny>) -> PyResult<Net> {
    let array = contiguous::<f64>(obj, NET)?;
    let &[rows, columns, 3] = array.shape() else {
        let shape = shape_text(array.shape());
        return Err(geometry_error(format!(
            "control points: shape is {shape} (expected (M, N, 3))"
        )));
    };
    let points = array.as_slice()?.as_chunks::<3>().0;
    Ok(Net {
        size: [rows, columns],
        points: points.iter().map(|p| Point3::from(*p)).collect(),
    })
}

fn numbers<'py>(obj: Option<&Bound<'py, PyAny>>, what: Argument) -> PyResult<Option<PyReadonlyArrayDyn<'py, f64>>> {
    obj.map(|obj| contiguous::<f64>(obj, what)).transpose()
}

fn patch(net: &Net, weights: Option<&[f64]>) -> Result<BezierPatch, SurfaceError> {
    let degrees = net.size.map(|n| n.saturating_sub(1));
    match weights {
        Some(weights) => BezierPatch::rational(degrees, &net.points, weights),
        None => BezierPatch::polynomial(degrees, &net.points),
    }
}

#[pymethods]
impl Geometry {
    /// Returns the surface of tensor-product Bézier patches, without an inside.
    ///
    /// nets: for each patch its control points, shape (p + 1, q + 1, 3) for the degrees p in u and
    /// q in v. weights: for each patch an array of shape (p + 1, q + 1); None if all are equal.
    #[staticmethod]
    #[pyo3(signature = (nets, weights=None))]
    fn surface(nets: Vec<Bound<'_, PyAny>>, weights: Option<Vec<Bound<'_, PyAny>>>) -> PyResult<Self> {
        let mut patches = Vec::with_capacity(nets.len());
        for (k, points) in nets.iter().enumerate() {
            let of_patch = weights.as_ref().and_then(|all| all.get(k));
            let weights = numbers(of_patch, WEIGHTS)?;
            let weights = weights.as_ref().map(|w| w.as_slice()).transpose()?;
            let patch = patch(&net(points)?, weights);
            patches.push(patch.map_err(|e| geometry_error(format!("patch {k}: {e}")))?);
        }
        Ok(Self(BezierSurface::new(patches).map_err(geometry_error)?.into()))
    }

    /// Returns the NURBS surface of the given degrees in u and v, without an inside.
    ///
    /// knots_u, knots_v: never decreasing. points: shape (M, N, 3), u along the first axis.
    /// weights: shape (M, N); None if all are equal.
    #[staticmethod]
    #[pyo3(signature = (degrees, knots_u, knots_v, points, weights=None))]
    fn nurbs(
        degrees: [usize; 2],
        knots_u: &Bound<'_, PyAny>,
        knots_v: &Bound<'_, PyAny>,
        points: &Bound<'_, PyAny>,
        weights: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let knots = [contiguous::<f64>(knots_u, KNOTS)?, contiguous::<f64>(knots_v, KNOTS)?];
        let (net, weights) = (net(points)?, numbers(weights, WEIGHTS)?);
        let nurbs = Nurbs {
            degrees,
            knots: [knots[0].as_slice()?, knots[1].as_slice()?],
            points: &net.points,
            weights: weights.as_ref().map(|w| w.as_slice()).transpose()?,
            trimming_curves: 0,
        };
        Ok(Self(BezierSurface::from_nurbs(&nurbs).map_err(geometry_error)?.into()))
    }
}
