//! Where queries are answered: in this process, or by executors of a scheduler.

use std::sync::Arc;

use ballista::prelude::SessionContextExt;
use ballista_core::extension::SessionConfigExt;
use datafusion::prelude::{SessionConfig, SessionContext};

use crate::error::StudyError;
use crate::study::Study;

/// Rows of a batch: what a function is called with, and what a checker of the pool answers at once.
pub const BATCH: usize = 8192;

/// Returns a context of this process that knows the functions of a study, and answers partitions
/// side by side.
#[must_use]
pub fn local(study: &Arc<Study>, partitions: usize) -> SessionContext {
    let mut config = SessionConfig::new()
        .with_target_partitions(partitions.max(1))
        .with_batch_size(BATCH);
    let options = config.options_mut();
    // Rows stay in the order and the partition in which they were given.
    options.optimizer.enable_round_robin_repartition = false;
    // Strings as all writers have them.
    options.execution.parquet.schema_force_view_types = false;
    let context = SessionContext::new_with_config(config);
    study.register(&context);
    context
}

/// Returns a context whose queries the executors of a scheduler answer, `host:port`.
///
/// # Errors
/// A scheduler that is not reached.
pub async fn cluster(study: &Arc<Study>, scheduler: &str, partitions: usize) -> Result<SessionContext, StudyError> {
    let config = SessionConfig::new_with_ballista()
        .with_target_partitions(partitions.max(1))
        .with_batch_size(BATCH);
    let state = study.session_state(config)?;
    let context = SessionContext::remote_with_state(&format!("df://{scheduler}"), state).await?;
    // The state of a remote context has lost them.
    study.register(&context);
    Ok(context)
}
