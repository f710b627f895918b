//! Proofs over ranges of joints.

use lin_canny_robot::plan::receipt::Receipt;
use lin_canny_robot::plan::{
    Checker as Loaded, ClearanceWidth, ConfigurationSpace, JointTree, PlanError, RangeAnswer as Answer, RangeOptions,
    RangeProver,
};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use super::Checker;
use super::answers::{Pair, names};
use super::cell::{Bodies, BodyId};
use crate::array::{Argument, numbers, of_table};
use crate::errors::{no_condition, plan_error};
use crate::watch::Watch;

const LOW: Argument = Argument {
    name: "low",
    error: |why| plan_error(why),
};
const HIGH: Argument = Argument { name: "high", ..LOW };

/// Whether two bodies can meet at any configuration of a range, with proof.
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct RangeAnswer {
    answer: Answer,
    pair: Pair,
    coordinates: Vec<String>,
    text: String,
}

#[pymethods]
impl RangeAnswer {
    /// Raises TypeError: the answer has more than two values.
    fn __bool__(&self) -> PyResult<bool> {
        Err(no_condition("RangeAnswer", "verdict"))
    }

    /// "never" (at every configuration the pair keeps its distance), "always" (at none), "both"
    /// (`witnesses` are a configuration of each) or "open" (the budget ended before).
    #[getter]
    fn verdict(&self) -> &'static str {
        self.answer.verdict.name()
    }

    /// The name of the first body.
    #[getter]
    fn a(&self) -> &str {
        &self.pair.0
    }

    /// The name of the second body.
    #[getter]
    fn b(&self) -> &str {
        &self.pair.1
    }

    /// The ids of both bodies.
    #[getter]
    fn ids(&self) -> (BodyId, BodyId) {
        (BodyId(self.answer.pair.a), BodyId(self.answer.pair.b))
    }

    /// Proven lower bound of the distance over the whole range; 0 if the pair may be in contact.
    #[getter]
    fn lower(&self) -> f64 {
        self.answer.lower
    }

    /// Least distance that was found; 0 in contact, infinite if none was measured.
    #[getter]
    fn upper(&self) -> f64 {
        self.answer.upper
    }

    /// The configuration at which `upper` was found, shape (dof,).
    #[getter]
    fn at<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.answer.at)
    }

    /// A configuration at which the pair keeps its distance, and one at which it does not, each of
    /// shape (dof,), or None where none was found.
    ///
    /// Exact predicates decide them, as those of `Checker.is_free`.
    #[getter]
    #[allow(clippy::type_complexity)] // a pair of arrays
    fn witnesses<'py>(
        &self,
        py: Python<'py>,
    ) -> (Option<Bound<'py, PyArray1<f64>>>, Option<Bound<'py, PyArray1<f64>>>) {
        let [free, touching] = &self.answer.witnesses;
        let array = |q: &Option<Vec<f64>>| q.as_ref().map(|q| PyArray1::from_slice(py, q));
        (array(free), array(touching))
    }

    /// The share of the volume of the range that is left; 0 unless open.
    #[getter]
    fn share(&self) -> f64 {
        self.answer.open_share()
    }

    /// The number of cells that were searched.
    #[getter]
    fn cells(&self) -> u64 {
        self.answer.cells
    }

    /// The names of the coordinates that move the bodies against each other.
    #[getter]
    fn coordinates(&self) -> Vec<String> {
        self.coordinates.clone()
    }

    /// Least and greatest value of each coordinate, shape (dof, 2).
    #[getter]
    fn range<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows: Vec<Vec<f64>> = self.answer.range.iter().map(|ends| ends.to_vec()).collect();
        of_table(py, &rows, 2)
    }

    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> String {
        let ((a, b), verdict) = (&self.pair, self.verdict());
        format!("<RangeAnswer {a:?} - {b:?}: {verdict}>")
    }
}

/// Returns how far a proof goes.
pub(super) fn options(cells: u64, width: Option<f64>, relative: Option<f64>) -> PyResult<RangeOptions> {
    let options = RangeOptions::default().cells(cells);
    let width = match (width, relative) {
        (None, None) => return Ok(options),
        (Some(_), Some(_)) => return Err(plan_error("width and relative are both given (expected one)")),
        (Some(width), None) if width > 0.0 && width.is_finite() => ClearanceWidth::Length(width),
        (None, Some(share)) if share > 0.0 && share < 1.0 => ClearanceWidth::Share(share),
        (Some(width), _) => return Err(plan_error(format!("width is {width} (expected a positive length)"))),
        (_, Some(share)) => return Err(plan_error(format!("relative is {share} (expected between 0 and 1)"))),
    };
    Ok(options.width(width))
}

impl Checker {
    pub(super) fn answer(&self, answer: Answer) -> RangeAnswer {
        let coordinates = self.coordinate_list();
        let each = answer.coordinates.iter().map(|k| coordinates[*k].name.clone());
        RangeAnswer {
            pair: names(&self.checker, answer.pair),
            coordinates: each.collect(),
            text: self.checker.show(&answer).to_string(),
            answer,
        }
    }

    /// Returns the ends of a range; by default the limits of the joints.
    fn range_ends(&self, low: Option<&Bound<'_, PyAny>>, high: Option<&Bound<'_, PyAny>>) -> PyResult<[Vec<f64>; 2]> {
        let coordinates = self.coordinate_list();
        let end = |argument: Argument, given: Option<&Bound<'_, PyAny>>, k: usize| {
            let Some(given) = given else {
                return Ok(self.checker.space().bounds().iter().map(|ends| ends[k]).collect());
            };
            let (values, what) = (numbers(given, argument)?, argument.name);
            let (found, expected) = (values.len(), coordinates.len());
            if found != expected {
                return Err(plan_error(format!(
                    "{what}: shape is ({found},) (expected ({expected},))"
                )));
            }
            for (value, c) in values.iter().zip(coordinates) {
                let [least, most] = c.limits;
                if !(*value >= least && *value <= most) {
                    let name = &c.name;
                    return Err(plan_error(format!(
                        "{what}: {name} is {value}, outside its limits {least} and {most}"
                    )));
                }
            }
            Ok(values)
        };
        let (low, high): (Vec<f64>, Vec<f64>) = (end(LOW, low, 0)?, end(HIGH, high, 1)?);
        match (0..low.len()).find(|k| low[*k] > high[*k]) {
            Some(k) => Err(plan_error(format!(
                "range of {} is empty: {} to {} (expected low <= high)",
                coordinates[k].name, low[k], high[k]
            ))),
            None => Ok([low, high]),
        }
    }

    /// Makes a proof with progress and Ctrl-C.
    pub(super) fn proved<T: Send>(
        &mut self,
        py: Python<'_>,
        progress: Option<&Bound<'_, PyAny>>,
        call: impl FnOnce(&mut Loaded<JointTree>, &mut Watch) -> Result<T, PlanError> + Send,
    ) -> PyResult<T> {
        let mut watch = Watch::new(py, progress)?;
        let found = py.detach(|| call(&mut self.checker, &mut watch));
        watch.finish(py, false)?;
        found.map_err(plan_error)
    }
}

#[pymethods]
impl Checker {
    /// Returns whether the bodies of each pair can meet at any configuration of a range, with proof.
    ///
    /// The range is divided into cells, each proven free or blocked as a whole; nothing is
    /// sampled. Moving obstacles are at their poses of `time`. Ctrl-C ends the call.
    ///
    /// Parameters
    /// ----------
    /// low, high : array_like, shape (dof,), optional
    ///     Least and greatest value of each coordinate. By default the limits of the joints.
    /// cells : int
    ///     The largest number of cells of each pair.
    /// width : float, optional
    ///     The width to which the least clearance of each pair is proven, a length. By default it is
    ///     only proven that the pair keeps its distance.
    /// relative : float, optional
    ///     This width as a fraction of the clearance, instead of `width`.
    /// progress : callable or bool, optional
    ///     A callable that receives the number of cells of the pair at hand and the largest number,
    ///     or True for a tqdm bar.
    ///
    /// Returns
    /// -------
    /// list of RangeAnswer
    ///     One for each pair that is checked, in the order of `bodies`.
    #[pyo3(signature = (low=None, high=None, *, cells=20_000, width=None, relative=None, progress=None))]
    #[allow(clippy::too_many_arguments)] // the signature in Python
    fn prove_range(
        &mut self,
        py: Python<'_>,
        low: Option<&Bound<'_, PyAny>>,
        high: Option<&Bound<'_, PyAny>>,
        cells: u64,
        width: Option<f64>,
        relative: Option<f64>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Vec<RangeAnswer>> {
        let ([low, high], options) = (self.range_ends(low, high)?, options(cells, width, relative)?);
        let found = self.proved(py, progress, |checker, watch| {
            RangeProver::new(&options)
                .progress(&mut |now| watch.look(now))
                .all_pairs(checker, &low, &high)
        })?;
        Ok(found.into_iter().map(|answer| self.answer(answer)).collect())
    }

    /// Returns whether two bodies can meet at any configuration of a range, with proof.
    ///
    /// `a` and `b` stand for one body each. Pairs that are excluded are answered too. For the other
    /// parameters see `prove_range`.
    #[pyo3(signature = (a, b, low=None, high=None, *, cells=20_000, width=None, relative=None, progress=None))]
    #[allow(clippy::too_many_arguments)] // the signature in Python
    fn prove_pair(
        &mut self,
        py: Python<'_>,
        a: Bodies,
        b: Bodies,
        low: Option<&Bound<'_, PyAny>>,
        high: Option<&Bound<'_, PyAny>>,
        cells: u64,
        width: Option<f64>,
        relative: Option<f64>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<RangeAnswer> {
        let pair = self.pair_of(self.one_body(&a)?, self.one_body(&b)?)?;
        let ([low, high], options) = (self.range_ends(low, high)?, options(cells, width, relative)?);
        let found = self.proved(py, progress, |checker, watch| {
            RangeProver::new(&options)
                .progress(&mut |now| watch.look(now))
                .pair(checker, pair.a, pair.b, &low, &high)
        })?;
        Ok(self.answer(found))
    }

    /// Returns the receipt of answers about one range, as a text: see `receipt`.
    ///
    /// Pairs that never meet have a proof; all others are listed with the reason.
    ///
    /// Parameters
    /// ----------
    /// answers : sequence of RangeAnswer
    ///     Those of `prove_range`, and of `prove_pair` over the same range.
    /// cells : int
    ///     The most cells of a pair. A receipt needs more of them than the search.
    #[pyo3(signature = (answers, *, cells=20_000))]
    fn receipt_range(&self, py: Python<'_>, answers: Vec<Py<RangeAnswer>>, cells: u64) -> PyResult<String> {
        let answers: Vec<Answer> = answers.iter().map(|one| one.get().answer.clone()).collect();
        let written = py.detach(|| Receipt::range(&self.checker, &answers, cells));
        Ok(written.map_err(plan_error)?.to_string())
    }

    /// Goes on with an answer that is open, for as many cells more; see `prove_range`.
    ///
    /// Two calls give the answer of one call with the sum of both budgets. The world must be that of
    /// the answer.
    #[pyo3(signature = (answer, *, cells=20_000, width=None, relative=None, progress=None))]
    fn resume_range(
        &mut self,
        py: Python<'_>,
        answer: &Bound<'_, RangeAnswer>,
        cells: u64,
        width: Option<f64>,
        relative: Option<f64>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<RangeAnswer> {
        let (answer, options) = (&answer.get().answer, options(cells, width, relative)?);
        let found = self.proved(py, progress, |checker, watch| {
            RangeProver::new(&options)
                .progress(&mut |now| watch.look(now))
                .resume(checker, answer)
        })?;
        Ok(self.answer(found))
    }
}
