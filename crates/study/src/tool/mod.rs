//! The command line tool: its commands and exit codes.

mod cells;
mod cluster;
mod options;
mod progress;
mod roadmap;
mod run;
mod sample;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use lin_canny_study::cluster::{Executor, Scheduler};

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
    Scheduler(cluster::ProcessOptions<Scheduler>),
    /// Start an executor, which processes rows for a scheduler
    Executor(cluster::ProcessOptions<Executor>),
}

#[tokio::main]
pub(crate) async fn main() -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("error")).init();
    let done = match Arguments::parse().command {
        Command::Sample(options) => sample::run(&options),
        Command::Cells(options) => cells::run(&options),
        Command::Run(options) => run::run(&options).await,
        Command::Roadmap(options) => roadmap::run(&options).await,
        Command::Scheduler(options) => cluster::schedule(&options).await,
        Command::Executor(options) => cluster::execute(&options).await,
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            warn!("lin-canny-study: {error}");
            ExitCode::from(3)
        }
    }
}
