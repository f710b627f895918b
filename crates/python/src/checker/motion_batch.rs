//! Many motions.

use lin_canny_robot::plan::{Checker as Loaded, JointCurve as Curve, JointTree, JointTube, Verdict as Judged};
use numpy::PyArray1;
use pyo3::prelude::*;

use super::Checker;
use super::batches::Numbers;
use super::motions::in_tube;
use crate::array::{filled, of_triples, words};
use crate::batch::{Batch, Run};
use crate::curve::curves_of;

/// Number of motions between two readings of the clock.
const CLOCK_STRIDE: usize = 4;

/// Curves, for checkers of one world.
struct Motions<'a> {
    checker: &'a Checker,
    curves: &'a [Curve],
    /// None, or one for each curve.
    tubes: Vec<JointTube>,
}

impl Batch for Motions<'_> {
    type State = Loaded<JointTree>;
    type Row = Option<Judged>;
    const CLOCK_STRIDE: usize = CLOCK_STRIDE;

    fn start(&self) -> PyResult<Self::State> {
        self.checker.copy()
    }

    fn answer(&self, checker: &mut Self::State, first: usize, rows: &mut [Option<Judged>]) -> PyResult<()> {
        for (k, to) in (first..).zip(rows) {
            checker.reset();
            let motion = in_tube(&self.curves[k], self.tubes.get(k));
            let found = motion.and_then(|motion| checker.certify(&motion));
            *to = Some(found.map_err(|e| self.checker.numbered_fault(k, &e))?);
        }
        Ok(())
    }
}

#[pymethods]
impl Checker {
    /// Returns the verdicts on many motions, each over its whole length.
    ///
    /// Row i has the bits of `certify_curve(curves[i])` after `reset`, for any number of threads.
    /// Ctrl-C ends the call.
    ///
    /// Parameters
    /// ----------
    /// curves : array_like of shape (N, degree + 1, dof), or sequence of JointCurve
    ///     Segments between configurations are `np.stack([starts, goals], axis=1)`. Curves need not
    ///     meet.
    /// tube : float, array_like of shape (dof,), or sequence of JointCurve, optional
    ///     See `certify_curve`; of a sequence, one for each curve.
    /// threads : int
    /// progress : callable or bool, optional
    ///     A callable that receives the number of certified motions and of all, or True for a tqdm
    ///     bar.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray, shape (N,)
    ///     A structured array with the fields `state` ("free", "blocked" or "undecided"); `free_until`;
    ///     `contact_at`; `a` and `b`, the bodies that block, as indices of `bodies`; `point_a` and
    ///     `point_b`, their closest points at `free_until`, in the world, of shape (3,). See Verdict.
    ///     Unless blocked, `contact_at` is NaN, the indices are -1 and the points are zero.
    #[pyo3(signature = (curves, *, tube=None, threads=1, progress=None))]
    fn certify_batch<'py>(
        &self,
        py: Python<'py>,
        curves: &Bound<'py, PyAny>,
        tube: Option<&Bound<'py, PyAny>>,
        threads: usize,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let curves = curves_of(curves)?;
        let count = curves.len();
        let mut rows = vec![None; count];
        let batch = Motions {
            checker: self,
            curves: &curves,
            tubes: self.tubes(tube, count)?,
        };
        Run::new(py, count, threads, progress)?.rows(py, &batch, &mut rows)?;
        let found: Vec<Judged> = rows.into_iter().flatten().collect();
        let numbers = Numbers::new(&self.checker);
        let number = |of: fn(&Judged) -> f64| PyArray1::from_iter(py, found.iter().map(of)).into_any();
        let body = |second: bool| {
            let of = |verdict: &Judged| match verdict {
                Judged::Blocked { pair, .. } => numbers.of(if second { pair.b } else { pair.a }),
                _ => -1,
            };
            PyArray1::from_iter(py, found.iter().map(of)).into_any()
        };
        let point = |k: usize| {
            let of = |verdict: &Judged| match verdict {
                Judged::Blocked { witnesses, .. } => witnesses[k].into(),
                _ => [0.0; 3],
            };
            of_triples(py, found.iter().map(of).collect()).map(Bound::into_any)
        };
        let contact_at = |verdict: &Judged| match *verdict {
            Judged::Blocked { contact_at, .. } => contact_at,
            _ => f64::NAN,
        };
        let columns = vec![
            (("state", "U9", None), words::<9>(py, found.iter().map(Judged::name))?),
            (("free_until", "f8", None), number(Judged::free_until)),
            (("contact_at", "f8", None), number(contact_at)),
            (("a", "i4", None), body(false)),
            (("b", "i4", None), body(true)),
            (("point_a", "f8", Some(3)), point(0)?),
            (("point_b", "f8", Some(3)), point(1)?),
        ];
        filled(py, count, columns)
    }
}
