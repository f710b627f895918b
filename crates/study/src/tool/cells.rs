//! The command `cells`: writes cells of the joint limits in which pairs are proven.

use std::path::PathBuf;

use clap::Args;
use lin_canny_study::{Format, StudyError, audited};

use super::options::StudyArguments;

#[derive(Args)]
pub(super) struct CellOptions {
    #[command(flatten)]
    study: StudyArguments,
    /// Most cells for each pair of links, and each link and obstacle
    #[arg(long, value_name = "N", default_value_t = 64)]
    cells: usize,
    /// Rows per file: an interrupted run on a cluster keeps whole files
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(1..))]
    rows_per_file: u32,
    /// Output folder; it must not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub(super) fn run(options: &CellOptions) -> Result<(), StudyError> {
    let study = options.study.load()?;
    std::fs::create_dir(&options.out).map_err(StudyError::io(&options.out))?;
    let rows = audited::cells(&study, options.cells)?;
    let (count, most) = (rows.num_rows(), options.rows_per_file as usize);
    // CSV has no lists.
    let format = Format::Parquet;
    let starts = (0..count.max(1)).step_by(most);
    let files = starts.len();
    for (k, start) in starts.enumerate() {
        let part = rows.slice(start, most.min(count - start));
        let file = options.out.join(format!("cells-{k:05}.{}", format.extension()));
        format.write_grouped(&part.schema(), &[part], &file, audited::ROWS_PER_GROUP)?;
    }
    say!("{count} cells in {files} file(s) of {}", options.out.display());
    Ok(())
}
