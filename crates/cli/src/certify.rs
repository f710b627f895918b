//! The command `certify`: proves the motion from each row to the next free, or reports time and
//! pair.

use std::path::{Path, PathBuf};

use clap::Args;
use lin_canny_cli::{RobotOptions, output::progress, values};
use lin_canny_robot::plan::receipt::Receipt;
use lin_canny_robot::plan::{self, Certified, Checker, JointMotion, PlanError, Verdict, nearest_name};
use lin_canny_robot::{Coordinate, Trajectory};

use crate::end::{End, ToolError};
use crate::options::{ReadRows, RestOptions, check_at_rest};
use crate::pair_boxes::PairBoxArguments;
use crate::text::{Table, configuration, fraction_below, names, place, time_at, write};
use crate::{film, receipt};

#[derive(Args)]
pub(crate) struct CertifyOptions {
    #[command(flatten)]
    robot: RobotOptions,
    /// Configurations: one column per joint, in any order, and optionally `time`; each joint moves at
    /// constant speed from row to row
    #[arg(long, value_name = "Q.csv", required_unless_present = "trajectory")]
    joints: Option<PathBuf>,
    /// Points with times, and optionally velocities and accelerations (columns `JOINT.velocity` and
    /// `JOINT.acceleration`): CSV, or a ROS JointTrajectory as JSON or YAML. The motion is linear, cubic
    /// or quintic, as the joint trajectory controller of ROS 2 interpolates. A column `JOINT.tube` says
    /// how much the joint may deviate, linear between rows
    #[arg(long, value_name = "FILE", conflicts_with = "joints")]
    trajectory: Option<PathBuf>,
    #[command(flatten)]
    rest: RestOptions,
    /// Let a joint deviate by this much, in radians or metres, instead of by its column `JOINT.tube`:
    /// everything in the tube is proven free; may be repeated
    #[arg(long, value_name = "JOINT=X", value_parser = values::named_number, conflicts_with = "start_contact")]
    tube: Vec<(String, f64)>,
    /// Required distance of all pairs in metres, without their paddings [default: that of the cell, or 0]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = values::not_negative)]
    margin: Option<f64>,
    #[command(flatten)]
    pair_boxes: PairBoxArguments,
    /// Accept pairs that are in contact at the start of a segment, within this distance in metres: they
    /// must not come closer until they have left it
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = values::not_negative)]
    start_contact: Option<f64>,
    /// Output file with the verdict of each segment
    #[arg(long, value_name = "OUT.csv")]
    csv: Option<PathBuf>,
    #[command(flatten)]
    film: film::FilmOptions,
    /// Output receipt, a proof that `verify` checks: of all segments if they are free, otherwise of
    /// the first that is blocked. If what blocks has no receipt, the tool says why, and ends with 1.
    /// Pairs of an accepted start contact are listed as not looked at
    #[arg(long, value_name = "OUT.jsonl", conflicts_with = "tube")]
    receipt: Option<PathBuf>,
    /// Output scene, the bodies and the motion without a proof: `verify --on` checks an older
    /// receipt on it
    #[arg(long, value_name = "OUT.jsonl", conflicts_with = "tube")]
    scene: Option<PathBuf>,
}

const COLUMNS: [&str; 8] = ["from_line", "to_line", "verdict", "safe", "t", "time", "a", "b"];

/// Lets joints deviate by as much at each row.
fn deviate(
    path: &mut Trajectory,
    given: &[(String, f64)],
    coordinates: &[Coordinate],
    file: &Path,
) -> Result<(), ToolError> {
    for (name, value) in given {
        let Some(k) = coordinates.iter().position(|c| c.name == *name) else {
            let near = nearest_name(name, coordinates.iter().map(|c| c.name.as_str()));
            let near = near.map_or(String::new(), |near| format!(" (nearest: {near:?})"));
            let reason = format!("--tube: joint {name:?} does not exist{near}");
            let file = file.to_owned();
            return Err(ToolError::State { file, reason });
        };
        path.tube.resize(path.rows.len(), Vec::new());
        for row in &mut path.tube {
            row.resize(coordinates.len(), 0.0);
            row[k] = *value;
        }
    }
    Ok(())
}

pub(crate) fn run(options: &CertifyOptions) -> Result<End, ToolError> {
    let (robot, cell) = options.robot.load()?;
    let files = (&options.robot, &robot, &cell);
    let (file, read): (_, ReadRows) = match (&options.trajectory, &options.joints) {
        (Some(file), _) => (file, |file, of, rest| Trajectory::load_timed(file, of, rest)),
        (None, Some(file)) => (file, |file, of, rest| Trajectory::load_with_rest(file, of, rest)),
        (None, None) => return Ok(End::Unknown),
    };
    let mut path = options.rest.load(file, files, 2, read)?;
    deviate(&mut path, &options.tube, cell.coordinates(), file)?;
    let tubes = path.tubes()?;
    let without = [
        ("--start-contact", options.start_contact.is_some()),
        ("--receipt", options.receipt.is_some()),
        ("--scene", options.scene.is_some()),
    ];
    if let Some((option, _)) = without.iter().find(|(_, is_given)| *is_given && !tubes.is_empty()) {
        let reason = format!("columns JOINT.tube cannot be used with {option}");
        let file = file.clone();
        return Err(ToolError::State { file, reason });
    }
    // A file that is not CSV has no lines.
    let unit = match path.velocities.is_empty() || file.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")) {
        true => "lines",
        false => "points",
    };
    let mut checker = Checker::of_robots(cell.clone())?;
    if let Some(margin) = options.margin {
        checker.cell_mut().set_margin(margin)?;
    }
    checker.set_start_contact_margin(options.start_contact)?;
    options.pair_boxes.set(&mut checker)?;
    if path.times.is_none() {
        check_at_rest(checker.cell(), file, "a column \"time\"")?;
    }
    let mut table = Table::new(COLUMNS);
    let bar = progress("segments", path.rows.len() as u64 - 1);
    let (mut end, mut free) = (End::Free, 0);
    let (curves, mut verdicts, mut blocked) = (path.curves()?, Vec::new(), None);
    let mut whole: Option<Certified> = None;
    for (k, curve) in curves.iter().enumerate() {
        let (from, to) = (path.lines[k], path.lines[k + 1]);
        let tube = tubes.get(k);
        let motion = match tube {
            Some(tube) => JointMotion::curve(curve).with_tube(tube)?,
            None => JointMotion::curve(curve),
        };
        let asked = plan::CertifyOptions::default().certificates(options.receipt.is_some());
        let found = checker.certify_with(&motion, asked).map_err(|error| match error {
            PlanError::CurveLimit {
                coordinate,
                time,
                value,
            } => {
                let Coordinate { name, limits, .. } = &cell.coordinates()[coordinate];
                let [low, high] = limits;
                let at = place(time, time_at(&path, k, time));
                let reason = format!(
                    "{unit} {from} to {to}: {name} exceeds its limits {low} and {high} {at}: {value}; see --limit-slack"
                );
                let file = file.clone();
                ToolError::State { file, reason }
            }
            error @ PlanError::PoseTime { .. } => {
                let reason = format!("{unit} {from} to {to}: {error}");
                let file = file.clone();
                ToolError::State { file, reason }
            }
            error => error.into(),
        })?;
        bar.inc(1);
        let verdict = found.verdict.clone();
        if blocked.is_none() && matches!(verdict, Verdict::Blocked { .. }) {
            blocked = Some((k, found.clone()));
        }
        whole = Some(match whole {
            Some(whole) => whole.followed_by(found),
            None => found,
        });
        if options.film.file().is_some() {
            verdicts.push(verdict.clone());
        }
        let safe = verdict.free_until();
        let contact = match tube.is_some() && !verdict.is_free() {
            true => checker.tube_contact(&motion, 0, safe)?,
            false => None,
        };
        let mut cells = vec![from.to_string(), to.to_string()];
        let name = verdict.name();
        for leaving in verdict.start_contacts() {
            let [a, b] = names(&checker, leaving.pair);
            let until = match leaving.contact.until {
                Some(t) => format!("leave their contact {}", place(t, time_at(&path, k, t))),
                None => "keep their contact".into(),
            };
            bar.suspend(|| say!("{unit} {from} to {to}: {a} - {b} {until}"));
        }
        match verdict {
            Verdict::Free { .. } => {
                free += 1;
                cells.extend([name, "1", "", "", "", ""].map(String::from));
            }
            Verdict::Blocked {
                contact_at: t,
                pair,
                required,
                ..
            } => {
                let [a, b] = names(&checker, pair);
                let (time, at) = (time_at(&path, k, t), place(t, time_at(&path, k, t)));
                let meet = checker.show(&required).meet(" m");
                let apart = fraction_below(safe);
                bar.suspend(|| say!("{unit} {from} to {to}: {a} - {b} {meet} {at}, free to {apart}"));
                let time = time.map_or(String::new(), |time| time.to_string());
                cells.extend([name.into(), safe.to_string(), t.to_string(), time, a, b]);
                end = end.max(End::Blocked);
            }
            _ => {
                let apart = fraction_below(safe);
                bar.suspend(|| say!("{unit} {from} to {to}: undecided from {apart} of the segment on"));
                cells.extend([name.into(), safe.to_string()]);
                cells.extend(["", "", "", ""].map(String::from));
                end = end.max(End::Unknown);
            }
        }
        if let Some((t, q)) = contact {
            let at = place(t, time_at(&path, k, t));
            let values = configuration(cell.coordinates(), &q);
            bar.suspend(|| say!("  not free in the tube {at}: {values}"));
        }
        table.row(&cells);
    }
    bar.finish_and_clear();
    if let Some(file) = &options.csv {
        write(file, &table.text())?;
    }
    film::record(&options.film, &cell, &path, (&curves, &verdicts), unit)?;
    // A path of straight segments has no curves for spaces that follow segments alone.
    let motion = match curves.iter().any(|curve| curve.degree() > 1) {
        true => JointMotion::spline(&curves)?,
        false => JointMotion::path(&path.rows)?,
    };
    let motion = match &path.times {
        Some(times) if motion.pieces() + 1 == times.len() => motion.with_times(times)?,
        _ => motion,
    };
    if let Some(file) = &options.scene {
        receipt::write_unless_blocked(file, &options.robot, &cell, Receipt::scene(&checker, &motion), end)?;
    }
    match (&options.receipt, whole, blocked) {
        (None, ..) => {}
        (Some(file), Some(whole), None) if end == End::Free => {
            let written = Receipt::certified(&checker, &motion, &whole);
            let count = receipt::write(file, &options.robot, &cell, written)?;
            say!("{}: {count} pieces of evidence", file.display());
        }
        (Some(file), _, Some((k, found))) => {
            let piece = motion.piece(k).unwrap_or(motion);
            let written = Receipt::certified(&checker, &piece, &found);
            if receipt::write_unless_blocked(file, &options.robot, &cell, written, end)?.is_some() {
                let (from, to) = (path.lines[k], path.lines[k + 1]);
                say!("{}: proof of what blocks {unit} {from} to {to}", file.display());
            }
        }
        (Some(file), ..) => warn!(
            "warning: {}: not written, because a segment is undecided",
            file.display()
        ),
    }
    let queries = checker.work().queries;
    say!(
        "{free} of {} segments proven free, {queries} distance queries",
        path.rows.len() - 1
    );
    Ok(end)
}
