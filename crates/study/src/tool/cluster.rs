//! The commands `scheduler` and `executor`: the processes of a cluster.

use clap::Args;
use lin_canny_study::{StudyError, cluster};

use super::options::StudyArguments;

#[derive(Args)]
pub(super) struct SchedulerOptions {
    #[command(flatten)]
    study: StudyArguments,
    /// Address to listen on; 0.0.0.0 admits other machines (no authentication: trusted networks
    /// only)
    #[arg(long, value_name = "HOST", default_value = "127.0.0.1")]
    bind: String,
    /// Port to listen on
    #[arg(long, default_value_t = 50_050)]
    port: u16,
    /// Seconds without a message after which an executor counts as lost and others repeat its rows
    #[arg(long, alias = "lost-after", value_name = "SECONDS", default_value_t = 30)]
    executor_timeout: u64,
}

#[derive(Args)]
pub(super) struct ExecutorOptions {
    #[command(flatten)]
    study: StudyArguments,
    #[command(flatten)]
    executor: cluster::Executor,
}

pub(super) async fn schedule(options: &SchedulerOptions) -> Result<(), StudyError> {
    let study = options.study.load()?;
    say!("scheduler at {}:{}", options.bind, options.port);
    cluster::schedule(&study, &options.bind, options.port, options.executor_timeout).await
}

pub(super) async fn execute(options: &ExecutorOptions) -> Result<(), StudyError> {
    let study = options.study.load()?;
    let executor = &options.executor;
    say!(
        "executor of {} at {}:{}",
        executor.scheduler,
        executor.bind,
        executor.port
    );
    executor.run(&study).await
}
