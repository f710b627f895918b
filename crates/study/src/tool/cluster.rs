//! The commands `scheduler` and `executor`: the processes of a cluster.

use std::path::PathBuf;

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
    /// Address of the scheduler
    #[arg(long, value_name = "HOST:PORT", default_value = "127.0.0.1:50050")]
    scheduler: String,
    /// Address to listen on; 0.0.0.0 admits other machines (no authentication: trusted networks
    /// only)
    #[arg(long, value_name = "HOST", default_value = "127.0.0.1")]
    bind: String,
    /// Host name under which other machines reach this machine
    #[arg(long, value_name = "HOST")]
    external_host: Option<String>,
    /// Port to listen on; the next port is used as well
    #[arg(long, default_value_t = 50_051)]
    port: u16,
    /// Number of partitions that run in parallel [default: number of cores]
    #[arg(long, value_name = "N")]
    cores: Option<usize>,
    /// Folder for results until they are fetched [default: a new folder for temporary files]
    #[arg(long, value_name = "DIR")]
    work: Option<PathBuf>,
}

pub(super) async fn schedule(options: &SchedulerOptions) -> Result<(), StudyError> {
    let study = options.study.load()?;
    say!("scheduler at {}:{}", options.bind, options.port);
    cluster::schedule(&study, &options.bind, options.port, options.executor_timeout).await
}

pub(super) async fn execute(options: &ExecutorOptions) -> Result<(), StudyError> {
    let study = options.study.load()?;
    let executor = cluster::Executor {
        scheduler: options.scheduler.clone(),
        bind: options.bind.clone(),
        external_host: options.external_host.clone(),
        port: options.port,
        cores: options.cores,
        work: options.work.clone(),
    };
    say!("executor of {} at {}:{}", options.scheduler, options.bind, options.port);
    executor.run(&study).await
}
