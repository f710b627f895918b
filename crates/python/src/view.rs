//! Pictures, which the Python module `lin_canny._show` makes.

use pyo3::call::PyCallArgs;
use pyo3::prelude::*;

/// Calls a function of the module.
pub(crate) fn call<'py>(
    py: Python<'py>,
    function: &str,
    arguments: impl PyCallArgs<'py>,
) -> PyResult<Bound<'py, PyAny>> {
    py.import("lin_canny._show")?.call_method1(function, arguments)
}
