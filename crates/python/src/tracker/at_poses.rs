//! Distances at many poses.

use lin_canny::{ConvexPolyhedron, Distance, PairTracker, RelativePose, Tracker};
use pyo3::prelude::*;

use super::bodies::{Bodies, BodiesView};
use crate::array::structured;
use crate::batch::{Batch, Run};
use crate::errors::pose_error;
use crate::pose::{PoseView, Poses};

/// A row of the answer: distance, lower and upper bound.
type Row = [f64; 3];

/// Distances of two geometries at many poses.
struct Distances<'a> {
    a: BodiesView<'a>,
    b: BodiesView<'a>,
    poses: PoseView<'a>,
}

impl Distances<'_> {
    /// Returns the pair of all poses if it is one of polyhedra.
    fn polyhedra(&self) -> Option<[&ConvexPolyhedron; 2]> {
        Some([self.a.one()?.as_polyhedron()?, self.b.one()?.as_polyhedron()?])
    }
}

/// The tracker of a block, and its poses. All poses are converted before the first query, so that
/// their arithmetic overlaps.
struct Block {
    tracker: AnyTracker,
    poses: Vec<RelativePose>,
}

/// The tracker of polyhedra saves the choice of a tracker in every query.
enum AnyTracker {
    Polyhedra(Box<Tracker>),
    Pair(Box<PairTracker>),
}

fn row(d: Distance) -> Row {
    [d.value, d.lower, d.upper]
}

impl Batch for Distances<'_> {
    type State = Block;
    type Row = Row;

    fn start(&self) -> PyResult<Block> {
        let tracker = match self.polyhedra() {
            Some(_) => AnyTracker::Polyhedra(Box::default()),
            None => AnyTracker::Pair(Box::default()),
        };
        let poses = Vec::with_capacity(Self::CLOCK_STRIDE);
        Ok(Block { tracker, poses })
    }

    fn answer(&self, block: &mut Block, first: usize, rows: &mut [Row]) -> PyResult<()> {
        let read = self.poses.read(first..first + rows.len(), &mut block.poses);
        read.map_err(|k| pose_error(self.poses.fault(k)))?;
        let each = rows.iter_mut().zip(&block.poses);
        match (&mut block.tracker, self.polyhedra()) {
            (AnyTracker::Polyhedra(tracker), Some([a, b])) => {
                each.for_each(|(to, pose)| *to = row(tracker.distance(a, b, pose)));
            }
            (AnyTracker::Pair(tracker), _) => {
                let each = (first..).zip(each);
                each.for_each(|(k, (to, pose))| *to = row(tracker.distance(self.a.at(k), self.b.at(k), pose)));
            }
            _ => {}
        }
        Ok(())
    }
}

/// Returns the signed distances of two geometries at many poses of B in the frame of A.
///
/// a, b: a Geometry, or a sequence of N of them, one for each pose.
///
/// The result is a structured array of shape (N,) with the fields `distance`, `lower` and `upper`.
/// It has the same bits for any number of threads. Ctrl-C ends the call.
///
/// poses: shape (N, 4, 4), or (N, 7) with position and quaternion xyzw, or a tuple of positions (N,
/// 3) and quaternions (N, 4) or a scipy Rotation. progress: a callable that receives the number of
/// finished poses and of all poses about twenty times per second, or True for a tqdm bar.
#[pyfunction]
#[pyo3(signature = (a, b, poses, *, threads=1, progress=None))]
pub(crate) fn distances<'py>(
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
    let batch = Distances {
        a: a.view(),
        b: b.view(),
        poses: view,
    };
    let mut rows = vec![[0.0; 3]; batch.poses.len()];
    Run::new(py, rows.len(), threads, progress)?.rows(py, &batch, &mut rows)?;
    structured(
        py,
        rows,
        &[("distance", "f8", 1), ("lower", "f8", 1), ("upper", "f8", 1)],
    )
}

/// Returns the seconds of thread CPU time of the Rust loop over converted poses, and the sum of all
/// distances.
#[cfg(feature = "bench")]
#[pyfunction]
#[pyo3(name = "_rust_loop")]
pub(crate) fn rust_loop(
    py: Python<'_>,
    a: &Bound<'_, crate::geometry::Geometry>,
    b: &Bound<'_, crate::geometry::Geometry>,
    poses: &Bound<'_, PyAny>,
) -> PyResult<(f64, f64)> {
    let poses = Poses::new(poses)?;
    let view = poses.view()?;
    let (Some(a), Some(b)) = (a.get().0.as_polyhedron(), b.get().0.as_polyhedron()) else {
        return Err(pose_error("the loop takes polyhedra only"));
    };
    py.detach(|| {
        let isometries: Option<Vec<_>> = (0..view.len()).map(|k| view.isometry(k)).collect();
        let isometries = isometries.ok_or_else(|| pose_error("a pose is not a rigid motion"))?;
        let mut rows = vec![[0.0; 3]; isometries.len()];
        let mut tracker = Tracker::new();
        let start = cpu_time::ThreadTime::now();
        for (to, pose) in rows.iter_mut().zip(&isometries) {
            let pose = RelativePose::from_isometry(pose).map_err(pose_error)?;
            *to = row(tracker.distance(a, b, &pose));
        }
        let seconds = start.elapsed().as_secs_f64();
        Ok((seconds, rows.iter().map(|row| row[0]).sum()))
    })
}
