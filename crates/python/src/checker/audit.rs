//! Audits: for each two links, and each link and obstacle, whether they can ever meet.

use std::time::Instant;

use lin_canny::Progress;
use lin_canny_robot::plan::RangeAnswer as Answer;
use lin_canny_robot::{LinkAudit as Found, audit};
use numpy::PyArray1;
use pyo3::prelude::*;

use super::Checker;
use super::range::{RangeAnswer, options};
use crate::errors::{no_condition, plan_error};

/// Whether two links, or a link and an obstacle, can meet at any configuration within the limits,
/// with proof.
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct LinkAudit {
    found: Found,
    coordinates: Vec<String>,
    answers: Vec<Py<RangeAnswer>>,
}

#[pymethods]
impl LinkAudit {
    /// Raises TypeError: the answer has more than two values.
    fn __bool__(&self) -> PyResult<bool> {
        Err(no_condition("LinkAudit", "verdict"))
    }

    /// The name of the first link, or of an attached object.
    #[getter]
    fn a(&self) -> &str {
        &self.found.names[0]
    }

    /// The name of the second link, attached object or obstacle.
    #[getter]
    fn b(&self) -> &str {
        &self.found.names[1]
    }

    /// "never" (they never meet), "always" (they meet at every configuration), "both" (two bodies of
    /// them meet at one configuration and are free at another) or "open" (the budget ended before).
    #[getter]
    fn verdict(&self) -> String {
        self.found.verdict.to_string()
    }

    /// The names of the coordinates that move one against the other.
    #[getter]
    fn coordinates(&self) -> Vec<String> {
        self.coordinates.clone()
    }

    /// Proven lower bound of the distance at every configuration; 0 if they may meet.
    #[getter]
    fn lower(&self) -> f64 {
        self.found.lower
    }

    /// Least distance that was found; 0 in contact, infinite if none was measured.
    #[getter]
    fn upper(&self) -> f64 {
        self.found.upper
    }

    /// The configuration at which `upper` was found, shape (dof,).
    #[getter]
    fn at<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.found.at)
    }

    /// A configuration at which they are in contact, shape (dof,), or None if none was found.
    #[getter]
    fn contact<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.found.contact().map(|q| PyArray1::from_slice(py, q))
    }

    /// The share of the volume of the limits that is left; 0 unless open.
    #[getter]
    fn share(&self) -> f64 {
        self.found.open
    }

    /// The number of cells that were searched.
    #[getter]
    fn cells(&self) -> u64 {
        self.found.cells
    }

    /// Whether two bodies touch without depth, so that more cells do not decide.
    #[getter]
    fn is_flush(&self) -> bool {
        self.found.is_flush()
    }

    /// The answer about each two bodies.
    #[getter]
    fn answers(&self, py: Python<'_>) -> Vec<Py<RangeAnswer>> {
        self.answers.iter().map(|answer| answer.clone_ref(py)).collect()
    }

    fn __repr__(&self) -> String {
        let ([a, b], verdict) = (&self.found.names, self.found.verdict);
        format!("<LinkAudit {a:?} - {b:?}: {verdict}>")
    }
}

impl Checker {
    fn link_audit(&self, py: Python<'_>, found: Found) -> PyResult<LinkAudit> {
        let answers = found
            .answers
            .iter()
            .map(|answer| Py::new(py, self.answer(answer.clone())));
        let is_moved = |k: &usize| found.answers.iter().any(|answer| answer.coordinates.contains(k));
        let coordinates = self.coordinate_list();
        let moved = (0..coordinates.len()).filter(is_moved);
        Ok(LinkAudit {
            coordinates: moved.map(|k| coordinates[k].name.clone()).collect(),
            answers: answers.collect::<PyResult<_>>()?,
            found,
        })
    }
}

#[pymethods]
impl Checker {
    /// Returns for each two links, and each link and obstacle, whether they can ever meet, with proof.
    ///
    /// The rows are those of the command `audit` of the tool. The ranges are the limits of the joints.
    /// Excluded pairs are answered too, pairs that keep their relative pose are not. Moving obstacles
    /// are at their poses of `time`. Ctrl-C ends the call.
    ///
    /// Parameters
    /// ----------
    /// cells : int
    ///     The largest number of cells of each pair of bodies.
    /// width : float, optional
    ///     The width to which the least clearance of each pair is proven, a length. By default it is
    ///     only proven that they never meet.
    /// relative : float, optional
    ///     This width as a fraction of the clearance, instead of `width`; the tool takes 0.1.
    /// seconds : float, optional
    ///     The time limit. Pairs without a verdict are then open.
    /// resume : sequence of LinkAudit, optional
    ///     The result of an earlier call in the same world: open pairs go on, others are taken over.
    /// progress : callable or bool, optional
    ///     A callable that receives the number of cells of the pair at hand and the largest number,
    ///     or True for a tqdm bar.
    ///
    /// Returns
    /// -------
    /// list of LinkAudit
    ///     In the order of `bodies`.
    #[pyo3(signature = (*, cells=20_000, width=None, relative=None, seconds=None, resume=None, progress=None))]
    #[allow(clippy::too_many_arguments)] // the signature in Python
    fn audit(
        &mut self,
        py: Python<'_>,
        cells: u64,
        width: Option<f64>,
        relative: Option<f64>,
        seconds: Option<f64>,
        resume: Option<Vec<Bound<'_, LinkAudit>>>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<LinkAudit>> {
        let options = options(cells, width, relative)?;
        let limit = match seconds {
            Some(limit) if !(limit >= 0.0) => {
                return Err(plan_error(format!("seconds is {limit} (expected at least 0)")));
            }
            given => given.unwrap_or(f64::INFINITY),
        };
        let earlier: Vec<Answer> = resume
            .iter()
            .flatten()
            .flat_map(|one| one.get().found.answers.clone())
            .collect();
        let began = Instant::now();
        let found = self.proved(py, progress, |checker, watch| {
            audit(checker, &options, &earlier, &mut |now| {
                let is_stopped = watch.look(now).is_break();
                Progress::stop_if(is_stopped || began.elapsed().as_secs_f64() > limit)
            })
        })?;
        found.into_iter().map(|found| self.link_audit(py, found)).collect()
    }
}
