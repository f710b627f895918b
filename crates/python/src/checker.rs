//! The class `Checker`: clearances, proven motions and paths of robots.

mod answers;
mod audit;
mod batches;
mod cell;
mod motion_batch;
mod motions;
mod pair_boxes;
mod range;
mod setup;
mod smooth;
mod view;

pub(crate) use answers::{NearPair, Verdict};
pub(crate) use audit::LinkAudit;
pub(crate) use cell::BodyId;
pub(crate) use range::RangeAnswer;

use std::path::PathBuf;
use std::time::Instant;

use lin_canny::Progress;
use lin_canny_robot::plan::receipt::Receipt;
use lin_canny_robot::plan::{
    Cell, Checker as Loaded, ConfigurationSpace, JointMotion, JointTree, Path, PlanError, PlanMethod, PlanOptions,
    Shortcuts,
};
use lin_canny_robot::{CellFile, Coordinate, Skipped};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};

use crate::array::{Argument, contiguous, refuse_mask, shape_text};
use crate::errors::{file_error, plan_error, refused};
use crate::robot::Robot;
use crate::watch::Watch;
use answers::Pair;
use setup::{Obstacle, RobotArgument};

const CONFIGURATION: Argument = Argument {
    name: "a configuration",
    error: |why| plan_error(why),
};
const CONFIGURATIONS: Argument = Argument {
    name: "configurations",
    error: |why| plan_error(why),
};

/// Checks robots among obstacles: clearances with bounds, motions proven free over their whole
/// length, and paths.
///
/// The world changes between queries: obstacles are added, moved, replaced and removed, objects are
/// attached to links, bodies are padded, pairs are excluded. In these methods, `bodies`, `a` and
/// `b` are a BodyId, a name, which stands for all bodies that have it, or a sequence of names. A
/// wrong name is a PlanError that states the nearest name. A change that fails changes nothing.
///
/// One thread at a time may use a checker; batches use several threads. A pickled checker has the
/// world of the original, with the same ids; the files of its robots and cell are read again.
///
/// Parameters
/// ----------
/// robot : Robot or dict
///     For several robots, a dict from a prefix of names to a tuple (Robot, pose).
/// pose : pose, optional
///     Of the root link of a single robot.
/// cell : str or PathLike, optional
///     A file of obstacles, JSON or SDFormat, or one that `save` wrote.
/// keep_invalid : bool
///     Whether points without a return (NaN or infinite) in the point files of the cell are a
///     FileError. If not, they are dropped, and `skipped` counts them.
/// obstacles : sequence of tuples (name, Geometry, pose), optional
/// exclude : sequence of tuples of two names, optional
///     Links and obstacles whose pairs are not checked.
/// exclude_adjacent : bool
///     Whether pairs of adjacent links are not checked.
/// margin : float, optional
///     The distance that all pairs must keep, a length. By default that of the cell, or else 0.
/// start_contact_margin : float, optional
///     See the attribute.
#[pyclass(module = "lin_canny")]
pub(crate) struct Checker {
    skipped: Vec<String>,
    /// In a box: it is aligned to cache lines, and objects of Python are not.
    pub(crate) checker: Box<Loaded<JointTree>>,
    /// The arguments, for pickling.
    arguments: (Py<PyTuple>, Py<PyDict>),
}

#[pymethods]
impl Checker {
    #[new]
    #[pyo3(signature = (
        robot, *, pose=None, cell=None, keep_invalid=false, obstacles=None, exclude=None, exclude_adjacent=true,
        margin=None, start_contact_margin=None
    ))]
    #[allow(clippy::too_many_arguments)] // the signature in Python
    fn new<'py>(
        py: Python<'py>,
        robot: RobotArgument<'py>,
        pose: Option<Bound<'py, PyAny>>,
        cell: Option<Bound<'py, PyAny>>,
        keep_invalid: bool,
        obstacles: Option<Vec<Obstacle<'py>>>,
        exclude: Option<Vec<(String, String)>>,
        exclude_adjacent: bool,
        margin: Option<f64>,
        start_contact_margin: Option<f64>,
    ) -> PyResult<Self> {
        let options = PyDict::new(py);
        options.set_item("pose", &pose)?;
        options.set_item("cell", &cell)?;
        options.set_item("keep_invalid", keep_invalid)?;
        options.set_item("exclude_adjacent", exclude_adjacent)?;
        let robot_object = robot.object().clone();
        let (mut made, mut skipped) = setup::of_robots(&robot, pose, exclude_adjacent)?;
        skipped.extend(setup::add_cell(&mut made, &robot, cell, keep_invalid)?);
        setup::add_obstacles(&mut made, obstacles.unwrap_or_default())?;
        for (a, b) in exclude.unwrap_or_default() {
            match made.exclude(&a, &b) {
                // A link without bodies has no pairs.
                Ok(_) | Err(PlanError::WithoutBodies(_)) => {}
                Err(error) => return Err(plan_error(error)),
            }
        }
        let arguments = (PyTuple::new(py, [robot_object])?.unbind(), options.unbind());
        let mut checker = Self::of_cell(made, &skipped, arguments)?;
        if let Some(margin) = margin {
            checker.set_margin(margin)?;
        }
        checker.set_start_contact_margin(start_contact_margin)?;
        Ok(checker)
    }

    /// The robots and the file of the cell; the cell as it is now is in the state.
    fn __getnewargs_ex__(&self, py: Python<'_>) -> (Py<PyTuple>, Py<PyDict>) {
        (self.arguments.0.clone_ref(py), self.arguments.1.clone_ref(py))
    }

    fn __getstate__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let checker = &self.checker;
        let state = (checker.cell(), checker.start_contact_margin(), checker.time());
        Ok(PyBytes::new(py, &postcard::to_stdvec(&state).map_err(refused)?))
    }

    fn __setstate__(&mut self, state: &[u8]) -> PyResult<()> {
        let (cell, margin, time): (Cell, _, _) = postcard::from_bytes(state).map_err(plan_error)?;
        *self.checker = checker_of(self.checker.space().clone(), cell, margin, time)?;
        Ok(())
    }

    /// Writes the world to a JSON file that the parameter `cell` reads.
    ///
    /// The file holds obstacles, attached objects, paddings, margins and excluded pairs. A checker
    /// of the same robots at the same poses with `cell=path` gives the same answers, bit for bit.
    /// Bodies keep their order; those that were removed have no id in it. The file does not hold
    /// `start_contact_margin`. Raises FileError if the file cannot be written.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let cell = CellFile::from_cell(self.checker.cell());
        py.detach(|| cell.save(path)).map_err(file_error)
    }

    /// The names of the coordinates of a configuration.
    #[getter]
    fn coordinates(&self) -> Vec<&str> {
        self.checker
            .cell()
            .coordinates()
            .iter()
            .map(|c| c.name.as_str())
            .collect()
    }

    /// The number of coordinates of a configuration.
    #[getter]
    fn dof(&self) -> usize {
        self.checker.cell().coordinates().len()
    }

    /// Least and greatest value of each coordinate, shape (dof, 2).
    #[getter]
    fn limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let limits: Vec<[f64; 2]> = self.checker.cell().coordinates().iter().map(|c| c.limits).collect();
        PyArray1::from_vec(py, limits.into_flattened()).reshape([self.dof(), 2])
    }

    /// The length that one unit of each coordinate stands for, shape (dof,): 1 for a prismatic
    /// joint, the radius of the moved part for a revolute joint.
    #[getter]
    fn scales<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.checker.space().scales())
    }

    /// What the files of the robots have and this checker does not use: see `Robot.skipped`.
    #[getter]
    fn skipped(&self) -> Vec<String> {
        self.skipped.clone()
    }

    /// The distance that pairs without a margin of their own must keep to be free, a length.
    #[getter]
    fn margin(&self) -> f64 {
        self.checker.cell().margin()
    }

    #[setter]
    fn set_margin(&mut self, margin: f64) -> PyResult<()> {
        self.checker.cell_mut().set_margin(margin).map_err(plan_error)
    }

    /// The distance within which a contact at the start of a segment is accepted, or None.
    ///
    /// A pair that is within this distance at the start, or overlaps by no more, is accepted if it
    /// is proven not to come closer until it has left the margin. `Verdict.start_contacts` lists
    /// such pairs. It acts on motions without a tube: `certify`, `certify_path`, `certify_curve`,
    /// `certify_spline`, `certify_trajectory`, and `is_free` of two configurations.
    #[getter]
    fn start_contact_margin(&self) -> Option<f64> {
        self.checker.start_contact_margin()
    }

    #[setter]
    fn set_start_contact_margin(&mut self, margin: Option<f64>) -> PyResult<()> {
        self.checker.set_start_contact_margin(margin).map_err(plan_error)
    }

    /// The time at which configurations are queried, or None: moving obstacles are at their poses at
    /// this time.
    ///
    /// Curves and trajectories have times of their own. It must be set before configurations are
    /// queried among moving obstacles. Raises PlanError if a moving obstacle has no pose at the time.
    #[getter]
    fn time(&self) -> Option<f64> {
        self.checker.time()
    }

    #[setter]
    fn set_time(&mut self, time: f64) -> PyResult<()> {
        self.checker.set_time(time).map_err(plan_error)
    }

    /// Drops all cached state: the next answer has the bits of a new checker's.
    fn reset(&mut self) {
        self.checker.reset();
    }

    /// Returns the pair of least signed distance at a configuration, shape (dof,).
    ///
    /// Returns None if there is no pair to check.
    fn clearance(&mut self, q: &Bound<'_, PyAny>) -> PyResult<Option<NearPair>> {
        let found = self.checker.clearance(&configuration(q)?).map_err(|e| self.fault(&e))?;
        Ok(found.map(|near| NearPair::new(near, &self.checker)))
    }

    /// Returns all pairs whose signed distance exceeds the least by at most `slack`, a length.
    ///
    /// The closest pair comes first, by true distance; `excess` takes off what it must keep.
    fn nearest(&mut self, q: &Bound<'_, PyAny>, slack: f64) -> PyResult<Vec<NearPair>> {
        let found = self
            .checker
            .nearest(&configuration(q)?, slack)
            .map_err(|e| self.fault(&e))?;
        Ok(found
            .into_iter()
            .map(|near| NearPair::new(near, &self.checker))
            .collect())
    }

    /// Returns the names of all pairs in contact at a configuration, by exact predicates.
    ///
    /// A pair within rounding error of contact counts. Margins do not matter.
    fn in_contact(&mut self, q: &Bound<'_, PyAny>) -> PyResult<Vec<Pair>> {
        let found = self
            .checker
            .in_contact(&configuration(q)?)
            .map_err(|e| self.fault(&e))?;
        Ok(found
            .into_iter()
            .map(|pair| answers::names(&self.checker, pair))
            .collect())
    }

    /// Returns whether a configuration keeps the margins, by exact predicates.
    ///
    /// With a second configuration, returns whether the straight segment between both is proven to
    /// keep the margins over its whole length.
    #[pyo3(signature = (q, to=None))]
    fn is_free(&mut self, q: &Bound<'_, PyAny>, to: Option<&Bound<'_, PyAny>>) -> PyResult<bool> {
        let q = configuration(q)?;
        match to {
            Some(to) => self.checker.is_free(&JointMotion::segment(&q, &configuration(to)?)),
            None => self.checker.is_free_at(&q),
        }
        .map_err(|e| self.fault(&e))
    }

    /// Returns the verdict on the straight segment between two configurations, over its whole
    /// length.
    ///
    /// The verdict is free, blocked by a pair at a time, or undecided.
    fn certify(&mut self, py: Python<'_>, start: &Bound<'_, PyAny>, goal: &Bound<'_, PyAny>) -> PyResult<Verdict> {
        let ends = [configuration(start)?, configuration(goal)?];
        let verdict = py.detach(|| self.checker.certify(&JointMotion::segment(&ends[0], &ends[1])));
        Ok(Verdict::new(verdict.map_err(|e| self.fault(&e))?, &self.checker))
    }

    /// Returns the receipt of a path, shape (K, dof), as a text: its proof, which `verify.py` checks.
    ///
    /// A path that is free has one proof for each segment. A segment (two rows) that is blocked has
    /// the proof of its contact, and that all pairs are apart before. Write the text to a file without
    /// changing line ends, and check it with `lin-canny verify FILE` or `python3 verify.py FILE`.
    ///
    /// Raises PlanError if a longer path is not free, or if the motion or a body has no receipt:
    /// clouds, surfaces, half-spaces and curved shapes but cylinders, cones and balls.
    fn receipt(&mut self, py: Python<'_>, path: &Bound<'_, PyAny>) -> PyResult<String> {
        let path = self.path(path)?;
        let motion = JointMotion::path(&path).map_err(plan_error)?;
        let written = py.detach(|| Receipt::motion(&mut self.checker, &motion));
        Ok(written.map_err(plan_error)?.to_string())
    }

    /// Returns the verdict on a path, shape (K, dof).
    ///
    /// It is free, or the verdict on the first segment that is not free; `segment` is its index.
    fn certify_path(&mut self, py: Python<'_>, path: &Bound<'_, PyAny>) -> PyResult<Verdict> {
        let path = self.path(path)?;
        let motion = JointMotion::path(&path).map_err(|e| self.fault(&e))?;
        let verdict = py.detach(|| self.checker.certify(&motion));
        Ok(Verdict::new(verdict.map_err(|e| self.fault(&e))?, &self.checker))
    }

    /// Returns the least clearance along the straight segment between two configurations.
    ///
    /// The result has a proven lower bound, a distance that is attained, its time, and the names of
    /// the pair. `relative`: the largest difference of the bounds, as a fraction of the upper
    /// bound.
    #[pyo3(signature = (start, goal, *, relative=1e-3))]
    fn clearance_along(
        &mut self,
        py: Python<'_>,
        start: &Bound<'_, PyAny>,
        goal: &Bound<'_, PyAny>,
        relative: f64,
    ) -> PyResult<(f64, f64, f64, Option<Pair>)> {
        let ends = [configuration(start)?, configuration(goal)?];
        let found = py.detach(|| {
            self.checker
                .clearance_along(&JointMotion::segment(&ends[0], &ends[1]), relative)
        });
        let found = found.map_err(|e| self.fault(&e))?;
        let pair = found.pair.map(|pair| answers::names(&self.checker, pair));
        Ok((found.lower, found.upper, found.t, pair))
    }

    /// Returns a path from one configuration to another, shape (K, dof).
    ///
    /// Every segment of the path is proven to keep the margin. Returns None if a limit ended the
    /// search, which proves nothing.
    ///
    /// method: "rrt-connect" (two trees that grow towards random configurations) or "opportunistic"
    /// (freeways of largest clearance). seed: the random seed; the same seed gives the same path
    /// unless `seconds` ends the search. slices and samples: the maximum number of random slices of the
    /// opportunistic planner, and of samples of RRT-Connect. seconds: the time limit. shorten: the
    /// number of attempts to shorten the path. Ctrl-C ends the search.
    #[pyo3(signature = (
        start, goal, *, method="rrt-connect", seed=0, slices=10_000, samples=100_000, seconds=None, shorten=300
    ))]
    #[allow(clippy::too_many_arguments)] // the signature in Python
    fn plan<'py>(
        &mut self,
        py: Python<'py>,
        start: &Bound<'py, PyAny>,
        goal: &Bound<'py, PyAny>,
        method: &str,
        seed: u64,
        slices: u64,
        samples: u64,
        seconds: Option<f64>,
        shorten: usize,
    ) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let ends = [configuration(start)?, configuration(goal)?];
        let names = || PlanMethod::ALL.map(|known| format!("{:?}", known.name())).join(", ");
        let method = PlanMethod::from_name(method)
            .ok_or_else(|| refused(format!("method is {method:?} (expected one of {})", names())))?;
        let options = PlanOptions::default().unlimited().seed(seed);
        let options = options.slices(slices).samples(samples);
        let limit = seconds.unwrap_or(f64::INFINITY);
        let path = py.detach(|| self.search(method, &ends, &options, limit, shorten))?;
        let Some(path) = path else { return Ok(None) };
        let (rows, columns) = (path.len(), self.dof());
        Ok(Some(PyArray1::from_vec(py, path.concat()).reshape([rows, columns])?))
    }

    fn __repr__(&self) -> String {
        let cell = self.checker.cell();
        let (robot, attached) = (cell.robot_bodies().len(), cell.attached().count());
        let carried = match attached {
            0 => String::new(),
            count => format!("{count} attached, "),
        };
        format!(
            "<Checker: {robot} bodies, {carried}{} obstacles, {} coordinates>",
            cell.obstacles().len(),
            self.dof()
        )
    }
}

impl Checker {
    fn of_cell(cell: Cell, skipped: &[Skipped], arguments: (Py<PyTuple>, Py<PyDict>)) -> PyResult<Self> {
        let checker = Box::new(Loaded::of_robots(cell).map_err(plan_error)?);
        Ok(Self {
            skipped: skipped.iter().map(ToString::to_string).collect(),
            checker,
            arguments,
        })
    }

    /// Returns the error of a call, with the name of the joint that is out of bounds.
    fn fault(&self, error: &PlanError) -> PyErr {
        plan_error(named(error, self.checker.cell().coordinates()))
    }

    /// Returns a new checker of the same world, with the same boxes of pairs.
    fn copy(&self) -> PyResult<Loaded<JointTree>> {
        self.checker.fork().map_err(plan_error)
    }

    /// Returns the checker of a robot without obstacles.
    pub(crate) fn alone(robot: &Bound<'_, Robot>) -> PyResult<Self> {
        let py = robot.py();
        let (cell, skipped) = setup::of_robots(&RobotArgument::One(robot.clone()), None, true)?;
        let arguments = (PyTuple::new(py, [robot])?.unbind(), PyDict::new(py).unbind());
        Self::of_cell(cell, &skipped, arguments)
    }

    /// Returns the configurations of a path.
    fn path(&self, path: &Bound<'_, PyAny>) -> PyResult<Path> {
        let array = contiguous::<f64>(path, CONFIGURATIONS)?;
        let rows = configurations(&array, self.dof())?;
        Ok(rows.map(<[f64]>::to_vec).collect())
    }

    fn search(
        &mut self,
        method: PlanMethod,
        [start, goal]: &[Vec<f64>; 2],
        options: &PlanOptions,
        seconds: f64,
        shorten: usize,
    ) -> PyResult<Option<Path>> {
        let began = Instant::now();
        let mut watch = Python::attach(|py| Watch::new(py, None))?;
        let mut stop = |now| {
            let is_stopped = watch.look(now).is_break();
            Progress::stop_if(is_stopped || began.elapsed().as_secs_f64() > seconds)
        };
        let found = method.plan(&mut self.checker, [start, goal], options, &mut stop);
        Python::attach(|py| watch.finish(py, false))?;
        match found.map_err(|e| self.fault(&e))?.path {
            Some(path) => {
                let short = Shortcuts::new(shorten, options.seed).shorten(&mut self.checker, &path);
                Ok(Some(short.map_err(|e| self.fault(&e))?))
            }
            None => Ok(None),
        }
    }
}

fn checker_of(space: JointTree, cell: Cell, margin: Option<f64>, time: Option<f64>) -> PyResult<Loaded<JointTree>> {
    let mut checker = Loaded::new(space, cell).map_err(plan_error)?;
    checker.set_start_contact_margin(margin).map_err(plan_error)?;
    time.map_or(Ok(()), |time| checker.set_time(time)).map_err(plan_error)?;
    Ok(checker)
}

/// Returns the text of an error, with the name of the joint that is out of bounds.
fn named(error: &PlanError, coordinates: &[Coordinate]) -> String {
    match error {
        PlanError::Coordinate { index, value } if *index < coordinates.len() => {
            let Coordinate { name, limits, .. } = &coordinates[*index];
            let [low, high] = limits;
            format!("coordinate {index}, {name}, is {value}, outside its limits {low} and {high}")
        }
        _ => error.to_string(),
    }
}

/// Returns a configuration of an argument of shape (dof,).
pub(crate) fn configuration(obj: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    if let Ok(array) = obj.cast::<PyArray1<f64>>()
        && let Ok(numbers) = array.to_vec()
    {
        refuse_mask(obj, CONFIGURATION)?;
        return Ok(numbers);
    }
    let array = contiguous::<f64>(obj, CONFIGURATION)?;
    match array.shape() {
        [_] => Ok(array.as_slice()?.to_vec()),
        shape => Err(plan_error(format!(
            "configuration: shape is {} (expected (dof,))",
            shape_text(shape)
        ))),
    }
}

/// Returns the rows of an array of shape (N, dof).
fn configurations<'a>(
    array: &'a numpy::PyReadonlyArrayDyn<'_, f64>,
    dof: usize,
) -> PyResult<std::slice::ChunksExact<'a, f64>> {
    if dof == 0 {
        return Err(refused("the robot has no coordinates"));
    }
    match array.shape() {
        [_, columns] if *columns == dof => Ok(array.as_slice()?.chunks_exact(dof)),
        shape => Err(plan_error(format!(
            "configurations: shape is {} (expected (N, {dof}))",
            shape_text(shape)
        ))),
    }
}
