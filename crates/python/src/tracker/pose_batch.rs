//! Closest points, contacts, depths and common volumes at many poses.

use lin_canny::nalgebra::Point3;
use lin_canny::{Geometry as Body, ManifoldOptions, PairOutcome, PairTracker, QueryOptions, RelativePose};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use super::bodies::{Bodies, BodiesView};
use super::closest::gradients;
use super::contacts::{FIELDS, Row as Contact, depth_options, manifold_options, row};
use crate::array::{filled, of_triples, structured, words};
use crate::batch::{Batch, Run};
use crate::errors::{pair_error, pose_error};
use crate::pose::{PoseView, Poses};

/// Two geometries, or two for each pose, and poses of B in the frame of A.
struct Pair<'a> {
    a: BodiesView<'a>,
    b: BodiesView<'a>,
    poses: PoseView<'a>,
}

impl<'a> Pair<'a> {
    fn new(a: &'a Bodies<'_>, b: &'a Bodies<'_>, poses: PoseView<'a>) -> Self {
        let (a, b) = (a.view(), b.view());
        Self { a, b, poses }
    }

    fn pose(&self, k: usize) -> PyResult<RelativePose> {
        let pose = self.poses.isometry(k);
        let pose = pose.and_then(|pose| RelativePose::from_isometry(&pose).ok());
        pose.ok_or_else(|| pose_error(self.poses.fault(k)))
    }

    /// Answers some poses one after another.
    fn each<T>(
        &self,
        first: usize,
        rows: &mut [T],
        mut answer: impl FnMut(&Body, &Body, &RelativePose) -> PyResult<T>,
    ) -> PyResult<()> {
        for (k, to) in (first..).zip(rows) {
            *to = answer(self.a.at(k), self.b.at(k), &self.pose(k)?)?;
        }
        Ok(())
    }
}

struct ClosestPoints<'a>(Pair<'a>);

impl Batch for ClosestPoints<'_> {
    type State = PairTracker;
    type Row = Option<PairOutcome>;

    fn start(&self) -> PyResult<PairTracker> {
        Ok(PairTracker::new())
    }

    fn answer(&self, tracker: &mut PairTracker, first: usize, rows: &mut [Self::Row]) -> PyResult<()> {
        self.0
            .each(first, rows, |a, b, pose| Ok(Some(tracker.closest(a, b, pose))))
    }
}

struct Contacts<'a>(Pair<'a>, ManifoldOptions);

impl Batch for Contacts<'_> {
    type State = PairTracker;
    type Row = Vec<Contact>;

    fn start(&self) -> PyResult<PairTracker> {
        Ok(PairTracker::new())
    }

    fn answer(&self, tracker: &mut PairTracker, first: usize, rows: &mut [Self::Row]) -> PyResult<()> {
        self.0.each(first, rows, |a, b, pose| {
            let groups = tracker.contacts(a, b, pose, &self.1).map_err(pair_error)?;
            let groups = groups.iter().enumerate();
            Ok(groups
                .flat_map(|(k, group)| group.contacts.iter().map(move |c| row(c, k, pose)))
                .collect())
        })
    }
}

struct Depths<'a>(Pair<'a>, QueryOptions);

impl Batch for Depths<'_> {
    type State = PairTracker;
    type Row = [f64; 5];
    const CLOCK_STRIDE: usize = 4;

    fn start(&self) -> PyResult<PairTracker> {
        Ok(PairTracker::new())
    }

    fn answer(&self, tracker: &mut PairTracker, first: usize, rows: &mut [Self::Row]) -> PyResult<()> {
        self.0.each(first, rows, |a, b, pose| {
            let found = tracker.penetration_with(a, b, pose, &self.1);
            Ok(found.map_or([f64::NAN; 5], |bounds| {
                let [x, y, z] = (pose.poses().0.rotation * bounds.shift).into();
                [bounds.lower, bounds.upper, x, y, z]
            }))
        })
    }
}

struct Volumes<'a>(Pair<'a>);

impl Batch for Volumes<'_> {
    type State = PairTracker;
    type Row = [f64; 6];
    const CLOCK_STRIDE: usize = 4;

    fn start(&self) -> PyResult<PairTracker> {
        Ok(PairTracker::new())
    }

    fn answer(&self, tracker: &mut PairTracker, first: usize, rows: &mut [Self::Row]) -> PyResult<()> {
        self.0.each(first, rows, |a, b, pose| {
            let found = tracker.overlap(a, b, pose).map_err(pair_error)?;
            let place = |p: Point3<f64>| (pose.poses().0 * p).coords.into();
            let [x, y, z] = found.centroid.map_or([f64::NAN; 3], place);
            Ok([
                found.lower,
                found.upper,
                x,
                y,
                z,
                f64::from(u8::from(found.covers_itself)),
            ])
        })
    }
}

/// Returns the closest points of two geometries at many poses of B in the frame of A.
///
/// Row i has the bits of `PairTracker.closest(a, b, None, poses[i])` in a loop over the poses, with
/// a new tracker every 1024 poses, for any number of threads. Ctrl-C ends the call.
///
/// Parameters
/// ----------
/// a, b : Geometry, or a sequence of N of them
///     The pair of all poses, or one for each pose.
/// poses : array_like
///     As for `distances`.
/// threads : int
/// progress : callable or bool, optional
///     As for `distances`.
///
/// Returns
/// -------
/// numpy.ndarray, shape (N,)
///     A structured array with the fields `distance`, `lower`, `upper`, `state`, `features`, `parts`
///     of shape (2,), `point_a`, `point_b` and `normal` of shape (3,), and `gradient_a` and
///     `gradient_b` of shape (6,), in the frame of A. See Closest.
#[pyfunction]
#[pyo3(signature = (a, b, poses, *, threads=1, progress=None))]
pub(crate) fn closest_batch<'py>(
    py: Python<'py>,
    a: &Bound<'py, PyAny>,
    b: &Bound<'py, PyAny>,
    poses: &Bound<'py, PyAny>,
    threads: usize,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let poses = Poses::new(poses)?;
    let view = poses.view()?;
    let [a, b] = [Bodies::new("a", a, view.len())?, Bodies::new("b", b, view.len())?];
    let mut rows = vec![None; view.len()];
    let batch = ClosestPoints(Pair::new(&a, &b, view));
    Run::new(py, rows.len(), threads, progress)?.rows(py, &batch, &mut rows)?;
    let found: Vec<PairOutcome> = rows.into_iter().flatten().collect();
    let number = |of: fn(&PairOutcome) -> f64| PyArray1::from_iter(py, found.iter().map(of)).into_any();
    let parts = found.iter().flat_map(|o| o.locations.map(|at| i64::from(at.subshape)));
    let parts = PyArray1::from_iter(py, parts).reshape([found.len(), 2])?;
    let (mut points_b, mut turns) = (Vec::new(), [Vec::new(), Vec::new()]);
    for (k, o) in found.iter().enumerate() {
        let pose = batch.0.pose(k)?;
        points_b.push((pose.poses().1 * o.point_on_b).into());
        turns
            .iter_mut()
            .zip(gradients(o, &pose))
            .for_each(|(to, row)| to.extend(row));
    }
    let [gradient_a, gradient_b] = turns.map(|rows| PyArray1::from_vec(py, rows).reshape([found.len(), 6]));
    let vector = |of: fn(&PairOutcome) -> [f64; 3]| of_triples(py, found.iter().map(of).collect()).map(Bound::into_any);
    let columns = vec![
        (("distance", "f8", None), number(|o| o.distance)),
        (("lower", "f8", None), number(|o| o.lower)),
        (("upper", "f8", None), number(|o| o.upper)),
        (
            ("state", "U11", None),
            words::<11>(py, found.iter().map(|o| o.state.name()))?,
        ),
        (
            ("features", "U24", None),
            words::<24>(py, found.iter().map(|o| o.features.to_string()))?,
        ),
        (("parts", "i8", Some(2)), parts.into_any()),
        (("point_a", "f8", Some(3)), vector(|o| o.point_on_a.into())?),
        (("point_b", "f8", Some(3)), of_triples(py, points_b)?.into_any()),
        (("normal", "f8", Some(3)), vector(|o| (*o.normal).into())?),
        (("gradient_a", "f8", Some(6)), gradient_a?.into_any()),
        (("gradient_b", "f8", Some(6)), gradient_b?.into_any()),
    ];
    filled(py, found.len(), columns)
}

/// Returns the contact points of two geometries at many poses of B in the frame of A.
///
/// The contacts of a pose have the bits of `PairTracker.contacts(a, b, None, poses[i])` in a loop
/// over the poses, with a new tracker every 1024 poses, for any number of threads. Ctrl-C ends the
/// call.
///
/// The result is a tuple. The first array has the contacts of all poses, one pose after another,
/// with the fields of `PairTracker.contacts`, in the frame of A. The second, of shape (N + 1,), has
/// the index of the first contact of each pose: those of pose i are
/// `contacts[first[i]:first[i + 1]]`. For the parameters see `distances` and `PairTracker.contacts`.
#[pyfunction]
#[pyo3(signature = (a, b, poses, *, prediction=0.0, max_points=4, threads=1, progress=None))]
#[allow(clippy::too_many_arguments)] // the signature in Python
pub(crate) fn contacts_batch<'py>(
    py: Python<'py>,
    a: &Bound<'py, PyAny>,
    b: &Bound<'py, PyAny>,
    poses: &Bound<'py, PyAny>,
    prediction: f64,
    max_points: usize,
    threads: usize,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyArray1<i64>>)> {
    let options = manifold_options(prediction, max_points)?;
    let poses = Poses::new(poses)?;
    let view = poses.view()?;
    let [a, b] = [Bodies::new("a", a, view.len())?, Bodies::new("b", b, view.len())?];
    let mut rows = vec![Vec::new(); view.len()];
    let batch = Contacts(Pair::new(&a, &b, view), options);
    Run::new(py, rows.len(), threads, progress)?.rows(py, &batch, &mut rows)?;
    let counted = rows.iter().scan(0, |sum, row| {
        *sum += row.len() as i64;
        Some(*sum)
    });
    let first = PyArray1::from_iter(py, std::iter::once(0).chain(counted));
    Ok((structured(py, rows.concat(), &FIELDS)?, first))
}

/// Returns bounds of the penetration depth of two solids at many poses of B in the frame of A.
///
/// Row i has the bits of `PairTracker.penetration(a, b, None, poses[i])` in a loop over the poses,
/// with a new tracker every 1024 poses, for any number of threads. Ctrl-C ends the call.
///
/// The result is a structured array of shape (N,) with the fields `lower`, `upper`, and `shift` of
/// shape (3,), in the frame of A. All are NaN if one of the geometries has no inside. For the
/// parameters see `distances` and `PairTracker.penetration`; an interval that stays wider than
/// `tolerance` is returned as it is.
#[pyfunction]
#[pyo3(signature = (a, b, poses, *, tolerance=None, budget=None, threads=1, progress=None))]
#[allow(clippy::too_many_arguments)] // the signature in Python
pub(crate) fn penetration_batch<'py>(
    py: Python<'py>,
    a: &Bound<'py, PyAny>,
    b: &Bound<'py, PyAny>,
    poses: &Bound<'py, PyAny>,
    tolerance: Option<f64>,
    budget: Option<usize>,
    threads: usize,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let options = depth_options(tolerance, budget)?;
    let poses = Poses::new(poses)?;
    let view = poses.view()?;
    let [a, b] = [Bodies::new("a", a, view.len())?, Bodies::new("b", b, view.len())?];
    let mut rows = vec![[0.0; 5]; view.len()];
    let batch = Depths(Pair::new(&a, &b, view), options);
    Run::new(py, rows.len(), threads, progress)?.rows(py, &batch, &mut rows)?;
    structured(py, rows, &[("lower", "f8", 1), ("upper", "f8", 1), ("shift", "f8", 3)])
}

/// Returns bounds of the volume that two solids share at many poses of B in the frame of A.
///
/// Row i has the bits of `PairTracker.overlap(a, b, None, poses[i])`. The result is a structured array
/// of shape (N,) with the fields `lower`, `upper`, `centroid` of shape (3,), in the frame of A (NaN
/// unless the volume is certainly positive), and `covers_itself`. For the parameters see `distances`.
#[pyfunction]
#[pyo3(signature = (a, b, poses, *, threads=1, progress=None))]
pub(crate) fn overlap_batch<'py>(
    py: Python<'py>,
    a: &Bound<'py, PyAny>,
    b: &Bound<'py, PyAny>,
    poses: &Bound<'py, PyAny>,
    threads: usize,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let poses = Poses::new(poses)?;
    let view = poses.view()?;
    let [a, b] = [Bodies::new("a", a, view.len())?, Bodies::new("b", b, view.len())?];
    let mut rows = vec![[0.0; 6]; view.len()];
    let batch = Volumes(Pair::new(&a, &b, view));
    Run::new(py, rows.len(), threads, progress)?.rows(py, &batch, &mut rows)?;
    let fields = [
        ("lower", "f8", 1),
        ("upper", "f8", 1),
        ("centroid", "f8", 3),
        ("covers_itself", "?", 1),
    ];
    structured(py, rows, &fields)
}
