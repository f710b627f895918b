//! The processes of a cluster: Apache Ballista, with the functions of a study.

use std::path::PathBuf;
use std::sync::Arc;

use ballista_core::extension::SessionConfigExt;
use ballista_core::registry::BallistaFunctionRegistry;
use ballista_executor::executor_process::{ExecutorProcessConfig, start_executor_process};
use ballista_scheduler::cluster::BallistaCluster;
use ballista_scheduler::config::SchedulerConfig;
use ballista_scheduler::scheduler_process::start_server;
use clap::Args;
use datafusion::prelude::SessionConfig;

use crate::error::StudyError;
use crate::study::Study;

/// Seconds between heartbeats of an executor.
const HEARTBEAT: u64 = 5;

/// A process that divides queries among executors; the options of the command `scheduler`.
#[derive(Args, Clone, Debug)]
pub struct Scheduler {
    /// Address to listen on; 0.0.0.0 admits other machines (no authentication: trusted networks
    /// only)
    #[arg(long, value_name = "HOST", default_value = "127.0.0.1")]
    pub bind: String,
    /// Port to listen on
    #[arg(long, default_value_t = 50_050)]
    pub port: u16,
    /// Seconds without a message after which an executor counts as lost and others repeat its rows
    #[arg(long, alias = "lost-after", value_name = "SECONDS", default_value_t = 30)]
    pub executor_timeout: u64,
}

impl Scheduler {
    /// Divides queries among executors until the process is stopped.
    ///
    /// # Errors
    /// Returns an error if the address is invalid or cannot be used.
    pub async fn run(&self, study: &Arc<Study>) -> Result<(), StudyError> {
        let study = Arc::clone(study);
        let mut config = SchedulerConfig::default()
            .with_port(self.port)
            .with_override_session_builder(Arc::new(move |config| study.session_state(config)));
        config.bind_host.clone_from(&self.bind);
        config.executor_timeout_seconds = self.executor_timeout.max(HEARTBEAT + 1);
        config.expire_dead_executor_interval_seconds = HEARTBEAT.min(config.executor_timeout_seconds);
        let failed = |e: ballista_core::error::BallistaError| StudyError::Cluster(e.to_string());
        let address = format!("{}:{}", self.bind, self.port);
        let listen = address.parse().map_err(|e| StudyError::unfit(&address, e))?;
        let cluster = BallistaCluster::new_from_config(&config).await.map_err(failed)?;
        start_server(cluster, listen, Arc::new(config)).await.map_err(failed)
    }
}

/// A process that computes rows for a scheduler; the options of the command `executor`.
#[derive(Args, Clone, Debug)]
pub struct Executor {
    /// Address of the scheduler
    #[arg(long, value_name = "HOST:PORT", default_value = "127.0.0.1:50050")]
    pub scheduler: String,
    /// Address to listen on; 0.0.0.0 admits other machines (no authentication: trusted networks
    /// only)
    #[arg(long, value_name = "HOST", default_value = "127.0.0.1")]
    pub bind: String,
    /// Host name under which other machines reach this machine
    #[arg(long, value_name = "HOST")]
    pub external_host: Option<String>,
    /// Port to listen on; the next port is used as well
    #[arg(long, default_value_t = 50_051)]
    pub port: u16,
    /// Number of partitions that run in parallel [default: number of cores]
    #[arg(long, value_name = "N")]
    pub cores: Option<usize>,
    /// Folder for results until they are fetched [default: a new folder for temporary files]
    #[arg(long, value_name = "DIR")]
    pub work: Option<PathBuf>,
}

impl Executor {
    /// Computes rows until the process is stopped.
    ///
    /// # Errors
    /// Returns an error if the scheduler cannot be reached or the address cannot be used.
    pub async fn run(&self, study: &Arc<Study>) -> Result<(), StudyError> {
        let (host, port) = self
            .scheduler
            .rsplit_once(':')
            .and_then(|(host, port)| Some((host, port.parse().ok()?)))
            .ok_or_else(|| StudyError::unfit(&self.scheduler, "expected HOST:PORT"))?;
        let default = ExecutorProcessConfig::default();
        let own = std::env::temp_dir().join(format!("lin-canny-study-{}", default.executor_id));
        let work = self.work.clone().unwrap_or(own);
        std::fs::create_dir_all(&work).map_err(StudyError::io(&work))?;
        let state = study.session_state(SessionConfig::new_with_ballista())?;
        let config = ExecutorProcessConfig {
            bind_host: self.bind.clone(),
            external_host: self.external_host.clone(),
            port: self.port,
            grpc_port: self.port.saturating_add(1),
            scheduler_host: host.into(),
            scheduler_port: port,
            scheduler_connect_timeout_seconds: 30,
            vcores: self.cores.unwrap_or(default.vcores),
            work_dir: Some(work.to_string_lossy().into_owned()),
            executor_heartbeat_interval_seconds: HEARTBEAT,
            override_function_registry: Some(Arc::new(BallistaFunctionRegistry::from(&state))),
            ..default
        };
        let ended = start_executor_process(Arc::new(config)).await;
        ended.map_err(|e| StudyError::Cluster(e.to_string()))
    }
}
