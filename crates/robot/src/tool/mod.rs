//! The tool: its commands, and how a run ends.

mod certify;
mod clearance;
mod ignorable;
mod options;
mod plan;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use lin_canny_robot::FileError;
use lin_canny_robot::plan::{Checker, ConfigurationSpace, PlanError, WorldPair};

const ENDS: &str = "\
Exit codes:
  0  free: every row is clear, every segment proven free, a path found
  1  a row, a start or a goal in contact, or a segment blocked
  2  wrong arguments
  3  a file was refused, or cannot be written
  4  neither proven: rounding hides whether a pair meets
  5  no path found within the limits: there may be one nevertheless";

/// Clearances, proven motions and paths of a robot from its URDF.
#[derive(Parser)]
#[command(name = "lin-canny-robot", version, about, after_help = ENDS)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// The closest pair at every row of a file of configurations.
    Clearance(clearance::ClearanceOptions),
    /// Proves the motion from row to row free over its whole length, or names time and pair.
    Certify(certify::CertifyOptions),
    /// Searches a path from the first to the last row, every segment proven free.
    Plan(plan::PlanArguments),
    /// Finds pairs of links that need no check, and writes them as SRDF.
    Ignorable(ignorable::IgnorableOptions),
}

/// How a run ended, worst last.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum End {
    Free,
    Unknown,
    Blocked,
    NoPath,
}

/// Why a run could not be done.
#[derive(Debug, thiserror::Error)]
enum ToolError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Plan(#[from] PlanError),
    #[error("{}: cannot be written: {reason}", file.display())]
    Write { file: PathBuf, reason: std::io::Error },
    #[error("{}: {reason}", file.display())]
    Rows { file: PathBuf, reason: String },
}

pub(crate) fn main() -> ExitCode {
    let found = match Arguments::parse().command {
        Command::Clearance(options) => clearance::run(&options),
        Command::Certify(options) => certify::run(&options),
        Command::Plan(options) => plan::run(&options),
        Command::Ignorable(options) => ignorable::run(&options),
    };
    match found {
        Ok(End::Free) => ExitCode::SUCCESS,
        Ok(End::Blocked) => ExitCode::from(1),
        Ok(End::Unknown) => ExitCode::from(4),
        Ok(End::NoPath) => ExitCode::from(5),
        Err(error) => {
            eprintln!("lin-canny-robot: {error}");
            let is_contact = matches!(error, ToolError::Plan(PlanError::Contact { .. }));
            ExitCode::from(if is_contact { 1 } else { 3 })
        }
    }
}

fn write(file: &Path, text: &str) -> Result<(), ToolError> {
    std::fs::write(file, text).map_err(|reason| ToolError::Write {
        file: file.to_owned(),
        reason,
    })
}

/// A bar on stderr, if a terminal is there.
fn progress(what: &'static str, length: u64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr());
    match ProgressStyle::with_template("{prefix} {wide_bar} {pos}/{len} {eta}") {
        Ok(style) => bar.with_style(style).with_prefix(what),
        Err(_) => bar,
    }
}

fn names<C: ConfigurationSpace>(checker: &Checker<C>, pair: WorldPair) -> [String; 2] {
    [pair.a, pair.b].map(|part| checker.name(part).to_owned())
}

/// A table as CSV.
struct Table(csv::Writer<Vec<u8>>);

impl Table {
    fn new(columns: &[&str]) -> Self {
        let mut table = Self(csv::Writer::from_writer(Vec::new()));
        table.row(columns);
        table
    }

    /// Writing to memory does not fail.
    fn row(&mut self, cells: &[impl AsRef<[u8]>]) {
        let _ = self.0.write_record(cells);
    }

    fn text(self) -> String {
        let bytes = self.0.into_inner().unwrap_or_default();
        String::from_utf8_lossy(&bytes).into_owned()
    }
}
