//! `scheduler` and `executor`: the processes of a cluster.

use std::path::PathBuf;

use clap::Args;
use lin_canny_study::{StudyError, cluster};

use super::options::StudyArguments;

#[derive(Args)]
pub(super) struct SchedulerOptions {
    #[command(flatten)]
    study: StudyArguments,
    /// The address to listen at; 0.0.0.0 for other machines, in a network that you trust
    #[arg(long, value_name = "HOST", default_value = "127.0.0.1")]
    bind: String,
    /// The port to listen at
    #[arg(long, default_value_t = 50_050)]
    port: u16,
    /// Seconds of silence after which an executor counts as lost, and others repeat its rows
    #[arg(long, value_name = "SECONDS", default_value_t = 30)]
    lost_after: u64,
}

#[derive(Args)]
pub(super) struct ExecutorOptions {
    #[command(flatten)]
    study: StudyArguments,
    /// The scheduler
    #[arg(long, value_name = "HOST:PORT", default_value = "127.0.0.1:50050")]
    scheduler: String,
    /// The address to listen at; 0.0.0.0 for other machines, in a network that you trust
    #[arg(long, value_name = "HOST", default_value = "127.0.0.1")]
    bind: String,
    /// The name by which others reach this machine
    #[arg(long, value_name = "HOST")]
    external_host: Option<String>,
    /// The port to listen at; the next one is used too
    #[arg(long, default_value_t = 50_051)]
    port: u16,
    /// Partitions answered side by side; as many as the machine has cores if left out
    #[arg(long, value_name = "N")]
    cores: Option<usize>,
    /// Where answers wait until they are fetched
    #[arg(long, value_name = "DIR")]
    work: Option<PathBuf>,
}

pub(super) async fn schedule(options: &SchedulerOptions) -> Result<(), StudyError> {
    let study = options.study.load()?;
    println!("scheduler at {}:{}", options.bind, options.port);
    cluster::schedule(&study, &options.bind, options.port, options.lost_after).await
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
    println!("executor of {} at {}:{}", options.scheduler, options.bind, options.port);
    executor.run(&study).await
}
