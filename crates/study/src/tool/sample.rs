//! The command `sample`: writes configurations to measure.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use lin_canny_cli::output::progress;
use lin_canny_study::sampled::Sampler;
use lin_canny_study::{Format, StudyError};

use super::options::StudyArguments;

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Method {
    /// Halton sequence: evenly spread, for up to about ten joints
    Halton,
    /// Independent random numbers
    Random,
}

#[derive(Args)]
pub(super) struct SampleOptions {
    #[command(flatten)]
    study: StudyArguments,
    /// Number of configurations
    #[arg(long, default_value_t = 100_000)]
    rows: u64,
    /// Sampling method, within the limits of the joints
    #[arg(long, value_enum, default_value = "halton")]
    method: Method,
    /// Random seed of `--method random`
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Rows per file: an interrupted run on a cluster keeps whole files
    #[arg(long, alias = "rows-a-file", value_name = "N", default_value_t = 1_000_000)]
    rows_per_file: u64,
    /// Output format
    #[arg(long, value_enum, default_value = "parquet")]
    format: Format,
    /// Output folder; it must not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub(super) fn run(options: &SampleOptions) -> Result<(), StudyError> {
    let study = options.study.load()?;
    std::fs::create_dir(&options.out).map_err(StudyError::io(&options.out))?;
    let format = options.format;
    let mut source = match options.method {
        Method::Halton => Sampler::halton(study.coordinates()),
        Method::Random => Sampler::random(study.coordinates(), options.seed),
    };
    let bar = progress("rows", options.rows);
    let (mut first, mut files) = (0, 0);
    while first < options.rows {
        let end = (first + options.rows_per_file.max(1)).min(options.rows);
        let rows = source.rows(first..end)?;
        let name = format!("configs-{files:05}.{}", format.extension());
        format.write(&rows.schema(), std::slice::from_ref(&rows), &options.out.join(name))?;
        bar.inc(end - first);
        (first, files) = (end, files + 1);
    }
    bar.finish_and_clear();
    let (rows, joints, folder) = (options.rows, study.coordinates().len(), options.out.display());
    say!("{rows} configurations of {joints} joints in {files} file(s) of {folder}");
    Ok(())
}
