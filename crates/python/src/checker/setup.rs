//! The arguments of a checker.

use std::path::PathBuf;

use lin_canny::nalgebra::Isometry3;
use lin_canny_robot::{CellFile, Setup};
use pyo3::Borrowed;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::{file_error, refused};
use crate::geometry::Geometry;
use crate::pose::Pose;
use crate::robot::Robot;

/// Name, geometry and pose of an obstacle.
pub(super) type Obstacle<'py> = (String, Bound<'py, Geometry>, Bound<'py, PyAny>);

/// A robot, or several by prefix.
pub(super) enum RobotArgument<'py> {
    One(Bound<'py, Robot>),
    Several(Bound<'py, PyDict>),
}

impl<'a, 'py> FromPyObject<'a, 'py> for RobotArgument<'py> {
    type Error = PyErr;

    fn extract(obj: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(robot) = obj.cast::<Robot>() {
            return Ok(Self::One(robot.to_owned()));
        }
        let several = obj.cast::<PyDict>().map_err(|_| {
            let kind = obj
                .get_type()
                .name()
                .map_or_else(|_| "object".into(), |kind| kind.to_string());
            PyTypeError::new_err(format!(
                "robot is a {kind} (expected a Robot, as Robot.load returns it, or a dict of robots by prefix)"
            ))
        })?;
        Ok(Self::Several(several.to_owned()))
    }
}

impl<'py> RobotArgument<'py> {
    /// Returns the argument as given.
    pub(super) fn object(&self) -> &Bound<'py, PyAny> {
        match self {
            Self::One(robot) => robot.as_any(),
            Self::Several(robots) => robots.as_any(),
        }
    }

    fn first(&self) -> PyResult<Bound<'py, Robot>> {
        match self {
            Self::One(robot) => Ok(robot.clone()),
            Self::Several(robots) => match robots.values().get_item(0) {
                Ok(item) => Ok(item.extract::<(Bound<'py, Robot>, Bound<'py, PyAny>)>()?.0),
                Err(_) => Err(refused("a checker needs a robot")),
            },
        }
    }
}

/// Returns a pose; the identity if left out.
fn pose_of(pose: Option<&Bound<'_, PyAny>>) -> PyResult<Isometry3<f64>> {
    pose.map_or(Ok(Isometry3::identity()), |pose| Ok(pose.extract::<Pose>()?.0))
}

/// Returns the setup of the robots, with the pairs of their SRDFs.
pub(super) fn of_robots(
    robots: &RobotArgument<'_>,
    pose: Option<Bound<'_, PyAny>>,
    exclude_adjacent: bool,
) -> PyResult<Setup> {
    let mut placed = Vec::new();
    match robots {
        RobotArgument::One(robot) => placed.push((String::new(), robot.clone(), pose_of(pose.as_ref())?)),
        RobotArgument::Several(_) if pose.is_some() => {
            return Err(refused(
                "pose is for a single robot; give several robots as a dict of (robot, pose)",
            ));
        }
        RobotArgument::Several(robots) => {
            for (prefix, item) in robots.iter() {
                let (robot, pose): (Bound<'_, Robot>, Bound<'_, PyAny>) = item.extract()?;
                placed.push((prefix.extract()?, robot, pose_of(Some(&pose))?));
            }
        }
    }
    let mut setup = Setup::new();
    for (prefix, robot, pose) in &placed {
        setup.robot(prefix, &robot.get().robot, *pose);
    }
    // An SRDF may enable pairs of adjacent links again.
    if exclude_adjacent {
        setup.exclude_adjacent();
    }
    for (prefix, robot, _) in &placed {
        if let Some(srdf) = &robot.get().srdf {
            setup.exclude_srdf(prefix, srdf);
        }
    }
    Ok(setup)
}

/// Adds the cell of a JSON or SDFormat file.
pub(super) fn add_cell(
    setup: &mut Setup,
    robots: &RobotArgument<'_>,
    cell: Option<Bound<'_, PyAny>>,
    keep_invalid: bool,
) -> PyResult<()> {
    let Some(cell) = cell else { return Ok(()) };
    let (packages, options) = robots.first()?.get().mesh_sources()?;
    let options = options.keep_invalid(keep_invalid);
    let cell = CellFile::load(cell.extract::<PathBuf>()?, &packages, &options).map_err(file_error)?;
    setup.cell(&cell);
    Ok(())
}

/// Adds obstacles.
pub(super) fn add_obstacles(setup: &mut Setup, obstacles: Vec<Obstacle<'_>>) -> PyResult<()> {
    for (name, geometry, pose) in obstacles {
        setup.obstacle(name, geometry.get().0.clone(), pose_of(Some(&pose))?);
    }
    Ok(())
}
