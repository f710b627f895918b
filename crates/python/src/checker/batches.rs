//! Many configurations.

use lin_canny_robot::Coordinate;
use lin_canny_robot::plan::{CellBody, CellPair, Checker as Loaded, JointTree, NearPairs, PlanError};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::prelude::*;

use super::{CONFIGURATIONS, Checker, configurations, named};
use crate::array::{contiguous, filled, of_triples, structured};
use crate::batch::{BLOCK, Batch, Run};
use crate::errors::plan_error;

/// Number of queries between two readings of the clock.
const CLOCK_STRIDE: usize = 16;

/// Distance, lower and upper bound, and the numbers of the two bodies.
type Row = [f64; 5];

/// The answer without a pair.
const NO_PAIR: Row = [f64::INFINITY, f64::INFINITY, f64::INFINITY, -1.0, -1.0];

/// Configurations row by row, for checkers of one world.
struct Configurations<'a> {
    checker: &'a Loaded<JointTree>,
    coordinates: &'a [Coordinate],
    numbers: Numbers,
    rows: Vec<&'a [f64]>,
}

/// The bodies of a world in the order of `Checker.bodies`.
pub(super) struct Numbers(Vec<CellBody>);

impl Numbers {
    pub(super) fn new(checker: &Loaded<JointTree>) -> Self {
        Self(checker.cell().bodies().map(|(id, _)| id).collect())
    }

    /// Returns the index of a body; bodies are in ascending order.
    pub(super) fn of(&self, id: CellBody) -> i32 {
        self.0.binary_search(&id).map_or(-1, |k| k as i32)
    }
}

impl Configurations<'_> {
    fn clearance(&self, checker: &mut Loaded<JointTree>, k: usize) -> PyResult<Row> {
        let found = checker
            .clearance(self.rows[k])
            .map_err(|e| fault(k, &e, self.coordinates))?;
        Ok(found.map_or(NO_PAIR, |near| {
            let [a, b] = [near.pair.a, near.pair.b].map(|id| f64::from(self.numbers.of(id)));
            [near.distance, near.lower, near.upper, a, b]
        }))
    }
}

#[cold]
fn fault(k: usize, error: &PlanError, coordinates: &[Coordinate]) -> PyErr {
    plan_error(format!("configuration {k}: {}", named(error, coordinates)))
}

/// The clearance of each configuration.
struct Clearances<'a>(Configurations<'a>);

impl Batch for Clearances<'_> {
    type State = Loaded<JointTree>;
    type Row = Row;
    const CLOCK_STRIDE: usize = CLOCK_STRIDE;

    fn start(&self) -> PyResult<Self::State> {
        self.0.checker.fork().map_err(plan_error)
    }

    fn answer(&self, checker: &mut Self::State, first: usize, rows: &mut [Row]) -> PyResult<()> {
        for (k, to) in (first..).zip(rows) {
            *to = self.0.clearance(checker, k)?;
        }
        Ok(())
    }
}

/// Whether each configuration keeps the margin.
struct Free<'a>(Configurations<'a>);

impl Batch for Free<'_> {
    type State = Loaded<JointTree>;
    type Row = bool;
    const CLOCK_STRIDE: usize = CLOCK_STRIDE;

    fn start(&self) -> PyResult<Self::State> {
        self.0.checker.fork().map_err(plan_error)
    }

    fn answer(&self, checker: &mut Self::State, first: usize, rows: &mut [bool]) -> PyResult<()> {
        for (k, to) in (first..).zip(rows) {
            *to = checker
                .is_free_at(self.0.rows[k])
                .map_err(|e| fault(k, &e, self.0.coordinates))?;
        }
        Ok(())
    }
}

impl Checker {
    fn batch<'a>(&'a self, array: &'a PyReadonlyArrayDyn<'_, f64>) -> PyResult<Configurations<'a>> {
        Ok(Configurations {
            checker: &self.checker,
            coordinates: self.checker.cell().coordinates(),
            numbers: Numbers::new(&self.checker),
            rows: configurations(array, self.checker.cell().coordinates().len())?.collect(),
        })
    }
}

#[pymethods]
impl Checker {
    /// Returns the clearance at many configurations, shape (N, dof).
    ///
    /// The result is a structured array of shape (N,) with the fields `distance`, `lower`, `upper`,
    /// `a` and `b`. The last two are the bodies of the closest pair, as indices of `bodies`.
    /// Without a pair the distance is infinite and the indices are -1. The result has the same bits
    /// for any number of threads. Ctrl-C ends the call.
    ///
    /// progress: a callable that receives the number of finished configurations and of all
    /// configurations, or True for a tqdm bar.
    #[pyo3(signature = (q, *, threads=1, progress=None))]
    pub(crate) fn clearances<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        threads: usize,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let array = contiguous::<f64>(q, CONFIGURATIONS)?;
        let batch = Clearances(self.batch(&array)?);
        let mut rows = vec![NO_PAIR; batch.0.rows.len()];
        Run::new(py, rows.len(), threads, progress)?.rows(py, &batch, &mut rows)?;
        let [distance, lower, upper] = ["distance", "lower", "upper"].map(|name| (name, "f8", 1));
        structured(py, rows, &[distance, lower, upper, ("a", "i4", 1), ("b", "i4", 1)])
    }

    /// Returns whether each of many configurations, shape (N, dof), keeps the margin.
    ///
    /// The result is a bool array of shape (N,). For threads and progress see `clearances`.
    #[pyo3(signature = (q, *, threads=1, progress=None))]
    fn are_free<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        threads: usize,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let array = contiguous::<f64>(q, CONFIGURATIONS)?;
        let batch = Free(self.batch(&array)?);
        let mut rows = vec![false; batch.0.rows.len()];
        Run::new(py, rows.len(), threads, progress)?.rows(py, &batch, &mut rows)?;
        Ok(PyArray1::from_vec(py, rows))
    }

    /// Returns the `k` closest pairs at many configurations, shape (N, dof), with gradients.
    ///
    /// Row i has the bits of `nearest(q[i], slack)[:k]` after `reset`, for any number of threads.
    /// Ctrl-C ends the call.
    ///
    /// Parameters
    /// ----------
    /// q : array_like, shape (N, dof)
    /// k : int
    ///     The largest number of pairs of a row.
    /// slack : float
    ///     Pairs whose distance exceeds the least of the row by more are left out.
    /// threads : int
    /// progress : callable or bool, optional
    ///     As for `clearances`.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (N, k)
    ///     A structured array, the closest pair of each row first. Fields: `distance`, `lower`,
    ///     `upper`, `excess`; `a` and `b`, indices of `bodies`; `point_a`, `point_b`, `normal` of
    ///     shape (3,), in the world; `gradient` of shape (dof,): see `NearPair.gradient`. In entries
    ///     without a pair `a` and `b` are -1, the first four are infinite, the others zero.
    #[pyo3(signature = (q, k, slack=f64::INFINITY, *, threads=1, progress=None))]
    #[allow(clippy::too_many_arguments)] // the signature in Python
    fn nearest_batch<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        k: usize,
        slack: f64,
        threads: usize,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let array = contiguous::<f64>(q, CONFIGURATIONS)?;
        let (dof, checker, coordinates) = (self.dof(), &self.checker, self.checker.cell().coordinates());
        let rows = configurations(&array, dof)?.len();
        let run = Run::new(py, rows, threads, progress)?;
        let numbers = array.as_slice()?;
        let parts = run.parts(py, rows, BLOCK.saturating_mul(threads), |part| {
            let values = &numbers[part.start * dof..part.end * dof];
            let found = checker.nearest_batch(values, k, slack, threads);
            found.map_err(|error| match error {
                PlanError::Row { row, error } => fault(part.start + row, &error, coordinates),
                error => plan_error(error),
            })
        })?;
        let found = near_pairs(py, &parts, &Numbers::new(checker), dof)?;
        found.call_method1("reshape", ((rows, k),))
    }

    /// Returns the seconds of thread CPU time of the loop in Rust, and the sum of all distances.
    #[cfg(feature = "bench")]
    fn _rust_loop(&self, py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<(f64, f64)> {
        let array = contiguous::<f64>(q, CONFIGURATIONS)?;
        let batch = self.batch(&array)?;
        py.detach(|| {
            let start = cpu_time::ThreadTime::now();
            let mut checker = batch.checker.fork().map_err(plan_error)?;
            let rows: PyResult<Vec<Row>> = (0..batch.rows.len())
                .map(|k| batch.clearance(&mut checker, k))
                .collect();
            let seconds = start.elapsed().as_secs_f64();
            Ok((seconds, rows?.iter().map(|row| row[0]).sum()))
        })
    }
}

/// Returns the entries of batches as a structured array.
fn near_pairs<'py>(py: Python<'py>, parts: &[NearPairs], numbers: &Numbers, dof: usize) -> PyResult<Bound<'py, PyAny>> {
    let number = |of: fn(&NearPairs) -> &Vec<f64>| {
        let values: Vec<f64> = parts.iter().flat_map(of).copied().collect();
        PyArray1::from_vec(py, values)
    };
    let vector = |of: fn(&NearPairs) -> &Vec<[f64; 3]>| {
        let values: Vec<[f64; 3]> = parts.iter().flat_map(of).copied().collect();
        of_triples(py, values).map(Bound::into_any)
    };
    let body = |of: fn(&CellPair) -> CellBody| {
        let pairs = parts.iter().flat_map(|part| &part.pairs);
        let indices = pairs.map(|pair| pair.as_ref().map_or(-1, |pair| numbers.of(of(pair))));
        PyArray1::from_vec(py, indices.collect()).into_any()
    };
    let count = parts.iter().map(|part| part.pairs.len()).sum();
    let columns = vec![
        (("distance", "f8", None), number(|n| &n.distances).into_any()),
        (("lower", "f8", None), number(|n| &n.lower).into_any()),
        (("upper", "f8", None), number(|n| &n.upper).into_any()),
        (("excess", "f8", None), number(|n| &n.excesses).into_any()),
        (("a", "i4", None), body(|pair| pair.a)),
        (("b", "i4", None), body(|pair| pair.b)),
        (("point_a", "f8", Some(3)), vector(|n| &n.points_a)?),
        (("point_b", "f8", Some(3)), vector(|n| &n.points_b)?),
        (("normal", "f8", Some(3)), vector(|n| &n.normals)?),
        (
            ("gradient", "f8", Some(dof)),
            number(|n| &n.gradients).reshape([count, dof])?.into_any(),
        ),
    ];
    filled(py, count, columns)
}
