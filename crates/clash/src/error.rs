//! Errors of files, of rules and of the search.

use std::path::PathBuf;

use lin_canny::broad::BroadPhaseError;
use lin_canny::{MeshError, PoseError};
use lin_canny_formats::FormatError;
use lin_canny_robot::FileError;
use lin_canny_robot::plan::PlanError;

/// Error of a model, of its rules, or of a search for clashes.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ClashError {
    /// A mesh file is invalid.
    #[error(transparent)]
    Mesh(#[from] FormatError),
    /// A cell file is invalid.
    #[error(transparent)]
    Cell(#[from] FileError),
    /// A part of a file is no mesh.
    #[error("{}: part {part:?}: {reason}", file.display())]
    Part {
        /// The file.
        file: PathBuf,
        /// The name of the part.
        part: String,
        /// The reason.
        reason: MeshError,
    },
    /// A folder cannot be read.
    #[error("{}: cannot be read: {reason}", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// The reason.
        reason: std::io::Error,
    },
    /// No input holds a part.
    #[error("no part: the inputs hold no mesh file")]
    NoParts,
    /// A cell file is in metres alone.
    #[error("{}: a cell is in metres (no other unit)", .0.display())]
    Unit(PathBuf),
    /// A robot has no joint of a name.
    #[error("{}: no joint {joint:?} (expected one of {known})", file.display())]
    Joint {
        /// The file.
        file: PathBuf,
        /// The name.
        joint: String,
        /// The joints of the robot.
        known: String,
    },
    /// Joints or an SRDF are given, and not exactly one robot.
    #[error("values of joints and an SRDF are those of one robot, and the inputs hold {0}")]
    NotOneRobot(usize),
    /// A robot cannot be put to a configuration.
    #[error("{}: {reason}", file.display())]
    Robot {
        /// The file.
        file: PathBuf,
        /// The reason.
        reason: PlanError,
    },
    /// The pose of a part is not finite, or too far away.
    #[error("part {part:?}: {reason}")]
    Pose {
        /// The name of the part.
        part: String,
        /// The reason.
        reason: PoseError,
    },
    /// The box of a part is not finite.
    #[error("part {part:?}: {reason}")]
    Box {
        /// The name of the part.
        part: String,
        /// The reason.
        reason: BroadPhaseError,
    },
    /// Rules are no JSON or TOML, or have an unknown key.
    #[error("rules: {0}")]
    Rules(String),
    /// A length or a volume is negative or not finite.
    #[error("{what} is {value} (expected a number of at least 0)")]
    Length {
        /// The rule or the option, such as `margins[2]`.
        what: String,
        /// The number.
        value: f64,
    },
    /// A row of an earlier output is invalid.
    #[error("{}:{line}: {reason}", file.display())]
    Baseline {
        /// The file.
        file: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// The reason.
        reason: String,
    },
}
