//! Times of impact.

use lin_canny::Velocity;
use lin_canny::impact::{self, Impact, Tolerance, cast_within};
use lin_canny::motion::{Motion, Steady};
use lin_canny::nalgebra::Isometry3;
use lin_canny::separation::Measurement;
use numpy::PyArray1;
use pyo3::prelude::*;

use super::PairTracker;
use crate::array::{Argument, triple, vector};
use crate::errors::motion_error;
use crate::geometry::Geometry;
use crate::pose::Pose;

const VELOCITY: Argument = Argument {
    name: "a velocity",
    error: |why| motion_error(why),
};

/// The first contact of two moving geometries: a bracket of the time, or a proven miss.
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct Cast {
    cast: impact::Cast,
    /// Poses of both bodies at the time of the measurement.
    poses: [Isometry3<f64>; 2],
}

impl Cast {
    fn measure(&self) -> Option<&Measurement> {
        match &self.cast.impact {
            Impact::AtStart { seen } | Impact::Hit { seen, .. } => Some(seen),
            _ => None,
        }
    }
}

#[pymethods]
impl Cast {
    /// "hit", "miss" (proven for the whole interval), "start" (in contact, or within the distance,
    /// at time 0), "undecided" (within rounding error of contact) or "incomplete" (a limit was reached).
    #[getter]
    fn state(&self) -> &'static str {
        match self.cast.impact {
            Impact::AtStart { .. } => "start",
            Impact::Hit { .. } => "hit",
            Impact::Undecided { .. } => "undecided",
            Impact::Miss => "miss",
            _ => "incomplete",
        }
    }

    /// The time up to which the geometries are proven apart; None for a miss.
    #[getter]
    fn safe(&self) -> Option<f64> {
        match self.cast.impact {
            Impact::AtStart { .. } => Some(0.0),
            Impact::Hit { safe, .. } | Impact::Undecided { safe, .. } | Impact::Incomplete { safe } => Some(safe),
            _ => None,
        }
    }

    /// A time at which the geometries are proven to be in contact; None unless there is a hit.
    #[getter]
    fn hit(&self) -> Option<f64> {
        match self.cast.impact {
            Impact::Hit { hit, .. } => Some(hit),
            _ => None,
        }
    }

    /// The witness on A at the time `safe`, in the world, shape (3,); None without a contact.
    #[getter]
    fn point_a<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let seen = self.measure()?;
        Some(triple(py, (self.poses[0] * seen.point_on_a).coords.into()))
    }

    /// The witness on B at the time `safe`, in the world, shape (3,); None without a contact.
    #[getter]
    fn point_b<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let seen = self.measure()?;
        Some(triple(py, (self.poses[1] * seen.point_on_b).coords.into()))
    }

    /// The unit vector from A to B at the time `safe`, in the world, shape (3,); None without a
    /// contact.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let seen = self.measure()?;
        Some(triple(py, (self.poses[0].rotation * *seen.normal).into()))
    }

    /// The number of distance queries.
    #[getter]
    fn queries(&self) -> u32 {
        self.cast.queries
    }

    fn __repr__(&self) -> String {
        let time = match self.cast.impact {
            Impact::Hit { safe, hit, .. } => format!(" between {safe:.9} and {hit:.9}"),
            Impact::Undecided { safe, .. } | Impact::Incomplete { safe } => format!(", apart until {safe:.9}"),
            _ => String::new(),
        };
        format!("<Cast {}{time}>", self.state())
    }
}

/// Returns the motion of a body at a constant velocity.
fn motion(pose: Option<Pose>, velocity: Option<(Bound<'_, PyAny>, Bound<'_, PyAny>)>) -> PyResult<Steady> {
    let pose = pose.map_or_else(Isometry3::identity, |pose| pose.0);
    let velocity = match velocity {
        Some((linear, angular)) => Velocity::new(vector(&linear, VELOCITY)?, vector(&angular, VELOCITY)?),
        None => Velocity::default(),
    };
    Steady::new(&pose, velocity).map_err(motion_error)
}

#[pymethods]
impl PairTracker {
    /// Returns when two moving geometries first touch or come within `distance`.
    ///
    /// The cast covers the times from 0 to `duration`.
    ///
    /// velocity_a, velocity_b: tuples (linear, angular), each of three numbers in the world, about
    /// the origin of the geometry, in lengths per time and radians per time; None is at rest.
    /// tolerance: the geometries are closer than this at `safe`, a length.
    #[pyo3(signature = (
        a, b, pose_a=None, pose_b=None, *, velocity_a=None, velocity_b=None, duration, tolerance, distance=0.0
    ))]
    #[allow(clippy::too_many_arguments)] // the signature in Python
    fn cast<'py>(
        &mut self,
        py: Python<'py>,
        a: &Bound<'py, Geometry>,
        b: &Bound<'py, Geometry>,
        pose_a: Option<Pose>,
        pose_b: Option<Pose>,
        velocity_a: Option<(Bound<'py, PyAny>, Bound<'py, PyAny>)>,
        velocity_b: Option<(Bound<'py, PyAny>, Bound<'py, PyAny>)>,
        duration: f64,
        tolerance: f64,
        distance: f64,
    ) -> PyResult<Cast> {
        let motions = [motion(pose_a, velocity_a)?, motion(pose_b, velocity_b)?];
        let (a, b) = (&a.get().0, &b.get().0);
        let tolerance = Tolerance::Distance(tolerance);
        let cast = py.detach(|| {
            let mut pair = self.tracker.pair(a, b);
            cast_within(&mut pair, &motions[0], &motions[1], 0.0..duration, tolerance, distance)
        });
        let cast = cast.map_err(motion_error)?;
        let time = match cast.impact {
            Impact::Hit { safe, .. } => safe,
            _ => 0.0,
        };
        let poses = [motions[0].pose(time), motions[1].pose(time)];
        Ok(Cast { cast, poses })
    }
}
