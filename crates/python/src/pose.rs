//! Poses from Python: arrays of shape (4, 4) or (7,), (position, quaternion xyzw), objects that
//! have such a form, `None` for the identity.

mod argument;
mod rigid;

pub(crate) use argument::{Pose, relative};
pub(crate) use batch::Poses;
pub(crate) use rigid::PoseView;

mod batch;

use lin_canny::nalgebra::Isometry3;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

/// Returns a pose as an array of shape (4, 4).
pub(crate) fn matrix_of_pose<'py>(py: Python<'py>, pose: &Isometry3<f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let matrix = pose.to_homogeneous();
    PyArray1::from_slice(py, matrix.transpose().as_slice()).reshape([4, 4])
}
