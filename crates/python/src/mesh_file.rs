//! Mesh files by themselves.

use std::path::PathBuf;

use lin_canny::nalgebra::Point3;
use lin_canny::{Compound, ConvexPolyhedron, Geometry as Body, Mesh, Piece, RepairOptions};
use lin_canny_formats::MeshFile as Loaded;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::errors::{file_error, geometry_error, refused};
use crate::geometry::Geometry;

/// A mesh file: all its points and triangles, its objects, and what was skipped.
///
/// Lengths are in the unit of the file, or in metres for COLLADA and glTF. A mesh file is pickled by
/// its path, and is read again.
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct MeshFile {
    file: Loaded,
    path: PathBuf,
}

/// Points of shape (N, 3) and triangles of shape (M, 3).
type Arrays<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<i64>>);

/// Name, points and triangles of an object.
type Object<'a, 'py> = (&'a str, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<i64>>);

fn arrays<'py>(py: Python<'py>, points: &[[f64; 3]], triangles: &[[u32; 3]]) -> PyResult<Arrays<'py>> {
    let indices = triangles.iter().flatten().map(|&k| i64::from(k));
    Ok((
        PyArray1::from_slice(py, points.as_flattened()).reshape([points.len(), 3])?,
        PyArray1::from_iter(py, indices).reshape([triangles.len(), 3])?,
    ))
}

fn positions(points: &[[f64; 3]]) -> Vec<Point3<f64>> {
    points.iter().map(|&p| Point3::from(p)).collect()
}

/// Returns the mesh of an STL, OBJ, COLLADA, PLY, glTF or MSH file.
///
/// Raises FileError, which names file and line, if the file is malformed, has no triangle, or has
/// geometry that is not read.
#[pyfunction]
pub(crate) fn load_mesh(py: Python<'_>, path: PathBuf) -> PyResult<MeshFile> {
    let file = py.detach(|| Loaded::load(&path)).map_err(file_error)?;
    Ok(MeshFile { file, path })
}

#[pymethods]
impl MeshFile {
    /// The points of all objects, float64 of shape (N, 3).
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (points, triangles) = self.file.whole();
        Ok(arrays(py, &points, &triangles)?.0)
    }

    /// The triangles of all objects, int64 of shape (M, 3): indices of `points`, counterclockwise
    /// from outside.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        let (points, triangles) = self.file.whole();
        Ok(arrays(py, &points, &triangles)?.1)
    }

    /// The objects in the order of the file: tuples of name, points and triangles, whose indices
    /// are those of the points of the object.
    #[getter]
    fn objects<'py>(&self, py: Python<'py>) -> PyResult<Vec<Object<'_, 'py>>> {
        let objects = self.file.objects.iter().map(|object| {
            let (points, triangles) = arrays(py, &object.points, &object.triangles)?;
            Ok((object.name.as_str(), points, triangles))
        });
        objects.collect()
    }

    /// What is no part of a body and was skipped: tuples of the first line, or None, and the kind.
    #[getter]
    fn skipped(&self) -> Vec<(Option<usize>, &str)> {
        let skipped = self.file.skipped.iter();
        skipped.map(|skipped| (skipped.line, skipped.what.as_str())).collect()
    }

    /// Returns the geometry of the file: the hull of all points ("hull"), the triangles as they
    /// are ("mesh"), the triangles with holes closed ("solid", see `Geometry.repaired_mesh`), or the
    /// union of the hulls of the objects ("pieces").
    #[pyo3(signature = (kind="hull"))]
    fn geometry(&self, py: Python<'_>, kind: &str) -> PyResult<Geometry> {
        let hull = |points: &[[f64; 3]]| ConvexPolyhedron::from_points(&positions(points));
        let body = py.detach(|| -> Result<Option<Body>, String> {
            let (points, triangles) = self.file.whole();
            Ok(Some(match kind {
                "hull" => hull(&points).map_err(|e| e.to_string())?.into(),
                "mesh" => Mesh::new(&positions(&points), &triangles)
                    .map_err(|e| e.to_string())?
                    .into(),
                "solid" => Mesh::repaired(&positions(&points), &triangles, &RepairOptions::default())
                    .map_err(|e| e.to_string())?
                    .into(),
                "pieces" => {
                    let pieces = self
                        .file
                        .objects
                        .iter()
                        .map(|object| hull(&object.points).map(Piece::new));
                    let pieces: Result<Vec<Piece>, _> = pieces.collect();
                    Compound::new(pieces.map_err(|e| e.to_string())?)
                        .map_err(|e| e.to_string())?
                        .into()
                }
                _ => return Ok(None),
            }))
        });
        let body = body.map_err(|why| geometry_error(format!("{}: {why}", self.path.display())))?;
        let unknown = || {
            refused(format!(
                "kind is {kind:?} (expected \"hull\", \"mesh\", \"solid\" or \"pieces\")"
            ))
        };
        Ok(Geometry(body.ok_or_else(unknown)?))
    }

    fn __repr__(&self) -> String {
        let (points, triangles) = self.file.whole();
        format!(
            "<MeshFile {:?}: {} objects, {} points, {} triangles>",
            self.path.display().to_string(),
            self.file.objects.len(),
            points.len(),
            triangles.len()
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let load = py.import("lin_canny")?.getattr("load_mesh")?;
        (load, (&self.path,)).into_pyobject(py)
    }
}
