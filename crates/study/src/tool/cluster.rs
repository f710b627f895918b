//! The commands `scheduler` and `executor`: the processes of a cluster.

use clap::Args;
use lin_canny_study::StudyError;
use lin_canny_study::cluster::{Executor, Scheduler};

use super::options::StudyArguments;

/// The options of a process, and those of the study.
#[derive(Args)]
pub(super) struct ProcessOptions<P: Args> {
    #[command(flatten)]
    study: StudyArguments,
    #[command(flatten)]
    process: P,
}

pub(super) async fn schedule(options: &ProcessOptions<Scheduler>) -> Result<(), StudyError> {
    let (study, process) = (options.study.load()?, &options.process);
    say!("scheduler at {}:{}", process.bind, process.port);
    process.run(&study).await
}

pub(super) async fn execute(options: &ProcessOptions<Executor>) -> Result<(), StudyError> {
    let (study, process) = (options.study.load()?, &options.process);
    say!("executor of {} at {}:{}", process.scheduler, process.bind, process.port);
    process.run(&study).await
}
