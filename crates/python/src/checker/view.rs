//! Pictures and recordings of a checker.

use std::path::PathBuf;

use lin_canny_robot::RobotRecorder;
use pyo3::prelude::*;

use super::{CONFIGURATIONS, Checker, configurations, named};
use crate::array::{Argument, contiguous, numbers};
use crate::errors::{file_error, plan_error};
use crate::geometry::Geometry;

use super::cell::Bodies;

const TIMES: Argument = Argument {
    name: "times",
    error: |why| plan_error(why),
};

#[pymethods]
impl Checker {
    /// Returns the geometry of a body.
    ///
    /// body: a BodyId, or a name that stands for one body.
    fn geometry(&self, body: Bodies) -> PyResult<Geometry> {
        let id = self.one_body(&body)?;
        let geometry = self.checker.cell().geometry(id).cloned();
        geometry
            .map(Geometry)
            .ok_or_else(|| plan_error(format!("{id} has no geometry")))
    }

    /// Returns a View of the robot in its cell with the closest pair. See `lin_canny.show`.
    ///
    /// q: a configuration, shape (dof,), or many, shape (N, dof), which the page plays. By default
    /// zero, or the nearest value within the limits.
    #[pyo3(signature = (q=None))]
    fn show<'py>(this: &Bound<'py, Self>, q: Option<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        crate::view::call(this.py(), "checker", (this, q))
    }

    /// Returns the page of `show` for a notebook; None beyond 100,000 triangles.
    fn _repr_html_<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        crate::view::call(this.py(), "checker_html", (this,))
    }

    /// Writes a recording of configurations with their closest pairs, for a page or rerun.
    ///
    /// Parameters
    /// ----------
    /// path : str or PathLike
    ///     The file, JSON lines; an existing file is replaced.
    /// q : array_like, shape (N, dof)
    ///     One configuration for each frame.
    /// times : array_like, shape (N,), optional
    ///     The time of each frame, for moving obstacles. The attribute `time` is then the last of
    ///     them.
    ///
    /// Raises
    /// ------
    /// PlanError
    ///     If a configuration or a time is invalid, or no pair is checked.
    /// FileError
    ///     If the file cannot be written.
    #[pyo3(signature = (path, q, *, times=None))]
    fn record(
        &mut self,
        py: Python<'_>,
        path: PathBuf,
        q: &Bound<'_, PyAny>,
        times: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let array = contiguous::<f64>(q, CONFIGURATIONS)?;
        let rows: Vec<&[f64]> = configurations(&array, self.dof())?.collect();
        let times = times.map(|times| numbers(times, TIMES)).transpose()?;
        if let Some(times) = times.as_ref().filter(|times| times.len() != rows.len()) {
            let (found, expected) = (times.len(), rows.len());
            return Err(plan_error(format!(
                "times: shape is ({found},) (expected ({expected},), one for each configuration)"
            )));
        }
        let mut recorder: Option<RobotRecorder> = None;
        for (k, q) in rows.iter().enumerate() {
            py.check_signals()?;
            let fault = |e: &dyn std::fmt::Display| plan_error(format!("configuration {k}: {e}"));
            if let Some(times) = &times {
                self.checker.set_time(times[k]).map_err(|e| fault(&e))?;
            }
            let near = self.checker.clearance(q);
            let near = near.map_err(|e| fault(&named(&e, self.coordinate_list())))?;
            let near = near.ok_or_else(|| fault(&"no pair is checked"))?;
            let place = match &times {
                Some(times) => format!("time {}", times[k]),
                None => format!("configuration {k}"),
            };
            let to = match &mut recorder {
                Some(to) => to,
                None => recorder.insert(RobotRecorder::create(&path, &self.checker, q).map_err(file_error)?),
            };
            to.frame(&self.checker, q, &place, &near).map_err(file_error)?;
        }
        match recorder {
            Some(to) => to.finish().map(drop).map_err(file_error),
            None => Err(plan_error("configurations: there are none to record")),
        }
    }
}
