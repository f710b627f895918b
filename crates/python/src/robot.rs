//! Robots of URDF, MJCF and SDFormat files.

use std::path::PathBuf;

use lin_canny_robot::{LoadOptions, MeshUse, Packages, Robot as Loaded, Srdf};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::checker::{Checker, configuration};
use crate::errors::{file_error, plan_error, refused};

/// The files of a robot.
#[derive(Clone)]
struct Files {
    urdf: PathBuf,
    srdf: Option<PathBuf>,
    packages: Vec<PathBuf>,
    meshes: String,
    pieces: Option<PathBuf>,
    skip_missing_meshes: bool,
    floating: f64,
}

impl Files {
    fn packages(&self) -> Packages {
        Packages::new(&self.packages).with_environment()
    }

    fn options(&self) -> PyResult<LoadOptions> {
        let usage = match self.meshes.as_str() {
            "hull" => MeshUse::Hull,
            "mesh" => MeshUse::Mesh,
            "solid" => MeshUse::Solid,
            "pieces" => MeshUse::Pieces,
            other => {
                return Err(refused(format!(
                    "meshes is {other:?} (expected \"hull\", \"mesh\", \"solid\" or \"pieces\")"
                )));
            }
        };
        if !(self.floating >= 0.0 && self.floating.is_finite()) {
            let floating = self.floating;
            return Err(refused(format!(
                "floating is out of range: {floating} (expected 0 or more)"
            )));
        }
        let mut options = LoadOptions::default()
            .meshes(usage)
            .floating_limits([-self.floating, self.floating])
            .skip_missing_meshes(self.skip_missing_meshes);
        options.pieces.clone_from(&self.pieces);
        Ok(options)
    }
}

/// A robot of a URDF, MJCF or SDFormat file: links, joints and the geometry of the links.
///
/// A configuration has a number for each of `coordinates`, radians for joints that turn and the
/// unit of the file for joints that slide. Cylinders, capsules and spheres are exact. A robot is
/// pickled by the paths of its files, which are read again.
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct Robot {
    pub(crate) robot: Loaded,
    pub(crate) srdf: Option<Srdf>,
    files: Files,
}

impl Robot {
    /// Returns the package folders and load options of this robot, which cells use as well.
    pub(crate) fn mesh_sources(&self) -> PyResult<(Packages, LoadOptions)> {
        Ok((self.files.packages(), self.files.options()?))
    }
}

#[pymethods]
impl Robot {
    /// Returns the robot of a URDF, MJCF or SDFormat file; the pairs of links of an SRDF file are
    /// not checked.
    ///
    /// packages: folders in which `package://` is looked up, before those of ROS_PACKAGE_PATH and
    /// those above the URDF. meshes: what mesh files become, "hull", "mesh" (the triangles as they
    /// are), "solid" (the triangles with holes closed, see `Geometry.repaired_mesh`) or "pieces" (the
    /// hulls of the objects of an OBJ of the same name in the folder `pieces`). skip_missing_meshes: whether collision elements whose mesh file does not exist
    /// are listed in `skipped`, and nothing is checked against them; else they are errors. floating:
    /// how far floating and planar joints, and sliding joints without limits, may go each way along
    /// x, y and z; the pose at which the file draws a body is always within. Raises FileError, which
    /// names file, line and element.
    #[staticmethod]
    #[pyo3(signature = (
        urdf, srdf=None, *, packages=Vec::new(), meshes="hull", pieces=None, skip_missing_meshes=false, floating=10.0
    ))]
    #[allow(clippy::too_many_arguments)] // the signature in Python
    fn load(
        py: Python<'_>,
        urdf: PathBuf,
        srdf: Option<PathBuf>,
        packages: Vec<PathBuf>,
        meshes: &str,
        pieces: Option<PathBuf>,
        skip_missing_meshes: bool,
        floating: f64,
    ) -> PyResult<Self> {
        let meshes = meshes.to_owned();
        let files = Files {
            urdf,
            srdf,
            packages,
            meshes,
            pieces,
            skip_missing_meshes,
            floating,
        };
        let options = files.options()?;
        let robot = py.detach(|| Loaded::load_with(&files.urdf, &files.packages(), &options));
        let robot = robot.map_err(file_error)?;
        let srdf = files.srdf.as_ref().map(|path| Srdf::load(path, &robot)).transpose();
        Ok(Self {
            srdf: srdf.map_err(file_error)?,
            robot,
            files,
        })
    }

    /// The name in the file.
    #[getter]
    fn name(&self) -> &str {
        self.robot.name()
    }

    /// The names of the links, the root first.
    #[getter]
    fn links(&self) -> Vec<&str> {
        self.robot.links().iter().map(|link| link.name.as_str()).collect()
    }

    /// The names of the coordinates of a configuration.
    #[getter]
    fn coordinates(&self) -> Vec<&str> {
        self.robot.coordinates().iter().map(|c| c.name.as_str()).collect()
    }

    /// The number of coordinates of a configuration.
    #[getter]
    fn dof(&self) -> usize {
        self.robot.coordinates().len()
    }

    /// Least and greatest value of each coordinate, shape (dof, 2).
    #[getter]
    fn limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let limits: Vec<[f64; 2]> = self.robot.coordinates().iter().map(|c| c.limits).collect();
        PyArray1::from_vec(py, limits.into_flattened()).reshape([self.dof(), 2])
    }

    /// The configuration of MuJoCo's `qpos`, for a robot of an MJCF file.
    ///
    /// The quaternions of free and ball joints become the angles roll, pitch and yaw.
    fn configuration_of_qpos<'py>(
        &self,
        py: Python<'py>,
        qpos: &Bound<'_, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let found = self.robot.configuration_of_qpos(&configuration(qpos)?);
        Ok(PyArray1::from_vec(py, found.map_err(plan_error)?))
    }

    /// MuJoCo's `qpos` of a configuration, for a robot of an MJCF file: the inverse of `configuration_of_qpos`.
    fn qpos_of_configuration<'py>(&self, py: Python<'py>, q: &Bound<'_, PyAny>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let found = self.robot.qpos_of_configuration(&configuration(q)?);
        Ok(PyArray1::from_vec(py, found.map_err(plan_error)?))
    }

    /// What the file and the SRDF have and this robot does not use, with file, line and reason:
    /// collision elements whose mesh file does not exist, and pairs of links that do not exist.
    #[getter]
    fn skipped(&self) -> Vec<String> {
        let srdf = self.srdf.iter().flat_map(|srdf| &srdf.skipped);
        self.robot
            .skipped()
            .iter()
            .chain(srdf)
            .map(ToString::to_string)
            .collect()
    }

    /// Returns the clearance between the links of the robot alone at many configurations, shape
    /// (N, dof): see `Checker.clearances`. Adjacent links and pairs of the SRDF are not checked.
    #[pyo3(signature = (q, *, threads=1, progress=None))]
    fn clearances<'py>(
        slf: &Bound<'py, Self>,
        q: &Bound<'py, PyAny>,
        threads: usize,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        Checker::alone(slf)?.clearances(slf.py(), q, threads, progress)
    }

    fn __repr__(&self) -> String {
        let (links, dof) = (self.robot.links().len(), self.dof());
        format!("<Robot {:?}: {links} links, {dof} coordinates>", self.robot.name())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let Files {
            urdf,
            srdf,
            packages,
            meshes,
            pieces,
            skip_missing_meshes,
            floating,
        } = &self.files;
        let options = PyDict::new(py);
        options.set_item("packages", packages)?;
        options.set_item("meshes", meshes)?;
        options.set_item("pieces", pieces)?;
        options.set_item("skip_missing_meshes", skip_missing_meshes)?;
        options.set_item("floating", floating)?;
        let load = py.get_type::<Self>().getattr("load")?;
        let partial = py.import("functools")?.getattr("partial")?;
        let load = partial.call((load,), Some(&options))?;
        (load, (urdf, srdf)).into_pyobject(py)
    }
}
