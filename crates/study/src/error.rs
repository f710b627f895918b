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
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub(crate) struct RowError(String);

impl RowError {
    pub(crate) fn null(name: &str) -> Self {
        Self(format!("{name} is NULL"))
    }

    pub(crate) fn limits(name: &str, value: f64, [lower, upper]: [f64; 2]) -> Self {
        Self(format!("{name} is {value:?} (expected {lower:?}..={upper:?})"))
    }

    pub(crate) fn refused(error: impl ToString) -> Self {
        Self(error.to_string())
    }
}
