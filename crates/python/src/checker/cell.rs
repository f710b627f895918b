//! Changes of the world of a checker, and what the world holds.

use lin_canny::nalgebra::Isometry3;
use lin_canny_robot::plan::{CellBody, CellPair, PlanError, Select, TimedPoses};
use numpy::PyArray2;
use pyo3::Borrowed;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::answers::{Pair, names};
use super::{Checker, configuration};
use crate::array::{Argument, numbers};
use crate::errors::{plan_error, pose_error, refused};
use crate::geometry::Geometry;
use crate::pose::{Pose, Poses, matrix_of_pose};

const TIMES: Argument = Argument {
    name: "times",
    error: |why| plan_error(why),
};

/// Names one body of a checker for ever: ids of removed bodies are never used again.
///
/// Parameters
/// ----------
/// kind : {"robot", "attached", "obstacle"}
/// index : int
///     The number of the body in the order of insertion.
#[pyclass(frozen, eq, hash, module = "lin_canny")]
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct BodyId(pub(super) CellBody);

#[pymethods]
impl BodyId {
    #[new]
    fn new(kind: &str, index: usize) -> PyResult<Self> {
        Ok(Self(match kind {
            "robot" => CellBody::Robot(index),
            "attached" => CellBody::Attached(index),
            "obstacle" => CellBody::Obstacle(index),
            _ => {
                return Err(refused(format!(
                    "kind is {kind:?} (expected \"robot\", \"attached\" or \"obstacle\")"
                )));
            }
        }))
    }

    /// "robot", "attached" or "obstacle".
    #[getter]
    fn kind(&self) -> &'static str {
        match self.0 {
            CellBody::Robot(_) => "robot",
            CellBody::Attached(_) => "attached",
            CellBody::Obstacle(_) => "obstacle",
        }
    }

    /// The number of the body among those of its kind, in the order of insertion.
    #[getter]
    fn index(&self) -> usize {
        match self.0 {
            CellBody::Robot(k) | CellBody::Attached(k) | CellBody::Obstacle(k) => k,
        }
    }

    fn __repr__(&self) -> String {
        format!("<BodyId {} {}>", self.kind(), self.index())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        (py.get_type::<Self>(), (self.kind(), self.index())).into_pyobject(py)
    }
}

/// Bodies as an argument: an id, a name, or several names.
pub(super) enum Bodies {
    Id(CellBody),
    Name(String),
    Names(Vec<String>),
}

impl<'a, 'py> FromPyObject<'a, 'py> for Bodies {
    type Error = PyErr;

    fn extract(obj: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(id) = obj.cast::<BodyId>() {
            return Ok(Self::Id(id.get().0));
        }
        if let Ok(name) = obj.extract::<String>() {
            return Ok(Self::Name(name));
        }
        obj.extract().map(Self::Names).map_err(|_| {
            let kind = obj
                .get_type()
                .name()
                .map_or_else(|_| "object".into(), |kind| kind.to_string());
            PyTypeError::new_err(format!(
                "bodies: a {kind} is no body (expected a BodyId, a name, or a list of names)"
            ))
        })
    }
}

impl Bodies {
    fn select(&self) -> Select<'_> {
        match self {
            Self::Id(id) => (*id).into(),
            Self::Name(name) => name.into(),
            Self::Names(names) => names.into(),
        }
    }
}

fn pose_of(pose: Option<Pose>) -> Isometry3<f64> {
    pose.map_or_else(Isometry3::identity, |pose| pose.0)
}

/// Converts the answer of a change.
fn ids(found: Result<Vec<CellBody>, PlanError>) -> PyResult<Vec<BodyId>> {
    Ok(found.map_err(plan_error)?.into_iter().map(BodyId).collect())
}

impl Checker {
    fn pair_names(&self, found: Result<Vec<CellPair>, PlanError>) -> PyResult<Vec<Pair>> {
        let pairs = found.map_err(plan_error)?.into_iter();
        Ok(pairs.map(|pair| names(&self.checker, pair)).collect())
    }

    /// Returns the id of an argument that stands for one body.
    pub(super) fn one_body(&self, body: &Bodies) -> PyResult<CellBody> {
        let ids = self.checker.cell().select(body.select()).map_err(plan_error)?;
        match (&ids[..], body) {
            ([id], _) => Ok(*id),
            (_, Bodies::Names(names)) => Err(plan_error(format!("bodies are {names:?} (expected one)"))),
            (_, Bodies::Name(name)) => Err(plan_error(PlanError::Ambiguous {
                name: name.clone(),
                count: ids.len(),
            })),
            (_, Bodies::Id(id)) => Err(plan_error(PlanError::NoBody(*id))),
        }
    }

    pub(super) fn pair_of(&self, a: CellBody, b: CellBody) -> PyResult<CellPair> {
        let pair = CellPair::new(a, b);
        pair.ok_or_else(|| plan_error(format!("{a} and {b} are not a pair that is checked")))
    }
}

#[pymethods]
impl Checker {
    /// Adds an obstacle, and returns its id.
    ///
    /// The change costs the pairs of this body; the cached state of other pairs stays.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Several obstacles may have the same name.
    /// geometry : Geometry
    /// pose : pose, optional
    ///     In the world.
    #[pyo3(signature = (name, geometry, pose=None))]
    fn add_obstacle(&mut self, name: &str, geometry: &Bound<'_, Geometry>, pose: Option<Pose>) -> PyResult<BodyId> {
        let geometry = geometry.get().0.clone();
        let id = self.checker.cell_mut().add_obstacle(name, geometry, pose_of(pose));
        id.map(BodyId).map_err(plan_error)
    }

    /// Adds an obstacle that moves, and returns its id.
    ///
    /// `certify_trajectory`, and curves with times (`JointCurve.with_times`), are proven against its
    /// motion. Configurations are queried at `time`. Motions without times are then a PlanError.
    ///
    /// Parameters
    /// ----------
    /// name : str
    /// geometry : Geometry
    /// times : array_like, shape (N,)
    ///     On the clock of the trajectories, in ascending order, at least two.
    /// poses : poses, shape (N, 4, 4) or (N, 7)
    ///     In the world, one at each time. Between two poses the position moves along a straight
    ///     line and the rotation is by slerp, both at constant speed. Before the first time and
    ///     after the last there is no pose: queries there are a PlanError that names the obstacle.
    fn add_moving_obstacle(
        &mut self,
        name: &str,
        geometry: &Bound<'_, Geometry>,
        times: &Bound<'_, PyAny>,
        poses: &Bound<'_, PyAny>,
    ) -> PyResult<BodyId> {
        let (times, poses) = (numbers(times, TIMES)?, Poses::new(poses)?);
        let view = poses.view()?;
        let (found, expected) = (times.len(), view.len());
        if found != expected {
            return Err(plan_error(format!(
                "times: shape is ({found},) (expected ({expected},), one for each pose)"
            )));
        }
        let each = (0..expected).map(|k| view.isometry(k).ok_or_else(|| pose_error(view.fault(k))));
        let poses = each.collect::<PyResult<Vec<_>>>()?;
        let fault = |e: PlanError| plan_error(format!("obstacle {name:?}: {e}"));
        let poses = TimedPoses::new(&times, &poses).map_err(fault)?;
        let geometry = geometry.get().0.clone();
        let id = self.checker.cell_mut().add_moving_obstacle(name, geometry, poses);
        id.map(BodyId).map_err(plan_error)
    }

    /// Moves obstacles to a pose in the world, and returns their ids.
    fn move_obstacle(&mut self, bodies: Bodies, pose: Pose) -> PyResult<Vec<BodyId>> {
        ids(self.checker.cell_mut().move_obstacle(bodies.select(), pose.0))
    }

    /// Replaces the geometry of obstacles, and returns their ids; poses, names and ids stay.
    ///
    /// This is the call for the next cloud of a camera.
    fn replace_obstacle(&mut self, bodies: Bodies, geometry: &Bound<'_, Geometry>) -> PyResult<Vec<BodyId>> {
        let geometry = geometry.get().0.clone();
        ids(self.checker.cell_mut().replace_obstacle(bodies.select(), geometry))
    }

    /// Removes obstacles, with their paddings, margins and excluded pairs, and returns their ids.
    fn remove_obstacle(&mut self, bodies: Bodies) -> PyResult<Vec<BodyId>> {
        ids(self.checker.cell_mut().remove_obstacle(bodies.select()))
    }

    /// Attaches an object to a link, and returns its id: it moves with the link in every query.
    ///
    /// Parameters
    /// ----------
    /// link : str
    ///     A link with or without bodies, such as a tool flange.
    /// name : str
    /// geometry : Geometry
    ///     Of any kind but a half-space.
    /// pose : pose, optional
    ///     In the frame of the link.
    /// touch_links : sequence of str
    ///     Links that may touch the object, such as fingers: these pairs are excluded.
    #[pyo3(signature = (link, name, geometry, pose=None, *, touch_links=Vec::new()))]
    fn attach(
        &mut self,
        link: &str,
        name: &str,
        geometry: &Bound<'_, Geometry>,
        pose: Option<Pose>,
        touch_links: Vec<String>,
    ) -> PyResult<BodyId> {
        let touch: Vec<&str> = touch_links.iter().map(String::as_str).collect();
        let geometry = geometry.get().0.clone();
        let id = self
            .checker
            .cell_mut()
            .attach(link, name, geometry, pose_of(pose), &touch);
        id.map(BodyId).map_err(plan_error)
    }

    /// Removes attached objects, and returns their ids.
    fn detach(&mut self, bodies: Bodies) -> PyResult<Vec<BodyId>> {
        ids(self.checker.cell_mut().detach(bodies.select()))
    }

    /// Removes an attached object, and leaves it as an obstacle where it is at a configuration.
    ///
    /// Returns the id of the obstacle, which has the name and the padding of the object.
    fn detach_at(&mut self, body: Bodies, q: &Bound<'_, PyAny>) -> PyResult<BodyId> {
        let id = self.checker.detach_at(body.select(), &configuration(q)?);
        id.map(BodyId).map_err(plan_error)
    }

    /// Sets the padding of bodies, a length: their pairs must keep so much more than the margin.
    ///
    /// The padding of a link covers the objects that it carries. An attached object with a padding of
    /// its own has that instead, also if it is 0; None removes it. Returns the ids. Distances do not
    /// change; `NearPair.excess` takes the padding off.
    fn pad(&mut self, bodies: Bodies, padding: Option<f64>) -> PyResult<Vec<BodyId>> {
        ids(self.checker.cell_mut().pad(bodies.select(), padding))
    }

    /// Sets the distance that the pairs of two bodies must keep, instead of the margin of all pairs.
    ///
    /// None removes it. Returns the names of the pairs.
    fn set_pair_margin(&mut self, a: Bodies, b: Bodies, margin: Option<f64>) -> PyResult<Vec<Pair>> {
        let found = self.checker.cell_mut().set_pair_margin(a.select(), b.select(), margin);
        self.pair_names(found)
    }

    /// Excludes the pairs of two bodies, which are then never checked.
    ///
    /// Returns the names of the pairs that were checked before.
    fn exclude(&mut self, a: Bodies, b: Bodies) -> PyResult<Vec<Pair>> {
        let found = self.checker.cell_mut().exclude(a.select(), b.select());
        self.pair_names(found)
    }

    /// Includes the pairs of two bodies again.
    ///
    /// Returns the names of the pairs that were excluded.
    fn include(&mut self, a: Bodies, b: Bodies) -> PyResult<Vec<Pair>> {
        let found = self.checker.cell_mut().include(a.select(), b.select());
        self.pair_names(found)
    }

    /// The table of excluded pairs (the allowed collision matrix of MoveIt): each two names once,
    /// if all pairs of their bodies are excluded.
    #[getter]
    fn excluded(&self) -> Vec<(&str, &str)> {
        let names = self.checker.cell().excluded_names();
        names.into_iter().map(|([a, b], _)| (a, b)).collect()
    }

    /// All excluded pairs of bodies, by their ids.
    #[getter]
    fn excluded_ids(&self) -> Vec<(BodyId, BodyId)> {
        let pairs = self.checker.cell().excluded();
        pairs.map(|[a, b]| (BodyId(a), BodyId(b))).collect()
    }

    /// The names of all bodies: of the robots, then attached objects, then obstacles.
    ///
    /// The name of a link with several bodies is repeated.
    #[getter]
    fn bodies(&self) -> Vec<&str> {
        self.checker.cell().bodies().map(|(_, name)| name).collect()
    }

    /// The ids of `bodies`, in the same order.
    #[getter]
    fn ids(&self) -> Vec<BodyId> {
        self.checker.cell().bodies().map(|(id, _)| BodyId(id)).collect()
    }

    /// Returns the padding of a body, a length: of an attached object without its own, that of its link.
    ///
    /// body: a BodyId, or a name that stands for one body.
    fn padding(&self, body: Bodies) -> PyResult<f64> {
        Ok(self.checker.cell().padding(self.one_body(&body)?))
    }

    /// Returns the distance that two bodies must keep: their margin plus both paddings.
    ///
    /// a, b: a BodyId each, or a name that stands for one body.
    fn required_distance(&self, a: Bodies, b: Bodies) -> PyResult<f64> {
        let pair = self.pair_of(self.one_body(&a)?, self.one_body(&b)?)?;
        Ok(self.checker.cell().required_distance(pair).distance)
    }

    /// Returns the pose of a body in the world at a configuration, shape (4, 4).
    ///
    /// body: a BodyId, or a name that stands for one body.
    fn pose<'py>(&self, py: Python<'py>, body: Bodies, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let pose = self.checker.pose(self.one_body(&body)?, &configuration(q)?);
        matrix_of_pose(py, &pose.map_err(|e| self.fault(&e))?)
    }

    /// Returns the pose of a link in the world at a configuration, shape (4, 4): the frame of
    /// `attach`.
    fn link_pose<'py>(
        &self,
        py: Python<'py>,
        link: &str,
        q: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let pose = self.checker.link_pose(link, &configuration(q)?);
        matrix_of_pose(py, &pose.map_err(|e| self.fault(&e))?)
    }
}
