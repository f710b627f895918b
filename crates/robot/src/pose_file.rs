//! Timed poses of an obstacle: a CSV file, or rows in the JSON text of a cell.

use std::path::Path;

use lin_canny::RelativePose;
use lin_canny::nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use lin_canny_plan::{PlanError, TimedPoses};

use crate::csv_rows::Records;
use crate::error::{FileError, FileErrorKind};
use crate::trajectory::{check_time, number};
use crate::turn::from_xyzw;

/// The columns of a file, and the numbers of a row in a cell.
const COLUMNS: [&str; 8] = ["time", "x", "y", "z", "qx", "qy", "qz", "qw"];

/// One row: the numbers of all columns.
pub(crate) type PoseRow = [f64; 8];

/// Returns the timed poses of a CSV file.
///
/// # Errors
/// Returns an error if the file cannot be read, a column is missing, unknown or repeated, a value is
/// not a number, times do not increase, or a quaternion is zero. The error names the line and the
/// column.
pub(crate) fn load(path: &Path) -> Result<TimedPoses, FileError> {
    parse(&FileError::read(path)?, path)
}

/// Returns the timed poses of a CSV text. Errors name the file `path`.
fn parse(text: &str, path: &Path) -> Result<TimedPoses, FileError> {
    let mut records = Records::new(text, path)?;
    let mut columns = Vec::new();
    for name in &records.names {
        let wrong = |reason| FileError::new(path, Some(records.line), format!("column {name:?}"), reason);
        let column = COLUMNS.iter().position(|c| c == name).ok_or_else(|| {
            wrong(FileErrorKind::UnknownPart {
                what: "column",
                name: name.clone(),
                expected: &COLUMNS,
            })
        })?;
        if columns.contains(&column) {
            return Err(wrong(FileErrorKind::Repeated));
        }
        columns.push(column);
    }
    if let Some(k) = (0..COLUMNS.len()).find(|k| !columns.contains(k)) {
        let missing = FileErrorKind::Missing(format!("column {:?}", COLUMNS[k]));
        return Err(FileError::new(path, Some(records.line), "", missing));
    }
    let (mut times, mut poses, mut lines) = (Vec::new(), Vec::new(), Vec::new());
    while let Some((line, fields)) = records.next_row()? {
        let wrong = |name: &str, reason| FileError::new(path, Some(line), format!("column {name:?}"), reason);
        let mut row: PoseRow = [0.0; 8];
        for (text, &column) in fields.iter().zip(&columns) {
            let name = COLUMNS[column];
            row[column] = number(text, name).map_err(|reason| wrong(name, reason))?;
        }
        check_time(times.last(), row[0]).map_err(|reason| wrong(COLUMNS[0], reason))?;
        times.push(row[0]);
        poses.push(pose(&row).map_err(|reason| FileError::new(path, Some(line), "", reason))?);
        lines.push(line);
    }
    timed(&times, &poses).map_err(|(row, reason)| {
        let line = row.and_then(|row| lines.get(row).copied());
        FileError::new(path, line, "", reason)
    })
}

/// Returns the timed poses of rows in a cell.
pub(crate) fn of_rows(rows: &[PoseRow]) -> Result<TimedPoses, FileErrorKind> {
    let of_row = |k: usize, reason| FileErrorKind::Malformed(format!("row {k} of poses: {reason}"));
    let (mut times, mut poses) = (Vec::new(), Vec::new());
    for (k, row) in rows.iter().enumerate() {
        check_time(times.last(), row[0]).map_err(|reason| of_row(k, reason))?;
        times.push(row[0]);
        poses.push(pose(row).map_err(|reason| of_row(k, reason))?);
    }
    timed(&times, &poses).map_err(|(row, reason)| match row {
        Some(k) => of_row(k, reason),
        None => reason,
    })
}

/// Returns the rows of timed poses, with the bits of their numbers.
pub(crate) fn rows(poses: &TimedPoses) -> Vec<PoseRow> {
    let each = poses.times().iter().zip(poses.poses());
    each.map(|(&time, pose)| {
        let ([x, y, z], [qx, qy, qz, qw]) = (pose.translation.vector.into(), pose.rotation.coords.into());
        [time, x, y, z, qx, qy, qz, qw]
    })
    .collect()
}

/// Returns the pose of a row. A quaternion that a checker takes as it is keeps its bits.
fn pose(&[_, x, y, z, qx, qy, qz, qw]: &PoseRow) -> Result<Isometry3<f64>, FileErrorKind> {
    let xyzw = [qx, qy, qz, qw];
    let placed = |turn| Isometry3::from_parts(Translation3::new(x, y, z), turn);
    let given = placed(UnitQuaternion::new_unchecked(Quaternion::from(xyzw)));
    if RelativePose::from_isometry(&given).is_ok() {
        return Ok(given);
    }
    let turn = from_xyzw(xyzw).ok_or_else(|| FileErrorKind::Range {
        field: "length of the quaternion".into(),
        value: 0.0,
    })?;
    Ok(placed(turn))
}

/// Returns timed poses, or the reason with the index of the row if it belongs to one.
fn timed(times: &[f64], poses: &[Isometry3<f64>]) -> Result<TimedPoses, (Option<usize>, FileErrorKind)> {
    if poses.len() < 2 {
        let reason = format!("too few poses: {} (expected at least 2)", poses.len());
        return Err((None, FileErrorKind::Malformed(reason)));
    }
    TimedPoses::new(times, poses).map_err(|error| match error {
        PlanError::TimedPose { row, error } => (Some(row), FileErrorKind::Geometry(error.to_string())),
        error => (None, FileErrorKind::Geometry(error.to_string())),
    })
}
