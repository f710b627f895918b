//! Runs: a query over many rows, part by part, that can be interrupted and resumed.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use datafusion::arrow::array::{AsArray, RecordBatch};
use datafusion::arrow::compute::BatchCoalescer;
use datafusion::arrow::datatypes::{Int64Type, SchemaRef};
use datafusion::arrow::util::display::array_value_to_string;
use datafusion::datasource::MemTable;
use datafusion::error::DataFusionError;
use datafusion::prelude::SessionContext;
use futures::StreamExt;

use crate::engine::{self, BATCH};
use crate::error::StudyError;
use crate::format::Format;
use crate::input::{ID, Input, TABLE};
use crate::manifest::Manifest;
use crate::study::Study;

/// Options of a run.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RunOptions {
    /// Number of partitions that run in parallel.
    pub partitions: usize,
    /// Rows per part: an interrupted run repeats at most this number.
    pub rows_per_part: usize,
    /// The format of the parts.
    pub format: Format,
    /// Scheduler of a cluster, `host:port`; `None` runs in this process.
    pub scheduler: Option<String>,
}

impl Default for RunOptions {
    /// One partition per core, parts of 65,536 rows, Parquet, in this process.
    fn default() -> Self {
        Self {
            partitions: std::thread::available_parallelism().map_or(1, usize::from),
            rows_per_part: 65_536,
            format: Format::Parquet,
            scheduler: None,
        }
    }
}

impl RunOptions {
    /// Returns the options with another number of partitions.
    #[must_use]
    pub const fn partitions(mut self, partitions: usize) -> Self {
        self.partitions = partitions;
        self
    }

    /// Returns the options with another number of rows per part.
    #[must_use]
    pub const fn rows_per_part(mut self, rows: usize) -> Self {
        self.rows_per_part = rows;
        self
    }

    /// Returns the options with another format of the parts.
    #[must_use]
    pub const fn format(mut self, format: Format) -> Self {
        self.format = format;
        self
    }

    /// Returns the options with the scheduler of a cluster, `host:port`.
    #[must_use]
    pub fn scheduler(mut self, address: impl Into<String>) -> Self {
        self.scheduler = Some(address.into());
        self
    }
}

/// Progress of a run; another thread may read it.
#[derive(Debug, Default)]
pub struct RunProgress {
    /// Rows of the input.
    pub total: AtomicU64,
    /// Rows that need no more work, without those that [`Study::rows`] has counted since the start.
    pub known: AtomicU64,
}

/// Summary of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RunSummary {
    /// Rows of the input.
    pub rows: u64,
    /// Number of parts of the result.
    pub parts: usize,
    /// Number of parts that an earlier run had finished.
    pub kept: usize,
}

/// A query over the rows of an input.
pub struct Run<'a> {
    /// Robot and cell.
    pub study: &'a Arc<Study>,
    /// The rows.
    pub input: &'a Input,
    /// The query over the table `configs`. It must return one row per input row, without order or
    /// groups.
    pub query: &'a str,
    /// The folder of the parts.
    pub folder: &'a Path,
    /// The options.
    pub options: &'a RunOptions,
}

impl Run<'_> {
    /// Processes all rows that no part in the folder contains yet.
    ///
    /// In this process, parts have [`RunOptions::rows_per_part`] rows in the order of the input. On a
    /// cluster, a file is a part, ordered by the column `id` if there is one.
    ///
    /// # Errors
    /// Returns an error if the folder has parts of another study or query, if the query fails, or
    /// if a file cannot be read or written.
    pub async fn go(&self, progress: &RunProgress) -> Result<RunSummary, StudyError> {
        let manifest = Manifest::new(self);
        manifest.claim(self.folder)?;
        let context = engine::local(self.study, self.options.partitions);
        let rows = self.input.read(&context).await?.count().await?;
        progress.total.store(rows as u64, Ordering::Relaxed);
        match &self.options.scheduler {
            None => self.go_local(progress).await,
            Some(scheduler) => self.go_remote(scheduler, progress).await,
        }
    }

    async fn go_local(&self, progress: &RunProgress) -> Result<RunSummary, StudyError> {
        let [reader, context] = [1, self.options.partitions].map(|count| engine::local(self.study, count));
        let mut summary = RunSummary::default();
        for file in self.input.each() {
            let rows = file.read(&reader).await?;
            let mut stream = rows.execute_stream().await?;
            let mut parts = BatchCoalescer::new(stream.schema(), self.options.rows_per_part.max(1));
            loop {
                let batch = stream.next().await.transpose()?;
                let is_end = batch.is_none();
                match batch {
                    Some(batch) => parts.push_batch(batch)?,
                    None => parts.finish_buffered_batch()?,
                }
                while let Some(rows) = parts.next_completed_batch() {
                    self.block(&context, &rows, &mut summary, progress).await?;
                }
                if is_end {
                    break;
                }
            }
        }
        Ok(summary)
    }

    /// Processes a block of rows, unless its part exists.
    async fn block(
        &self,
        context: &SessionContext,
        rows: &RecordBatch,
        summary: &mut RunSummary,
        progress: &RunProgress,
    ) -> Result<(), StudyError> {
        let path = self.part(summary.parts);
        summary.parts += 1;
        summary.rows += rows.num_rows() as u64;
        if path.exists() {
            summary.kept += 1;
            progress.known.fetch_add(rows.num_rows() as u64, Ordering::Relaxed);
            return Ok(());
        }
        let table = MemTable::try_new(rows.schema(), divided(rows, self.options.partitions))?;
        context.deregister_table(TABLE)?;
        context.register_table(TABLE, Arc::new(table))?;
        let answers = context.sql(self.query).await?;
        let schema: SchemaRef = Arc::clone(answers.schema().inner());
        let answers = answers.collect_partitioned().await?.concat();
        self.options.format.write(&schema, &answers, &path)
    }

    async fn go_remote(&self, scheduler: &str, progress: &RunProgress) -> Result<RunSummary, StudyError> {
        let context = engine::cluster(self.study, scheduler, self.options.partitions).await?;
        let mut summary = RunSummary::default();
        for file in self.input.each() {
            let path = self.part(summary.parts);
            summary.parts += 1;
            file.register(&context).await?;
            if path.exists() {
                let rows = file.read(&engine::local(self.study, 1)).await?.count().await? as u64;
                (summary.kept, summary.rows) = (summary.kept + 1, summary.rows + rows);
                progress.known.fetch_add(rows, Ordering::Relaxed);
                continue;
            }
            let (schema, answers) = self.asked(&context).await?;
            let rows: u64 = answers.iter().map(|b| b.num_rows() as u64).sum();
            summary.rows += rows;
            progress.known.fetch_add(rows, Ordering::Relaxed);
            self.options.format.write(&schema, &answers, &path)?;
        }
        Ok(summary)
    }

    /// Runs the query on the executors, and repeats it if an executor with unfetched results is
    /// lost.
    async fn asked(&self, context: &SessionContext) -> Result<(SchemaRef, Vec<RecordBatch>), StudyError> {
        let mut tries = 0;
        loop {
            let mut answers = context.sql(self.query).await?;
            if answers.schema().has_column_with_unqualified_name(ID) {
                answers = answers.sort_by(vec![datafusion::prelude::col(ID)])?;
            }
            let schema: SchemaRef = Arc::clone(answers.schema().inner());
            tries += 1;
            match answers.collect().await {
                Ok(batches) => return Ok((schema, batches)),
                Err(error) if tries < TRIES && !is_in_vain(&error) => log::warn!("asked again: {error}"),
                Err(error) => return Err(cluster_error(&error)),
            }
        }
    }

    fn part(&self, number: usize) -> PathBuf {
        let name = format!("part-{number:05}.{}", self.options.format.extension());
        self.folder.join(name)
    }
}

/// Maximum number of attempts per file on a cluster.
const TRIES: u32 = 3;

/// Returns whether a repetition would fail again: an invalid row or an unknown function.
fn is_in_vain(error: &DataFusionError) -> bool {
    let text = error.to_string();
    text.contains("of its batch") || text.contains(UNKNOWN)
}

/// Text in a scheduler's error for a plan with an unknown function.
const UNKNOWN: &str = "not provided for scalar function";

/// Returns the error of a query that a cluster rejected.
#[must_use]
pub fn cluster_error(error: &DataFusionError) -> StudyError {
    let text = error.strip_backtrace();
    StudyError::Cluster(match text.contains(UNKNOWN) {
        true => {
            "the scheduler has another robot, cell or option than this command: both print a fingerprint as they begin"
                .into()
        }
        false => text,
    })
}

/// Divides rows into consecutive partitions.
fn divided(rows: &RecordBatch, partitions: usize) -> Vec<Vec<RecordBatch>> {
    let (count, partitions) = (rows.num_rows(), partitions.max(1));
    let cuts = (0..=partitions).map(|k| count * k / partitions).collect::<Vec<_>>();
    let partition = |ends: &[usize]| {
        let starts = (ends[0]..ends[1]).step_by(BATCH);
        starts.map(|k| rows.slice(k, BATCH.min(ends[1] - k))).collect()
    };
    cuts.windows(2).map(partition).collect()
}

/// Checks all rows of an input before they are measured, and returns the number of invalid rows.
///
/// # Errors
/// Returns an error for the first invalid row, unless the study is lenient.
pub async fn look_over(
    study: &Arc<Study>,
    input: &Input,
    arguments: &str,
    partitions: usize,
) -> Result<u64, StudyError> {
    let context = engine::local(study, partitions);
    input.register(&context).await?;
    let fault = format!("configuration_error({arguments})");
    let bad = format!("FROM {TABLE} WHERE {fault} IS NOT NULL");
    if study.options().lenient {
        let counted = context.sql(&format!("SELECT count(*) {bad}")).await?.collect().await?;
        let count = |b: &RecordBatch| b.column(0).as_primitive::<Int64Type>().value(0);
        return Ok(counted.first().map_or(0, count) as u64);
    }
    let first = context
        .sql(&format!("SELECT {fault} AS fault, * {bad} LIMIT 1"))
        .await?;
    let found = first.collect().await?;
    if let Some(batch) = found.iter().find(|b| b.num_rows() > 0) {
        let value = |k: usize| array_value_to_string(batch.column(k), 0);
        let schema = batch.schema();
        let named = |k: usize| Ok(format!("{} {}", schema.field(k).name(), value(k)?));
        let row: Vec<String> = (1..batch.num_columns()).map(named).collect::<Result<_, StudyError>>()?;
        return Err(StudyError::Row(format!("{}: {}", row.join(", "), value(0)?)));
    }
    Ok(0)
}
