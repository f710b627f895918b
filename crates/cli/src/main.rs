//! `lin-canny`: clearances, proven motions and paths of a robot from its files, on a command line.
//!
//! One module for each command: it reads, asks, reports.
#![forbid(unsafe_code)]
// They panic if the reader of a pipe has gone: see `lin_canny_cli::output::put`.
#![deny(clippy::print_stdout, clippy::print_stderr)]

#[macro_use(say, warn)]
extern crate lin_canny_cli;

mod audit;
mod audit_page;
mod cell;
mod certify;
mod clash;
mod clearance;
mod cover;
mod drawing;
mod end;
mod film;
mod find_excluded;
mod grid;
mod inspect;
mod options;
mod packaging;
mod pair_boxes;
mod plan;
mod points;
mod receipt;
mod smooth;
mod text;
mod verify;

use std::path::Path;
use std::process::ExitCode;

use clap::error::ErrorKind;
use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser, Subcommand};
use end::{End, ToolError};

const ENDS: &str = "\
Exit codes:
  0  every row is clear, every segment is proven free, a path was found, a file was written, a
     receipt holds, or `audit` decided every pair
  1  a row is in contact or closer than required, a segment is blocked, a receipt does not hold,
     a pair excluded as `Never` can meet, parts clash, or `inspect` found something to repair
  2  wrong arguments
  3  a file is invalid or cannot be written, or was left out by `clash --keep-going`
  4  undecided: a pair is within rounding error of contact or of its required distance, or `audit`
     left a pair open
  5  no path found within the limits; a path may exist
  6  the start or the goal of `plan` is in contact or closer than required
  130  `clash` was stopped by Ctrl-C; the rows that were done are written";

/// Compute clearances, proven motions and paths of a robot from its URDF, MJCF or SDFormat, and
/// distances of points
#[derive(Parser)]
#[command(name = "lin-canny", version, about, after_help = ENDS)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Find the closest pair at each row of a file of configurations, or along the motion between, and
    /// whether pairs keep their required distance
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
    FindExcluded(find_excluded::FindExcludedOptions),
    /// Find parts of a model that overlap, and gaps that are too small, in mesh files and cells
    Clash(clash::ClashArguments),
    /// Compute the signed distances of points, or of the nodes of a grid, from a mesh
    Points(points::PointOptions),
    /// List what keeps a mesh from being a solid: holes, inverted triangles, crossings; and what a repair
    /// would change
    Inspect(inspect::InspectOptions),
    /// Check a receipt of `certify` in exact arithmetic, and print what it proves
    Verify(verify::VerifyOptions),
    /// Write manual pages and completions of shells, for a package of the tool
    #[command(hide = true)]
    Packaging(packaging::PackagingOptions),
}

/// Returns an error if a command would write to a file that it reads.
///
/// The name of the value of an option says which it is: files that are written are `OUT`, or the page of
/// an audit.
fn check_outputs(command: &clap::Command, matches: &ArgMatches) -> Result<(), clap::Error> {
    let Some((command, matches)) = matches
        .subcommand()
        .and_then(|(name, matches)| Some((command.find_subcommand(name)?, matches)))
    else {
        return Ok(());
    };
    let (mut inputs, mut outputs) = (Vec::new(), Vec::new());
    for argument in command.get_arguments() {
        let id = argument.get_id().as_str();
        let Ok(Some(values)) = matches.try_get_raw(id) else {
            continue;
        };
        let of = argument.get_value_names().and_then(|names| names.first());
        let is_written = of.is_some_and(|name| name.starts_with("OUT") || name.as_str() == "AUDIT.html");
        for value in values.filter_map(|value| value.to_str()) {
            // `PREFIX=FILE`
            let parts = value.split_once('=').map(|(_, file)| file).into_iter().chain([value]);
            let files = parts.filter_map(|part| Some((std::fs::canonicalize(part).ok()?, part)));
            let all = if is_written { &mut outputs } else { &mut inputs };
            all.extend(files.filter(|(file, _)| file.is_file()));
        }
    }
    let is_read = |file: &Path| inputs.iter().any(|(input, _)| input == file);
    match outputs.iter().find(|(file, _)| is_read(file)) {
        None => Ok(()),
        Some((_, name)) => {
            let reason = format!("{name} would be written, but is read as well");
            Err(command.clone().error(ErrorKind::ArgumentConflict, reason))
        }
    }
}

fn main() -> ExitCode {
    let mut command = Arguments::command();
    command.build();
    let matches = command.clone().get_matches();
    let arguments = check_outputs(&command, &matches).and_then(|()| Arguments::from_arg_matches(&matches));
    let arguments = arguments.unwrap_or_else(|error| error.exit());
    let found = match arguments.command {
        Command::Clearance(options) => clearance::run(&options),
        Command::Certify(options) => certify::run(&options),
        Command::Plan(options) => plan::run(&options),
        Command::Audit(options) => audit::run(&options),
        Command::Smooth(options) => smooth::run(&options),
        Command::Cell(options) => cell::run(&options),
        Command::Cover(options) => cover::run(&options),
        Command::FindExcluded(options) => find_excluded::run(&options),
        Command::Clash(options) => clash::run(&options),
        Command::Points(options) => points::run(&options),
        Command::Inspect(options) => inspect::run(&options),
        Command::Verify(options) => verify::run(&options),
        Command::Packaging(options) => packaging::run(&options, Arguments::command()),
    };
    match found {
        Ok(End::Free) => ExitCode::SUCCESS,
        Ok(End::Blocked) => ExitCode::from(1),
        Ok(End::Unknown) => ExitCode::from(4),
        Ok(End::NoPath) => ExitCode::from(5),
        Ok(End::Invalid) => ExitCode::from(3),
        Ok(End::Stopped) => ExitCode::from(130),
        Err(error) => {
            warn!("lin-canny: {error}");
            ExitCode::from(if matches!(error, ToolError::Blocked { .. }) {
                6
            } else {
                3
            })
        }
    }
}
