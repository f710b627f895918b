//! Exceptions: subclasses of `ValueError` with the messages of the library.

use pyo3::prelude::*;
use pyo3::{create_exception, exceptions::PyValueError};

create_exception!(
    lin_canny,
    LinCannyError,
    PyValueError,
    "Input that the library refuses: the base class of its exceptions."
);
create_exception!(
    lin_canny,
    GeometryError,
    LinCannyError,
    "Points or parameters that make no geometry."
);
create_exception!(lin_canny, PoseError, LinCannyError, "A pose that is no rigid motion.");
create_exception!(
    lin_canny,
    PairError,
    LinCannyError,
    "A question that a pair of these kinds of geometry cannot answer."
);
create_exception!(
    lin_canny,
    UndecidedError,
    LinCannyError,
    "A predicate that rounding or a budget leaves open."
);
create_exception!(
    lin_canny,
    MotionError,
    LinCannyError,
    "A velocity, an interval or a tolerance that is out of range."
);
create_exception!(lin_canny, SceneError, LinCannyError, "A refused call of a scene.");
create_exception!(
    lin_canny,
    FileError,
    LinCannyError,
    "A refused file: the message names file, line and element."
);
create_exception!(
    lin_canny,
    PlanError,
    LinCannyError,
    "A configuration, an option or a name that a checker refuses."
);

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
