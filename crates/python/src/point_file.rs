//! Point files.

use std::path::PathBuf;

use lin_canny_formats::{Invalid, PointFile as Loaded, Points};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::array::of_triples;
use crate::errors::{file_error, refused};

/// A point file: its points, and what was dropped or skipped.
///
/// Lengths are in the unit of the file. A point file is pickled by its path, and is read again.
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct PointFile {
    file: Loaded,
    path: PathBuf,
    invalid: String,
}

/// Returns the points of a PLY, PCD, XYZ or npy file.
///
/// Parameters
/// ----------
/// path : str or PathLike
/// invalid : {"drop", "refuse"}
///     What happens to points whose coordinates are NaN or infinite, as depth cameras return them:
///     they are dropped and counted, or the first of them is an error.
///
/// Raises
/// ------
/// FileError
///     If the file is malformed or has no finite point: names the file and, if known, the line.
///
/// Examples
/// --------
/// >>> file = lc.read_points("scan.ply")                         # doctest: +SKIP
/// >>> cloud = lc.Cloud(file.points, radius=0.005)               # doctest: +SKIP
#[pyfunction]
#[pyo3(signature = (path, *, invalid="drop"))]
pub(crate) fn read_points(py: Python<'_>, path: PathBuf, invalid: &str) -> PyResult<PointFile> {
    let policy = match invalid {
        "drop" => Invalid::Drop,
        "refuse" => Invalid::Refuse,
        _ => {
            return Err(refused(format!(
                "invalid is {invalid:?} (expected \"drop\" or \"refuse\")"
            )));
        }
    };
    let file = py.detach(|| Loaded::read_with(&path, policy)).map_err(file_error)?;
    let invalid = invalid.to_owned();
    Ok(PointFile { file, path, invalid })
}

#[pymethods]
impl PointFile {
    /// The finite points in the order of the file, shape (N, 3): float32 if all coordinates of the
    /// file are, else float64.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(match &self.file.points {
            Points::F32(points) => of_triples(py, points.clone())?.into_any(),
            Points::F64(points) => of_triples(py, points.clone())?.into_any(),
        })
    }

    /// A radius for each point, shape (N,); None if the file has none.
    #[getter]
    fn radii<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.file.radii.as_ref().map(|radii| PyArray1::from_slice(py, radii))
    }

    /// The number of points that were dropped because a coordinate is NaN or infinite.
    #[getter]
    fn dropped(&self) -> usize {
        self.file.dropped
    }

    /// What was skipped, such as colours: tuples of the first line, or None, and the kind.
    #[getter]
    fn skipped(&self) -> Vec<(Option<usize>, &str)> {
        let skipped = self.file.skipped.iter();
        skipped.map(|skipped| (skipped.line, skipped.what.as_str())).collect()
    }

    /// The format: "ply", "pcd", "xyz" or "npy".
    #[getter]
    fn format(&self) -> String {
        format!("{:?}", self.file.format).to_lowercase()
    }

    /// The number of points.
    fn __len__(&self) -> usize {
        self.file.points.len()
    }

    fn __repr__(&self) -> String {
        let (points, dropped) = (self.file.points.len(), self.file.dropped);
        format!(
            "<PointFile {:?}: {points} points, {dropped} dropped>",
            self.path.display().to_string()
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let read = py.import("lin_canny")?.getattr("read_points")?;
        let options = pyo3::types::PyDict::new(py);
        options.set_item("invalid", &self.invalid)?;
        let read = py
            .import("functools")?
            .getattr("partial")?
            .call((read,), Some(&options))?;
        (read, (&self.path,)).into_pyobject(py)
    }
}
