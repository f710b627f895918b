//! The class `Recorder`: recordings of bodies and scenes.

use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;

use lin_canny::nalgebra::Isometry3;
use lin_canny_robot::record::{Recorder as Writer, WriteError};
use pyo3::prelude::*;

use crate::array::{Argument, points};
use crate::errors::{file_error, refused};
use crate::geometry::Geometry;
use crate::pose::Pose;
use crate::scene::Scene;
use crate::tracker::Closest;

const PATH: Argument = Argument {
    name: "a path",
    error: |why| refused(why),
};
const VERTICES: Argument = Argument {
    name: "vertices",
    ..PATH
};

/// Writes a recording: bodies that move, and results of queries, frame by frame.
///
/// The example `page` of `lin-canny-record` makes a page that plays the file, and `lin-canny-rerun`
/// converts it to a file of rerun. Add bodies with `body`; then call for each frame `pose`, `closest`, `path` and `note` as
/// needed, and at last `end_frame`. `scene` writes a step of a Scene as one frame, and
/// `Checker.record` the motion of a robot. As a context manager, a recorder closes its file.
///
/// Raises FileError if the file cannot be written, and LinCannyError for a body that was not added.
///
/// Parameters
/// ----------
/// path : str or PathLike
///     The file, JSON lines; an existing file is replaced.
/// title : str
#[pyclass(module = "lin_canny")]
pub(crate) struct Recorder {
    path: PathBuf,
    /// None after `close`.
    to: Option<Writer<BufWriter<File>>>,
}

#[pymethods]
impl Recorder {
    #[new]
    #[pyo3(signature = (path, title=""))]
    fn new(path: PathBuf, title: &str) -> PyResult<Self> {
        let to = Writer::create(&path, title).map_err(|e| fault(&path, &e))?;
        Ok(Self { path, to: Some(to) })
    }

    /// Adds a body at a pose in the world, and returns its number.
    #[pyo3(signature = (name, geometry, pose=None))]
    fn body(&mut self, name: &str, geometry: &Bound<'_, Geometry>, pose: Option<Pose>) -> PyResult<u32> {
        let pose = pose.map_or_else(Isometry3::identity, |pose| pose.0);
        self.write(|to| to.body(name, &geometry.get().0, &pose))
    }

    /// Sets the pose of a body from this frame on.
    fn pose(&mut self, body: u32, pose: Pose) -> PyResult<()> {
        self.write(|to| to.pose(body, &pose.0))
    }

    /// Sets the vertices of a mesh from this frame on, shape (N, 3), in the order of
    /// `Geometry.vertices`.
    fn vertices(&mut self, body: u32, vertices: &Bound<'_, PyAny>) -> PyResult<()> {
        let vertices = points(vertices, VERTICES)?;
        self.write(|to| to.vertices(body, &vertices))
    }

    /// Removes a body from this frame on.
    fn remove(&mut self, body: u32) -> PyResult<()> {
        self.write(|to| to.remove(body))
    }

    /// Adds the closest points of two bodies, as `PairTracker.closest` returned them for their
    /// poses.
    fn closest(&mut self, a: u32, b: u32, closest: &Bound<'_, Closest>) -> PyResult<()> {
        self.write(|to| to.answer(a, b, closest.get().answer()))
    }

    /// Adds a path through the world, points of shape (N, 3).
    fn path(&mut self, points: &Bound<'_, PyAny>) -> PyResult<()> {
        let points = self::points(points, PATH)?;
        self.write(|to| {
            to.path(points);
            Ok(())
        })
    }

    /// Sets the line of text about this frame.
    fn note(&mut self, text: &str) -> PyResult<()> {
        self.write(|to| {
            to.note(text);
            Ok(())
        })
    }

    /// Writes the frame and starts the next one.
    fn end_frame(&mut self) -> PyResult<()> {
        self.write(Writer::end_frame)
    }

    /// Writes the last step of a scene as a frame: bodies, poses, boxes, and the closest points and
    /// contacts that the enabled queries computed.
    ///
    /// The name of a body is a number.
    fn scene(&mut self, scene: &Bound<'_, Scene>) -> PyResult<()> {
        self.write(|to| to.scene(scene.borrow().loaded()))
    }

    /// Writes the data that is still in memory, and closes the file. Later calls are errors, but
    /// another `close`.
    fn close(&mut self) -> PyResult<()> {
        let Some(to) = self.to.take() else { return Ok(()) };
        to.finish().map(|_| ()).map_err(|e| fault(&self.path, &e))
    }

    fn __enter__(this: Bound<'_, Self>) -> Bound<'_, Self> {
        this
    }

    #[pyo3(signature = (*_exception))]
    fn __exit__(&mut self, _exception: &Bound<'_, pyo3::types::PyTuple>) -> PyResult<()> {
        self.close()
    }

    fn __repr__(&self) -> String {
        let state = if self.to.is_some() { "" } else { ", closed" };
        format!("<Recorder {}{state}>", self.path.display())
    }
}

impl Recorder {
    fn write<T>(&mut self, what: impl FnOnce(&mut Writer<BufWriter<File>>) -> Result<T, WriteError>) -> PyResult<T> {
        let Some(to) = &mut self.to else {
            return Err(refused(format!("the recording {} is closed", self.path.display())));
        };
        what(to).map_err(|e| fault(&self.path, &e))
    }
}

#[cold]
fn fault(path: &std::path::Path, error: &WriteError) -> PyErr {
    match error {
        WriteError::File(_) | WriteError::Json(_) => file_error(format!("{}: {error}", path.display())),
        _ => refused(error),
    }
}
