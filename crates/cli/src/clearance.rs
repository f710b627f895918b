//! The command `clearance`: finds the closest pair at each row, or along each segment.

use std::collections::HashMap;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use lin_canny_cli::{RobotOptions, output::progress, values};
use lin_canny_robot::Trajectory;
use lin_canny_robot::plan::{
    Cell, CellBody, CellPair, Checker, JointCurve, JointMotion, JointTree, NearPair, PlanError, SegmentClearance,
    Verdict,
};

use crate::end::{End, ToolError};
use crate::film::FilmOptions;
use crate::options::{RowOptions, check_at_rest};
use crate::text::{Table, distance, names, place, time_at, write};

/// The pairs that are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Against {
    /// The robot against the cell and against itself
    All,
    /// The robot against the obstacles of the cell
    Cell,
    /// The robot against itself
    #[value(name = "self")]
    Robot,
}

#[derive(Args)]
pub(crate) struct ClearanceOptions {
    #[command(flatten)]
    robot: RobotOptions,
    #[command(flatten)]
    rows: RowOptions,
    /// Pairs that are measured
    #[arg(long, value_enum, default_value = "all", requires_if("cell", "cell"))]
    against: Against,
    /// Required distance of all pairs in metres, without their paddings [default: that of the cell, or 0]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = values::not_negative)]
    margin: Option<f64>,
    /// Measure the least clearance along the motion from row to row, at constant joint speeds; its
    /// bounds differ by 0.1 %, or by up to 10 % if a pair comes close for a short time
    #[arg(long, conflicts_with_all = ["record", "page"])]
    along: bool,
    /// Output file with the pair of each row, or of each segment, that is closest to its required
    /// distance, and its distance; `excess` is the distance less the required one
    #[arg(long, value_name = "OUT.csv")]
    csv: Option<PathBuf>,
    /// Add a column to OUT.csv for each pair of links, or of a link and an obstacle: the signed
    /// distance, 0 for a mesh in contact
    #[arg(long, requires = "csv", conflicts_with = "along")]
    pairs: bool,
    #[command(flatten)]
    film: FilmOptions,
}

pub(crate) fn run(options: &ClearanceOptions) -> Result<End, ToolError> {
    let (robot, mut cell) = options.robot.load()?;
    if let Some(margin) = options.margin {
        cell.set_margin(margin)?;
    }
    let rows = options
        .rows
        .load(&options.robot, &robot, &cell, if options.along { 2 } else { 1 })?;
    let mut checker = checker(&cell, options.against)?;
    if rows.times.is_none() {
        check_at_rest(checker.cell(), options.rows.file(), "a column \"time\"")?;
    }
    let (table, end) = if options.along {
        measure_segments(options, &mut checker, &rows)?
    } else {
        measure_rows(options, &mut checker, &rows)?
    };
    if let Some(file) = &options.csv {
        write(file, &table.text())?;
    }
    Ok(end)
}

/// Returns the checker of the pairs to be measured.
fn checker(cell: &Cell, against: Against) -> Result<Checker<JointTree>, ToolError> {
    let mut cell = cell.clone();
    if against != Against::All {
        let is_of_cell = |pair: CellPair| matches!(pair.b, CellBody::Obstacle(_));
        cell.exclude_if(|pair| is_of_cell(pair) != (against == Against::Cell));
    }
    Ok(Checker::of_robots(cell)?)
}

const COLUMNS: [&str; 14] = [
    "line", "time", "distance", "lower", "upper", "excess", "a", "b", "a_x", "a_y", "a_z", "b_x", "b_y", "b_z",
];

/// What rows and segments are that do not keep a required distance.
const CLOSER: &str = "closer than required";

fn measure_rows(
    options: &ClearanceOptions,
    checker: &mut Checker<JointTree>,
    rows: &Trajectory,
) -> Result<(Table, End), ToolError> {
    let first = &rows.rows[0];
    set_time(options, checker, rows, 0)?;
    let (titles, columns) = if options.pairs {
        pair_columns(checker, first)?
    } else {
        Default::default()
    };
    let mut table = Table::new(COLUMNS.into_iter().chain(titles.iter().map(String::as_str)));
    let mut recorder = options.film.start(checker, first)?;
    let bar = progress("rows", rows.rows.len() as u64);
    let (mut least, mut too_close): (Option<(u32, NearPair)>, usize) = (None, 0);
    for (k, q) in rows.rows.iter().enumerate() {
        let line = rows.lines[k];
        bar.inc(1);
        set_time(options, checker, rows, k)?;
        let found = match options.pairs {
            true => checker.nearest(q, f64::INFINITY)?,
            false => checker.least_excess(q)?.into_iter().collect(),
        };
        let Some(near) = found.iter().min_by(|x, y| x.excess.total_cmp(&y.excess)) else {
            continue;
        };
        if let Some(recorder) = &mut recorder {
            recorder.frame(checker, q, &format!("line {line}"), near)?;
        }
        let mut distances = vec![f64::INFINITY; titles.len()];
        for other in found.iter().filter(|_| options.pairs) {
            let column = &mut distances[columns[&other.pair]];
            *column = column.min(other.distance);
        }
        let mut cells = vec![line.to_string()];
        cells.push(rows.times.as_ref().map_or(String::new(), |t| t[k].to_string()));
        cells.extend([near.distance, near.lower, near.upper, near.excess].map(|x| x.to_string()));
        cells.extend(names(checker, near.pair));
        cells.extend(near.witnesses.iter().flat_map(|p| p.iter().map(f64::to_string)));
        cells.extend(distances.iter().map(f64::to_string));
        table.row(&cells);
        too_close += usize::from(near.excess <= 0.0);
        if least.as_ref().is_none_or(|(_, other)| near.excess < other.excess) {
            least = Some((line, near.clone()));
        }
    }
    bar.finish_and_clear();
    if let Some(recorder) = recorder {
        options.film.finish(recorder)?;
    }
    let count = rows.rows.len();
    match least {
        None => say!("{count} rows; no pair to measure"),
        Some((line, near)) => {
            let [a, b] = names(checker, near.pair);
            let least = distance(near.lower, near.upper);
            if checker.cell().requires_distance() {
                let required = checker.cell().required_distance(near.pair);
                let excess = distance(near.lower - required.distance, near.upper - required.distance);
                let required = checker.show(&required).length(" m");
                say!(
                    "{count} rows, {too_close} {CLOSER}; least excess {excess} at line {line}: {a} - {b}, \
                     {least} apart, required {required}"
                );
            } else {
                say!("{count} rows, {too_close} in contact; least clearance {least} at line {line}: {a} - {b}");
            }
        }
    }
    Ok((table, if too_close > 0 { End::Blocked } else { End::Free }))
}

/// Puts moving obstacles where they are at the time of a row.
fn set_time(
    options: &ClearanceOptions,
    checker: &mut Checker<JointTree>,
    rows: &Trajectory,
    k: usize,
) -> Result<(), ToolError> {
    let Some(times) = &rows.times else { return Ok(()) };
    let line = rows.lines[k];
    checker.set_time(times[k]).map_err(|error| ToolError::State {
        file: options.rows.file().to_owned(),
        reason: format!("line {line}: {error}"),
    })
}

/// Returns the titles of the columns of all pairs of names, and the column of each pair of bodies.
fn pair_columns(
    checker: &mut Checker<JointTree>,
    q: &[f64],
) -> Result<(Vec<String>, HashMap<CellPair, usize>), ToolError> {
    let mut pairs: Vec<CellPair> = checker.nearest(q, f64::INFINITY)?.iter().map(|n| n.pair).collect();
    pairs.sort_unstable();
    let mut titles = Vec::new();
    let mut by_title = HashMap::new();
    let mut columns = HashMap::new();
    for pair in pairs {
        let column = *by_title.entry(names(checker, pair)).or_insert(titles.len());
        if column == titles.len() {
            titles.push(names(checker, pair).join(" - "));
        }
        columns.insert(pair, column);
    }
    Ok((titles, columns))
}

const SEGMENT_COLUMNS: [&str; 10] = [
    "from_line",
    "to_line",
    "verdict",
    "lower",
    "upper",
    "excess",
    "t",
    "time",
    "a",
    "b",
];

fn measure_segments(
    options: &ClearanceOptions,
    checker: &mut Checker<JointTree>,
    rows: &Trajectory,
) -> Result<(Table, End), ToolError> {
    let mut table = Table::new(SEGMENT_COLUMNS);
    let count = rows.rows.len() - 1;
    let bar = progress("segments", count as u64);
    let (mut worst, mut contacts, mut least) = (End::Free, 0, None::<(usize, SegmentClearance)>);
    for (k, curve) in rows.curves()?.iter().enumerate() {
        let found = clearance_along(checker, curve);
        let (end, found) = found.map_err(|error| match error {
            error @ PlanError::PoseTime { .. } => {
                let (from, to) = (rows.lines[k], rows.lines[k + 1]);
                let file = options.rows.file().to_owned();
                let reason = format!("lines {from} to {to}: {error}");
                ToolError::State { file, reason }
            }
            error => error.into(),
        })?;
        bar.inc(1);
        let Some(pair) = found.pair else { continue };
        let ([a, b], time) = (names(checker, pair), time_at(rows, k, found.t));
        let (at, far) = (place(found.t, time), distance(found.lower, found.upper));
        let required = checker.cell().required_distance(pair);
        let (verdict, text) = match end {
            End::Free => ("free", format!("least clearance {far} {at}")),
            End::Blocked if required.distance > 0.0 => {
                let required = checker.show(&required).length(" m");
                ("blocked", format!("first within {required} {at}"))
            }
            End::Blocked => ("blocked", format!("first contact {at}")),
            _ => ("undecided", format!("undecided, {far} {at}")),
        };
        let [from, to] = [rows.lines[k], rows.lines[k + 1]];
        bar.suspend(|| say!("lines {from} to {to}: {text}: {a} - {b}"));
        let lower = Some(found.lower).filter(|lower| lower.is_finite());
        let [lower, time] = [lower, time].map(|x| x.map_or(String::new(), |x| x.to_string()));
        let [upper, excess, t] = [found.upper, found.upper - required.distance, found.t].map(|x| x.to_string());
        let verdict = verdict.to_owned();
        let [from, to] = [from, to].map(|line| line.to_string());
        table.row([from, to, verdict, lower, upper, excess, t, time, a, b]);
        contacts += usize::from(end == End::Blocked);
        worst = worst.max(end);
        if least.is_none_or(|(_, other)| found.upper < other.upper) {
            least = Some((k, found));
        }
    }
    bar.finish_and_clear();
    let too_close = if checker.cell().requires_distance() {
        CLOSER
    } else {
        "in contact"
    };
    match least {
        None => say!("{count} segments; no pair to measure"),
        Some(_) if contacts > 0 => say!("{contacts} of {count} segments {too_close}"),
        Some((k, found)) => {
            let (from, to, far) = (rows.lines[k], rows.lines[k + 1], distance(found.lower, found.upper));
            say!("0 of {count} segments {too_close}; least clearance {far} on lines {from} to {to}");
        }
    }
    Ok((table, worst))
}

/// Relative widths of the bounds of a segment. A narrow width may end without a proof if a pair
/// comes much closer than at the sampled configurations.
const WIDTHS: [f64; 3] = [1e-3, 1e-2, 1e-1];

/// Returns the least clearance along a segment; if it is blocked, the pair and the time with the
/// required distance as upper bound. The lower bound is minus infinity if nothing is proven.
fn clearance_along(checker: &mut Checker<JointTree>, curve: &JointCurve) -> Result<(End, SegmentClearance), PlanError> {
    let mut found = checker.clearance_along(&JointMotion::curve(curve), WIDTHS[0])?;
    let is_apart = found.lower > 0.0;
    if is_apart && !checker.cell().requires_distance() {
        return Ok((End::Free, found));
    }
    let end = match checker.certify(&JointMotion::curve(curve))? {
        Verdict::Free { .. } => End::Free,
        Verdict::Blocked {
            contact_at: t,
            pair,
            required,
            ..
        } => {
            (found.upper, found.t, found.pair) = (required.distance, t, Some(pair));
            End::Blocked
        }
        _ => End::Unknown,
    };
    if is_apart {
        return Ok((end, found));
    }
    if end != End::Free {
        found.lower = f64::NEG_INFINITY;
        return Ok((end, found));
    }
    for width in &WIDTHS[1..] {
        found = checker.clearance_along(&JointMotion::curve(curve), *width)?;
        if found.lower > 0.0 {
            break;
        }
    }
    Ok((end, found))
}
