//! The command line tool: its commands and exit codes.

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
  0  every row is clear, every segment is proven free, or a path was found
  1  a row, the start or the goal is in contact, or a segment is blocked
  2  wrong arguments
  3  a file is invalid or cannot be written
  4  undecided: a pair is within rounding error of contact
  5  no path found within the limits; a path may exist";

/// Compute clearances, proven motions and paths of a robot from its URDF
#[derive(Parser)]
#[command(name = "lin-canny-robot", version, about, after_help = ENDS)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Find the closest pair at each row of a file of configurations
    Clearance(clearance::ClearanceOptions),
    /// Prove that the motion from row to row is free, or report the time and the pair that collides
    Certify(certify::CertifyOptions),
    /// Search for a path from the first to the last row, with every segment proven free
    Plan(plan::PlanArguments),
    /// Find link pairs that always or never collide, and write them as SRDF
    Ignorable(ignorable::IgnorableOptions),
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

/// Returns a progress bar on stderr, visible on a terminal only.
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

/// A CSV table in memory.
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
