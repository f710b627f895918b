//! The command `clash`: which parts of a model overlap, and which gaps are too small.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::{Args, ValueEnum};
use lin_canny::{ManifoldOptions, PairTracker, Progress, RelativePose};
use lin_canny_clash::{
    ClashError, ClashOptions, Comparison, Kind, Model, ModelOptions, Part, Row, Rules, find, is_unlikely_size, to_csv,
    to_junit, worst_first,
};
use lin_canny_cli::output::progress;
use lin_canny_cli::{values, warn_of_skipped};
use lin_canny_record::{PageOptions, Recorder, Recording, page};

use crate::end::{End, ToolError};
use crate::text::write;

/// Greatest number of rows that the table for people and the page have.
const SHOWN: usize = 100;

/// Unit of lengths.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Unit {
    /// Metres
    M,
    /// Millimetres
    Mm,
    /// Inches
    In,
}

/// What is done to open meshes.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Repair {
    /// They are surfaces without inside
    None,
    /// Holes are closed if they are at most 1 % of the area of a part
    Surface,
}

#[derive(Args)]
pub(crate) struct ClashArguments {
    /// Mesh files (STL, OBJ, COLLADA, PLY, glTF, MSH), folders of them, cells (JSON, SDFormat) and robots (URDF,
    /// MJCF). Each object of a file is a part
    #[arg(value_name = "INPUT", required = true)]
    inputs: Vec<PathBuf>,
    /// Rules as JSON or TOML: margin, margins, paddings, exclude, `allowed_depth`, `allowed_volume`, touching
    #[arg(long, value_name = "RULES.json")]
    rules: Option<PathBuf>,
    /// Value of a joint of a robot, in radians or metres; other joints are where the file draws them; may be
    /// repeated
    #[arg(long = "joint", value_name = "JOINT=VALUE", value_parser = values::joint_value)]
    joints: Vec<(String, f64)>,
    /// Link pairs of a robot to exclude, as SRDF
    #[arg(long, value_name = "FILE")]
    srdf: Option<PathBuf>,
    /// Add rows of pairs that are at most this far apart
    #[arg(long, value_name = "LENGTH", default_value_t = 0.0, value_parser = values::not_negative)]
    within: f64,
    /// Compute the volume that parts share
    #[arg(long)]
    volume: bool,
    /// Unit of STL, OBJ, PLY and MSH, which have none, and of all lengths that are printed and written
    #[arg(long, value_enum, default_value = "m")]
    unit: Unit,
    /// What is done to open meshes
    #[arg(long, value_enum, default_value = "surface")]
    repair: Repair,
    /// Output file with a line of JSON for each pair
    #[arg(long, value_name = "OUT.jsonl")]
    jsonl: Option<PathBuf>,
    /// Output file with a row for each pair
    #[arg(long, value_name = "OUT.csv")]
    csv: Option<PathBuf>,
    /// Output file with a test case for each pair, as JUnit XML
    #[arg(long, value_name = "OUT.xml")]
    junit: Option<PathBuf>,
    /// Output page that shows the parts, and one of the worst pairs per frame
    #[arg(long, value_name = "OUT.html")]
    page: Option<PathBuf>,
    /// Earlier output of `--jsonl`: only pairs that are new, worse or gone are reported
    #[arg(long, value_name = "FILE.jsonl")]
    baseline: Option<PathBuf>,
    /// Leave out files that cannot be read; the exit code is 3 all the same
    #[arg(long)]
    keep_going: bool,
    /// Take a rule that matches no part for an error
    #[arg(long)]
    strict: bool,
}

impl From<ClashError> for ToolError {
    fn from(error: ClashError) -> Self {
        match error {
            ClashError::Mesh(error) => Self::Format(error),
            ClashError::Cell(error) => Self::File(error),
            error => Self::Clash(Box::new(error)),
        }
    }
}

pub(crate) fn run(options: &ClashArguments) -> Result<End, ToolError> {
    let read = |file: &Path| {
        std::fs::read_to_string(file).map_err(|reason| ToolError::Input {
            file: file.to_owned(),
            reason: format!("cannot be read: {reason}"),
        })
    };
    let rules = match &options.rules {
        Some(file) => {
            let text = read(file)?;
            let rules = match file.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml")) {
                true => Rules::from_toml(&text),
                false => Rules::from_json(&text),
            };
            rules.map_err(|error| ToolError::Input {
                file: file.clone(),
                reason: error.to_string(),
            })?
        }
        None => Rules::default(),
    };
    let unit = match options.unit {
        Unit::M => lin_canny_clash::Unit::Metre,
        Unit::Mm => lin_canny_clash::Unit::Millimetre,
        Unit::In => lin_canny_clash::Unit::Inch,
    };
    let reading = ModelOptions::default()
        .unit(unit)
        .repair(options.repair == Repair::Surface)
        .joints(options.joints.iter().cloned())
        .srdf(options.srdf.clone())
        .keep_going(options.keep_going);
    let model = Model::load(&options.inputs, &reading)?;
    for failure in model.failures() {
        warn!("left out: {failure}");
    }
    warn_of_skipped(model.skipped());
    for part in model.parts() {
        if let Some(note) = &part.note {
            say!("{}: {note}", part.name);
        }
    }
    if is_unlikely_size(&model, unit) {
        warn!("warning: the model is smaller than 1 mm or larger than 1 km; is --unit right?");
    }
    check_rules(options, &rules, &model)?;
    let asked = ClashOptions::default().within(options.within).volume(options.volume);
    let is_stopped = Arc::new(AtomicBool::new(false));
    let stop = is_stopped.clone();
    // The first Ctrl-C ends the search, the second one the tool.
    let _ = ctrlc::set_handler(move || {
        if stop.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
    let bar = progress("pairs", 0);
    let found = find(&model, &rules, &asked, |now: Progress| {
        bar.set_length(now.total.unwrap_or_default() as u64);
        bar.set_position(now.done as u64);
        Progress::stop_if(is_stopped.load(Ordering::Relaxed))
    })?;
    bar.finish_and_clear();

    let mut rows = found.rows;
    if let Some(file) = &options.jsonl {
        lines(file, &rows)?;
    }
    if let Some(file) = &options.baseline {
        let compared = Comparison::new(&rows, &read(file)?, file)?;
        // Pairs that were not measured are not gone.
        for row in compared.gone.iter().filter(|_| found.is_complete) {
            say!("gone: {} - {}: {}", row.a, row.b, row.kind);
        }
        rows = compared.rows;
    }
    if let Some(file) = &options.csv {
        write(file, &to_csv(&rows))?;
    }
    if let Some(file) = &options.junit {
        write(file, &to_junit(&rows))?;
    }
    if let Some(file) = &options.page {
        write(file, &drawn(file, &model, &rows)?)?;
    }
    for row in worst_first(&rows).into_iter().take(SHOWN) {
        say!("{} - {}: {}", row.a, row.b, row.text());
    }
    if rows.len() > SHOWN {
        say!("and {} more: see --jsonl", rows.len() - SHOWN);
    }
    let broken = rows.iter().filter(|row| row.broken).count();
    let undecided = rows.iter().filter(|row| row.kind == Kind::Undecided).count();
    say!(
        "{} parts, {} pairs measured, {} excluded: {broken} clash, {undecided} undecided",
        model.parts().len(),
        found.measured,
        found.excluded
    );
    if !found.is_complete {
        warn!("stopped: not all pairs were measured");
        return Ok(End::Stopped);
    }
    Ok(match (broken, undecided) {
        _ if !model.failures().is_empty() => End::Invalid,
        (0, 0) => End::Free,
        (0, _) => End::Unknown,
        _ => End::Blocked,
    })
}

/// Warns about rules that match no part.
fn check_rules(options: &ClashArguments, rules: &Rules, model: &Model) -> Result<(), ToolError> {
    let names: Vec<&str> = model.parts().iter().map(|part| part.name.as_str()).collect();
    let unused = rules.unused(&names);
    if let (true, Some(first), Some(file)) = (options.strict, unused.first(), &options.rules) {
        return Err(ToolError::Input {
            file: file.clone(),
            reason: format!("{first} matches no part"),
        });
    }
    for rule in unused {
        warn!("warning: {rule} matches no part");
    }
    Ok(())
}

/// Writes rows as JSON lines.
fn lines(file: &Path, rows: &[Row]) -> Result<(), ToolError> {
    let failed = |reason| ToolError::Write {
        file: file.to_owned(),
        reason,
    };
    let mut out = std::io::BufWriter::new(std::fs::File::create(file).map_err(failed)?);
    for row in rows {
        writeln!(out, "{}", row.to_json()).map_err(failed)?;
    }
    out.flush().map_err(failed)
}

/// Returns the page: all parts, and a frame with the closest points and the curves of each of the worst pairs.
fn drawn(file: &Path, model: &Model, rows: &[Row]) -> Result<String, ToolError> {
    let failed = |error: &dyn std::fmt::Display| ToolError::State {
        file: file.to_owned(),
        reason: error.to_string(),
    };
    let mut recorder = Recorder::new(Vec::new(), "Clashes").map_err(|e| failed(&e))?;
    let mut numbers = std::collections::HashMap::new();
    for part in model.parts() {
        let number = recorder
            .body(&part.name, &part.geometry, &part.pose)
            .map_err(|e| failed(&e))?;
        numbers.insert(part.name.as_str(), (number, part));
    }
    for row in worst_first(rows).into_iter().take(SHOWN) {
        let (Some((i, a)), Some((j, b))) = (numbers.get(row.a.as_str()), numbers.get(row.b.as_str())) else {
            continue;
        };
        frame(&mut recorder, (*i, a), (*j, b)).map_err(|e| failed(&e))?;
        recorder.note(format!("{} - {}: {}", row.a, row.b, row.text()));
        recorder.end_frame().map_err(|e| failed(&e))?;
    }
    let lines = recorder.finish().map_err(|e| failed(&e))?;
    let recording = Recording::read(&lines[..]).map_err(|e| failed(&e))?;
    Ok(page(&recording, &PageOptions::default()))
}

/// Adds the closest points, the contacts and the curves of a pair to a frame.
fn frame(
    recorder: &mut Recorder<Vec<u8>>,
    (i, a): (u32, &Part),
    (j, b): (u32, &Part),
) -> Result<(), lin_canny_record::WriteError> {
    let Ok(pose) = RelativePose::new(&a.pose, &b.pose) else {
        return Ok(());
    };
    let mut tracker = PairTracker::new();
    recorder.answer(i, j, &tracker.closest(&a.geometry, &b.geometry, &pose))?;
    if let Ok(found) = tracker.overlap_loops(&a.geometry, &b.geometry, &pose) {
        for curve in &found.loops {
            recorder.path(curve.iter().chain(curve.first()).map(|p| a.pose * p));
        }
    }
    if let Ok(groups) = tracker.contacts(&a.geometry, &b.geometry, &pose, &ManifoldOptions::default()) {
        recorder.contacts(i, j, groups)?;
    }
    Ok(())
}
