//! Times of impact.

use lin_canny::Velocity;
use lin_canny::impact::{self, CastOptions, Impact, Tolerance};
use lin_canny::motion::{Motion, Steady};
use lin_canny::nalgebra::Isometry3;
use lin_canny::separation::Measurement;
use numpy::PyArray1;
use pyo3::prelude::*;

use super::PairTracker;
use crate::array::{Argument, triple, vector};
use crate::errors::{motion_error, no_condition};
use crate::geometry::Geometry;
use crate::pose::Pose;

const VELOCITY: Argument = Argument {
    name: "a velocity",
    error: |why| motion_error(why),
};

/// A contact at the start of a motion that was accepted: the bodies leave it or slide along it.
#[pyclass(frozen, module = "lin_canny")]
#[derive(Clone)]
pub(crate) struct StartContact {
    contact: impact::StartContact,
    pair: Option<(String, String)>,
}

impl StartContact {
    pub(crate) fn new(contact: impact::StartContact, pair: Option<(String, String)>) -> Self {
        Self { contact, pair }
    }
}

#[pymethods]
impl StartContact {
    /// The names of both bodies; None for a cast of two geometries.
    #[getter]
    fn pair(&self) -> Option<(String, String)> {
        self.pair.clone()
    }

    /// Lower bound of the signed distance at the start.
    #[getter]
    fn distance(&self) -> f64 {
        self.contact.distance
    }

    /// The signed distance that the bodies are proven to keep until `until`: `distance` less 2^-30
    /// of the pair size.
    #[getter]
    fn kept(&self) -> f64 {
        self.contact.kept
    }

    /// The time at which the bodies have left the margin; None if they slide along each other to
    /// the end.
    #[getter]
    fn until(&self) -> Option<f64> {
        self.contact.until
    }

    fn __repr__(&self) -> String {
        let pair = self.pair.as_ref();
        let pair = pair.map_or(String::new(), |(a, b)| format!(" {a:?} - {b:?}"));
        let end = self.contact.until;
        let end = end.map_or("to the end".to_owned(), |time| format!("until {time:.6}"));
        format!("<StartContact{pair}: {:.6} apart, {end}>", self.contact.distance)
    }
}

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
    /// Raises TypeError: the answer has more than two values.
    fn __bool__(&self) -> PyResult<bool> {
        Err(no_condition("Cast", "state"))
    }

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

    /// The contact at the start that the cast accepted; None without one.
    #[getter]
    fn start_contact(&self) -> Option<StartContact> {
        self.cast.start_contact.map(|contact| StartContact::new(contact, None))
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
pub(crate) fn motion(pose: Option<Pose>, velocity: Option<(Bound<'_, PyAny>, Bound<'_, PyAny>)>) -> PyResult<Steady> {
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
    /// start_contact_margin: a contact at the start within this distance, or of at most this depth,
    /// is accepted if the geometries are proven not to come closer until they have left it; see
    /// `Cast.start_contact`. None accepts no contact.
    #[pyo3(signature = (
        a, b, pose_a=None, pose_b=None, *, velocity_a=None, velocity_b=None, duration, tolerance, distance=0.0,
        start_contact_margin=None
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
        start_contact_margin: Option<f64>,
    ) -> PyResult<Cast> {
        let motions = [motion(pose_a, velocity_a)?, motion(pose_b, velocity_b)?];
        let (a, b) = (&a.get().0, &b.get().0);
        let mut options = CastOptions::default()
            .tolerance(Tolerance::Distance(tolerance))
            .distance(distance);
        options.start_contact_margin = start_contact_margin;
        let [from, to] = &motions;
        let cast = py.detach(|| {
            let bodies = [a.into(), b.into()];
            self.tracker
                .cast_from_contact(bodies, from, to, 0.0..duration, &options, None)
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
