//! The error of a file.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use lin_canny_plan::nearest_name as nearest;

/// Error of a file: the file, the line, the element and the reason.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {}{reason}", file.display(), at_line(*line), of_element(element))]
#[non_exhaustive]
pub struct FileError {
    /// The file.
    pub file: PathBuf,
    /// The line, counted from 1, if known.
    pub line: Option<u32>,
    /// The element, row or field, such as `joint "elbow"`; empty for the whole file.
    pub element: String,
    /// The reason.
    pub reason: FileErrorKind,
}

/// Reason of a [`FileError`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileErrorKind {
    /// Returned if the file cannot be read.
    #[error("cannot be read: {0}")]
    Read(#[from] std::io::Error),
    /// Returned if the text does not have the format of the file.
    #[error("{0}")]
    Malformed(String),
    /// Returned if a number is not finite, or a list of numbers has the wrong length.
    #[error("invalid {field}: {text:?} (expected {})", finite_numbers(*count))]
    Number {
        /// The field: an attribute or a column.
        field: String,
        /// How many numbers the field must have.
        count: usize,
        /// The text of the field.
        text: String,
    },
    /// Returned if a number is out of range.
    #[error("{field} is out of range: {value:?}")]
    Range {
        /// The field.
        field: String,
        /// The number.
        value: f64,
    },
    /// Returned if the version of the file does not have a field.
    #[error("{field} is not supported in version {}.{} (expected version {}.{} or later)", version[0], version[1], since[0], since[1])]
    Version {
        /// The field.
        field: &'static str,
        /// The version of the file.
        version: [u32; 2],
        /// The first version that has the field.
        since: [u32; 2],
    },
    /// Returned if something required is missing.
    #[error("{0} is missing")]
    Missing(String),
    /// Returned if the file of a mesh or of points does not exist: its name, and where it was
    /// searched.
    #[error("{}", missing(.0))]
    MissingMesh(String),
    /// Returned if two elements of a kind have the same name.
    #[error("name is already in use")]
    Repeated,
    /// Returned if nothing of the kind has this name.
    #[error("{kind} {name:?} does not exist{}", suggested(near))]
    Unknown {
        /// The kind, such as link, joint, coordinate or group.
        kind: &'static str,
        /// The name.
        name: String,
        /// A name that exists and is spelt almost the same.
        near: Option<Box<str>>,
    },
    /// Returned if an element or attribute is unknown, so that its meaning would be lost.
    #[error("unknown {what}: {name:?} (expected {}){}", listed(expected), suggested(&nearest(name, expected.iter().copied())))]
    UnknownPart {
        /// `element` or `attribute`.
        what: &'static str,
        /// The name of the element or attribute.
        name: String,
        /// The names that are read here.
        expected: &'static [&'static str],
    },
    /// Returned if an element is given twice where at most one is allowed.
    #[error("element is given twice (expected at most one {0})")]
    Twice(String),
    /// Returned if an element or value is in the language of xacro.
    #[error("unexpanded xacro: {0:?} (expected a URDF); run xacro on the file first")]
    Xacro(String),
    /// Returned if the lower limit is above the upper limit.
    #[error("lower limit {lower} is above upper limit {upper}")]
    Limits {
        /// The lower limit.
        lower: f64,
        /// The upper limit.
        upper: f64,
    },
    /// Returned if two joints move the same link.
    #[error("link {link:?} already has a parent joint: {other:?}")]
    SecondParent {
        /// The link.
        link: String,
        /// The other joint that moves the link.
        other: String,
    },
    /// Returned if joints form a loop, so that their links are not connected to the root.
    #[error("joints form a loop: {}", .0.join(", "))]
    Loop(Vec<String>),
    /// Returned if no link, or more than one, has no parent joint.
    #[error("invalid root links: {} (expected exactly one link that no joint moves)", roots(.0))]
    Roots(Vec<String>),
    /// Returned if a joint mimics itself, directly or through other joints.
    #[error("mimics itself: {}", .0.join(", "))]
    MimicLoop(Vec<String>),
    /// Returned if a group of an SRDF contains itself, directly or through other groups.
    #[error("contains itself: {} (expected groups without cycles)", .0.join(", "))]
    GroupLoop(Vec<String>),
    /// Returned if a kind of element or joint is not supported.
    #[error("{0} is not supported")]
    Unsupported(String),
    /// Returned if a file cannot be written.
    #[error("cannot be written: {0}")]
    Write(#[source] std::io::Error),
    /// Returned if a recording cannot be written.
    #[error("cannot be written: {0}")]
    Record(#[from] lin_canny_record::WriteError),
    /// Returned if a mesh file cannot be read: the file, the line and the reason.
    #[error("mesh {0}")]
    Mesh(#[source] Box<lin_canny_formats::FormatError>),
    /// Returned if a geometry cannot form a body.
    #[error("{0}")]
    Geometry(String),
    /// Returned if a cell cannot hold what the file says.
    #[error(transparent)]
    Cell(Box<lin_canny_plan::PlanError>),
}

/// Something that a file names and that was skipped, with the line and the reason.
///
/// Its text is the one of the [`FileError`] that it would be otherwise.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Skipped {
    /// The file.
    pub file: PathBuf,
    /// The line, counted from 1, if known.
    pub line: Option<u32>,
    /// The element, such as `disable_collisions`.
    pub element: String,
    /// The reason.
    pub reason: String,
}

impl From<FileError> for Skipped {
    fn from(error: FileError) -> Self {
        Self {
            reason: error.reason.to_string(),
            file: error.file,
            line: error.line,
            element: error.element,
        }
    }
}

impl std::fmt::Display for Skipped {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (line, element) = (at_line(self.line), of_element(&self.element));
        write!(f, "{}{line}: {element}{}", self.file.display(), self.reason)
    }
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

fn finite_numbers(count: usize) -> String {
    match count {
        1 => "a finite number".into(),
        _ => format!("{count} finite numbers"),
    }
}

fn missing(name: &str) -> String {
    let is_of_package = ["package://", "model://"].iter().any(|scheme| name.contains(scheme));
    let help = "; add the folder of its package to the packages";
    format!("file {name} is missing{}", if is_of_package { help } else { "" })
}

fn suggested(near: &Option<Box<str>>) -> String {
    near.as_ref()
        .map(|name| format!("; did you mean {name:?}?"))
        .unwrap_or_default()
}

fn listed(expected: &[&str]) -> String {
    match expected {
        [] => "none".into(),
        _ => expected.join(", "),
    }
}

fn roots(names: &[String]) -> String {
    match names {
        [] => "none".into(),
        _ => names.join(", "),
    }
}

impl FileError {
    /// Returns the error of a cell that cannot hold what a file says.
    pub(crate) fn of_plan(file: &Path, error: lin_canny_plan::PlanError) -> Self {
        Self::new(file, None, "", FileErrorKind::Cell(Box::new(error)))
    }

    pub(crate) fn new(file: &Path, line: Option<u32>, element: impl Into<String>, reason: FileErrorKind) -> Self {
        Self {
            file: file.to_owned(),
            line,
            element: element.into(),
            reason,
        }
    }
}

/// An element of a file, for an error of it.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    pub(crate) file: Rc<Path>,
    pub(crate) line: u32,
    pub(crate) element: String,
}

impl Place {
    pub(crate) fn error(&self, reason: FileErrorKind) -> FileError {
        FileError::new(&self.file, Some(self.line), self.element.clone(), reason)
    }
}

impl From<lin_canny_formats::FormatError> for FileErrorKind {
    fn from(error: lin_canny_formats::FormatError) -> Self {
        Self::Mesh(Box::new(error))
    }
}
