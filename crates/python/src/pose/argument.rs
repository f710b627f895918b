//! One pose as an argument.

use lin_canny::RelativePose;
use lin_canny::nalgebra::Isometry3;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use super::rigid;
use crate::array::{Argument, refuse_mask, shape_text};
use crate::errors::pose_error;

/// A pose as an argument.
pub(crate) struct Pose(pub(crate) Isometry3<f64>);

/// Returns the relative pose of two bodies; the identity for a pose left out.
#[inline]
pub(crate) fn relative(a: Option<Pose>, b: Option<Pose>) -> PyResult<RelativePose> {
    let [a, b] = [a, b].map(|pose| pose.map_or_else(Isometry3::identity, |pose| pose.0));
    RelativePose::new(&a, &b).map_err(pose_error)
}

impl<'a, 'py> FromPyObject<'a, 'py> for Pose {
    type Error = PyErr;

    fn extract(obj: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Some(pose) = of_array(obj) {
            return pose.map(Self);
        }
        if let Ok(pair) = obj.cast::<PyTuple>() {
            return of_pair(&pair).map(Self);
        }
        if obj.is_none() {
            return Ok(Self(Isometry3::identity()));
        }
        of_object(obj).map(Self)
    }
}

const POSE: Argument = Argument {
    name: "pose",
    error: |why| pose_error(why),
};

/// Returns the pose of a float64 array of shape (4, 4) or (7,), of any strides; `None` for other
/// objects.
fn of_array(obj: Borrowed<'_, '_, PyAny>) -> Option<PyResult<Isometry3<f64>>> {
    let Ok(array) = obj.cast::<PyArray2<f64>>() else {
        return of_flat_array(obj);
    };
    if array.shape() != [4, 4] {
        return Some(Err(wrong_shape(array.shape())));
    }
    if let Err(error) = refuse_mask(&obj, POSE) {
        return Some(Err(error));
    }
    let mut m = [0.0; 16];
    let view = array.try_readonly().ok()?;
    // A column-major array is contiguous as well: its slice would be the transpose.
    match view.as_slice() {
        Ok(rows) if array.is_c_contiguous() => m.copy_from_slice(rows),
        _ => m.iter_mut().zip(view.as_array()).for_each(|(to, from)| *to = *from),
    }
    Some(rigid::of_matrix(&m).ok_or_else(|| pose_error(rigid::fault_of_matrix(&m))))
}

fn of_flat_array(obj: Borrowed<'_, '_, PyAny>) -> Option<PyResult<Isometry3<f64>>> {
    let array = obj.cast::<PyArray1<f64>>().ok()?;
    if array.len() != 7 {
        return Some(Err(wrong_shape(array.shape())));
    }
    if let Err(error) = refuse_mask(&obj, POSE) {
        return Some(Err(error));
    }
    let mut v = [0.0; 7];
    let view = array.try_readonly().ok()?;
    v.iter_mut().zip(view.as_array()).for_each(|(to, from)| *to = *from);
    Some(seven(&v))
}

fn seven(v: &[f64; 7]) -> PyResult<Isometry3<f64>> {
    rigid::of_seven(v).ok_or_else(|| pose_error(rigid::fault_of_seven(v)))
}

#[cold]
fn wrong_shape(shape: &[usize]) -> PyErr {
    pose_error(format!(
        "shape of a pose is {} (expected (4, 4), or (7,) with position and quaternion xyzw)",
        shape_text(shape)
    ))
}

/// Returns the pose of a tuple of position and rotation: a quaternion xyzw, or an object with
/// `as_quat`, such as scipy's `Rotation`.
fn of_pair(pair: &Bound<'_, PyTuple>) -> PyResult<Isometry3<f64>> {
    if pair.len() != 2 {
        return Err(pose_error(format!(
            "pose tuple has {} items (expected position and quaternion xyzw)",
            pair.len()
        )));
    }
    let [x, y, z] = floats(&pair.get_item(0)?, "position")?;
    let turn = pair.get_item(1)?;
    let is_plain =
        turn.is_instance_of::<PyTuple>() || turn.is_instance_of::<PyList>() || turn.cast::<PyArray1<f64>>().is_ok();
    let method = if is_plain { None } else { turn.getattr_opt("as_quat")? };
    let turn = method.map_or(Ok(turn), |method| method.call0())?;
    let [qx, qy, qz, qw] = floats(&turn, "quaternion (x, y, z, w)")?;
    seven(&[x, y, z, qx, qy, qz, qw])
}

/// Returns N numbers of an array, a tuple or another sequence.
fn floats<const N: usize>(obj: &Bound<'_, PyAny>, what: &str) -> PyResult<[f64; N]> {
    let mut to = [0.0; N];
    if let Ok(array) = obj.cast::<PyArray1<f64>>()
        && array.len() == N
    {
        refuse_mask(obj, POSE)?;
        let view = array.try_readonly()?;
        to.iter_mut().zip(view.as_array()).for_each(|(to, from)| *to = *from);
        return Ok(to);
    }
    let wrong = |e: PyErr| pose_error(format!("invalid {what} (expected {N} numbers): {e}"));
    if let Ok(tuple) = obj.cast::<PyTuple>()
        && tuple.len() == N
    {
        for (to, item) in to.iter_mut().zip(tuple.iter_borrowed()) {
            *to = item.extract().map_err(wrong)?;
        }
        return Ok(to);
    }
    if let Ok(list) = obj.cast::<PyList>()
        && list.len() == N
    {
        for (to, item) in to.iter_mut().zip(list.iter()) {
            *to = item.extract().map_err(wrong)?;
        }
        return Ok(to);
    }
    let list: PyResult<Vec<f64>> = obj.try_iter().and_then(|items| items.map(|x| x?.extract()).collect());
    let list = list.map_err(wrong)?;
    list.try_into()
        .map_err(|v: Vec<f64>| pose_error(format!("{what} has {} numbers (expected {N})", v.len())))
}

/// Returns the matrix of an object: `homogeneous` of `pinocchio.SE3`, `as_matrix()` of scipy's
/// `RigidTransform`, `GetAsMatrix4()` of Drake; the object itself otherwise.
pub(super) fn matrix_of<'py>(obj: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    if let Some(matrix) = obj.getattr_opt("homogeneous")? {
        return Ok(matrix);
    }
    for name in ["as_matrix", "GetAsMatrix4"] {
        if let Some(method) = obj.getattr_opt(name)? {
            return method.call0();
        }
    }
    Ok(obj.clone())
}

fn of_object(obj: Borrowed<'_, '_, PyAny>) -> PyResult<Isometry3<f64>> {
    let py = obj.py();
    let refused = |e: &dyn std::fmt::Display| {
        pose_error(format!(
            "invalid pose: {e} (expected an array of shape (4, 4) or (7,), or (position, quaternion xyzw))"
        ))
    };
    let options = PyDict::new(py);
    options.set_item("dtype", "float64")?;
    let matrix = matrix_of(&obj)?;
    refuse_mask(&matrix, POSE)?;
    let array = py.import("numpy")?.call_method("asarray", (matrix,), Some(&options));
    let array = array.map_err(|e| refused(&e))?;
    match of_array(array.as_borrowed()) {
        Some(pose) => pose,
        None => Err(refused(&format!("type {}", obj.get_type().name()?))),
    }
}
