//! The class `Trajectory`: points with times, velocities and accelerations.

use std::path::PathBuf;

use lin_canny_robot::plan::{JointCurve as Curve, nearest_name};
use lin_canny_robot::{Coordinate, Trajectory as Loaded};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::array::{Argument, numbers, of_table, table};
use crate::checker::Checker;
use crate::curve::JointCurve;
use crate::errors::{file_error, plan_error, refused};
use crate::pickle::{Pickled, pickled};
use crate::robot::Robot;

const TIMES: Argument = Argument {
    name: "times",
    error: |why| plan_error(why),
};
const POSITIONS: Argument = Argument {
    name: "positions",
    ..TIMES
};
const VELOCITIES: Argument = Argument {
    name: "velocities",
    ..TIMES
};
const ACCELERATIONS: Argument = Argument {
    name: "accelerations",
    ..TIMES
};
const TUBE: Argument = Argument { name: "tube", ..TIMES };

/// What has coordinates.
#[derive(FromPyObject)]
pub(crate) enum Coordinates<'py> {
    Robot(Bound<'py, Robot>),
    Checker(PyRef<'py, Checker>),
}

impl Coordinates<'_> {
    fn list(&self) -> &[Coordinate] {
        match self {
            Self::Robot(robot) => robot.get().robot.coordinates(),
            Self::Checker(checker) => checker.coordinate_list(),
        }
    }
}

/// Points with times, and optionally velocities and accelerations.
///
/// Between two points a joint moves as the joint trajectory controller of ROS 2 interpolates:
/// linearly, by a cubic if both points have velocities, by a quintic if both have accelerations as
/// well. `Checker.certify_trajectory` proves the whole motion.
///
/// Parameters
/// ----------
/// times : array_like, shape (N,)
///     In ascending order.
/// positions : array_like, shape (N, dof)
/// velocities, accelerations : array_like, shape (N, dof), optional
///     In the unit of the times. Accelerations need velocities.
/// tube : array_like, shape (N, dof), optional
///     How much each joint may deviate at each point, linear between points: the tube of
///     `Checker.certify_trajectory`.
/// names : sequence of str, optional
///     The joints of the columns, in any order. By default the columns are in the order of
///     `Checker.coordinates`.
///
/// Examples
/// --------
/// >>> rest = np.zeros((2, 2))
/// >>> motion = lc.Trajectory([0, 2], [[0, 0], [1, 0.5]], rest, names=["lift", "turn"])
/// >>> motion.at([0, 1, 2])
/// array([[0.  , 0.  ],
///        [0.5 , 0.25],
///        [1.  , 0.5 ]])
#[pyclass(frozen, module = "lin_canny")]
pub(crate) struct Trajectory {
    names: Option<Vec<String>>,
    times: Vec<f64>,
    points: Loaded,
    /// Of a smooth motion, the rows of the path at which it stops.
    stops: Option<Vec<usize>>,
}

/// The numbers of a trajectory: names, times, positions, velocities, accelerations, tube.
type Parts = (
    Option<Vec<String>>,
    Vec<f64>,
    Vec<Vec<f64>>,
    Vec<Vec<f64>>,
    Vec<Vec<f64>>,
    Vec<Vec<f64>>,
);

impl Trajectory {
    fn of_parts((names, times, rows, velocities, accelerations, tube): Parts) -> Self {
        let mut points = Loaded::default();
        points.rows = rows;
        points.times = Some(times.clone());
        points.velocities = velocities;
        points.accelerations = accelerations;
        points.tube = tube;
        Self {
            names,
            times,
            points,
            stops: None,
        }
    }

    fn of_points(names: Vec<String>, mut points: Loaded) -> Self {
        let times = points.times.take().unwrap_or_default();
        let Loaded {
            rows,
            velocities,
            accelerations,
            tube,
            ..
        } = points;
        Self::of_parts((Some(names), times, rows, velocities, accelerations, tube))
    }

    /// Returns a smooth motion, which stops at rows of its path.
    pub(crate) fn smooth(names: Vec<String>, points: Loaded, stops: Vec<usize>) -> Self {
        Self {
            stops: Some(stops),
            ..Self::of_points(names, points)
        }
    }

    /// Returns the number of points.
    pub(crate) fn len(&self) -> usize {
        self.times.len()
    }

    fn width(&self) -> usize {
        self.points.rows[0].len()
    }

    /// Returns the times at the ends of a segment.
    pub(crate) fn span(&self, segment: usize) -> [f64; 2] {
        let last = self.len() - 1;
        [segment, segment + 1].map(|k| self.times[k.min(last)])
    }

    /// Returns the time of a point of a segment.
    pub(crate) fn time_at(&self, segment: usize, t: f64) -> f64 {
        let [from, until] = self.span(segment);
        from + (until - from) * t
    }

    /// Returns the curves of the segments, in the order of the coordinates. A trajectory of one point
    /// is a curve that stays there.
    pub(crate) fn curves_in_order(&self, coordinates: &[Coordinate]) -> PyResult<Vec<Curve>> {
        let order = self.order(coordinates)?;
        let Loaded {
            rows,
            velocities,
            accelerations,
            ..
        } = &self.points;
        let [rows, velocities, accelerations] = [rows, velocities, accelerations].map(|of| ordered(of, &order));
        let parts = (None, self.times.clone(), rows, velocities, accelerations, Vec::new());
        curves(&Self::of_parts(parts).points)
    }

    /// Returns the tube of the points, in the order of the coordinates; none if the trajectory
    /// has none.
    pub(crate) fn tube_in_order(&self, coordinates: &[Coordinate]) -> PyResult<Vec<Vec<f64>>> {
        let rows = &self.points.tube;
        match rows.iter().all(Vec::is_empty) {
            true => Ok(Vec::new()),
            false => Ok(ordered(rows, &self.order(coordinates)?)),
        }
    }

    /// Returns the column of each coordinate.
    fn order(&self, coordinates: &[Coordinate]) -> PyResult<Vec<usize>> {
        let count = coordinates.len();
        let Some(names) = &self.names else {
            if self.width() == count {
                return Ok((0..count).collect());
            }
            let width = self.width();
            return Err(plan_error(format!(
                "trajectory has {width} columns (expected {count}, or names of the columns)"
            )));
        };
        let known = || coordinates.iter().map(|c| c.name.as_str());
        if let Some(name) = names.iter().find(|name| !known().any(|known| known == *name)) {
            let near = nearest_name(name, known());
            let near = near.map_or(String::new(), |near| format!(" (nearest: {near:?})"));
            return Err(plan_error(format!("trajectory: joint {name:?} does not exist{near}")));
        }
        let column = |coordinate: &Coordinate| {
            let found = names.iter().position(|name| *name == coordinate.name);
            found.ok_or_else(|| plan_error(format!("trajectory: joint {:?} is missing", coordinate.name)))
        };
        coordinates.iter().map(column).collect()
    }

    /// Returns velocities, accelerations or tube as an array, NaN in rows without; `None` if no row has
    /// them.
    fn derivative<'py>(&self, py: Python<'py>, rows: &[Vec<f64>]) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        if rows.iter().all(Vec::is_empty) {
            return Ok(None);
        }
        let width = self.width();
        let full = |row: &Vec<f64>| match row.is_empty() {
            true => vec![f64::NAN; width],
            false => row.clone(),
        };
        let full: Vec<Vec<f64>> = rows.iter().map(full).collect();
        of_table(py, &full, width).map(Some)
    }
}

/// Returns rows whose columns are in this order; empty rows stay.
fn ordered(rows: &[Vec<f64>], order: &[usize]) -> Vec<Vec<f64>> {
    let each = |row: &Vec<f64>| match row.is_empty() {
        true => Vec::new(),
        false => order.iter().map(|k| row[*k]).collect(),
    };
    rows.iter().map(each).collect()
}

fn curves(points: &Loaded) -> PyResult<Vec<Curve>> {
    match &points.rows[..] {
        [only] => Ok(vec![Curve::bezier(&[only]).map_err(plan_error)?]),
        _ => points.curves().map_err(plan_error),
    }
}

/// Returns an error unless times are finite and in ascending order.
fn check_times(times: &[f64]) -> PyResult<()> {
    if times.is_empty() {
        return Err(plan_error("trajectory has no point (expected at least one)"));
    }
    if let Some(k) = times.iter().position(|t| !t.is_finite()) {
        return Err(plan_error(format!("times: entry {k} is not finite: {}", times[k])));
    }
    match times.windows(2).position(|pair| !(pair[1] > pair[0])) {
        Some(k) => Err(plan_error(format!(
            "times: entry {} is {}, not after entry {k}, {}",
            k + 1,
            times[k + 1],
            times[k]
        ))),
        None => Ok(()),
    }
}

/// Returns rows of the shape of the positions; none if the argument was left out.
fn like_positions(
    obj: Option<&Bound<'_, PyAny>>,
    argument: Argument,
    [count, width]: [usize; 2],
) -> PyResult<Vec<Vec<f64>>> {
    let Some(obj) = obj else { return Ok(Vec::new()) };
    let rows = table(obj, argument)?;
    let found = rows.first().map_or(0, Vec::len);
    if rows.len() != count || found != width {
        return Err(plan_error(format!(
            "{}: shape is ({}, {found}) (expected ({count}, {width}))",
            argument.name,
            rows.len()
        )));
    }
    Ok(rows)
}

#[pymethods]
impl Trajectory {
    #[new]
    #[pyo3(signature = (times, positions, velocities=None, accelerations=None, *, tube=None, names=None))]
    fn new(
        times: &Bound<'_, PyAny>,
        positions: &Bound<'_, PyAny>,
        velocities: Option<&Bound<'_, PyAny>>,
        accelerations: Option<&Bound<'_, PyAny>>,
        tube: Option<&Bound<'_, PyAny>>,
        names: Option<Vec<String>>,
    ) -> PyResult<Self> {
        let times = numbers(times, TIMES)?;
        check_times(&times)?;
        let rows = table(positions, POSITIONS)?;
        let shape = [times.len(), rows.first().map_or(0, Vec::len)];
        if rows.len() != shape[0] {
            let (count, expected) = (rows.len(), shape[0]);
            return Err(plan_error(format!(
                "positions: number of rows is {count} (expected {expected}, one for each time)"
            )));
        }
        if velocities.is_none() && accelerations.is_some() {
            return Err(plan_error("accelerations are given without velocities"));
        }
        let velocities = like_positions(velocities, VELOCITIES, shape)?;
        let accelerations = like_positions(accelerations, ACCELERATIONS, shape)?;
        let tube = like_positions(tube, TUBE, shape)?;
        if let Some(value) = tube.iter().flatten().find(|x| !(**x >= 0.0)) {
            return Err(plan_error(format!("tube: entry is {value} (expected at least 0)")));
        }
        if let Some(names) = &names {
            if names.len() != shape[1] {
                let (count, expected) = (names.len(), shape[1]);
                return Err(plan_error(format!("number of names is {count} (expected {expected})")));
            }
            if let Some(k) = (1..names.len()).find(|k| names[..*k].contains(&names[*k])) {
                return Err(plan_error(format!("names: joint {:?} is given twice", names[k])));
            }
        }
        let made = Self::of_parts((names, times, rows, velocities, accelerations, tube));
        curves(&made.points)?;
        Ok(made)
    }

    /// Returns the trajectory of a CSV, JSON or YAML file; the extension decides.
    ///
    /// A CSV file has the columns `time` and one for each joint, in any order. Joint `elbow` has the
    /// optional columns `elbow.velocity`, `elbow.acceleration` and `elbow.tube`, how much it may
    /// deviate. JSON and YAML files hold a message
    /// `JointTrajectory` of ROS 1 or 2, alone or in a message around it.
    ///
    /// Parameters
    /// ----------
    /// path : str or PathLike
    /// robot : Robot or Checker
    ///     Whose coordinates the columns are.
    /// rest : dict, optional
    ///     From names of coordinates to the values of those that the file does not name: they stay.
    ///
    /// Raises
    /// ------
    /// FileError
    ///     If a joint is missing or unknown, if times do not increase, or if a value is not a number
    ///     within its limits. Names the file, and the line or the point, counted from 1.
    #[staticmethod]
    #[pyo3(signature = (path, robot, *, rest=None))]
    fn load(path: PathBuf, robot: Coordinates<'_>, rest: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let coordinates = robot.list();
        let mut values = vec![None; coordinates.len()];
        for (name, value) in rest.into_iter().flatten() {
            let (name, value): (String, f64) = (name.extract()?, value.extract()?);
            let at = coordinates.iter().position(|c| c.name == name);
            let at = at.ok_or_else(|| plan_error(format!("rest: joint {name:?} does not exist")))?;
            let [low, high] = coordinates[at].limits;
            if !(low..=high).contains(&value) {
                return Err(plan_error(format!(
                    "rest: {name} is {value}, outside its limits {low} and {high}"
                )));
            }
            values[at] = Some(value);
        }
        let points = Loaded::load_timed(path, coordinates, &values).map_err(file_error)?;
        let names = coordinates.iter().map(|c| c.name.clone()).collect();
        Ok(Self::of_points(names, points))
    }

    /// The joints of the columns; None if they are those of the checker.
    #[getter]
    fn names(&self) -> Option<Vec<String>> {
        self.names.clone()
    }

    /// The times of the points, shape (N,).
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.times)
    }

    /// The configurations, shape (N, dof).
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        of_table(py, &self.points.rows, self.width())
    }

    /// The velocities, shape (N, dof), NaN at points without; None if no point has them.
    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.derivative(py, &self.points.velocities)
    }

    /// The accelerations, shape (N, dof), NaN at points without; None if no point has them.
    #[getter]
    fn accelerations<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.derivative(py, &self.points.accelerations)
    }

    /// How much each joint may deviate at each point, shape (N, dof); None if the trajectory has no
    /// tube.
    #[getter]
    fn tube<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        self.derivative(py, &self.points.tube)
    }

    /// The inner rows of the path at which a motion of `Checker.smooth` stops; None for others.
    #[getter]
    fn stops(&self) -> Option<Vec<usize>> {
        self.stops.clone()
    }

    /// Returns the curves from each point to the next, each over its own times 0 to 1, with the
    /// times of its points: see `JointCurve.with_times`.
    ///
    /// robot: a Robot or Checker whose coordinates the curves have, in its order; by default that of
    /// the columns.
    #[pyo3(signature = (robot=None))]
    fn curves(&self, robot: Option<Coordinates<'_>>) -> PyResult<Vec<JointCurve>> {
        let found = match robot {
            Some(robot) => self.curves_in_order(robot.list())?,
            None => curves(&self.points)?,
        };
        Ok(found.into_iter().map(JointCurve).collect())
    }

    /// Returns the configurations at times, shape (N,), by interpolation: shape (N, dof), in the
    /// order of the columns.
    fn at<'py>(&self, py: Python<'py>, times: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let times = numbers(times, TIMES)?;
        let (first, last) = (self.times[0], self.times[self.len() - 1]);
        if let Some(k) = times.iter().position(|t| !(first..=last).contains(t)) {
            let time = times[k];
            return Err(plan_error(format!(
                "times: entry {k} is {time} (expected {first} to {last})"
            )));
        }
        let curves = curves(&self.points)?;
        let row = |time: &f64| {
            let k = self.times.partition_point(|t| t <= time).saturating_sub(1);
            let k = k.min(curves.len() - 1);
            let [from, until] = self.span(k);
            let part = if until > from {
                (time - from) / (until - from)
            } else {
                0.0
            };
            curves[k].at(part)
        };
        let rows: Vec<_> = times.iter().map(row).collect();
        of_table(py, &rows, self.width())
    }

    /// The number of points.
    fn __len__(&self) -> usize {
        self.len()
    }

    fn __repr__(&self) -> String {
        let (first, last) = (self.times[0], self.times[self.len() - 1]);
        let count = self.len();
        format!("<Trajectory: {count} points, times {first} to {last}>")
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py>> {
        let Loaded {
            rows,
            velocities,
            accelerations,
            tube,
            ..
        } = &self.points;
        let parts = (&self.names, &self.times, rows, velocities, accelerations, tube);
        let parts = (parts, &self.stops);
        pickled::<Self>(py, postcard::to_stdvec(&parts))
    }

    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        let (parts, stops): (Parts, _) = postcard::from_bytes(bytes).map_err(refused)?;
        check_times(&parts.1)?;
        let made = Self {
            stops,
            ..Self::of_parts(parts)
        };
        curves(&made.points)?;
        Ok(made)
    }
}
