//! What is wrong with a study or a row.

use std::path::PathBuf;

use datafusion::arrow::error::ArrowError;
use datafusion::error::DataFusionError;
use lin_canny_plan::PlanError;
use lin_canny_robot::FileError;

/// Why a study could not be made or run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A file of the robot or the cell was refused.
    #[error(transparent)]
    File(#[from] FileError),
    /// Robot and cell make no checker.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The engine refused a query, or a file of rows.
    #[error("{}", .0.strip_backtrace())]
    Engine(#[from] DataFusionError),
    /// Rows cannot be written or cut.
    #[error(transparent)]
    Arrow(#[from] ArrowError),
    /// A shape that cannot be written down.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// A file cannot be read or written.
    #[error("{}: {reason}", file.display())]
    Io {
        /// The file or folder.
        file: PathBuf,
        /// The reason.
        reason: std::io::Error,
    },
    /// A file, a folder or an argument that does not fit.
    #[error("{what}: {reason}")]
    Unfit {
        /// The file, the folder or the argument.
        what: String,
        /// The reason.
        reason: String,
    },
    /// A row that is no configuration.
    #[error("a row is refused: {0}; `--lenient` answers such rows by NULL")]
    Row(String),
    /// A scheduler or an executor could not be reached, or failed.
    #[error("{0}")]
    Cluster(String),
}

impl StudyError {
    /// Returns what makes an error of an input or output error about a file.
    pub fn io(file: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Self {
        let file = file.into();
        move |reason| Self::Io { file, reason }
    }

    /// Returns the error of a file, a folder or an argument that does not fit.
    pub fn unfit(what: impl ToString, reason: impl ToString) -> Self {
        Self::Unfit {
            what: what.to_string(),
            reason: reason.to_string(),
        }
    }
}

/// Why a row has no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RowError {
    /// A value that is missing.
    #[error("{name} is NULL")]
    Null {
        /// The argument.
        name: String,
    },
    /// A list with another number of values.
    #[error("{name} has {found} values instead of {needed}")]
    Length {
        /// The argument.
        name: String,
        /// Values of the list.
        found: usize,
        /// Values that it needs.
        needed: usize,
    },
    /// A value that is not within the limits of its joint.
    #[error("{name} is {value:?}, not within {lower:?} and {upper:?}")]
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
    /// A name that no body has, or more than one.
    #[error("{count} bodies are called {name:?}")]
    Name {
        /// The name.
        name: String,
        /// How many bodies have it.
        count: usize,
    },
    /// The checker refused the row.
    #[error("{0}")]
    Refused(String),
}
