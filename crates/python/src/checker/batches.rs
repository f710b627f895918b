//! Many configurations.

use lin_canny_robot::Setup;
use lin_canny_robot::plan::{Checker as Loaded, JointTree, WorldId};
use numpy::{PyArray1, PyReadonlyArrayDyn};
use pyo3::prelude::*;

use super::{CONFIGURATIONS, Checker, configurations};
use crate::array::{contiguous, structured};
use crate::batch::{Batch, Run};
use crate::errors::plan_error;

/// Number of queries between two readings of the clock.
const LOOK: usize = 16;

/// Distance, lower and upper bound, and the numbers of the two bodies.
type Row = [f64; 5];

/// The answer without a pair.
const NO_PAIR: Row = [f64::INFINITY, f64::INFINITY, f64::INFINITY, -1.0, -1.0];

/// Configurations row by row, for checkers of one setup.
struct Configurations<'a> {
    setup: &'a Setup,
    margin: f64,
    robot_bodies: usize,
    rows: Vec<&'a [f64]>,
}

impl Configurations<'_> {
    fn checker(&self) -> PyResult<Loaded<JointTree>> {
        let mut checker = self.setup.checker().map_err(plan_error)?;
        checker.set_margin(self.margin).map_err(plan_error)?;
        Ok(checker)
    }

    fn number(&self, part: WorldId) -> f64 {
        match part {
            WorldId::Robot(k) => k as f64,
            // A checker of Python has no attached objects.
            WorldId::Attached(_) => -1.0,
            WorldId::Obstacle(k) => (self.robot_bodies + k) as f64,
        }
    }

    fn clearance(&self, checker: &mut Loaded<JointTree>, k: usize) -> PyResult<Row> {
        let found = checker.clearance(self.rows[k]).map_err(|e| fault(k, &e))?;
        Ok(found.map_or(NO_PAIR, |near| {
            let [a, b] = [near.pair.a, near.pair.b].map(|part| self.number(part));
            [near.distance, near.lower, near.upper, a, b]
        }))
    }
}

#[cold]
fn fault(k: usize, error: &dyn std::fmt::Display) -> PyErr {
    plan_error(format!("configuration {k}: {error}"))
}

/// The clearance of each configuration.
struct Clearances<'a>(Configurations<'a>);

impl Batch for Clearances<'_> {
    type State = Loaded<JointTree>;
    type Row = Row;
    const LOOK: usize = LOOK;

    fn start(&self) -> PyResult<Self::State> {
        self.0.checker()
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
    const LOOK: usize = LOOK;

    fn start(&self) -> PyResult<Self::State> {
        self.0.checker()
    }

    fn answer(&self, checker: &mut Self::State, first: usize, rows: &mut [bool]) -> PyResult<()> {
        for (k, to) in (first..).zip(rows) {
            *to = checker.is_free_at(self.0.rows[k]).map_err(|e| fault(k, &e))?;
        }
        Ok(())
    }
}

impl Checker {
    fn batch<'a>(&'a self, array: &'a PyReadonlyArrayDyn<'_, f64>) -> PyResult<Configurations<'a>> {
        Ok(Configurations {
            setup: &self.setup,
            margin: self.checker.margin(),
            robot_bodies: self.robot_bodies,
            rows: configurations(array, self.setup.coordinates().len())?.collect(),
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

    /// Returns the seconds of thread CPU time of the loop in Rust, and the sum of all distances.
    #[cfg(feature = "bench")]
    fn _rust_loop(&self, py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<(f64, f64)> {
        let array = contiguous::<f64>(q, CONFIGURATIONS)?;
        let batch = self.batch(&array)?;
        py.detach(|| {
            let start = cpu_time::ThreadTime::now();
            let mut checker = batch.checker()?;
            let rows: PyResult<Vec<Row>> = (0..batch.rows.len())
                .map(|k| batch.clearance(&mut checker, k))
                .collect();
            let seconds = start.elapsed().as_secs_f64();
            Ok((seconds, rows?.iter().map(|row| row[0]).sum()))
        })
    }
}
