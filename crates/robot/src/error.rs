//! What is wrong with a file.

use std::path::{Path, PathBuf};

/// A file that was refused: where, and why.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {}{reason}", file.display(), at_line(*line), of_element(element))]
#[non_exhaustive]
pub struct FileError {
    /// The file.
    pub file: PathBuf,
    /// The line, from 1 on, where it is known.
    pub line: Option<u32>,
    /// The element, row or field, such as `joint "elbow"`; empty if the whole file is meant.
    pub element: String,
    /// The reason.
    pub reason: FileErrorKind,
}

/// Reason why a file was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileErrorKind {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Read(#[from] std::io::Error),
    /// The text is not what the file's kind needs.
    #[error("{0}")]
    Malformed(String),
    /// A number, or a list of numbers, that is not finite or not of the right length.
    #[error("{field} needs {count} finite number(s), not {text:?}")]
    Number {
        /// The field: an attribute or a column.
        field: String,
        /// How many numbers it has.
        count: usize,
        /// What stands there.
        text: String,
    },
    /// A number that is out of range.
    #[error("{field} is out of range: {value:?}")]
    Range {
        /// The field.
        field: String,
        /// The number.
        value: f64,
    },
    /// Something that has to be there is missing.
    #[error("{0} is missing")]
    Missing(String),
    /// Two of a kind have the same name.
    #[error("this name is taken already")]
    Repeated,
    /// A name that nothing has.
    #[error("there is no {kind} called {name:?}")]
    Unknown {
        /// The kind of thing that is named.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// A limit that is upside down.
    #[error("the lower limit {lower} is above the upper limit {upper}")]
    Limits {
        /// The lower limit.
        lower: f64,
        /// The upper limit.
        upper: f64,
    },
    /// A link that two joints move.
    #[error("moves link {link:?}, which joint {other:?} moves already")]
    SecondParent {
        /// The link.
        link: String,
        /// The joint that moves the link already.
        other: String,
    },
    /// Joints in a loop: no link of them hangs on the root.
    #[error("is part of a loop of joints: {}", .0.join(", "))]
    Loop(Vec<String>),
    /// No link or several links that no joint moves.
    #[error("a robot needs one root link, a link that no joint moves: there are {}", roots(.0))]
    Roots(Vec<String>),
    /// A joint that mimics itself, over others or not.
    #[error("mimics itself: {}", .0.join(", "))]
    MimicLoop(Vec<String>),
    /// A kind that is not read.
    #[error("{0} is not supported")]
    Unsupported(String),
    /// A recording that cannot be written.
    #[error("cannot be written: {0}")]
    Record(#[from] lin_canny_record::WriteError),
    /// Geometry that makes no body.
    #[error("{0}")]
    Geometry(String),
}

fn at_line(line: Option<u32>) -> String {
    line.map(|line| format!(":{line}")).unwrap_or_default()
}

fn of_element(element: &str) -> String {
    if element.is_empty() {
        String::new()
    } else {
        format!("{element}: ")
    }
}

fn roots(names: &[String]) -> String {
    match names {
        [] => "none".into(),
        _ => names.join(", "),
    }
}

/// The mark that some programs write in front of UTF-8.
const BOM: &[u8] = "\u{feff}".as_bytes();

impl FileError {
    pub(crate) fn new(file: &Path, line: Option<u32>, element: impl Into<String>, reason: FileErrorKind) -> Self {
        Self {
            file: file.to_owned(),
            line,
            element: element.into(),
            reason,
        }
    }

    /// Returns the text of a file.
    pub(crate) fn read(file: &Path) -> Result<String, Self> {
        let bytes = std::fs::read(file).map_err(|e| Self::new(file, None, "", FileErrorKind::Read(e)))?;
        let start = if bytes.starts_with(BOM) { BOM.len() } else { 0 };
        String::from_utf8(bytes[start..].to_vec()).map_err(|e| {
            let line = 1 + e.as_bytes()[..e.utf8_error().valid_up_to()]
                .iter()
                .filter(|b| **b == b'\n')
                .count();
            let reason = FileErrorKind::Malformed("not UTF-8".into());
            Self::new(file, Some(line as u32), "", reason)
        })
    }
}
