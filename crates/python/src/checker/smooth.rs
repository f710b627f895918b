//! Smooth motions along paths.

use lin_canny_robot::plan::{PlanError, SmoothOptions, Smoother, nearest_name};
use lin_canny_robot::{Coordinate, Trajectory as Timed};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{Checker, named};
use crate::array::Argument;
use crate::errors::plan_error;
use crate::trajectory::Trajectory;
use crate::watch::Watch;

const VELOCITY: Argument = Argument {
    name: "velocity",
    error: |why| plan_error(why),
};
const ACCELERATION: Argument = Argument {
    name: "acceleration",
    ..VELOCITY
};

impl Checker {
    /// Returns a limit of each coordinate: as given, or that of the robot.
    fn motion_limits(
        &self,
        argument: Argument,
        given: Option<&Bound<'_, PyAny>>,
        of_robot: impl Fn(&Coordinate) -> Option<f64>,
    ) -> PyResult<Vec<f64>> {
        let (coordinates, what) = (self.coordinate_list(), argument.name);
        let mut limits: Vec<Option<f64>> = coordinates.iter().map(of_robot).collect();
        match given.map(|given| (given, given.cast::<PyDict>())) {
            None => {}
            Some((_, Ok(named))) => {
                for (name, value) in named {
                    let name: String = name.extract()?;
                    let Some(k) = coordinates.iter().position(|c| c.name == name) else {
                        let near = nearest_name(&name, coordinates.iter().map(|c| c.name.as_str()));
                        let near = near.map_or(String::new(), |near| format!(" (nearest: {near:?})"));
                        return Err(plan_error(format!("{what}: joint {name:?} does not exist{near}")));
                    };
                    limits[k] = Some(value.extract()?);
                }
            }
            Some((given, Err(_))) => limits = self.of_each(given, argument)?.into_iter().map(Some).collect(),
        }
        let named = limits.into_iter().zip(coordinates);
        let each = named.map(|(limit, c)| {
            limit.ok_or_else(|| {
                plan_error(format!(
                    "{what}: joint {:?} has no limit (expected one in {what}=)",
                    c.name
                ))
            })
        });
        each.collect()
    }

    fn smooth_fault(&self, error: &PlanError) -> PyErr {
        match *error {
            PlanError::Limit {
                what,
                coordinate,
                value,
            } => {
                let name = &self.coordinate_list()[coordinate].name;
                plan_error(format!(
                    "{what} limit of joint {name:?} is out of range: {value} (expected a positive number)"
                ))
            }
            PlanError::Unproven { segment } => plan_error(format!(
                "path: the segment from row {segment} is not proven free (see certify_path)"
            )),
            _ => plan_error(format!("path: {}", named(error, self.coordinate_list()))),
        }
    }
}

#[pymethods]
impl Checker {
    /// Returns a smooth motion along a path, from rest to rest, proven free and within limits.
    ///
    /// Corners are rounded; velocities are continuous, and accelerations by choice. A corner whose
    /// blend is not proven free gets a smaller one, or the motion stops there: see
    /// `Trajectory.stops`. Every piece is proven as it is returned. The motion is not the fastest
    /// one. Ctrl-C ends the call.
    ///
    /// Parameters
    /// ----------
    /// path : array_like, shape (K, dof)
    ///     Segments that are free, such as those of `plan`.
    /// velocity : float, array_like of shape (dof,), or dict, optional
    ///     Greatest absolute velocity: of all joints, of each, or by name. By default, and for
    ///     joints that a dict does not name, that of the file of the robot.
    /// acceleration : float, array_like of shape (dof,), or dict
    ///     Greatest absolute acceleration, likewise; files have none.
    /// continuous_acceleration : bool
    ///     Whether accelerations are continuous as well.
    /// deviation : float
    ///     Greatest distance of the motion from a corner of the path, in any coordinate. With 0 the
    ///     motion follows the path and stops at each corner.
    /// progress : callable or bool, optional
    ///     A callable that receives how many blends, then pieces, are done, and of all, or True for a
    ///     tqdm bar.
    ///
    /// Returns
    /// -------
    /// Trajectory
    ///     It starts at time 0. Angles do not jump by full turns.
    ///
    /// Raises
    /// ------
    /// PlanError
    ///     If a segment is not proven free (names its row), or if a joint has no limit or one that
    ///     is not positive (names the joint).
    #[pyo3(signature = (
        path, *, velocity=None, acceleration, continuous_acceleration=false, deviation=f64::INFINITY, progress=None
    ))]
    #[allow(clippy::too_many_arguments)] // the signature in Python
    fn smooth(
        &mut self,
        py: Python<'_>,
        path: &Bound<'_, PyAny>,
        velocity: Option<&Bound<'_, PyAny>>,
        acceleration: &Bound<'_, PyAny>,
        continuous_acceleration: bool,
        deviation: f64,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Trajectory> {
        let path = self.path(path)?;
        let velocity = self.motion_limits(VELOCITY, velocity, |c| c.velocity)?;
        let acceleration = self.motion_limits(ACCELERATION, Some(acceleration), |_| None)?;
        let options = SmoothOptions::new(velocity, acceleration)
            .continuous_acceleration(continuous_acceleration)
            .deviation(deviation);
        let mut watch = Watch::new(py, progress)?;
        let found = py.detach(|| {
            Smoother::new(&options)
                .progress(&mut |now| watch.look(now))
                .smooth(&mut self.checker, &path)
        });
        watch.finish(py, true)?;
        let mut found = found.map_err(|e| self.smooth_fault(&e))?;
        let names = self.coordinate_list().iter().map(|c| c.name.clone()).collect();
        let stops = core::mem::take(&mut found.stops);
        Ok(Trajectory::smooth(names, Timed::from(found), stops))
    }
}
