//! Curves, splines and trajectories.

use lin_canny::separation::Proof;
use lin_canny_robot::Coordinate;
use lin_canny_robot::plan::{
    Certified, CertifyOptions, JointCurve as Curve, JointMotion, JointTube, PairProof, PlanError, Verdict as Judged,
};
use numpy::{PyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;

use super::answers::{self, Pair, Verdict};
use super::batches::Numbers;
use super::{Checker, configuration, named};
use crate::array::{Argument, contiguous, filled, is_number, of_triples, shape_text, table};
use crate::batch::Run;
use crate::curve::{JointCurve, curve_of, curves_of};
use crate::errors::plan_error;
use crate::trajectory::Trajectory;

const TUBE: Argument = Argument {
    name: "tube",
    error: |why| plan_error(why),
};

impl Checker {
    pub(crate) fn coordinate_list(&self) -> &[Coordinate] {
        self.checker.cell().coordinates()
    }

    /// Returns a number of each coordinate: one number for all, or one for each.
    pub(super) fn of_each(&self, given: &Bound<'_, PyAny>, argument: Argument) -> PyResult<Vec<f64>> {
        let dof = self.dof();
        let array = contiguous::<f64>(given, argument)?;
        let values = array.as_slice()?;
        let values = match is_number(given)? {
            true => vec![values[0]; dof],
            false => values.to_vec(),
        };
        match array.shape() {
            [_] if values.len() == dof => Ok(values),
            shape => Err(plan_error(format!(
                "{}: shape is {} (expected a number or ({dof},))",
                argument.name,
                shape_text(shape)
            ))),
        }
    }

    /// Returns a tube that is the same at all times; `None` unless it is one number for all
    /// coordinates, or one for each.
    fn constant_tube(&self, tube: &Bound<'_, PyAny>) -> PyResult<Option<JointTube>> {
        if !is_number(tube)? && contiguous::<f64>(tube, TUBE).is_ok_and(|array| array.shape().len() > 1) {
            return Ok(None);
        }
        let values = self.of_each(tube, TUBE)?;
        self.check_tube(&values)?;
        Ok(Some((&values).into()))
    }

    /// Returns a tube whose entries are a curve.
    fn tube_along(&self, curve: Curve) -> PyResult<JointTube> {
        let (dof, found) = (self.dof(), curve.coordinates());
        if found != dof {
            return Err(plan_error(format!(
                "tube: number of columns is {found} (expected {dof})"
            )));
        }
        (0..=curve.degree()).try_for_each(|k| self.check_tube(&curve.control_point(k)))?;
        Ok(curve.into())
    }

    fn check_tube(&self, entries: &[f64]) -> PyResult<()> {
        let Some(k) = entries.iter().position(|x| !(*x >= 0.0 && x.is_finite())) else {
            return Ok(());
        };
        let name = &self.coordinate_list()[k].name;
        Err(plan_error(format!(
            "tube: entry of {name} is {} (expected at least 0)",
            entries[k]
        )))
    }

    /// Returns the tube around a curve.
    fn tube(&self, tube: Option<&Bound<'_, PyAny>>) -> PyResult<Option<JointTube>> {
        let Some(tube) = tube else { return Ok(None) };
        if !tube.is_instance_of::<JointCurve>()
            && let Some(found) = self.constant_tube(tube)?
        {
            return Ok(Some(found));
        }
        self.tube_along(curve_of(tube)?).map(Some)
    }

    /// Returns the tubes around curves: none, or one for each.
    pub(super) fn tubes(&self, tube: Option<&Bound<'_, PyAny>>, count: usize) -> PyResult<Vec<JointTube>> {
        let Some(tube) = tube else { return Ok(Vec::new()) };
        let is_curves = tube.try_iter().is_ok_and(|mut items| {
            let first = items.next().and_then(Result::ok);
            first.is_some_and(|item| item.is_instance_of::<JointCurve>())
        });
        if !is_curves && let Some(found) = self.constant_tube(tube)? {
            return Ok(vec![found; count]);
        }
        let curves = curves_of(tube)?;
        if curves.len() != count {
            let found = curves.len();
            return Err(plan_error(format!(
                "tube: number of curves is {found} (expected {count}, one for each curve)"
            )));
        }
        curves.into_iter().map(|curve| self.tube_along(curve)).collect()
    }

    /// Returns the tubes around the segments of a trajectory: those that are given, or its own.
    fn trajectory_tubes(
        &self,
        tube: Option<&Bound<'_, PyAny>>,
        trajectory: &Trajectory,
        count: usize,
    ) -> PyResult<Vec<JointTube>> {
        let rows = match tube {
            None => trajectory.tube_in_order(self.coordinate_list())?,
            Some(tube) => match self.constant_tube(tube)? {
                Some(found) => return Ok(vec![found; count]),
                None => table(tube, TUBE)?,
            },
        };
        if rows.is_empty() {
            return Ok(Vec::new());
        }
        let points = trajectory.len();
        if rows.len() != points {
            let found = rows.len();
            return Err(plan_error(format!(
                "tube: number of rows is {found} (expected {points}, one for each point)"
            )));
        }
        let ends = |k: usize| Curve::bezier(&[&rows[k], &rows[(k + 1).min(points - 1)]]).map_err(plan_error);
        (0..count).map(|k| self.tube_along(ends(k)?)).collect()
    }

    /// Returns an error about a motion, with the name of the joint that exceeds its limits.
    fn motion_fault(&self, what: &str, error: &PlanError, at: impl Fn(f64) -> String) -> PyErr {
        let PlanError::CurveLimit {
            coordinate,
            time,
            value,
        } = *error
        else {
            return plan_error(format!("{what}: {}", named(error, self.coordinate_list())));
        };
        let Coordinate { name, limits, .. } = &self.coordinate_list()[coordinate];
        let ([low, high], at) = (limits, at(time));
        plan_error(format!(
            "{what}: {name} exceeds its limits {low} and {high} at {at}: {value}"
        ))
    }

    fn curve_fault(&self, error: &PlanError) -> PyErr {
        self.motion_fault("curve", error, |t| format!("t = {t}"))
    }

    /// Returns an error about a curve of many.
    pub(super) fn numbered_fault(&self, k: usize, error: &PlanError) -> PyErr {
        self.motion_fault(&format!("curve {k}"), error, |t| format!("t = {t}"))
    }

    /// Returns the first verdict that is not free, on the curves as one motion. Ctrl-C ends the call.
    /// `fault` makes the error of a curve.
    fn judge_all(
        &mut self,
        py: Python<'_>,
        curves: &[Curve],
        tubes: &[JointTube],
        progress: Option<&Bound<'_, PyAny>>,
        fault: impl Fn(&Self, usize, &PlanError) -> PyErr + Sync + Send,
    ) -> PyResult<Judged> {
        JointMotion::spline(curves).map_err(|error| match error {
            PlanError::Empty => plan_error("spline has no curve (expected at least one)"),
            error => plan_error(error),
        })?;
        let mut all: Option<Certified> = None;
        let run = Run::new(py, curves.len(), 1, progress)?;
        run.steps(py, curves.len(), |k| {
            let motion = in_tube(&curves[k], tubes.get(k));
            let found = motion.and_then(|motion| self.checker.certify_with(&motion, CertifyOptions::default()));
            let found = found.map_err(|e| fault(self, k, &e))?;
            let is_free = found.verdict.is_free();
            all = Some(match all.take() {
                Some(before) => before.followed_by(found),
                None => found,
            });
            Ok(is_free)
        })?;
        all.map(|all| all.verdict)
            .ok_or_else(|| plan_error("spline has no curve (expected at least one)"))
    }

    /// Returns the certificates of a motion as a structured array, if it is free.
    fn proof<'py>(
        &mut self,
        py: Python<'py>,
        motion: &JointMotion,
        fault: impl Fn(&Self, &PlanError) -> PyErr,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let found = py.detach(|| {
            let options = CertifyOptions::default().certificates(true);
            self.checker.certify_with(motion, options)
        });
        let mut found = found.map_err(|e| fault(self, &e))?;
        let is_free = found.verdict.is_free();
        let proofs = found.proofs.pop().filter(|_| is_free);
        proofs.map(|proofs| self.certificates(py, &proofs)).transpose()
    }

    /// Returns the certificates of all pairs as a structured array.
    fn certificates<'py>(&self, py: Python<'py>, proofs: &[PairProof]) -> PyResult<Bound<'py, PyAny>> {
        let numbers = Numbers::new(&self.checker);
        let each = || {
            proofs
                .iter()
                .flat_map(|of| of.certificates.iter().map(move |c| (of.pair, c)))
        };
        let bodies = |second: bool| {
            let ids = each().map(|(pair, _)| numbers.of(if second { pair.b } else { pair.a }));
            PyArray1::from_vec(py, ids.collect()).into_any()
        };
        let number = |of: fn(&lin_canny::impact::Certificate) -> f64| {
            PyArray1::from_vec(py, each().map(|(_, c)| of(c)).collect()).into_any()
        };
        let planes = each().map(|(_, c)| match c.proof {
            Proof::Plane { normal, spin } => (normal.into(), spin.into()),
            _ => ([0.0; 3], [0.0; 3]),
        });
        let (normals, spins): (Vec<[f64; 3]>, Vec<[f64; 3]>) = planes.unzip();
        let columns = vec![
            (("a", "i4", None), bodies(false)),
            (("b", "i4", None), bodies(true)),
            (("start", "f8", None), number(|c| c.from)),
            (("end", "f8", None), number(|c| c.until)),
            (("distance", "f8", None), number(|c| c.distance)),
            (("normal", "f8", Some(3)), of_triples(py, normals.clone())?.into_any()),
            (("spin", "f8", Some(3)), of_triples(py, spins)?.into_any()),
        ];
        filled(py, normals.len(), columns)
    }
}

/// Returns the motion along a curve, with a tube if it has one.
pub(super) fn in_tube(curve: &Curve, tube: Option<&JointTube>) -> Result<JointMotion, PlanError> {
    let motion = JointMotion::curve(curve);
    match tube {
        Some(tube) => motion.with_tube(tube),
        None => Ok(motion),
    }
}

#[pymethods]
impl Checker {
    /// Returns the verdict on a curve, over its whole length.
    ///
    /// The verdict is free, blocked by a pair at a time, or undecided.
    ///
    /// Parameters
    /// ----------
    /// curve : JointCurve or array_like, shape (degree + 1, dof)
    ///     A curve, or the control points of a Bézier curve.
    /// tube : float, array_like of shape (dof,), or JointCurve, optional
    ///     How much each coordinate may deviate from the curve at every time, such as the tracking
    ///     error of a controller: numbers, or a curve of them (or its control points), none of them
    ///     negative. Everything inside the tube is then proven. "blocked" means that a
    ///     pair comes closer on the curve than its margin plus a bound of what the tube moves;
    ///     a free motion may still exist. `start_contact_margin` does not act.
    ///
    /// Raises
    /// ------
    /// PlanError
    ///     If a coordinate leaves its limits between its control points (names the joint and the
    ///     time), or if a coordinate of a rotation has a degree above 1.
    #[pyo3(signature = (curve, *, tube=None))]
    fn certify_curve(
        &mut self,
        py: Python<'_>,
        curve: &Bound<'_, PyAny>,
        tube: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Verdict> {
        let (curve, tube) = (curve_of(curve)?, self.tube(tube)?);
        let motion = in_tube(&curve, tube.as_ref()).map_err(|e| self.curve_fault(&e))?;
        let found = py.detach(|| self.checker.certify(&motion));
        let found = found.map_err(|e| self.curve_fault(&e))?;
        Ok(Verdict::new(found, &self.checker))
    }

    /// Returns the verdict on a spline: curves, each of which starts where the one before ends.
    ///
    /// It is free, or the verdict on the first curve that is not free; `segment` is its index.
    /// Ctrl-C ends the call.
    ///
    /// Parameters
    /// ----------
    /// curves : sequence of JointCurve, or array_like of shape (N, degree + 1, dof)
    /// tube : float, array_like of shape (dof,), or sequence of JointCurve, optional
    ///     See `certify_curve`; of a sequence, one for each curve.
    /// progress : callable or bool, optional
    ///     A callable that receives the number of certified curves and of all, or True for a tqdm
    ///     bar.
    #[pyo3(signature = (curves, *, tube=None, progress=None))]
    fn certify_spline(
        &mut self,
        py: Python<'_>,
        curves: &Bound<'_, PyAny>,
        tube: Option<&Bound<'_, PyAny>>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Verdict> {
        let curves = curves_of(curves)?;
        let tubes = self.tubes(tube, curves.len())?;
        let verdict = self.judge_all(py, &curves, &tubes, progress, Self::numbered_fault)?;
        Ok(Verdict::new(verdict, &self.checker))
    }

    /// Returns the verdict on a trajectory, over all its times.
    ///
    /// It is free, or the verdict on the motion after the first point, `segment`, after which it is
    /// not free; `free_until_time` and `contact_time` are times of the trajectory. The columns may be in
    /// any order if the trajectory has names. Moving obstacles are where they are at these times:
    /// see `add_moving_obstacle`. Ctrl-C ends the call.
    ///
    /// Parameters
    /// ----------
    /// trajectory : Trajectory
    /// tube : float, or array_like of shape (dof,) or (N, dof), optional
    ///     See `certify_curve`. N rows are those of the N points, and linear between them. By
    ///     default the `tube` of the trajectory.
    /// progress : callable or bool, optional
    ///     As for `certify_spline`.
    ///
    /// Raises
    /// ------
    /// PlanError
    ///     If a joint is unknown or missing, or leaves its limits (names the joint and the time).
    #[pyo3(signature = (trajectory, *, tube=None, progress=None))]
    fn certify_trajectory(
        &mut self,
        py: Python<'_>,
        trajectory: &Bound<'_, Trajectory>,
        tube: Option<&Bound<'_, PyAny>>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Verdict> {
        let trajectory = trajectory.get();
        let curves = trajectory.curves_in_order(self.coordinate_list())?;
        let tubes = self.trajectory_tubes(tube, trajectory, curves.len())?;
        let last = curves.len() - 1;
        let fault = |checker: &Self, k: usize, error: &PlanError| {
            let what = format!("trajectory, points {k} to {}", k + 1);
            checker.motion_fault(&what, error, |t| format!("time {}", trajectory.time_at(k, t)))
        };
        let verdict = self.judge_all(py, &curves, &tubes, progress, fault)?;
        // A free verdict is about the end of the last segment.
        let timed = verdict.piece().unwrap_or(last);
        let verdict = Verdict::new(verdict, &self.checker);
        Ok(verdict.with_times(|t| trajectory.time_at(timed, t)))
    }

    /// Returns the proof that the straight segment between two configurations is free.
    ///
    /// Returns None if the segment is not proven free; see `prove_curve`.
    fn prove<'py>(
        &mut self,
        py: Python<'py>,
        start: &Bound<'py, PyAny>,
        goal: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let ends = [configuration(start)?, configuration(goal)?];
        self.proof(py, &JointMotion::segment(&ends[0], &ends[1]), Self::fault)
    }

    /// Returns the proof that a curve is free: the certificates of all pairs, in order of time.
    ///
    /// Returns None if the curve is not proven free. Times are those of the curve, 0 to 1. The
    /// certificates of a pair cover all of them.
    ///
    /// Parameters
    /// ----------
    /// curve : JointCurve or array_like, shape (degree + 1, dof)
    ///
    /// Returns
    /// -------
    /// numpy.ndarray or None
    ///     A structured array with the fields `a` and `b`, indices of `bodies`; `start` and `end`, the
    ///     times between which the pair is proven more than `distance` apart; `normal` and `spin`
    ///     of shape (3,), in the world: a plane with the normal `normal` at `start`, which rotates
    ///     by the rotation vector `spin * (t - start)`, is between both bodies. Both are zero if
    ///     balls around the bodies, or another bound, prove it; so they are for a curve that is
    ///     proven only as the straight segment on which it stays (see `prove`).
    fn prove_curve<'py>(&mut self, py: Python<'py>, curve: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let curve = curve_of(curve)?;
        self.proof(py, &JointMotion::curve(&curve), Self::curve_fault)
    }

    /// Returns the least clearance along a curve: see `clearance_along`.
    ///
    /// curve: a JointCurve, or control points of shape (degree + 1, dof).
    #[pyo3(signature = (curve, *, relative=1e-3))]
    fn clearance_along_curve(
        &mut self,
        py: Python<'_>,
        curve: &Bound<'_, PyAny>,
        relative: f64,
    ) -> PyResult<(f64, f64, f64, Option<Pair>)> {
        let curve = curve_of(curve)?;
        let found = py.detach(|| self.checker.clearance_along(&JointMotion::curve(&curve), relative));
        let found = found.map_err(|e| self.curve_fault(&e))?;
        let pair = found.pair.map(|pair| answers::names(&self.checker, pair));
        Ok((found.lower, found.upper, found.t, pair))
    }
}
