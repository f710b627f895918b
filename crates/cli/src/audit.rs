//! The command `audit`: proves which pairs can ever meet.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use lin_canny::Progress;
use lin_canny_cli::{RobotOptions, output::progress, values};
use lin_canny_robot::plan::receipt::Receipt;
use lin_canny_robot::plan::{Checker, ClearanceWidth, RangeAnswer, RangeOptions};
use lin_canny_robot::{AuditVerdict, LinkAudit, Srdf, audit};

use crate::audit_page::AuditPage;
use crate::end::{End, ToolError};
use crate::receipt;
use crate::text::{configuration, distance, write};

#[derive(Args)]
pub(crate) struct AuditOptions {
    #[command(flatten)]
    robot: RobotOptions,
    /// Most cells of each pair of bodies
    #[arg(long, value_name = "N", default_value_t = 20_000)]
    cells: u64,
    /// Time limit of the run in seconds: pairs without a verdict are then open [default: none]
    #[arg(long, value_name = "S", value_parser = values::duration)]
    seconds: Option<Duration>,
    /// Width of the least clearance as a share of it; 0 proves only that pairs never meet
    #[arg(long = "relative-width", value_name = "SHARE", default_value = "0.1", value_parser = values::share)]
    width: f64,
    /// Output file with one row for each pair
    #[arg(long, value_name = "OUT.csv")]
    csv: Option<PathBuf>,
    /// Output page with a table and a drawing of each pair at its least clearance
    #[arg(long, value_name = "AUDIT.html")]
    report: Option<PathBuf>,
    /// Output file with the excluded pairs as SRDF: those that never meet with the reason `Proven`
    #[arg(long, value_name = "OUT.srdf")]
    out: Option<PathBuf>,
    /// Output receipt, a proof that `verify` checks: of all pairs that never meet, but for those that
    /// would need more cells than --receipt-cells
    #[arg(long, value_name = "OUT.jsonl")]
    receipt: Option<PathBuf>,
    /// Most cells of each pair in the receipt
    #[arg(long, value_name = "N", default_value_t = 20_000, requires = "receipt")]
    receipt_cells: u64,
    /// File of the answers: open pairs of an earlier run go on, and the answers are written to it
    #[arg(long, value_name = "FILE")]
    resume: Option<PathBuf>,
}

pub(crate) fn run(options: &AuditOptions) -> Result<End, ToolError> {
    let (robot, cell) = options.robot.load()?;
    let mut checker = Checker::of_robots(cell.clone())?;
    let earlier = options.resume.as_deref().map_or(Ok(Vec::new()), load)?;
    let mut range = RangeOptions::default().cells(options.cells);
    if options.width > 0.0 {
        range = range.width(ClearanceWidth::Share(options.width));
    }
    let began = Instant::now();
    let bar = match options.seconds {
        Some(limit) => progress("seconds", limit.as_secs()),
        None => progress("cells", options.cells),
    };
    let found = audit(&mut checker, &range, &earlier, &mut |now| {
        bar.set_position(match options.seconds {
            Some(_) => began.elapsed().as_secs(),
            None => now.done as u64,
        });
        Progress::stop_if(options.seconds.is_some_and(|limit| began.elapsed() > limit))
    })?;
    bar.finish_and_clear();
    let reasons: BTreeMap<[&str; 2], &str> = cell.excluded_names().into_iter().collect();
    let reason = |names: &[String; 2]| {
        let mut names = names.each_ref().map(String::as_str);
        names.sort_unstable();
        reasons.get(&names).copied().filter(|reason| !reason.is_empty())
    };
    let coordinates = cell.coordinates();
    let [meet, meets] = match cell.requires_distance() {
        true => ["come closer than required", "comes closer than required"],
        false => ["meet", "meets"],
    };
    let mut end = End::Free;
    for one in &found {
        say!("{}", line(one));
        if one.verdict == AuditVerdict::Open {
            end = end.max(End::Unknown);
        }
        if let Some(claim) = reason(&one.names).filter(|claim| one.refutes(claim)) {
            end = end.max(End::Blocked);
            let values = one.contact().unwrap_or_default();
            say!(
                "  excluded as {claim}, but {meets} at {}",
                configuration(coordinates, values)
            );
        }
    }
    let count = |verdict| found.iter().filter(|one| one.verdict == verdict).count();
    say!(
        "{} pairs: {} never {meet}, {} always, {} both, {} open",
        found.len(),
        count(AuditVerdict::Never),
        count(AuditVerdict::Always),
        count(AuditVerdict::Both),
        count(AuditVerdict::Open),
    );
    for one in found.iter().filter(|one| one.verdict == AuditVerdict::Open) {
        say!("{}", why_open(one));
    }
    if let Some(file) = &options.csv {
        write(file, &table(&found))?;
    }
    if let Some(file) = &options.report {
        let page = AuditPage {
            robot: robot.name(),
            coordinates,
            found: &found,
            reason: &reason,
            meet,
        };
        write(file, &page.html(&checker)?)?;
    }
    if let Some(file) = &options.out {
        let srdf = Srdf::from_audit(&found, &|names| reason(names).map(str::to_owned));
        write(file, &srdf.text(robot.name()))?;
    }
    if let Some(file) = &options.receipt {
        let answers: Vec<RangeAnswer> = found.iter().flat_map(|one| one.answers.iter().cloned()).collect();
        let written = Receipt::range(&checker, &answers, options.receipt_cells);
        let count = receipt::write(file, &options.robot, &cell, written)?;
        say!("{}: {count} cells with a plane", file.display());
    }
    if let Some(file) = &options.resume {
        let answers: Vec<&RangeAnswer> = found.iter().flat_map(|one| &one.answers).collect();
        let text = serde_json::to_string(&answers).map_err(|error| state(file, &error.to_string()))?;
        write(file, &text)?;
    }
    Ok(end)
}

/// Returns the answers of an earlier run, or none if there is no such file.
fn load(file: &Path) -> Result<Vec<RangeAnswer>, ToolError> {
    match std::fs::read_to_string(file) {
        Ok(text) => serde_json::from_str(&text).map_err(|error| state(file, &error.to_string())),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(Vec::new()),
        Err(error) => Err(state(file, &error.to_string())),
    }
}

fn state(file: &Path, reason: &str) -> ToolError {
    ToolError::Input {
        file: file.to_owned(),
        reason: reason.to_owned(),
    }
}

fn line(one: &LinkAudit) -> String {
    let [a, b] = &one.names;
    let least = distance(one.lower, f64::INFINITY);
    let reported = match one.verdict {
        AuditVerdict::Never if one.upper.is_finite() => {
            format!(", {least}, {}", distance(f64::NEG_INFINITY, one.upper))
        }
        AuditVerdict::Never => format!(", {least}"),
        AuditVerdict::Open => format!(", {:.1e} open, {least}", one.open),
        _ => String::new(),
    };
    let joints = if one.joints == 1 { "joint" } else { "joints" };
    format!(
        "{:<7}{a} - {b} ({} {joints}{reported})",
        one.verdict.to_string(),
        one.joints
    )
}

/// Says why a pair is open, and what its user may do.
fn why_open(one: &LinkAudit) -> String {
    let [a, b] = &one.names;
    match (one.is_flush(), one.joints) {
        (true, 1) => format!(
            "open: {a} - {b} touch without depth at their joint, so no proof decides; \
             exclude adjacent links in the SRDF"
        ),
        (true, _) => format!("open: {a} - {b} touch without depth, so no proof decides; keep a margin or exclude them"),
        (false, _) => format!("open: {a} - {b} need more cells: --cells, or go on with --resume"),
    }
}

/// Returns the rows as CSV, lengths in metres.
fn table(found: &[LinkAudit]) -> String {
    let mut text = String::from("a,b,joints,verdict,lower,upper,open,cells,ms\n");
    for one in found {
        let [a, b] = one.names.each_ref().map(|name| quoted(name));
        let ms = one.time.as_secs_f64() * 1e3;
        let LinkAudit {
            joints,
            verdict,
            lower,
            upper,
            open,
            cells,
            ..
        } = one;
        text += &format!("{a},{b},{joints},{verdict},{lower:?},{upper:?},{open:?},{cells},{ms:.3}\n");
    }
    text
}

/// Returns a name as a field of CSV.
fn quoted(name: &str) -> String {
    match name.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.to_owned(),
    }
}
