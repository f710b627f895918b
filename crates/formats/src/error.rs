//! The error of a file.

use std::path::{Path, PathBuf};

/// Error of a file of meshes, points or numbers: the file, the line and the reason.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {fault}", file.display(), at_line(*line))]
#[non_exhaustive]
pub struct FormatError {
    /// The file.
    pub file: PathBuf,
    /// The line, counted from 1, if known.
    pub line: Option<usize>,
    /// The reason.
    pub fault: FormatFault,
}

impl FormatError {
    /// Returns the bytes of a file.
    pub(crate) fn read(file: &Path) -> Result<Vec<u8>, Self> {
        std::fs::read(file).map_err(|error| {
            let fault = FormatFault::Read(error);
            Fault { line: None, fault }.of(file)
        })
    }
}

/// Reason of a [`FormatError`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FormatFault {
    /// Returned if the file cannot be read.
    #[error("cannot be read: {0}")]
    Read(#[from] std::io::Error),
    /// Returned if the file cannot be written.
    #[error("cannot be written: {0}")]
    Write(#[source] std::io::Error),
    /// Returned if the file has no known format.
    #[error("{0}")]
    Unknown(String),
    /// Returned if the text or the bytes do not have the format of the file.
    #[error("{0}")]
    Malformed(String),
    /// Returned if the file contains geometry that this crate does not read.
    #[error("{0} is not supported")]
    Unsupported(String),
    /// Returned if no object of the file has a triangle.
    #[error("the file contains no triangle")]
    Empty,
    /// Returned if a point file has no point, or none whose coordinates are finite.
    #[error("the file contains no point{}", dropped(*.0))]
    NoPoint(
        /// Number of points whose coordinates are not finite.
        usize,
    ),
    /// Returned if a coordinate is not finite and the caller refuses such points.
    #[error("point {index} is not finite: {point:?}")]
    Invalid {
        /// The number of the point in the file, from 0.
        index: u64,
        /// Its coordinates.
        point: [f64; 3],
    },
}

fn dropped(count: usize) -> String {
    match count {
        0 => String::new(),
        count => format!(" that is finite ({count} are not)"),
    }
}

fn at_line(line: Option<usize>) -> String {
    line.map_or(String::new(), |line| format!(", line {line}"))
}

/// What a reader returns: a reason and its line. The caller adds the file.
#[derive(Debug)]
pub(crate) struct Fault {
    pub(crate) line: Option<usize>,
    pub(crate) fault: FormatFault,
}

impl Fault {
    /// Returns the error of a file.
    pub(crate) fn of(self, file: &Path) -> FormatError {
        FormatError {
            file: file.to_owned(),
            line: self.line,
            fault: self.fault,
        }
    }

    /// Returns the fault of a line: the text does not have the format.
    pub(crate) fn malformed(line: impl Into<Option<usize>>, why: impl Into<String>) -> Self {
        Self {
            line: line.into(),
            fault: FormatFault::Malformed(why.into()),
        }
    }

    /// Returns the fault of a line with geometry that is not supported.
    pub(crate) fn unsupported(line: impl Into<Option<usize>>, what: impl Into<String>) -> Self {
        Self {
            line: line.into(),
            fault: FormatFault::Unsupported(what.into()),
        }
    }
}
