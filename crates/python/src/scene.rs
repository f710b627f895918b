//! Scenes of many bodies.

mod answers;
mod queries;

pub(crate) use answers::ScenePair;

use lin_canny::Velocity;
use lin_canny::nalgebra::Isometry3;
use lin_canny::scene::{Body, BodyId, Group, Scene as Loaded};
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::array::{Argument, vector};
use crate::errors::{pose_error, scene_error};
use crate::geometry::Geometry;
use crate::pickle::{Pickled, pickled};
use crate::pose::{Pose, Poses, matrix_of_pose};

const VELOCITY: Argument = Argument {
    name: "a velocity",
    error: |why| scene_error(why),
};

/// A scene of many bodies: a step finds close pairs and runs the enabled queries.
///
/// Bodies are in groups 0 to 31. `set_queries` enables queries between two groups; without it nothing
/// is computed. Ids of bodies are integers. Poses have the forms of `PairTracker`. All returned
/// points and normals are in the world.
#[pyclass(module = "lin_canny")]
pub(crate) struct Scene(Box<Loaded>); // its boxes lie on cache lines, objects of Python do not

/// Returns the integer for an id.
pub(crate) fn number(id: BodyId) -> u64 {
    u64::from(id.generation) << 32 | u64::from(id.index)
}

/// Returns the id of an integer.
fn body(number: u64) -> BodyId {
    BodyId {
        index: number as u32,
        generation: (number >> 32) as u32,
    }
}

fn group(number: u8) -> PyResult<Group> {
    Group::new(number).ok_or_else(|| scene_error(format!("group is out of range: {number} (expected 0..=31)")))
}

impl Scene {
    /// Returns the scene itself.
    pub(crate) fn loaded(&self) -> &Loaded {
        &self.0
    }
}

#[pymethods]
impl Scene {
    #[new]
    fn new() -> Self {
        Self(Box::new(Loaded::new()))
    }

    /// Inserts a body at a pose, and returns its id.
    ///
    /// Two fixed bodies are tested only if `set_queries` says so; `fixed_left_out` counts the others.
    #[pyo3(signature = (geometry, pose=None, *, group=0, fixed=false))]
    fn insert(&mut self, geometry: &Bound<'_, Geometry>, pose: Option<Pose>, group: u8, fixed: bool) -> PyResult<u64> {
        let geometry = geometry.get().0.clone();
        let new = if fixed {
            Body::fixed(geometry)
        } else {
            Body::moving(geometry)
        };
        let pose = pose.map_or_else(Isometry3::identity, |pose| pose.0);
        let id = self.0.insert(new.group(self::group(group)?), pose);
        id.map(number).map_err(scene_error)
    }

    /// Removes a body.
    fn remove(&mut self, id: u64) -> PyResult<()> {
        self.0.remove(body(id)).map_err(scene_error)
    }

    /// Moves a body to a pose.
    fn set_pose(&mut self, id: u64, pose: Pose) -> PyResult<()> {
        self.0.set_pose(body(id), pose.0).map_err(scene_error)
    }

    /// Moves many bodies: poses of shape (N, 4, 4) or (N, 7), one per id.
    fn set_poses(&mut self, ids: Vec<u64>, poses: &Bound<'_, PyAny>) -> PyResult<()> {
        let poses = Poses::new(poses)?;
        let view = poses.view()?;
        if ids.len() != view.len() {
            return Err(scene_error(format!(
                "number of ids and poses differs: {} ids and {} poses",
                ids.len(),
                view.len()
            )));
        }
        for (k, id) in ids.into_iter().enumerate() {
            let pose = view.isometry(k).ok_or_else(|| pose_error(view.fault(k)))?;
            self.0.set_pose(body(id), pose).map_err(scene_error)?;
        }
        Ok(())
    }

    /// Returns the pose of a body, shape (4, 4).
    fn pose<'py>(&self, py: Python<'py>, id: u64) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let stale = || scene_error(format!("{} does not exist in this scene, or was removed", body(id)));
        matrix_of_pose(py, self.0.pose(body(id)).ok_or_else(stale)?)
    }

    /// Sets the velocity of a body in the world, which `advance` uses.
    ///
    /// linear: lengths per time. angular: radians per time, about the origin of the geometry.
    fn set_velocity(&mut self, id: u64, linear: &Bound<'_, PyAny>, angular: &Bound<'_, PyAny>) -> PyResult<()> {
        let velocity = Velocity::new(vector(linear, VELOCITY)?, vector(angular, VELOCITY)?);
        self.0.set_velocity(body(id), velocity).map_err(scene_error)
    }

    /// Moves all bodies by their velocities over a time. Call `step` afterwards for the results.
    fn advance(&mut self, time: f64) -> PyResult<()> {
        self.0.advance(time).map_err(scene_error)
    }

    /// Excludes a pair of bodies from all queries.
    fn exclude_pair(&mut self, a: u64, b: u64) -> PyResult<()> {
        self.0.exclude_pair(body(a), body(b)).map_err(scene_error)
    }

    /// Enables a pair again that was excluded.
    fn include_pair(&mut self, a: u64, b: u64) -> PyResult<()> {
        self.0.include_pair(body(a), body(b)).map_err(scene_error)
    }

    /// Applies all changes and runs the enabled queries, with the interpreter lock released.
    fn step(&mut self, py: Python<'_>) {
        py.detach(|| {
            self.0.step();
        });
    }

    /// Number of pairs of fixed bodies that the last step left out although queries are enabled
    /// between their groups.
    #[getter]
    fn fixed_left_out(&self) -> u64 {
        self.0.report().counts.fixed_left_out
    }

    fn __len__(&self) -> usize {
        self.0.body_count()
    }

    fn __repr__(&self) -> String {
        format!("<Scene: {} bodies, {} pairs>", self.0.body_count(), self.0.pair_count())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py>> {
        pickled::<Self>(py, postcard::to_stdvec(&self.0))
    }

    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        postcard::from_bytes(bytes).map(Self).map_err(scene_error)
    }
}
