//! Trajectories: configurations in CSV files.

use std::io::Read as _;
use std::path::Path;

use crate::error::{FileError, FileErrorKind};
use crate::robot::Coordinate;
use crate::text::check_content;
use lin_canny_plan::nearest_name as nearest;

/// A sequence of configurations; each joint moves at constant speed from one to the next.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Trajectory {
    /// The configurations, in the order of the coordinates.
    pub rows: Vec<Vec<f64>>,
    /// The column `time`, if there is one.
    pub times: Option<Vec<f64>>,
    /// Line of each row in the file.
    pub lines: Vec<u32>,
}

/// Name of the column of times.
const TIME: &str = "time";

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
        Self::read(&FileError::read(path)?, path, coordinates, rest)
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
        Self::read(text, path.as_ref(), coordinates, &[])
    }

    fn read(text: &str, path: &Path, coordinates: &[Coordinate], rest: &[Option<f64>]) -> Result<Self, FileError> {
        check_content(text).map_err(|reason| FileError::new(path, Some(1), "", reason))?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = Lines::new(text);
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .flexible(true)
            // A comment in the last line without an end would be a record.
            .from_reader(text.as_bytes().chain(&b"\n"[..]));
        let malformed = |e: csv::Error| FileError::new(path, None, "", FileErrorKind::Malformed(e.to_string()));
        let header = reader.headers().map_err(malformed)?;
        let (line, count) = (lines.of(header.position()), header.len());
        let columns = columns(header, coordinates, rest)
            .map_err(|(column, reason)| FileError::new(path, Some(line), column, reason))?;
        let mut trajectory = Self::default();
        let mut times = Vec::new();
        for record in reader.records() {
            let record = record.map_err(malformed)?;
            let line = lines.of(record.position());
            if record.len() != count {
                let reason = format!("wrong number of fields: {} (expected {count})", record.len());
                return Err(FileError::new(path, Some(line), "", FileErrorKind::Malformed(reason)));
            }
            let wrong = |column: &str, reason| FileError::new(path, Some(line), format!("column {column:?}"), reason);
            let mut row: Vec<f64> = rest.iter().map(|value| value.unwrap_or_default()).collect();
            row.resize(coordinates.len(), 0.0);
            for (text, column) in record.iter().zip(&columns) {
                let name = column.map_or(TIME, |k| &coordinates[k].name);
                let value = number(text, name).map_err(|reason| wrong(name, reason))?;
                let Some(k) = *column else {
                    if times.last().is_some_and(|before| !(value > *before)) {
                        let reason = FileErrorKind::Malformed(format!(
                            "time {value} is not greater than the time of the previous row"
                        ));
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

/// Counts the lines of a text up to its records, which come in order.
///
/// The positions of the reader are before the line feed of a CR LF and before blank lines and
/// comments.
struct Lines<'a> {
    text: &'a str,
    at: usize,
    line: u32,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str) -> Self {
        Self { text, at: 0, line: 1 }
    }

    /// Returns the line of the first letter of a record.
    fn of(&mut self, position: Option<&csv::Position>) -> u32 {
        let bytes = self.text.as_bytes();
        let start = position.map_or(self.at, |p| p.byte() as usize);
        let mut is_comment = false;
        while let Some(&byte) = bytes.get(self.at) {
            let is_end = matches!(byte, b'\r' | b'\n');
            if self.at >= start {
                is_comment = byte == b'#' || (is_comment && !is_end);
                if !is_end && !is_comment {
                    break;
                }
            }
            self.at += 1;
            self.line += u32::from(is_end && !(byte == b'\r' && bytes.get(self.at) == Some(&b'\n')));
        }
        self.line
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

/// Returns the coordinate of each column; `None` for the column of times.
fn columns(
    header: &csv::StringRecord,
    coordinates: &[Coordinate],
    rest: &[Option<f64>],
) -> Result<Vec<Option<usize>>, (String, FileErrorKind)> {
    let mut columns = Vec::new();
    for name in header {
        let column = coordinates.iter().position(|c| c.name == name);
        let title = || format!("column {name:?}");
        if column.is_none() && name != TIME {
            let reason = FileErrorKind::Unknown {
                kind: "coordinate",
                name: name.to_owned(),
                near: nearest(name, coordinates.iter().map(|c| c.name.as_str())),
            };
            return Err((title(), reason));
        }
        if columns.contains(&column) {
            return Err((title(), FileErrorKind::Repeated));
        }
        columns.push(column);
    }
    let has_value = |k: &usize| columns.contains(&Some(*k)) || matches!(rest.get(*k), Some(Some(_)));
    let missing: Vec<usize> = (0..coordinates.len()).filter(|k| !has_value(k)).collect();
    let Some(first) = missing.first().map(|&k| &coordinates[k].name) else {
        return Ok(columns);
    };
    let what = match missing.len() {
        1 => format!("column {first:?}"),
        count => format!("column {first:?} (first of {count})"),
    };
    Err((String::new(), FileErrorKind::Missing(what)))
}

/// Returns configurations as the text of a CSV file.
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
