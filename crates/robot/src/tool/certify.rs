//! The command `certify`: proves each segment between rows free, or reports time and pair.

use std::path::PathBuf;

use clap::Args;
use lin_canny_robot::Trajectory;
use lin_canny_robot::plan::Verdict;

use super::options::RobotOptions;
use super::{End, Table, ToolError, names, progress, write};

#[derive(Args)]
pub(super) struct CertifyOptions {
    #[command(flatten)]
    robot: RobotOptions,
    /// Rows of the motion: one column per joint, in any order, and optionally `time`; joints move
    /// at constant speed from row to row
    #[arg(long, value_name = "Q.csv")]
    joints: PathBuf,
    /// Minimum distance of all pairs, in the unit of the robot
    #[arg(long, value_name = "LENGTH", default_value_t = 0.0, allow_negative_numbers = true)]
    margin: f64,
    /// Output file with the verdict of each segment
    #[arg(long, value_name = "OUT.csv")]
    csv: Option<PathBuf>,
}

const COLUMNS: [&str; 8] = ["from_line", "to_line", "verdict", "safe", "t", "time", "a", "b"];

pub(super) fn run(options: &CertifyOptions) -> Result<End, ToolError> {
    let (_, setup) = options.robot.load()?;
    let path = Trajectory::load(&options.joints, setup.coordinates())?;
    if path.rows.len() < 2 {
        let (file, reason) = (options.joints.clone(), "too few rows (expected at least 2)".into());
        return Err(ToolError::Rows { file, reason });
    }
    let mut checker = setup.checker()?;
    checker.set_margin(options.margin)?;
    let mut table = Table::new(&COLUMNS);
    let bar = progress("segments", path.rows.len() as u64 - 1);
    let (mut end, mut free) = (End::Free, 0);
    for (k, ends) in path.rows.windows(2).enumerate() {
        let verdict = checker.certify(&ends[0], &ends[1])?;
        bar.inc(1);
        let (from, to) = (path.lines[k], path.lines[k + 1]);
        let mut cells = vec![from.to_string(), to.to_string()];
        // The time in the file at a fraction of the segment.
        let time = |t: f64| {
            path.times
                .as_ref()
                .map(|times| times[k] + (times[k + 1] - times[k]) * t)
        };
        match verdict {
            Verdict::Free { .. } => {
                free += 1;
                cells.extend(["free", "1", "", "", "", ""].map(String::from));
            }
            Verdict::Blocked { safe, t, pair, .. } => {
                let [a, b] = names(&checker, pair);
                let at = time(t).map_or(String::new(), |time| format!(", time {time}"));
                let meet = if options.margin == 0.0 {
                    "meet".to_owned()
                } else {
                    format!("come within the margin of {}", options.margin)
                };
                bar.suspend(|| {
                    println!("lines {from} to {to}: {a} - {b} {meet} at {t} of the segment{at}, free to {safe}")
                });
                let time = time(t).map_or(String::new(), |time| time.to_string());
                cells.extend(["blocked".into(), safe.to_string(), t.to_string(), time, a, b]);
                end = end.max(End::Blocked);
            }
            _ => {
                let safe = verdict.safe();
                bar.suspend(|| println!("lines {from} to {to}: undecided from {safe} of the segment on"));
                cells.extend(["undecided".into(), safe.to_string()]);
                cells.extend(["", "", "", ""].map(String::from));
                end = end.max(End::Unknown);
            }
        }
        table.row(&cells);
    }
    bar.finish_and_clear();
    if let Some(file) = &options.csv {
        write(file, &table.text())?;
    }
    let queries = checker.work().queries;
    println!(
        "{free} of {} segments proven free, {queries} distance queries",
        path.rows.len() - 1
    );
    Ok(end)
}
