//! Errors of a study and of a row.

use std::path::PathBuf;

use datafusion::arrow::error::ArrowError;
use datafusion::error::DataFusionError;
use lin_canny_plan::PlanError;
use lin_canny_robot::FileError;

/// Error of the construction or the run of a study.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// Returned if a file of the robot or the cell is invalid.
    #[error(transparent)]
    File(#[from] FileError),
    /// Returned if no checker can be made from robot and cell.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// Returned if the engine rejects a query or a file of rows.
    #[error("{}", .0.strip_backtrace())]
    Engine(#[from] DataFusionError),
    /// Returned if rows cannot be written or sliced.
    #[error(transparent)]
    Arrow(#[from] ArrowError),
    /// Returned if a shape cannot be serialised.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// Returned if a file cannot be read or written.
    #[error("{}: {reason}", file.display())]
    Io {
        /// The file or folder.
        file: PathBuf,
        /// The reason.
        reason: std::io::Error,
    },
    /// Returned if a file, a folder or an argument is invalid for this study.
    #[error("{what}: {reason}")]
    Unfit {
        /// The file, the folder or the argument.
        what: String,
        /// The reason.
        reason: String,
    },
    /// Returned if a row is not a valid configuration.
    #[error("invalid row: {0}; `--lenient` returns NULL for such rows")]
    Row(String),
    /// Returned if a scheduler or an executor cannot be reached or fails.
    #[error("{0}")]
    Cluster(String),
}

impl StudyError {
    /// Returns a function that converts an I/O error to an error of this file.
    pub fn io(file: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Self {
        let file = file.into();
        move |reason| Self::Io { file, reason }
    }

    /// Returns the error of a file, a folder or an argument that is invalid for this study.
    pub fn unfit(what: impl ToString, reason: impl ToString) -> Self {
        Self::Unfit {
            what: what.to_string(),
            reason: reason.to_string(),
        }
    }
}

/// Reason why a row has no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RowError {
    /// A value is missing.
    #[error("{name} is NULL")]
    Null {
        /// The argument.
        name: String,
    },
    /// A list has the wrong number of values.
    #[error("{name} has {found} values (expected {needed})")]
    Length {
        /// The argument.
        name: String,
        /// Number of values of the list.
        found: usize,
        /// Number of values that it must have.
        needed: usize,
    },
    /// A value is outside the limits of its joint.
    #[error("{name} is {value:?} (expected {lower:?}..={upper:?})")]
    Limits {
        /// The joint.
        name: String,
        /// The value.
        value: f64,
        /// The lower limit.
        lower: f64,
        /// The upper limit.
        upper: f64,
    },
    /// No body has this name, or more than one body has it.
    #[error("{count} bodies have the name {name:?} (expected 1)")]
    Name {
        /// The name.
        name: String,
        /// Number of bodies with this name.
        count: usize,
    },
    /// The checker rejected the row.
    #[error("{0}")]
    Refused(String),
}

impl RowError {
    pub(crate) fn null(name: &str) -> Self {
        Self::Null { name: name.into() }
    }

    pub(crate) fn limits(name: impl Into<String>, value: f64, [lower, upper]: [f64; 2]) -> Self {
        let name = name.into();
        Self::Limits {
            name,
            value,
            lower,
            upper,
        }
    }

    pub(crate) fn refused(error: impl ToString) -> Self {
        Self::Refused(error.to_string())
    }
}
