//! Trajectories: configurations in CSV files, and points with times, velocities and accelerations.

use std::path::Path;

use crate::csv_rows::Records;
use crate::error::{FileError, FileErrorKind};
use lin_canny_plan::Coordinate;
use lin_canny_plan::{JointCurve, JointTube, PlanError, SmoothPath, nearest_name as nearest};

/// A sequence of configurations.
///
/// Without velocities, each joint moves at constant speed from one to the next.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Trajectory {
    /// The configurations, in the order of the coordinates.
    pub rows: Vec<Vec<f64>>,
    /// The column `time`, if there is one.
    pub times: Option<Vec<f64>>,
    /// The velocities of each row; empty where the file has none.
    pub velocities: Vec<Vec<f64>>,
    /// The accelerations of each row; empty where the file has none.
    pub accelerations: Vec<Vec<f64>>,
    /// How much each coordinate may deviate at each row; empty where the file has no tubes.
    pub tube: Vec<Vec<f64>>,
    /// Line of each row in a CSV file, or number of each point in a file of another format.
    pub lines: Vec<u32>,
}

/// Name of the column of times.
const TIME: &str = "time";

/// What the name of a column adds to that of a coordinate.
const DERIVATIVES: [&str; 2] = [".velocity", ".acceleration"];

/// What the name of a column of a tube adds to that of a coordinate.
const TUBE: &str = ".tube";

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Column {
    Time,
    /// Value of a coordinate.
    Value(usize),
    /// First (0) or second (1) derivative of a coordinate.
    Derivative(usize, usize),
    /// How much a coordinate may deviate.
    Tube(usize),
}

impl Trajectory {
    /// Returns the trajectory of a CSV file.
    ///
    /// The first row names the columns: each coordinate once, in any order, and optionally `time`.
    /// A mimic joint has no column.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, a column is missing, unknown or repeated, a
    /// value is not a number within its limits, or times do not increase. The error names the line
    /// and the column.
    pub fn load(path: impl AsRef<Path>, coordinates: &[Coordinate]) -> Result<Self, FileError> {
        Self::load_with_rest(path, coordinates, &[])
    }

    /// Returns the trajectory of a CSV file, which may lack the columns of some coordinates.
    ///
    /// A coordinate without a column has its value of `rest`, in the order of `coordinates`. `None`
    /// and values beyond the end of `rest` require a column.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_with_rest(
        path: impl AsRef<Path>,
        coordinates: &[Coordinate],
        rest: &[Option<f64>],
    ) -> Result<Self, FileError> {
        let path = path.as_ref();
        Self::read(&FileError::read(path)?, path, coordinates, rest, false)
    }

    /// Returns the curve from each row to the next, as the joint trajectory controller of ROS 2
    /// interpolates: of degree 1, of degree 3 if both rows have velocities, of degree 5 if both
    /// have accelerations as well. Curves have the times of their rows
    /// ([`JointCurve::times`]), if there are times.
    ///
    /// # Errors
    /// Returns an error if the times do not increase or a number is out of range.
    pub fn curves(&self) -> Result<Vec<JointCurve>, PlanError> {
        let each = self.rows.windows(2).enumerate().map(|(k, ends)| {
            let ends = [&ends[0], &ends[1]];
            let both = |of: &[Vec<f64>]| Some([of.get(k)?.clone(), of.get(k + 1)?.clone()]);
            let given = |of: &[Vec<f64>]| both(of).filter(|of| of.iter().all(|row| !row.is_empty()));
            let times = self.times.as_ref().map(|times| [times[k], times[k + 1]]);
            let duration = times.map_or(1.0, |[from, until]| until - from);
            let curve = match (given(&self.velocities), given(&self.accelerations)) {
                (None, _) => JointCurve::bezier(&ends),
                (Some([v, w]), None) => JointCurve::cubic(ends[0], ends[1], &v, &w, duration),
                (Some(velocities), Some(accelerations)) => {
                    JointCurve::quintic(ends.map(Clone::clone), velocities, accelerations, duration)
                }
            }?;
            times.map_or(Ok(curve.clone()), |times| curve.with_times(times))
        });
        each.collect()
    }

    /// Returns the tube around the motion from each row to the next, for
    /// [`JointMotion::with_tube`](lin_canny_plan::JointMotion::with_tube). Its entries are
    /// linear between those of the rows. There are none if no row has a tube.
    ///
    /// # Errors
    /// Returns an error if a number is out of range, or if rows have different lengths.
    pub fn tubes(&self) -> Result<Vec<JointTube>, PlanError> {
        let each = self.tube.windows(2).filter(|rows| !rows[0].is_empty());
        each.map(|rows| Ok(JointCurve::bezier(rows)?.into())).collect()
    }

    /// Returns the trajectory as the text of a CSV file, which [`load_timed`](Self::load_timed) reads
    /// with the same bits.
    ///
    /// `coordinates` are those of the rows. Velocities, accelerations and tubes are written if all
    /// rows have them.
    #[must_use]
    pub fn csv_text(&self, coordinates: &[Coordinate]) -> String {
        let count = self.rows.len();
        let given = |rows: &[Vec<f64>]| rows.len() == count && rows.iter().all(|row| row.len() == coordinates.len());
        let mut names: Vec<String> = self.times.iter().map(|_| TIME.into()).collect();
        names.extend(coordinates.iter().map(|c| c.name.clone()));
        let mut parts = vec![&self.rows];
        let [velocity, acceleration] = DERIVATIVES;
        let more = [
            (&self.velocities, velocity),
            (&self.accelerations, acceleration),
            (&self.tube, TUBE),
        ];
        for (rows, suffix) in more {
            if given(rows) {
                names.extend(coordinates.iter().map(|c| format!("{}{suffix}", c.name)));
                parts.push(rows);
            }
        }
        let row = |k: usize| {
            let time = self.times.iter().map(move |times| times[k]);
            time.chain(parts.iter().flat_map(move |rows| rows[k].iter().copied()))
        };
        table(&names, (0..count).map(row))
    }

    /// Returns values for [`load_with_rest`](Self::load_with_rest): those of a CSV file with one
    /// row, and `None` for each coordinate without a column.
    ///
    /// # Errors
    /// As [`load`](Self::load), except that columns may be missing. Returns an error if the file
    /// has several rows.
    pub fn load_rest(path: impl AsRef<Path>, coordinates: &[Coordinate]) -> Result<Vec<Option<f64>>, FileError> {
        let path = path.as_ref();
        let missing = vec![Some(f64::NAN); coordinates.len()];
        let found = Self::load_with_rest(path, coordinates, &missing)?;
        match &found.rows[..] {
            [row] => Ok(row.iter().map(|&x| Some(x).filter(|x| !x.is_nan())).collect()),
            rows => {
                let reason = format!("too many rows: {} (expected 1)", rows.len());
                Err(FileError::new(path, None, "", FileErrorKind::Malformed(reason)))
            }
        }
    }

    /// Returns the trajectory of a CSV text. Errors name the file `path`.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(text: &str, path: impl AsRef<Path>, coordinates: &[Coordinate]) -> Result<Self, FileError> {
        Self::read(text, path.as_ref(), coordinates, &[], false)
    }

    /// Reads a CSV text; `is_timed` requires times, and accepts velocities and accelerations.
    pub(crate) fn read(
        text: &str,
        path: &Path,
        coordinates: &[Coordinate],
        rest: &[Option<f64>],
        is_timed: bool,
    ) -> Result<Self, FileError> {
        let mut records = Records::new(text, path)?;
        let columns = columns(&records.names, coordinates, rest, is_timed)
            .map_err(|(column, reason)| FileError::new(path, Some(records.line), column, reason))?;
        let is_derivative = |order: usize| move |c: &Column| matches!(c, Column::Derivative(o, _) if *o == order);
        let has = [0, 1].map(|order| columns.iter().any(is_derivative(order)));
        let has_tube = columns.iter().any(|c| matches!(c, Column::Tube(_)));
        let mut trajectory = Self::default();
        let mut times = Vec::new();
        while let Some((line, record)) = records.next_row()? {
            let wrong = |column: &str, reason| FileError::new(path, Some(line), format!("column {column:?}"), reason);
            let mut row: Vec<f64> = rest.iter().map(|value| value.unwrap_or_default()).collect();
            row.resize(coordinates.len(), 0.0);
            let mut derivatives = has.map(|has| vec![0.0; if has { row.len() } else { 0 }]);
            let mut tube = vec![0.0; if has_tube { row.len() } else { 0 }];
            for ((text, name), column) in record.iter().zip(&records.names).zip(&columns) {
                let value = number(text, name).map_err(|reason| wrong(name, reason))?;
                match *column {
                    Column::Time => {
                        check_time(times.last(), value).map_err(|reason| wrong(name, reason))?;
                        times.push(value);
                    }
                    Column::Value(k) => {
                        check_limits(&coordinates[k], value).map_err(|reason| wrong(name, reason))?;
                        row[k] = value;
                    }
                    Column::Derivative(order, k) => derivatives[order][k] = value,
                    Column::Tube(k) if value >= 0.0 => tube[k] = value,
                    Column::Tube(_) => {
                        let reason = format!("deviation is {value} (expected at least 0)");
                        return Err(wrong(name, FileErrorKind::Malformed(reason)));
                    }
                }
            }
            trajectory.rows.push(row);
            if is_timed {
                let [velocities, accelerations] = derivatives;
                trajectory.velocities.push(velocities);
                trajectory.accelerations.push(accelerations);
                trajectory.tube.push(tube);
            }
            trajectory.lines.push(line);
        }
        if trajectory.rows.is_empty() {
            return Err(FileError::new(path, None, "", FileErrorKind::Missing("a row".into())));
        }
        trajectory.times = columns.contains(&Column::Time).then_some(times);
        Ok(trajectory)
    }
}

impl From<SmoothPath> for Trajectory {
    /// Returns the rows of a smooth motion, which are numbered as the lines of
    /// [`csv_text`](Trajectory::csv_text). Its [`curves`](Trajectory::curves) are those of the
    /// motion, bit for bit, with their times.
    fn from(smooth: SmoothPath) -> Self {
        let count = smooth.positions.len();
        Self {
            lines: (2..).take(count).collect(),
            times: Some(smooth.times),
            velocities: smooth.velocities,
            accelerations: match smooth.accelerations.is_empty() {
                true => vec![Vec::new(); count],
                false => smooth.accelerations,
            },
            tube: vec![Vec::new(); count],
            rows: smooth.positions,
        }
    }
}

/// Returns the finite number of a field.
pub(crate) fn number(text: &str, name: &str) -> Result<f64, FileErrorKind> {
    let value = text.parse::<f64>().ok().filter(|x| x.is_finite());
    value.ok_or_else(|| FileErrorKind::Number {
        field: name.into(),
        count: 1,
        text: text.into(),
    })
}

/// Returns an error unless a time is later than the one before.
pub(crate) fn check_time(before: Option<&f64>, time: f64) -> Result<(), FileErrorKind> {
    match before {
        Some(before) if !(time > *before) => Err(FileErrorKind::Malformed(format!(
            "time {time} is not greater than the time of the previous row"
        ))),
        _ => Ok(()),
    }
}

/// Returns an error if a value is outside the limits of its coordinate.
pub(crate) fn check_limits(coordinate: &Coordinate, value: f64) -> Result<(), FileErrorKind> {
    let [low, high] = coordinate.limits;
    if (low..=high).contains(&value) {
        return Ok(());
    }
    let field = format!("{} (limits {low} and {high})", coordinate.name);
    Err(FileErrorKind::Range { field, value })
}

/// Returns the coordinate of a name.
pub(crate) fn coordinate(name: &str, coordinates: &[Coordinate]) -> Result<usize, FileErrorKind> {
    let found = coordinates.iter().position(|c| c.name == name);
    found.ok_or_else(|| FileErrorKind::Unknown {
        kind: "coordinate",
        name: name.to_owned(),
        near: nearest(name, coordinates.iter().map(|c| c.name.as_str())),
    })
}

/// Returns an error if a coordinate has neither a name in the file nor a value of `rest`. `what`
/// makes a name into what is missing.
pub(crate) fn check_complete(
    coordinates: &[Coordinate],
    rest: &[Option<f64>],
    is_named: impl Fn(usize) -> bool,
    what: impl Fn(&str) -> String,
) -> Result<(), FileErrorKind> {
    let has_value = |k: &usize| is_named(*k) || matches!(rest.get(*k), Some(Some(_)));
    let missing: Vec<usize> = (0..coordinates.len()).filter(|k| !has_value(k)).collect();
    let Some(first) = missing.first().map(|&k| what(&coordinates[k].name)) else {
        return Ok(());
    };
    Err(FileErrorKind::Missing(match missing.len() {
        1 => first,
        count => format!("{first} (first of {count})"),
    }))
}

/// Returns what each column holds.
fn columns(
    header: &[String],
    coordinates: &[Coordinate],
    rest: &[Option<f64>],
    is_timed: bool,
) -> Result<Vec<Column>, (String, FileErrorKind)> {
    let mut columns = Vec::new();
    for name in header {
        let title = || format!("column {name:?}");
        let derivative = DERIVATIVES.iter().enumerate().find_map(|(order, suffix)| {
            let k = coordinate(name.strip_suffix(suffix)?, coordinates).ok()?;
            is_timed.then_some(Column::Derivative(order, k))
        });
        let tube = || {
            let k = coordinate(name.strip_suffix(TUBE)?, coordinates).ok()?;
            is_timed.then_some(Column::Tube(k))
        };
        let column = match (derivative.or_else(tube), name == TIME) {
            (Some(derivative), _) => derivative,
            (None, is_time) => match (coordinate(name, coordinates), is_time) {
                (Ok(k), _) => Column::Value(k),
                (Err(_), true) => Column::Time,
                (Err(reason), false) => return Err((title(), reason)),
            },
        };
        if columns.contains(&column) {
            return Err((title(), FileErrorKind::Repeated));
        }
        columns.push(column);
    }
    let has = |column| columns.contains(&column);
    let whole = |reason| (String::new(), reason);
    check_complete(
        coordinates,
        rest,
        |k| has(Column::Value(k)),
        |name| format!("column {name:?}"),
    )
    .map_err(whole)?;
    if is_timed && !has(Column::Time) {
        return Err(whole(FileErrorKind::Missing(format!("column {TIME:?}"))));
    }
    for (order, suffix) in DERIVATIVES.into_iter().enumerate() {
        // All joints of the file have a derivative, and those below it, or none has.
        let is_used = |c: &Column| matches!(c, Column::Derivative(o, _) if *o >= order);
        let lacks = |k: &usize| has(Column::Value(*k)) && !has(Column::Derivative(order, *k));
        if columns.iter().any(is_used)
            && let Some(k) = (0..coordinates.len()).find(lacks)
        {
            let name = format!("{}{suffix}", coordinates[k].name);
            return Err(whole(FileErrorKind::Missing(format!("column {name:?}"))));
        }
    }
    Ok(columns)
}

/// Returns configurations as the text of a CSV file.
#[must_use]
pub fn csv_text(coordinates: &[Coordinate], rows: &[Vec<f64>]) -> String {
    let names: Vec<String> = coordinates.iter().map(|c| c.name.clone()).collect();
    table(&names, rows.iter().map(|row| row.iter().copied()))
}

/// Returns the text of a CSV file. Each number is written with as many digits as its bits need.
fn table(names: &[String], rows: impl Iterator<Item = impl Iterator<Item = f64>>) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing to memory does not fail.
    let _ = writer.write_record(names);
    for row in rows {
        let _ = writer.write_record(row.map(|x| format!("{x:?}")));
    }
    writer
        .into_inner()
        .map(|bytes| String::from_utf8_lossy(&bytes).into_owned())
        .unwrap_or_default()
}
