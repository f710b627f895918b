//! Rays.

use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::{Ray, RayCast as Found, RayCaster as Caster, RayHit};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::array::{Argument, triple, vector};
use crate::errors::{motion_error, no_condition};
use crate::geometry::Geometry;
use crate::pose::Pose;

const ORIGIN: Argument = Argument {
    name: "the origin of a ray",
    error: |why| motion_error(why),
};
const DIRECTION: Argument = Argument {
    name: "the direction of a ray",
    ..ORIGIN
};

/// The first point of a ray in a geometry: a bracket of its distance, or a proven miss.
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct RayCast(Found);

impl RayCast {
    fn entry(&self) -> Option<&RayHit> {
        match &self.0 {
            Found::Hit(hit) => Some(hit),
            _ => None,
        }
    }
}

#[pymethods]
impl RayCast {
    /// Raises TypeError: the answer has more than two values.
    fn __bool__(&self) -> PyResult<bool> {
        Err(no_condition("RayCast", "state"))
    }

    /// "hit", "miss" (proven for the whole length), "inside" (the origin is in the geometry) or
    /// "undecided" (rounding hides whether they meet).
    #[getter]
    fn state(&self) -> &'static str {
        match self.0 {
            Found::Hit(_) => "hit",
            Found::Miss => "miss",
            Found::Inside => "inside",
            _ => "undecided",
        }
    }

    /// The distance up to which all points of the ray are outside; None for a miss.
    #[getter]
    fn safe(&self) -> Option<f64> {
        self.0.safe()
    }

    /// A distance up to which a point of the ray is in the geometry; None unless there is a hit.
    #[getter]
    fn hit(&self) -> Option<f64> {
        self.entry().map(|hit| hit.hit)
    }

    /// The point where the ray enters, in the world, shape (3,); None unless there is a hit.
    #[getter]
    fn point<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.entry().map(|hit| triple(py, hit.point.coords.into()))
    }

    /// The outward normal at the point, in the world, shape (3,); None unless there is a hit.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.entry().map(|hit| triple(py, hit.normal.into_inner().into()))
    }

    /// The piece, triangle or point of a cloud that the ray enters; None unless there is a hit.
    #[getter]
    fn part(&self) -> Option<u32> {
        self.entry().map(|hit| hit.subshape)
    }

    fn __repr__(&self) -> String {
        match &self.0 {
            Found::Hit(hit) => format!("<RayCast hit between {:.9} and {:.9}>", hit.safe, hit.hit),
            _ => format!("<RayCast {}>", self.state()),
        }
    }
}

/// Casts rays at geometries, and begins with the state of the last ray.
///
/// One caster for each geometry makes neighbouring rays cheap; it is used by one thread at a time.
#[pyclass(module = "lin_canny")]
pub(crate) struct RayCaster(Caster);

#[pymethods]
impl RayCaster {
    #[new]
    fn new() -> Self {
        Self(Caster::new())
    }

    /// Returns where a ray enters a geometry.
    ///
    /// A ray that meets a Bézier surface is undecided.
    ///
    /// Parameters
    /// ----------
    /// geometry : Geometry
    /// origin, direction : array_like, shape (3,)
    ///     In the world; the direction may have any length except zero.
    /// length : float
    ///     The length of the ray; infinite by default.
    /// pose : pose, optional
    ///     Of the geometry in the world.
    ///
    /// Raises
    /// ------
    /// MotionError
    ///     If the direction has no length, or the length is negative.
    #[pyo3(signature = (geometry, origin, direction, length=f64::INFINITY, pose=None))]
    fn cast(
        &mut self,
        geometry: &Bound<'_, Geometry>,
        origin: &Bound<'_, PyAny>,
        direction: &Bound<'_, PyAny>,
        length: f64,
        pose: Option<Pose>,
    ) -> PyResult<RayCast> {
        let origin = Point3::from(vector(origin, ORIGIN)?);
        let ray = Ray::new(origin, vector(direction, DIRECTION)?).map_err(motion_error)?;
        let pose = pose.map_or_else(Isometry3::identity, |pose| pose.0);
        let found = self.0.cast(&geometry.get().0, &pose, &ray, length);
        found.map(RayCast).map_err(motion_error)
    }

    fn __repr__(&self) -> &'static str {
        "<RayCaster>"
    }

    /// A caster that was pickled starts again.
    fn __reduce__<'py>(&self, py: Python<'py>) -> (Bound<'py, PyAny>, ()) {
        (py.get_type::<Self>().into_any(), ())
    }
}
