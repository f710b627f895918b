//! The class `JointCurve`: polynomial curves of the coordinates of a robot.

use lin_canny_robot::plan::{JointCurve as Curve, PlanError};
use numpy::{PyArray1, PyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::array::{Argument, contiguous, is_number, numbers, of_table, shape_text, table};
use crate::errors::{plan_error, refused};
use crate::pickle::{Pickled, pickled};

const CONTROL_POINTS: Argument = Argument {
    name: "control points",
    error: |why| plan_error(why),
};
const COEFFICIENTS: Argument = Argument {
    name: "coefficients",
    ..CONTROL_POINTS
};
const ENDS: Argument = Argument {
    name: "ends",
    ..CONTROL_POINTS
};
const VELOCITIES: Argument = Argument {
    name: "velocities",
    ..CONTROL_POINTS
};
const ACCELERATIONS: Argument = Argument {
    name: "accelerations",
    ..CONTROL_POINTS
};
const KNOTS: Argument = Argument {
    name: "knots",
    ..CONTROL_POINTS
};
const TIME: Argument = Argument {
    name: "time",
    ..CONTROL_POINTS
};

/// A polynomial curve of all coordinates of a robot, over the times 0 to 1.
///
/// It is a Bézier curve of degree 1 to 16. At time 0 it is at its first control point, at time 1 at
/// its last. A straight segment is a curve of degree 1. A spline is a list of curves, each of which
/// starts where the one before it ends.
///
/// Curves in another form are converted. The rounding of the conversion is part of the curve, so
/// `Checker.certify_curve` proves the curve that was given. Every constructor raises PlanError for
/// shapes that do not fit, for numbers that are not finite, and for a degree above 16.
///
/// Examples
/// --------
/// >>> curve = lc.JointCurve.bezier([[0, 1], [0, 1], [1, 3], [1, 3]])  # from rest to rest
/// >>> curve.at(0.5)
/// array([0.5, 2. ])
#[pyclass(frozen, eq, module = "lin_canny")]
#[derive(PartialEq)]
pub(crate) struct JointCurve(pub(crate) Curve);

/// A curve as an argument: a curve, or its control points.
pub(crate) fn curve_of(obj: &Bound<'_, PyAny>) -> PyResult<Curve> {
    match obj.cast::<JointCurve>() {
        Ok(curve) => Ok(curve.get().0.clone()),
        Err(_) => Curve::bezier(&table(obj, CONTROL_POINTS)?).map_err(plan_error),
    }
}

/// The curves of a spline as an argument: curves, or their control points.
pub(crate) fn curves_of(obj: &Bound<'_, PyAny>) -> PyResult<Vec<Curve>> {
    if obj.is_instance_of::<JointCurve>() {
        return Err(refused("curves is one curve (expected a sequence of curves)"));
    }
    let each = obj.try_iter().map_err(|e| refused(format!("curves: {e}")))?;
    each.enumerate()
        .map(|(k, item)| curve_of(&item?).map_err(|error| numbered(obj.py(), k, error)))
        .collect()
}

/// Returns an error with the number of the curve that it is about.
fn numbered(py: Python<'_>, k: usize, error: PyErr) -> PyErr {
    plan_error(format!("curve {k}: {}", error.value(py)))
}

fn made(curve: Result<Curve, PlanError>) -> PyResult<JointCurve> {
    curve.map(JointCurve).map_err(plan_error)
}

/// Returns the rows of an array of shape (2, dof): those of the start and of the end.
fn two(obj: &Bound<'_, PyAny>, argument: Argument) -> PyResult<[Vec<f64>; 2]> {
    let rows = table(obj, argument)?;
    rows.try_into().map_err(|rows: Vec<_>| {
        let (name, count) = (argument.name, rows.len());
        plan_error(format!("{name}: number of rows is {count} (expected 2, start and end)"))
    })
}

impl JointCurve {
    /// Returns values at one time, shape (dof,), or at many, shape (N, dof).
    fn values<'py>(&self, time: &Bound<'py, PyAny>, of: fn(&Curve, f64) -> Vec<f64>) -> PyResult<Bound<'py, PyAny>> {
        let py = time.py();
        let array = contiguous::<f64>(time, TIME)?;
        let times = array.as_slice()?;
        if let Some(k) = times.iter().position(|t| !(0.0..=1.0).contains(t)) {
            return Err(plan_error(format!("time {k} is {} (expected 0 to 1)", times[k])));
        }
        // A single number becomes an array of shape (1,).
        match array.shape() {
            [1] if is_number(time)? => Ok(PyArray1::from_vec(py, of(&self.0, times[0])).into_any()),
            [_] => {
                let rows: Vec<_> = times.iter().map(|t| of(&self.0, *t)).collect();
                Ok(of_table(py, &rows, self.0.coordinates())?.into_any())
            }
            shape => Err(plan_error(format!(
                "time: shape is {} (expected a number or (N,))",
                shape_text(shape)
            ))),
        }
    }
}

#[pymethods]
impl JointCurve {
    /// Returns the Bézier curve of control points, shape (degree + 1, dof).
    #[staticmethod]
    fn bezier(points: &Bound<'_, PyAny>) -> PyResult<Self> {
        made(Curve::bezier(&table(points, CONTROL_POINTS)?))
    }

    /// Returns the curve `c[0] + c[1] t + c[2] t^2 + ...`, coefficients of shape (degree + 1, dof).
    #[staticmethod]
    fn power(coefficients: &Bound<'_, PyAny>) -> PyResult<Self> {
        made(Curve::power(&table(coefficients, COEFFICIENTS)?))
    }

    /// Returns the cubic curve with these configurations and velocities at its ends.
    ///
    /// ends, velocities: shape (2, dof), the start first. The curve takes `duration` for its times 0
    /// to 1; velocities are in its unit.
    #[staticmethod]
    #[pyo3(signature = (ends, velocities, duration=1.0))]
    fn cubic(ends: &Bound<'_, PyAny>, velocities: &Bound<'_, PyAny>, duration: f64) -> PyResult<Self> {
        let ([from, to], [v, w]) = (two(ends, ENDS)?, two(velocities, VELOCITIES)?);
        made(Curve::cubic(from, to, v, w, duration))
    }

    /// Returns the quintic curve with these configurations, velocities and accelerations at its
    /// ends.
    ///
    /// ends, velocities, accelerations: shape (2, dof), the start first. The curve takes `duration`
    /// for its times 0 to 1; velocities and accelerations are in its unit.
    #[staticmethod]
    #[pyo3(signature = (ends, velocities, accelerations, duration=1.0))]
    fn quintic(
        ends: &Bound<'_, PyAny>,
        velocities: &Bound<'_, PyAny>,
        accelerations: &Bound<'_, PyAny>,
        duration: f64,
    ) -> PyResult<Self> {
        let (ends, velocities) = (two(ends, ENDS)?, two(velocities, VELOCITIES)?);
        made(Curve::quintic(
            ends,
            velocities,
            two(accelerations, ACCELERATIONS)?,
            duration,
        ))
    }

    /// Returns the curves of a B-spline, one for each knot interval that is not empty.
    ///
    /// Each curve starts at the end of the one before, bit for bit. The times of a curve run from 0
    /// to 1, instead of its knot interval: see `b_spline_times`.
    ///
    /// points: control points, shape (K, dof). knots: shape (K + degree + 1,), in ascending order
    /// and with their multiplicities. Without knots the spline is uniform: the knots are 0, 1, 2, ...,
    /// so it starts and ends near its first and last control points, not at them.
    #[staticmethod]
    #[pyo3(signature = (points, degree, knots=None))]
    fn b_spline(points: &Bound<'_, PyAny>, degree: usize, knots: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<Self>> {
        let points = table(points, CONTROL_POINTS)?;
        let curves = match knots {
            Some(knots) => Curve::b_spline(&points, degree, &numbers(knots, KNOTS)?),
            None => Curve::uniform_b_spline(&points, degree),
        };
        Ok(curves.map_err(plan_error)?.into_iter().map(Self).collect())
    }

    /// Returns the times at which the curves of a B-spline of `points` control points start and
    /// end, shape (number of curves + 1,): its knots without repetitions.
    #[staticmethod]
    fn b_spline_times<'py>(
        py: Python<'py>,
        points: usize,
        degree: usize,
        knots: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let times = Curve::b_spline_times(points, degree, &numbers(knots, KNOTS)?);
        Ok(PyArray1::from_vec(py, times.map_err(plan_error)?))
    }

    /// The degree: the number of control points, less one.
    #[getter]
    fn degree(&self) -> usize {
        self.0.degree()
    }

    /// The number of coordinates.
    #[getter]
    fn dof(&self) -> usize {
        self.0.coordinates()
    }

    /// The control points, shape (degree + 1, dof).
    #[getter]
    fn control_points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points: Vec<_> = (0..=self.0.degree()).map(|k| self.0.control_point(k)).collect();
        of_table(py, &points, self.0.coordinates())
    }

    /// Returns the configuration at a time from 0 to 1, shape (dof,), or at many, shape (N, dof).
    fn at<'py>(&self, time: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.values(time, Curve::at)
    }

    /// Returns the first derivative at a time from 0 to 1, shape (dof,), or at many, shape (N, dof).
    fn velocity<'py>(&self, time: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.values(time, Curve::velocity)
    }

    /// Returns the second derivative at a time from 0 to 1, shape (dof,), or at many, shape (N,
    /// dof).
    fn acceleration<'py>(&self, time: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.values(time, Curve::acceleration)
    }

    /// Returns the same curve with times on a clock of its start and its end.
    ///
    /// They matter only among moving obstacles: see `Checker.add_moving_obstacle`. The times 0 to 1
    /// of the curve, and of verdicts about it, stay. Raises PlanError unless both are finite and the
    /// end is after the start.
    fn with_times(&self, start: f64, end: f64) -> PyResult<Self> {
        made(self.0.clone().with_times([start, end]))
    }

    /// The times on a clock of start and end, or None: see `with_times`.
    #[getter]
    fn times(&self) -> Option<(f64, f64)> {
        self.0.times().map(Into::into)
    }

    /// Returns the same curve, one degree higher.
    fn elevated(&self) -> PyResult<Self> {
        made(self.0.elevated())
    }

    fn __repr__(&self) -> String {
        format!(
            "<JointCurve of degree {}, {} coordinates>",
            self.0.degree(),
            self.0.coordinates()
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py>> {
        pickled::<Self>(py, postcard::to_stdvec(&self.0))
    }

    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        postcard::from_bytes(bytes).map(Self).map_err(plan_error)
    }
}
