//! Exceptions: subclasses of `ValueError` with the messages of the library.

use pyo3::prelude::*;
use pyo3::{create_exception, exceptions::PyTypeError, exceptions::PyValueError};

create_exception!(
    lin_canny,
    LinCannyError,
    PyValueError,
    "Base class of the exceptions of this package: an input is invalid."
);
create_exception!(
    lin_canny,
    GeometryError,
    LinCannyError,
    "Points or parameters from which no geometry can be built."
);
create_exception!(lin_canny, PoseError, LinCannyError, "A pose is not a rigid motion.");
create_exception!(
    lin_canny,
    PairError,
    LinCannyError,
    "A query that is not available for these kinds of geometry."
);
create_exception!(
    lin_canny,
    UndecidedError,
    LinCannyError,
    "A predicate that is undecided because of rounding or a budget."
);
create_exception!(
    lin_canny,
    MotionError,
    LinCannyError,
    "A velocity, an interval or a tolerance that is out of range."
);
create_exception!(lin_canny, SceneError, LinCannyError, "An invalid call of a scene.");
create_exception!(
    lin_canny,
    FileError,
    LinCannyError,
    "An invalid file: the message names the file, the line and the element."
);
create_exception!(
    lin_canny,
    PlanError,
    LinCannyError,
    "A configuration, an option or a name that is invalid for a checker."
);

/// Returns the error of an answer of more than two values that is used as a condition: without it,
/// every object of Python is true, also one that says no.
#[cold]
pub(crate) fn no_condition(answer: &str, member: &str) -> PyErr {
    PyTypeError::new_err(format!(
        "a {answer} is neither true nor false (expected its `{member}`)"
    ))
}

macro_rules! conversions {
    ($($function:ident => $exception:ident),* $(,)?) => {
        /// Adds the exceptions to the module.
        pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
            $(module.add(stringify!($exception), module.py().get_type::<$exception>())?;)*
            Ok(())
        }

        $(
        #[doc = concat!("Returns a [`", stringify!($exception), "`] with the message of an error.")]
        #[cold]
        pub(crate) fn $function(error: impl std::fmt::Display) -> PyErr {
            $exception::new_err(error.to_string())
        }
        )*
    };
}

conversions! {
    geometry_error => GeometryError,
    pose_error => PoseError,
    pair_error => PairError,
    undecided_error => UndecidedError,
    motion_error => MotionError,
    scene_error => SceneError,
    file_error => FileError,
    plan_error => PlanError,
    refused => LinCannyError,
}
