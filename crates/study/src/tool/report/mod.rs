//! The command `report`: writes the results of a run as one page.

mod charts;
mod page;
mod scene;
mod tables;

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use lin_canny_study::{Input, Study, StudyError, engine};

use super::options::StudyArguments;
use super::progress::wait;
use tables::Tables;

#[derive(Args)]
pub(super) struct ReportOptions {
    #[command(flatten)]
    study: StudyArguments,
    /// Output folder of a run
    #[arg(long = "in", value_name = "DIR")]
    input: PathBuf,
    /// Output file
    #[arg(long, value_name = "REPORT.html", default_value = "report.html")]
    out: PathBuf,
    /// Two joints of the map [default: the first two]
    #[arg(long, num_args = 2, value_names = ["JOINT", "JOINT"])]
    map: Option<Vec<String>>,
    /// Number of worst rows to list
    #[arg(long, default_value_t = 10)]
    worst: usize,
    /// Output recording of the worst rows, for the viewer
    #[arg(long, value_name = "WORST.jsonl")]
    record: Option<PathBuf>,
}

pub(super) async fn run(options: &ReportOptions) -> Result<(), StudyError> {
    let study = options.study.load()?;
    let input = Input::new(&options.input)?;
    let context = engine::local(&study, std::thread::available_parallelism().map_or(1, usize::from));
    input.register(&context).await?;
    let map = joints(&study, options.map.as_deref())?;
    let waiting = wait("counting");
    let tables = Tables::read(&context, &study, &map, options.worst).await?;
    let text = page::page(&study, &tables, &map)?;
    waiting.finish_and_clear();
    std::fs::write(&options.out, text).map_err(StudyError::io(&options.out))?;
    say!("{} rows; {}", tables.rows, tables.headline());
    say!("the page is {}", options.out.display());
    if let Some(file) = &options.record {
        scene::record(&study, &tables, file)?;
        say!("the worst rows are recorded in {}", file.display());
    }
    Ok(())
}

/// Returns the joints of the map.
fn joints(study: &Arc<Study>, named: Option<&[String]>) -> Result<Vec<String>, StudyError> {
    let names: Vec<_> = study.coordinates().iter().map(|c| c.name.clone()).collect();
    let Some(named) = named else {
        return Ok(names.into_iter().take(2).collect());
    };
    match named.iter().find(|n| !names.contains(n)) {
        None => Ok(named.to_vec()),
        Some(name) => Err(StudyError::unfit(
            "--map",
            format!("joint {name:?} does not exist (expected one of {})", names.join(", ")),
        )),
    }
}
