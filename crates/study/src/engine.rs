//! Contexts that run queries in this process or on the executors of a scheduler.

use std::sync::Arc;

use ballista::prelude::SessionContextExt;
use ballista_core::extension::SessionConfigExt;
use datafusion::prelude::{SessionConfig, SessionContext};

use crate::error::StudyError;
use crate::study::Study;

/// Rows per batch, in each call of a function and each use of a pooled checker.
pub const BATCH: usize = 8192;

/// Returns a context of this process with the functions of a study; partitions run in parallel.
#[must_use]
pub fn local(study: &Arc<Study>, partitions: usize) -> SessionContext {
    let mut config = SessionConfig::new()
        .with_target_partitions(partitions.max(1))
        .with_batch_size(BATCH);
    let options = config.options_mut();
    // Rows keep their order and their partition.
    options.optimizer.enable_round_robin_repartition = false;
    // Strings in the type that all writers support.
    options.execution.parquet.schema_force_view_types = false;
    let context = SessionContext::new_with_config(config);
    study.register(&context);
    context
}

/// Returns a context that runs queries on the executors of a scheduler, `host:port`.
///
/// # Errors
/// Returns an error if the scheduler cannot be reached.
pub async fn cluster(study: &Arc<Study>, scheduler: &str, partitions: usize) -> Result<SessionContext, StudyError> {
    let config = SessionConfig::new_with_ballista()
        .with_target_partitions(partitions.max(1))
        // A small file may hold long work: rows that prove cells of ranges.
        .with_repartition_file_min_size(0)
        .with_batch_size(BATCH);
    let state = study.session_state(config)?;
    let context = SessionContext::remote_with_state(&format!("df://{scheduler}"), state).await?;
    // The state of a remote context does not have the functions.
    study.register(&context);
    Ok(context)
}
