//! The command `roadmap`: writes free nodes, and edges proven free.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use datafusion::arrow::array::RecordBatch;
use datafusion::arrow::compute::concat_batches;
use lin_canny_study::sampled::Sampler;
use lin_canny_study::{
    Format, Input, Run, RunOptions, RunProgress, Study, StudyError, TABLE, configuration_of, engine, roadmap,
};

use super::options::{StudyArguments, WhereArguments};
use super::progress::{shown, wait};

#[derive(Args)]
pub(super) struct RoadmapOptions {
    #[command(flatten)]
    study: StudyArguments,
    #[command(flatten)]
    place: WhereArguments,
    /// Number of configurations of the Halton sequence; the free ones become nodes
    #[arg(long, default_value_t = 10_000, value_parser = clap::value_parser!(u64).range(1..))]
    samples: u64,
    /// Number of nearest nodes to which each node is connected, if the segment is proven free
    #[arg(long, default_value_t = 10)]
    neighbours: usize,
    /// Output folder. An interrupted command resumes in the same folder
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub(super) async fn run(options: &RoadmapOptions) -> Result<(), StudyError> {
    let study = options.study.load()?;
    let place = options.place.options(Format::Parquet);
    let [samples, nodes, segments, edges] = ["samples", "nodes", "segments", "edges"].map(|f| options.out.join(f));
    std::fs::create_dir_all(&options.out).map_err(StudyError::io(&options.out))?;

    let rows = Sampler::halton(study.coordinates()).rows(0..options.samples)?;
    written(&samples, &rows)?;
    let names: Vec<_> = study.coordinates().iter().map(|c| c.name.as_str()).collect();
    let query = format!(
        "SELECT *, is_free({}) AS free FROM {TABLE}",
        configuration_of(&study, &names)?
    );
    answered("nodes", &study, &samples, &query, &nodes, &place).await?;

    let free = table(&study, &nodes, &format!("SELECT * FROM {TABLE} WHERE free ORDER BY id")).await?;
    let waiting = wait("neighbours");
    let rows = roadmap::candidates(study.coordinates(), &free, options.neighbours)?;
    waiting.finish_and_clear();
    written(&segments, &rows)?;
    let query = format!("SELECT a AS node_a, b AS node_b, length, certify(\"from\", \"to\") AS found FROM {TABLE}");
    answered("edges", &study, &segments, &query, &edges, &place).await?;

    let counts = table(&study, &edges, &format!("SELECT * FROM {TABLE} WHERE verdict = 'free'")).await?;
    let found = roadmap::components(&free, &counts)?;
    let (free, samples) = (free.num_rows(), options.samples);
    let (proven, segments) = (counts.num_rows(), rows.num_rows());
    say!("{free} of {samples} configurations are free nodes; {proven} of {segments} segments are proven free");
    say!("{} component(s), the largest of {} nodes", found.count, found.largest);
    let [nodes, edges] = [nodes.display(), edges.display()];
    say!("nodes: {nodes} (column free); edges: {edges} (column verdict)");
    Ok(())
}

/// Writes rows to a file of a folder, unless the file exists.
fn written(folder: &Path, rows: &RecordBatch) -> Result<(), StudyError> {
    std::fs::create_dir_all(folder).map_err(StudyError::io(folder))?;
    let file = folder.join("rows.parquet");
    if file.exists() {
        return Ok(());
    }
    Format::Parquet.write(&rows.schema(), std::slice::from_ref(rows), &file)
}

async fn answered(
    what: &'static str,
    study: &Arc<Study>,
    rows: &Path,
    query: &str,
    folder: &Path,
    options: &RunOptions,
) -> Result<(), StudyError> {
    let input = Input::new(rows)?;
    let run = Run {
        study,
        input: &input,
        query,
        folder,
        options,
    };
    let progress = RunProgress::default();
    shown(what, study, &progress, run.go(&progress)).await.map(|_| ())
}

/// Returns the rows of a query over the files of a folder.
async fn table(study: &Arc<Study>, folder: &Path, query: &str) -> Result<RecordBatch, StudyError> {
    let context = engine::local(study, 1);
    Input::new(folder)?.register(&context).await?;
    let frame = context.sql(query).await?;
    let schema = Arc::clone(frame.schema().inner());
    Ok(concat_batches(&schema, &frame.collect().await?)?)
}
