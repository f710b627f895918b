//! The arguments of a checker.

use std::path::PathBuf;

use lin_canny::nalgebra::Isometry3;
use lin_canny_robot::plan::Cell;
use lin_canny_robot::{CellFile, Skipped};
use pyo3::Borrowed;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::{file_error, plan_error, refused};
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

/// Returns the cell of the robots, with the pairs of their SRDFs, and what was skipped.
pub(super) fn of_robots(
    robots: &RobotArgument<'_>,
    pose: Option<Bound<'_, PyAny>>,
    exclude_adjacent: bool,
) -> PyResult<(Cell, Vec<Skipped>)> {
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
    let (mut cell, mut skipped) = (Cell::new(), Vec::new());
    for (prefix, robot, pose) in &placed {
        let robot = &robot.get().robot;
        cell.add_robot(prefix, robot, *pose).map_err(plan_error)?;
        skipped.extend_from_slice(robot.skipped());
    }
    // An SRDF may enable pairs of adjacent links again.
    if exclude_adjacent {
        cell.exclude_adjacent();
    }
    for (prefix, robot, _) in &placed {
        if let Some(srdf) = &robot.get().srdf {
            srdf.exclude_in(&mut cell, prefix).map_err(plan_error)?;
            skipped.extend(srdf.skipped_pairs().cloned());
        }
    }
    Ok((cell, skipped))
}

/// Adds the bodies and pairs of a JSON or SDFormat file, and returns what was skipped.
pub(super) fn add_cell(
    cell: &mut Cell,
    robots: &RobotArgument<'_>,
    file: Option<Bound<'_, PyAny>>,
    keep_invalid: bool,
) -> PyResult<Vec<Skipped>> {
    let Some(file) = file else { return Ok(Vec::new()) };
    let (packages, options) = robots.first()?.get().mesh_sources()?;
    let options = options.keep_invalid(keep_invalid);
    let file = CellFile::load(file.extract::<PathBuf>()?, &packages, &options).map_err(file_error)?;
    file.add_to(cell).map_err(file_error)
}

/// Adds obstacles.
pub(super) fn add_obstacles(cell: &mut Cell, obstacles: Vec<Obstacle<'_>>) -> PyResult<()> {
    for (name, geometry, pose) in obstacles {
        let added = cell.add_obstacle(name, geometry.get().0.clone(), pose_of(Some(&pose))?);
        added.map_err(plan_error)?;
    }
    Ok(())
}
