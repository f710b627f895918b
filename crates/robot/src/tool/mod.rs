//! The command line tool: its commands and exit codes.

/// Writes a line to stdout.
macro_rules! say {
    ($($part:tt)*) => {
        $crate::tool::text::put(format_args!("{}\n", format_args!($($part)*)))
    };
}

/// Writes a line to stderr.
macro_rules! warn {
    ($($part:tt)*) => {
        $crate::tool::text::complain(format_args!($($part)*))
    };
}

mod audit;
mod audit_page;
mod cell;
mod certify;
mod clearance;
mod cover;
mod drawing;
mod film;
mod grid;
mod ignorable;
mod options;
mod pair_boxes;
mod plan;
mod points;
mod receipt;
mod smooth;
mod text;
mod verify;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use lin_canny_robot::FileError;
use lin_canny_robot::plan::{PlanError, World, WorldId};

const ENDS: &str = "\
Exit codes:
  0  every row is clear, every segment is proven free, a path was found, a file was written, a
     receipt holds, or `audit` decided every pair
  1  a row is in contact, a segment is blocked, a receipt does not hold, or a pair excluded as
     `Never` can meet
  2  wrong arguments
  3  a file is invalid or cannot be written
  4  undecided: a pair is within rounding error of contact, or `audit` left a pair open
  5  no path found within the limits; a path may exist
  6  the start or the goal of `plan` is in contact or within the margin";

/// Compute clearances, proven motions and paths of a robot from its URDF, MJCF or SDFormat, and
/// distances of points
#[derive(Parser)]
#[command(name = "lin-canny-robot", version, about, after_help = ENDS)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Find the closest pair at each row of a file of configurations, or along the motion between
    Clearance(clearance::ClearanceOptions),
    /// Prove that the motion from row to row is free, or report the time and the pair that collides
    Certify(certify::CertifyOptions),
    /// Search for a path from the first to the last row, with every segment proven free
    Plan(plan::PlanArguments),
    /// Prove which links can never meet each other or an obstacle, over the whole joint limits
    Audit(audit::AuditOptions),
    /// Turn a path of straight segments into a smooth trajectory within limits, proven free
    Smooth(smooth::SmoothArguments),
    /// Write the cell with attached objects, paddings, margin and excluded pairs as one cell file
    Cell(cell::CellOptions),
    /// Compute balls around and inside the links, or hulls of few faces around them, with proven gaps
    Cover(cover::CoverOptions),
    /// Find link pairs that always or never collide, and write them as SRDF
    Ignorable(ignorable::IgnorableOptions),
    /// Compute the signed distances of points, or of the nodes of a grid, from a mesh
    Points(points::PointOptions),
    /// Check a receipt of `certify` in exact arithmetic, and print what it proves
    Verify(verify::VerifyOptions),
}

/// Result of a run, worst last.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum End {
    Free,
    Unknown,
    Blocked,
    NoPath,
}

/// Error of a run.
#[derive(Debug, thiserror::Error)]
enum ToolError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Plan(#[from] PlanError),
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

pub(crate) fn main() -> ExitCode {
    let found = match Arguments::parse().command {
        Command::Clearance(options) => clearance::run(&options),
        Command::Certify(options) => certify::run(&options),
        Command::Plan(options) => plan::run(&options),
        Command::Audit(options) => audit::run(&options),
        Command::Smooth(options) => smooth::run(&options),
        Command::Cell(options) => cell::run(&options),
        Command::Cover(options) => cover::run(&options),
        Command::Ignorable(options) => ignorable::run(&options),
        Command::Points(options) => points::run(&options),
        Command::Verify(options) => verify::run(&options),
    };
    match found {
        Ok(End::Free) => ExitCode::SUCCESS,
        Ok(End::Blocked) => ExitCode::from(1),
        Ok(End::Unknown) => ExitCode::from(4),
        Ok(End::NoPath) => ExitCode::from(5),
        Err(error) => {
            warn!("lin-canny-robot: {error}");
            ExitCode::from(if matches!(error, ToolError::Blocked { .. }) {
                6
            } else {
                3
            })
        }
    }
}

/// Returns an error if an obstacle moves, because `expected` is missing.
fn check_at_rest(world: &World, file: &Path, expected: &str) -> Result<(), ToolError> {
    let moves = |id: &WorldId| world.obstacle_motion(*id).is_some();
    match world.bodies().map(|(id, _)| id).find(moves) {
        None => Ok(()),
        Some(id) => Err(ToolError::State {
            file: file.to_owned(),
            reason: format!("obstacle {:?} moves (expected {expected})", world.name(id)),
        }),
    }
}

fn write(file: &Path, text: &str) -> Result<(), ToolError> {
    std::fs::write(file, text).map_err(|reason| ToolError::Write {
        file: file.to_owned(),
        reason,
    })
}

/// Returns a progress bar on stderr, visible on a terminal only.
fn progress(what: &'static str, length: u64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr());
    match ProgressStyle::with_template("{prefix} {wide_bar} {pos}/{len} {eta}") {
        Ok(style) => bar.with_style(style).with_prefix(what),
        Err(_) => bar,
    }
}
