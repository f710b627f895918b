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

mod cells;
mod cluster;
mod options;
mod progress;
mod roadmap;
mod run;
mod sample;
mod text;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use lin_canny_study::StudyError;

const ENDS: &str = "\
Exit codes:
  0  done
  2  wrong arguments
  3  a file, a row or a query is invalid, or a process of a cluster failed

RUST_LOG=info prints the activity of scheduler and executors.";

/// Compute clearances of millions of robot configurations with SQL functions of Apache DataFusion
#[derive(Parser)]
#[command(name = "lin-canny-study", version, about, after_help = ENDS)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Write configurations to measure, from a Halton sequence or at random
    Sample(sample::SampleOptions),
    /// Write cells of the joint limits, to prove in each whether two links can meet
    Cells(cells::CellOptions),
    /// Compute the clearance of each row, or run your own query
    Run(run::RunArguments),
    /// Write a roadmap: free nodes, and edges between them that are proven free
    Roadmap(roadmap::RoadmapOptions),
    /// Start a scheduler, which divides queries among executors
    Scheduler(cluster::SchedulerOptions),
    /// Start an executor, which processes rows for a scheduler
    Executor(cluster::ExecutorOptions),
}

pub(crate) fn main() -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("error")).init();
    let arguments = Arguments::parse();
    match done(arguments.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            warn!("lin-canny-study: {error}");
            ExitCode::from(3)
        }
    }
}

fn done(command: Command) -> Result<(), StudyError> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .map_err(|e| StudyError::Cluster(e.to_string()))?;
    runtime.block_on(async {
        match command {
            Command::Sample(options) => sample::run(&options),
            Command::Cells(options) => cells::run(&options),
            Command::Run(options) => run::run(&options).await,
            Command::Roadmap(options) => roadmap::run(&options).await,
            Command::Scheduler(options) => cluster::schedule(&options).await,
            Command::Executor(options) => cluster::execute(&options).await,
        }
    })
}
