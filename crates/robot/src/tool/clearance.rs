//! The command `clearance`: finds the closest pair at each row.

use std::path::PathBuf;

use clap::Args;
use lin_canny_robot::plan::NearPair;
use lin_canny_robot::{RobotRecorder, Trajectory};

use super::options::RobotOptions;
use super::{End, Table, ToolError, names, progress, write};

#[derive(Args)]
pub(super) struct ClearanceOptions {
    #[command(flatten)]
    robot: RobotOptions,
    /// Configurations: one column per joint, in any order, and optionally `time`
    #[arg(long, value_name = "Q.csv")]
    joints: PathBuf,
    /// Output file with the closest pair and its distance at each row
    #[arg(long, value_name = "OUT.csv")]
    csv: Option<PathBuf>,
    /// Output recording for the viewer: the robot, its cell and the closest pair at each row
    #[arg(long, value_name = "OUT.jsonl")]
    record: Option<PathBuf>,
}

const COLUMNS: [&str; 13] = [
    "line", "time", "distance", "lower", "upper", "a", "b", "a_x", "a_y", "a_z", "b_x", "b_y", "b_z",
];

pub(super) fn run(options: &ClearanceOptions) -> Result<End, ToolError> {
    let (_, setup) = options.robot.load()?;
    let rows = Trajectory::load(&options.joints, setup.coordinates())?;
    let mut checker = setup.checker()?;
    let mut table = Table::new(&COLUMNS);
    let first = rows.rows.first();
    let mut recorder = match (&options.record, first) {
        (Some(file), Some(q)) => Some(RobotRecorder::create(file, &checker, q)?),
        _ => None,
    };
    let bar = progress("rows", rows.rows.len() as u64);
    let (mut least, mut contacts): (Option<(u32, NearPair)>, usize) = (None, 0);
    for (k, q) in rows.rows.iter().enumerate() {
        let line = rows.lines[k];
        bar.inc(1);
        let Some(near) = checker.clearance(q)? else { continue };
        if let Some(recorder) = &mut recorder {
            recorder.frame(checker.space(), q, &format!("line {line}"), &near)?;
        }
        let [a, b] = names(&checker, near.pair);
        let mut cells = vec![line.to_string()];
        cells.push(rows.times.as_ref().map_or(String::new(), |t| t[k].to_string()));
        cells.extend([near.distance, near.lower, near.upper].map(|x| x.to_string()));
        cells.extend([a, b]);
        cells.extend(near.witnesses.iter().flat_map(|p| p.iter().map(f64::to_string)));
        table.row(&cells);
        contacts += usize::from(near.distance <= 0.0);
        if least.as_ref().is_none_or(|(_, other)| near.distance < other.distance) {
            least = Some((line, near));
        }
    }
    bar.finish_and_clear();
    if let Some(recorder) = recorder {
        recorder.finish()?;
    }
    if let Some(file) = &options.csv {
        write(file, &table.text())?;
    }
    let Some((line, near)) = least else {
        println!("{} rows; no pair to measure", rows.rows.len());
        return Ok(End::Free);
    };
    let [a, b] = names(&checker, near.pair);
    let (least, low, high) = (near.distance, near.lower, near.upper);
    println!(
        "{} rows, {contacts} in contact; least {least} (from {low} to {high}) at line {line}: {a} - {b}",
        rows.rows.len()
    );
    Ok(if contacts > 0 { End::Blocked } else { End::Free })
}
