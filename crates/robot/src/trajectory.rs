//! Trajectories: configurations from a CSV file, and their answers.

use std::path::Path;

use crate::error::{FileError, FileErrorKind};
use crate::robot::Coordinate;

/// Configurations one after the other; each joint moves evenly from one to the next.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Trajectory {
    /// The configurations, in the order of the coordinates.
    pub rows: Vec<Vec<f64>>,
    /// The times of the column `time`, if there is one.
    pub times: Option<Vec<f64>>,
    /// The line of each row in the file.
    pub lines: Vec<u32>,
}

/// The column of times.
const TIME: &str = "time";

impl Trajectory {
    /// Returns the trajectory of a CSV file. The first row names the columns: each coordinate
    /// once, in any order, and optionally `time`. A joint that mimics has no column.
    ///
    /// # Errors
    /// A file that cannot be read, a column that is missing, unknown or there twice, a value that
    /// is no number or not within its limits, times that do not increase: the line and the column.
    pub fn load(path: impl AsRef<Path>, coordinates: &[Coordinate]) -> Result<Self, FileError> {
        let path = path.as_ref();
        Self::parse(&FileError::read(path)?, path, coordinates)
    }

    /// Returns the trajectory of the text of a CSV file; `path` is the file that errors name.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(text: &str, path: impl AsRef<Path>, coordinates: &[Coordinate]) -> Result<Self, FileError> {
        let path = path.as_ref();
        let malformed = |e: csv::Error| {
            let line = e.position().map(|p| p.line() as u32);
            FileError::new(path, line, "", FileErrorKind::Malformed(e.to_string()))
        };
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(text.as_bytes());
        let columns = columns(reader.headers().map_err(malformed)?, coordinates)
            .map_err(|(column, reason)| FileError::new(path, Some(1), column, reason))?;
        let mut trajectory = Self::default();
        let mut times = Vec::new();
        for record in reader.records() {
            let record = record.map_err(malformed)?;
            let line = record.position().map_or(0, |p| p.line() as u32);
            let wrong = |column: &str, reason| FileError::new(path, Some(line), format!("column {column:?}"), reason);
            let mut row = vec![0.0; coordinates.len()];
            for (text, column) in record.iter().zip(&columns) {
                let name = column.map_or(TIME, |k| &coordinates[k].name);
                let value = number(text, name).map_err(|reason| wrong(name, reason))?;
                let Some(k) = *column else {
                    if times.last().is_some_and(|before| !(value > *before)) {
                        let reason = FileErrorKind::Malformed(format!("time {value} is not after the time before"));
                        return Err(wrong(name, reason));
                    }
                    times.push(value);
                    continue;
                };
                let [low, high] = coordinates[k].limits;
                if !(low..=high).contains(&value) {
                    let field = format!("{name} (limits {low} and {high})");
                    return Err(wrong(name, FileErrorKind::Range { field, value }));
                }
                row[k] = value;
            }
            trajectory.rows.push(row);
            trajectory.lines.push(line);
        }
        if trajectory.rows.is_empty() {
            return Err(FileError::new(path, None, "", FileErrorKind::Missing("a row".into())));
        }
        trajectory.times = columns.contains(&None).then_some(times);
        Ok(trajectory)
    }
}

fn number(text: &str, name: &str) -> Result<f64, FileErrorKind> {
    let value = text.parse::<f64>().ok().filter(|x| x.is_finite());
    value.ok_or_else(|| FileErrorKind::Number {
        field: name.into(),
        count: 1,
        text: text.into(),
    })
}

/// Returns the coordinate of each column, `None` for the column of times.
fn columns(
    header: &csv::StringRecord,
    coordinates: &[Coordinate],
) -> Result<Vec<Option<usize>>, (String, FileErrorKind)> {
    let mut columns = Vec::new();
    for name in header {
        let column = coordinates.iter().position(|c| c.name == name);
        let title = || format!("column {name:?}");
        if column.is_none() && name != TIME {
            let (kind, name) = ("coordinate", name.to_owned());
            return Err((title(), FileErrorKind::Unknown { kind, name }));
        }
        if columns.contains(&column) {
            return Err((title(), FileErrorKind::Repeated));
        }
        columns.push(column);
    }
    match (0..coordinates.len()).find(|k| !columns.contains(&Some(*k))) {
        Some(k) => Err((
            String::new(),
            FileErrorKind::Missing(format!("column {:?}", coordinates[k].name)),
        )),
        None => Ok(columns),
    }
}

/// Returns the text of a CSV file of configurations.
#[must_use]
pub fn csv_text(coordinates: &[Coordinate], rows: &[Vec<f64>]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing to memory does not fail.
    let _ = writer.write_record(coordinates.iter().map(|c| &c.name));
    for row in rows {
        let _ = writer.write_record(row.iter().map(|x| format!("{x:?}")));
    }
    writer
        .into_inner()
        .map(|bytes| String::from_utf8_lossy(&bytes).into_owned())
        .unwrap_or_default()
}
