//! The command `run`: computes the clearance of each row, or runs a query.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use clap::Args;
use lin_canny_study::{
    Format, Input, Run, RunProgress, Study, StudyError, TABLE, cluster_error, configuration_of, engine, look_over,
};

use super::options::{StudyArguments, WhereArguments};
use super::progress::{shown, wait};

#[derive(Args)]
pub(super) struct RunArguments {
    #[command(flatten)]
    study: StudyArguments,
    #[command(flatten)]
    place: WhereArguments,
    /// Configurations: a file or a folder of Parquet, CSV or Arrow IPC files with one column per
    /// joint (or a column `q` of lists); other columns are copied to the output
    #[arg(long = "in", value_name = "Q.parquet")]
    input: PathBuf,
    /// Output folder. An interrupted run resumes in the same folder
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Columns that are added to each row instead of the clearance, such as
    /// `certify_curve(p0, p1, p2, p3) AS verdict`: any functions of a row; an interrupted run resumes
    #[arg(long, value_name = "COLUMNS", conflicts_with = "sql")]
    select: Option<String>,
    /// Your own query over the table `configs`, with the functions clearance, is_free, certify,
    /// certify_curve, receipt, separation, signed_distance, prove_pair and configuration_error; it writes one
    /// file
    #[arg(long, value_name = "QUERY")]
    sql: Option<String>,
    /// Rows per part: an interrupted run repeats at most this number
    #[arg(
        long,
        alias = "block",
        value_name = "N",
        default_value_t = 65_536,
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    rows_per_part: u32,
    /// Output format
    #[arg(long, value_enum, default_value = "parquet")]
    format: Format,
}

pub(super) async fn run(arguments: &RunArguments) -> Result<(), StudyError> {
    let study = arguments.study.load()?;
    let input = Input::new(&arguments.input)?;
    match &arguments.sql {
        Some(query) => whole(&study, &input, query, arguments).await,
        None => rows(&study, &input, arguments).await,
    }
}

/// Computes the clearance of each row, or the selected columns, part by part.
async fn rows(study: &Arc<Study>, input: &Input, arguments: &RunArguments) -> Result<(), StudyError> {
    let mut options = arguments.place.options(arguments.format);
    options.rows_per_part = arguments.rows_per_part as usize;
    let (partitions, began) = (options.partitions, Instant::now());
    let (columns, faults) = match &arguments.select {
        Some(columns) => (columns.clone(), String::new()),
        None => {
            let configuration = configuration_in(study, input).await?;
            let waiting = wait("looking all rows over");
            let faults = look_over(study, input, &configuration, partitions).await?;
            waiting.finish_and_clear();
            (
                format!("clearance({configuration}) AS clearance"),
                format!(", {faults} bad"),
            )
        }
    };
    let query = format!("SELECT *, {columns} FROM {TABLE}");
    let run = Run {
        study,
        input,
        query: &query,
        folder: &arguments.out,
        options: &options,
    };
    let progress = RunProgress::default();
    let done = shown("rows", study, &progress, run.go(&progress)).await?;
    let (rows, seconds) = (done.rows, began.elapsed().as_secs_f64());
    let (parts, kept) = (done.parts, done.kept);
    say!("{rows} rows in {parts} part(s), {kept} kept from before{faults}; {seconds:.1} s");
    Ok(())
}

/// Returns the arguments of the functions, as columns of an input.
pub(super) async fn configuration_in(study: &Arc<Study>, input: &Input) -> Result<String, StudyError> {
    let frame = input.read(&engine::local(study, 1)).await?;
    let names: Vec<_> = frame.schema().fields().iter().map(|f| f.name().as_str()).collect();
    configuration_of(study, &names)
}

/// Runs a query and writes one file.
async fn whole(study: &Arc<Study>, input: &Input, query: &str, arguments: &RunArguments) -> Result<(), StudyError> {
    let format = arguments.format;
    let options = arguments.place.options(format);
    let (began, waiting) = (Instant::now(), wait("the query"));
    let context = match &options.scheduler {
        None => engine::local(study, options.partitions),
        Some(scheduler) => engine::cluster(study, scheduler, options.partitions).await?,
    };
    input.register(&context).await?;
    let answers = context.sql(query).await?;
    let schema = Arc::clone(answers.schema().inner());
    let batches = answers.collect().await;
    let batches = match &options.scheduler {
        None => batches?,
        Some(_) => batches.map_err(|e| cluster_error(&e))?,
    };
    waiting.finish_and_clear();
    std::fs::create_dir_all(&arguments.out).map_err(StudyError::io(&arguments.out))?;
    let file = arguments.out.join(format!("result.{}", format.extension()));
    format.write(&schema, &batches, &file)?;
    let rows: usize = batches.iter().map(|b| b.num_rows()).sum();
    let (file, seconds) = (file.display(), began.elapsed().as_secs_f64());
    say!("{rows} row(s) in {file}; {seconds:.1} s");
    Ok(())
}
