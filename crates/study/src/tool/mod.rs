//! The tool: its commands, and how a run ends.

mod cluster;
mod options;
mod progress;
mod report;
mod roadmap;
mod run;
mod sample;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use lin_canny_study::StudyError;

const ENDS: &str = "\
Exit codes:
  0  done
  2  wrong arguments
  3  a file, a row or a query was refused, or a process of a cluster failed

RUST_LOG=info shows what scheduler and executors do.";

/// Clearances of millions of configurations of a robot, as SQL functions of Apache DataFusion.
#[derive(Parser)]
#[command(name = "lin-canny-study", version, about, after_help = ENDS)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Writes configurations to measure: a sequence of Halton, or random ones.
    Sample(sample::SampleOptions),
    /// Measures the clearance of every row, or answers a query of your own.
    Run(run::RunArguments),
    /// Draws what a run has found: clearances, worst rows, pairs, a map over two joints.
    Report(report::ReportOptions),
    /// Nodes that are free and edges between them that are proven free.
    Roadmap(roadmap::RoadmapOptions),
    /// Divides queries among executors, on one machine or on many.
    Scheduler(cluster::SchedulerOptions),
    /// Answers rows for a scheduler.
    Executor(cluster::ExecutorOptions),
}

pub(crate) fn main() -> ExitCode {
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("error")).init();
    let arguments = Arguments::parse();
    match done(arguments.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("lin-canny-study: {error}");
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
            Command::Run(options) => run::run(&options).await,
            Command::Report(options) => report::run(&options).await,
            Command::Roadmap(options) => roadmap::run(&options).await,
            Command::Scheduler(options) => cluster::schedule(&options).await,
            Command::Executor(options) => cluster::execute(&options).await,
        }
    })
}
