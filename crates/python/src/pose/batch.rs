//! Many poses as an argument.

use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::PoseView;
use super::argument::matrix_of;
use crate::array::{Argument, contiguous, refuse_mask, shape_text};
use crate::errors::pose_error;

const POSES: Argument = Argument {
    name: "poses",
    error: |why| pose_error(why),
};

/// The poses of a batch as an argument: an array of shape (N, 4, 4) or (N, 7), a tuple of positions
/// (N, 3) and quaternions xyzw (N, 4), or an object with a method `as_matrix`.
pub(crate) struct Poses<'py>(PyReadonlyArrayDyn<'py, f64>);

impl<'py> Poses<'py> {
    pub(crate) fn new(obj: &Bound<'py, PyAny>) -> PyResult<Self> {
        let array = match obj.cast::<PyTuple>() {
            Ok(pair) if pair.len() == 2 => joined(pair)?,
            _ => contiguous::<f64>(&matrix_of(obj)?, POSES)?,
        };
        match array.shape() {
            [_, 4, 4] | [_, 7] => Ok(Self(array)),
            shape => Err(pose_error(format!(
                "poses: shape is {} (expected (N, 4, 4), or (N, 7) with position and quaternion xyzw)",
                shape_text(shape)
            ))),
        }
    }

    pub(crate) fn view(&self) -> PyResult<PoseView<'_>> {
        let numbers = self.0.as_slice()?;
        Ok(match self.0.shape().len() {
            3 => PoseView::Matrices(numbers.as_chunks().0),
            _ => PoseView::Sevens(numbers.as_chunks().0),
        })
    }
}

/// Returns positions and rotations side by side.
fn joined<'py>(pair: &Bound<'py, PyTuple>) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    let turns = pair.get_item(1)?;
    let turns = match turns.getattr_opt("as_quat")? {
        Some(method) => method.call0()?,
        None => turns,
    };
    // `hstack` drops masks.
    refuse_mask(pair, POSES)?;
    let both = pair
        .py()
        .import("numpy")?
        .call_method1("hstack", ((pair.get_item(0)?, turns),));
    contiguous::<f64>(&both.map_err(|e| pose_error(format!("poses: {e}")))?, POSES)
}
