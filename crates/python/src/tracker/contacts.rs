//! Contact points, and the depth of solids of any kind.

use lin_canny::{ManifoldOptions, PatchContact, PenetrationBounds, QueryOptions, RelativePose};
use numpy::PyArray1;
use pyo3::prelude::*;

use super::PairTracker;
use crate::array::{Field, structured, triple};
use crate::errors::{pair_error, refused, undecided_error};
use crate::geometry::Geometry;
use crate::pose::{Pose, relative};

/// Numbers of a contact: two points, normal, separation, group, two patches.
pub(super) type Row = [f64; 13];

/// The fields of a contact.
pub(super) const FIELDS: [Field; 7] = [
    ("point_a", "f8", 3),
    ("point_b", "f8", 3),
    ("normal", "f8", 3),
    ("separation", "f8", 1),
    ("group", "i4", 1),
    ("patch_a", "i4", 1),
    ("patch_b", "i4", 1),
];

/// Returns the options of contacts, or what is wrong with them.
pub(super) fn manifold_options(prediction: f64, max_points: usize) -> PyResult<ManifoldOptions> {
    if !(prediction >= 0.0) || !(1..=8).contains(&max_points) {
        return Err(refused(format!(
            "prediction is {prediction} (expected at least 0), max_points is {max_points} (expected 1 to 8)"
        )));
    }
    Ok(ManifoldOptions::default().prediction(prediction).max_points(max_points))
}

/// Returns the options of a depth, or what is wrong with them.
pub(super) fn depth_options(tolerance: Option<f64>, budget: Option<usize>) -> PyResult<QueryOptions> {
    let mut options = QueryOptions::default();
    if let Some(tolerance) = tolerance {
        if !(tolerance >= 0.0) {
            return Err(refused(format!("tolerance is {tolerance} (expected at least 0)")));
        }
        options = options.width(tolerance);
    }
    options.splits = budget;
    Ok(options)
}

/// Returns the row of a contact, in the world.
pub(super) fn row(contact: &PatchContact, group: usize, pose: &RelativePose) -> Row {
    let (pose_a, pose_b) = pose.poses();
    let a = pose_a * contact.point.point_on_a;
    let b = pose_b * contact.point.point_on_b;
    let n = pose_a.rotation * *contact.normal;
    let [patch_a, patch_b] = contact.patches.map(f64::from);
    [
        a.x,
        a.y,
        a.z,
        b.x,
        b.y,
        b.z,
        n.x,
        n.y,
        n.z,
        contact.point.separation,
        group as f64,
        patch_a,
        patch_b,
    ]
}

/// Bounds of the penetration depth of two solids.
///
/// The depth is the length of the shortest translation of B after which they share no inner point.
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct Penetration {
    bounds: PenetrationBounds,
    pose: RelativePose,
}

#[pymethods]
impl Penetration {
    /// Lower bound of the depth.
    #[getter]
    fn lower(&self) -> f64 {
        self.bounds.lower
    }

    /// Upper bound of the depth: the length of `shift`.
    #[getter]
    fn upper(&self) -> f64 {
        self.bounds.upper
    }

    /// A translation of B in the world that separates the solids, shape (3,).
    #[getter]
    fn shift<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        triple(py, (self.pose.poses().0.rotation * self.bounds.shift).into())
    }

    fn __repr__(&self) -> String {
        format!(
            "<Penetration in [{:.15}, {:.15}]>",
            self.bounds.lower, self.bounds.upper
        )
    }
}

#[pymethods]
impl PairTracker {
    /// Returns the contact points that are at most `prediction` apart, a length.
    ///
    /// The result is a structured array with the fields `point_a`, `point_b`, `normal` (each (3,),
    /// in the world), `separation`, `group` (contacts of one direction, the deepest group first),
    /// `patch_a` and `patch_b`.
    ///
    /// max_points: the largest number of points per group, 1 to 8. Raises PairError for Bézier
    /// surfaces.
    #[pyo3(signature = (a, b, pose_a=None, pose_b=None, *, prediction=0.0, max_points=4))]
    #[allow(clippy::too_many_arguments)] // the signature in Python
    fn contacts<'py>(
        &mut self,
        py: Python<'py>,
        a: &Bound<'py, Geometry>,
        b: &Bound<'py, Geometry>,
        pose_a: Option<Pose>,
        pose_b: Option<Pose>,
        prediction: f64,
        max_points: usize,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = manifold_options(prediction, max_points)?;
        let pose = relative(pose_a, pose_b)?;
        let groups = self.tracker.contacts(&a.get().0, &b.get().0, &pose, &options);
        let groups = groups.map_err(pair_error)?.iter().enumerate();
        let rows = groups.flat_map(|(k, group)| group.contacts.iter().map(move |c| row(c, k, &pose)));
        structured(py, rows.collect(), &FIELDS)
    }

    /// Returns bounds of the penetration depth of two solids.
    ///
    /// Returns None if one of them has no inside: an open mesh or a Bézier surface. For two convex
    /// geometries, `closest` returns the depth itself.
    ///
    /// Parameters
    /// ----------
    /// a, b : Geometry
    /// pose_a, pose_b : pose, optional
    /// tolerance : float, optional
    ///     The largest width of the interval, a length. A search over translations narrows the
    ///     interval to it; its work grows with the depth divided by the tolerance. By default
    ///     nothing is narrowed, and the interval may be wide for bodies that interlock.
    /// budget : int, optional
    ///     How many cells of translations the search may split; 1000 by default, and at most 2**20.
    ///
    /// Raises
    /// ------
    /// UndecidedError
    ///     If the interval is still wider than the tolerance at the end of the budget: states it.
    #[pyo3(signature = (a, b, pose_a=None, pose_b=None, *, tolerance=None, budget=None))]
    #[allow(clippy::too_many_arguments)] // the signature in Python
    fn penetration(
        &mut self,
        py: Python<'_>,
        a: &Bound<'_, Geometry>,
        b: &Bound<'_, Geometry>,
        pose_a: Option<Pose>,
        pose_b: Option<Pose>,
        tolerance: Option<f64>,
        budget: Option<usize>,
    ) -> PyResult<Option<Penetration>> {
        let options = depth_options(tolerance, budget)?;
        let pose = relative(pose_a, pose_b)?;
        let (a, b) = (&a.get().0, &b.get().0);
        let found = py.detach(|| self.tracker.penetration_with(a, b, &pose, &options));
        if let (Some(PenetrationBounds { lower, upper, .. }), Some(tolerance)) = (found, tolerance)
            && upper - lower > tolerance
        {
            return Err(undecided_error(format!(
                "the depth is from {lower:.6} to {upper:.6}: wider than the tolerance {tolerance} at the end of the budget"
            )));
        }
        Ok(found.map(|bounds| Penetration { bounds, pose }))
    }
}
