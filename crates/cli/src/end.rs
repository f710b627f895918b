//! How a run ends: its result, or its error.

use std::path::PathBuf;

use lin_canny_robot::FileError;
use lin_canny_robot::plan::PlanError;

/// Result of a run, worst last.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum End {
    Free,
    Unknown,
    Blocked,
    NoPath,
    /// A file was left out.
    Invalid,
    /// The user has stopped it.
    Stopped,
}

/// Error of a run.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ToolError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Plan(#[from] PlanError),
    #[error(transparent)]
    Clash(Box<lin_canny_clash::ClashError>),
    #[error("{}: cannot be written: {reason}", file.display())]
    Write { file: PathBuf, reason: std::io::Error },
    #[error("{}:{line}: {reason}", file.display())]
    Blocked { file: PathBuf, line: u32, reason: String },
    #[error("{error}; see {see}")]
    Rows { error: Box<FileError>, see: &'static str },
    #[error("{}: {reason}", file.display())]
    State { file: PathBuf, reason: String },
    #[error(transparent)]
    Format(#[from] lin_canny_formats::FormatError),
    #[error("{}: {reason}", file.display())]
    Input { file: PathBuf, reason: String },
    #[error("{}: too few rows: {count} (expected at least {least})", file.display())]
    TooFew { file: PathBuf, count: usize, least: usize },
}
