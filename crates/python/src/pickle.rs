//! How objects are pickled: as the bytes of their contents.

use pyo3::PyTypeInfo;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors::refused;

/// What `__reduce__` returns: a function, and its arguments.
pub(crate) type Pickled<'py> = (Bound<'py, PyAny>, (Bound<'py, PyBytes>,));

/// Returns the call of `_from_bytes` of a class that makes an object again.
///
/// # Errors
/// Returns an error if the contents have no bytes.
pub(crate) fn pickled<T: PyTypeInfo>(py: Python<'_>, bytes: postcard::Result<Vec<u8>>) -> PyResult<Pickled<'_>> {
    let bytes = bytes.map_err(refused)?;
    let make = py.get_type::<T>().getattr("_from_bytes")?;
    Ok((make, (PyBytes::new(py, &bytes),)))
}
