//! What a row costs: a bare loop over `Checker::clearance` that remembers or forgets, and runs of one partition and of two.
//!
//! `cargo bench --bench cost -- [--rows N]` in `crates/study`; a line of CSV for each way.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use clap::Parser;
use datafusion::arrow::array::AsArray;
use datafusion::arrow::datatypes::Float64Type;
use lin_canny_study::robot::RobotFiles;
use lin_canny_study::robot::plan::Checker;
use lin_canny_study::sampled::Sampler;
use lin_canny_study::{Format, Input, Run, RunOptions, RunProgress, Study, StudyOptions};

type Trouble = Box<dyn std::error::Error>;

/// Rows after which a checker that forgets by blocks forgets.
const BLOCK: usize = 1024;

#[derive(Parser)]
struct Options {
    /// Random configurations
    #[arg(long, default_value_t = 100_000)]
    rows: u64,
    /// What `cargo bench` adds
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> Result<(), Trouble> {
    let options = Options::parse();
    let example = |name: &str| {
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../robot/examples")
            .join(name)
    };
    let mut files = RobotFiles::new(example("six_axis.urdf"));
    files.cell = Some(example("six_axis_cell.json"));
    files.srdf = Some(example("six_axis.srdf"));
    let study = Study::new(files.load()?.cell, StudyOptions::default())?;
    let rows = Sampler::random(study.coordinates(), 1).rows(0..options.rows)?;
    let columns: Vec<_> = (1..=6)
        .map(|k| rows.column(k).as_primitive::<Float64Type>().clone())
        .collect();
    let row = |k: usize| columns.iter().map(|c| c.value(k)).collect::<Vec<_>>();

    println!("way,rows,seconds,rows_a_second");
    for (way, every) in [
        ("loop that remembers", usize::MAX),
        ("loop that forgets", 1),
        ("loop that forgets by blocks", BLOCK),
    ] {
        let mut checker = Checker::of_robots(study.cell().clone())?;
        let (began, mut least) = (Instant::now(), f64::INFINITY);
        for k in 0..rows.num_rows() {
            if k % every == 0 {
                checker.reset();
            }
            if let Some(near) = checker.clearance(&row(k))? {
                least = least.min(near.distance);
            }
        }
        tell(way, options.rows, began);
        assert!(least < 0.0, "nothing was measured");
    }

    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cost");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(folder.join("in"))?;
    Format::Parquet.write(
        &rows.schema(),
        std::slice::from_ref(&rows),
        &folder.join("in/rows.parquet"),
    )?;
    for partitions in [1, 2] {
        let began = Instant::now();
        run(&study, &folder, partitions)?;
        tell(&format!("run of {partitions} partition(s)"), options.rows, began);
    }
    Ok(())
}

fn run(study: &Arc<Study>, folder: &Path, partitions: usize) -> Result<(), Trouble> {
    let options = RunOptions::default().partitions(partitions);
    let run = Run {
        study,
        input: &Input::new(folder.join("in"))?,
        query: "SELECT *, clearance(turn, lift, elbow, roll, bend, twist) AS c FROM configs",
        folder: &folder.join(format!("out {partitions}")),
        options: &options,
    };
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
    runtime.block_on(run.go(&RunProgress::default()))?;
    Ok(())
}

fn tell(way: &str, rows: u64, began: Instant) {
    let seconds = began.elapsed().as_secs_f64();
    println!("{way},{rows},{seconds:.2},{:.0}", rows as f64 / seconds);
}
