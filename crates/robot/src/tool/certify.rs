//! The command `certify`: proves each segment between rows free, or reports time and pair.

use std::path::PathBuf;

use clap::Args;
use lin_canny_robot::plan::Verdict;

use super::options::{RobotOptions, RowOptions};
use super::text::{Table, fraction_below, names, place, time_at};
use super::{End, ToolError, progress, write};

#[derive(Args)]
pub(super) struct CertifyOptions {
    #[command(flatten)]
    robot: RobotOptions,
    #[command(flatten)]
    rows: RowOptions,
    /// Minimum distance of all pairs in metres [default: that of the cell, or 0]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    margin: Option<f64>,
    /// Accept pairs that are in contact at the start of a segment, within this distance in metres: they
    /// must not come closer until they have left it
    #[arg(long, value_name = "LENGTH")]
    start_contact: Option<f64>,
    /// Output file with the verdict of each segment
    #[arg(long, value_name = "OUT.csv")]
    csv: Option<PathBuf>,
}

const COLUMNS: [&str; 8] = ["from_line", "to_line", "verdict", "safe", "t", "time", "a", "b"];

pub(super) fn run(options: &CertifyOptions) -> Result<End, ToolError> {
    let (robot, setup) = options.robot.load()?;
    let path = options.rows.load(&options.robot, &robot, &setup, 2)?;
    let mut checker = setup.checker()?;
    checker.set_margin(options.margin.unwrap_or(checker.margin()))?;
    checker.set_start_contact_margin(options.start_contact)?;
    let mut table = Table::new(COLUMNS);
    let bar = progress("segments", path.rows.len() as u64 - 1);
    let (mut end, mut free) = (End::Free, 0);
    for (k, ends) in path.rows.windows(2).enumerate() {
        let verdict = checker.certify(&ends[0], &ends[1])?;
        bar.inc(1);
        let (from, to) = (path.lines[k], path.lines[k + 1]);
        let mut cells = vec![from.to_string(), to.to_string()];
        match verdict {
            Verdict::Free { start_contacts, .. } => {
                free += 1;
                for leaving in start_contacts {
                    let [a, b] = names(&checker, leaving.pair);
                    let until = match leaving.contact.until {
                        Some(t) => format!("leave their contact {}", place(t, time_at(&path, k, t))),
                        None => "keep their contact".into(),
                    };
                    bar.suspend(|| println!("lines {from} to {to}: {a} - {b} {until}"));
                }
                cells.extend(["free", "1", "", "", "", ""].map(String::from));
            }
            Verdict::Blocked { safe, t, pair, .. } => {
                let [a, b] = names(&checker, pair);
                let (time, at) = (time_at(&path, k, t), place(t, time_at(&path, k, t)));
                let meet = match checker.margin() {
                    0.0 => "meet".to_owned(),
                    margin => format!("come within {margin} m"),
                };
                let apart = fraction_below(safe);
                bar.suspend(|| println!("lines {from} to {to}: {a} - {b} {meet} {at}, free to {apart}"));
                let time = time.map_or(String::new(), |time| time.to_string());
                cells.extend(["blocked".into(), safe.to_string(), t.to_string(), time, a, b]);
                end = end.max(End::Blocked);
            }
            _ => {
                let (safe, apart) = (verdict.safe(), fraction_below(verdict.safe()));
                bar.suspend(|| println!("lines {from} to {to}: undecided from {apart} of the segment on"));
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
