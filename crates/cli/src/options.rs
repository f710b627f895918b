//! The options that several commands share: the rows of a file.

use std::path::{Path, PathBuf};

use clap::Args;
use lin_canny_cli::{RobotOptions, warn_of_skipped};
use lin_canny_robot::plan::{Cell, CellBody};
use lin_canny_robot::{Coordinate, FileError, FileErrorKind, Robot, Srdf, Trajectory};

use crate::end::ToolError;

/// The rows of a command.
#[derive(Args)]
pub(crate) struct RowOptions {
    /// Configurations: one column per joint, in any order, and optionally `time`
    #[arg(long, value_name = "Q.csv")]
    joints: PathBuf,
    #[command(flatten)]
    rest: RestOptions,
}

/// The values of joints that a file does not name.
#[derive(Args)]
pub(crate) struct RestOptions {
    /// Values of the joints without a column in Q.csv: a CSV file with column names and one row
    #[arg(long, value_name = "FILE")]
    rest: Option<PathBuf>,
    /// State of the SRDF whose values the joints have that neither Q.csv nor --rest names, such as
    /// `arm/home`, or `home` if one group has it; may be repeated, and a later state wins
    #[arg(long, value_name = "GROUP/NAME", requires = "srdf")]
    state: Vec<String>,
}

impl RowOptions {
    /// Returns the file of the rows.
    pub(crate) fn file(&self) -> &Path {
        &self.joints
    }

    /// Returns at least this number of rows.
    pub(crate) fn load(
        &self,
        files: &RobotOptions,
        robot: &Robot,
        cell: &Cell,
        least: usize,
    ) -> Result<Trajectory, ToolError> {
        self.rest
            .load(&self.joints, (files, robot, cell), least, |file, of, rest| {
                Trajectory::load_with_rest(file, of, rest)
            })
    }
}

/// Reads a file: its path, the coordinates, and the values of those that it does not name.
pub(crate) type ReadRows = fn(&Path, &[Coordinate], &[Option<f64>]) -> Result<Trajectory, FileError>;

impl RestOptions {
    /// Returns at least this number of rows of a file.
    pub(crate) fn load(
        &self,
        file: &Path,
        (files, robot, cell): (&RobotOptions, &Robot, &Cell),
        least: usize,
        read: ReadRows,
    ) -> Result<Trajectory, ToolError> {
        let coordinates = cell.coordinates();
        let mut values = self.values_of_states(files, robot, cell)?;
        let rest = self.rest.as_ref().map(|file| Trajectory::load_rest(file, coordinates));
        let rows = rest.unwrap_or(Ok(Vec::new())).and_then(|rest| {
            for (value, rest) in values.iter_mut().zip(rest) {
                *value = rest.or(*value);
            }
            read(file, coordinates, &values)
        });
        let rows = rows.map_err(|error| {
            let see = match &error.reason {
                FileErrorKind::Missing(what) if what.starts_with("column") || what.starts_with("joint") => {
                    "--rest and --state"
                }
                FileErrorKind::Range { .. } => "--limit-slack, --turns and --floating",
                _ => return ToolError::File(error),
            };
            let error = Box::new(error);
            ToolError::Rows { error, see }
        })?;
        let (file, count) = (file.to_owned(), rows.rows.len());
        if count < least {
            return Err(ToolError::TooFew { file, count, least });
        }
        Ok(rows)
    }

    /// Returns the values of the coordinates in the states; `None` where no state has one.
    fn values_of_states(
        &self,
        files: &RobotOptions,
        robot: &Robot,
        cell: &Cell,
    ) -> Result<Vec<Option<f64>>, ToolError> {
        let coordinates = cell.coordinates();
        let mut found = vec![None; coordinates.len()];
        let Some(file) = files.srdf.as_ref().filter(|_| !self.state.is_empty()) else {
            return Ok(found);
        };
        let wrong = |reason: String| ToolError::State {
            file: file.clone(),
            reason,
        };
        let srdf = Srdf::load(file, robot)?;
        for name in &self.state {
            let state = srdf.state(name).map_err(|reason| wrong(reason.to_string()))?;
            let title = format!("group_state {:?} joint", state.name);
            let of_state = srdf.skipped.iter().filter(|one| one.element.starts_with(&title));
            warn_of_skipped(&of_state.cloned().collect::<Vec<_>>());
            for (coordinate, value) in &state.values {
                let Some(k) = coordinates.iter().position(|c| c.name == *coordinate) else {
                    continue;
                };
                let [low, high] = coordinates[k].limits;
                if !(low..=high).contains(value) {
                    let field = format!("{coordinate} (limits {low} and {high})");
                    let reason = FileErrorKind::Range { field, value: *value };
                    return Err(wrong(format!(
                        "state {name:?}: {reason}; see --limit-slack, --turns and --floating"
                    )));
                }
                found[k] = Some(*value);
            }
        }
        Ok(found)
    }
}

/// Returns an error if an obstacle moves, because `expected` is missing.
pub(crate) fn check_at_rest(cell: &Cell, file: &Path, expected: &str) -> Result<(), ToolError> {
    let moves = |id: &CellBody| cell.obstacle_motion(*id).is_some();
    match cell.bodies().map(|(id, _)| id).find(moves) {
        None => Ok(()),
        Some(id) => Err(ToolError::State {
            file: file.to_owned(),
            reason: format!("obstacle {:?} moves (expected {expected})", cell.name(id)),
        }),
    }
}
