//! Receipts: proofs as texts that `verify.py` checks.

use lin_canny::RelativePose;
use lin_canny::impact::Tolerance;
use lin_canny::nalgebra::Isometry3;
use lin_canny_robot::plan::JointMotion;
use lin_canny_robot::plan::receipt::{Receipt, ReceiptError};
use pyo3::prelude::*;

use crate::checker::Checker;
use crate::curve::{curve_of, curves_of};
use crate::errors::{motion_error, pair_error, plan_error, pose_error};
use crate::geometry::Geometry;
use crate::pose::Pose;
use crate::tracker::PairTracker;
use crate::tracker::cast::motion;

#[pymethods]
impl Checker {
    /// Returns the receipt of a curve, as a text: see `receipt`.
    ///
    /// The receipt is about the control points, which are rounded if the curve was given in another
    /// form.
    ///
    /// Parameters
    /// ----------
    /// curve : JointCurve, or array_like of shape (degree + 1, dof)
    fn receipt_curve(&mut self, py: Python<'_>, curve: &Bound<'_, PyAny>) -> PyResult<String> {
        let curve = curve_of(curve)?;
        let written = py.detach(|| Receipt::motion(&mut self.checker, &JointMotion::curve(&curve)));
        Ok(written.map_err(plan_error)?.to_string())
    }

    /// Returns the receipt of a spline that is free, as a text: see `receipt_curve`.
    ///
    /// Each curve starts where the one before ends.
    ///
    /// Parameters
    /// ----------
    /// curves : sequence of JointCurve, or array_like of shape (N, degree + 1, dof)
    fn receipt_spline(&mut self, py: Python<'_>, curves: &Bound<'_, PyAny>) -> PyResult<String> {
        let curves = curves_of(curves)?;
        let motion = JointMotion::spline(&curves).map_err(plan_error)?;
        let written = py.detach(|| Receipt::motion(&mut self.checker, &motion));
        Ok(written.map_err(plan_error)?.to_string())
    }
}

fn at(pose: Option<Pose>) -> Isometry3<f64> {
    pose.map_or_else(Isometry3::identity, |pose| pose.0)
}

#[pymethods]
impl PairTracker {
    /// Returns the receipt of the distance of two geometries, or of their overlap, as a text.
    ///
    /// It proves both bounds of the distance, or a common point. The distance of a closed mesh is that
    /// of its surface. `names` are the names of both bodies. Write the text to a file without changing
    /// line ends, and check it with `lin-canny verify FILE` or `python3 verify.py FILE`.
    ///
    /// Raises PairError if a geometry has no receipt, or if no evidence is certain, for example
    /// because the bodies touch.
    #[pyo3(signature = (a, b, pose_a=None, pose_b=None, *, names=("a".to_owned(), "b".to_owned())))]
    fn receipt(
        &mut self,
        a: &Bound<'_, Geometry>,
        b: &Bound<'_, Geometry>,
        pose_a: Option<Pose>,
        pose_b: Option<Pose>,
        names: (String, String),
    ) -> PyResult<String> {
        let b_in_a = at(pose_a).inverse() * at(pose_b);
        let pose = RelativePose::from_isometry(&b_in_a).map_err(pose_error)?;
        let (a, b) = (&a.get().0, &b.get().0);
        let outcome = self.tracker.closest(a, b, &pose).outcome;
        let written = Receipt::outcome([(&names.0, a), (&names.1, b)], &b_in_a, &outcome);
        Ok(written.map_err(pair_error)?.to_string())
    }

    /// Returns the receipt of a cast, as a text: a miss, or that the geometries are apart up to a time
    /// and in contact at a later one.
    ///
    /// For the parameters see `cast` and `receipt`.
    ///
    /// Raises MotionError if the cast is invalid, and PairError if a geometry has no receipt, or if no
    /// evidence is certain.
    #[pyo3(signature = (
        a, b, pose_a=None, pose_b=None, *, velocity_a=None, velocity_b=None, duration, tolerance, distance=0.0,
        names=("a".to_owned(), "b".to_owned())
    ))]
    #[allow(clippy::too_many_arguments)] // the signature in Python
    fn cast_receipt<'py>(
        &mut self,
        py: Python<'py>,
        a: &Bound<'py, Geometry>,
        b: &Bound<'py, Geometry>,
        pose_a: Option<Pose>,
        pose_b: Option<Pose>,
        velocity_a: Option<(Bound<'py, PyAny>, Bound<'py, PyAny>)>,
        velocity_b: Option<(Bound<'py, PyAny>, Bound<'py, PyAny>)>,
        duration: f64,
        tolerance: f64,
        distance: f64,
        names: (String, String),
    ) -> PyResult<String> {
        let motions = [motion(pose_a, velocity_a)?, motion(pose_b, velocity_b)?];
        let (a, b) = (&a.get().0, &b.get().0);
        let written = py.detach(|| {
            let (bodies, [from, to]) = ([(names.0.as_str(), a), (names.1.as_str(), b)], &motions);
            let tolerance = Tolerance::Distance(tolerance);
            Receipt::cast(bodies, [from, to], 0.0..duration, tolerance, distance)
        });
        let written = written.map_err(|error| match error {
            ReceiptError::Impact(error) => motion_error(error),
            error => pair_error(error),
        });
        Ok(written?.to_string())
    }
}
