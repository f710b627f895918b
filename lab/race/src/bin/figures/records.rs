//! Pictures of measurements, from the newest records of the instrument `accuracy_cost`.

use std::path::{Path, PathBuf};

use race::accuracy;
use race::plot::Chart;
use race::record::{self, Row};

use crate::Trouble;

/// Returns the newest file with an ending; names sort by date.
pub(crate) fn newest(folder: &Path, ending: &str) -> Result<PathBuf, Trouble> {
    let files = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let name = |p: &PathBuf| p.file_name().is_some_and(|n| n.to_string_lossy().ends_with(ending));
    let mut records: Vec<PathBuf> = files.filter_map(|f| Some(f.ok()?.path())).filter(name).collect();
    records.sort();
    Ok(records
        .pop()
        .ok_or(format!("no record that ends in {ending} in benches/record"))?)
}

/// Returns a chart as text for embedding in documentation, without blank lines.
pub(crate) fn text(chart: &Chart) -> Result<String, Trouble> {
    let svg = chart.svg()?;
    let lines = svg.lines().filter(|l| !l.trim().is_empty());
    Ok(lines.flat_map(|l| [l, "\n"]).collect())
}

/// Returns the rows with the time of exact queries that the newest record of `race pairs` has, because they became faster
/// after the record of the levels. Cold exact queries, which it does not measure, are left out.
fn exact_of_pairs(rows: &[Row], folder: &Path) -> Result<Vec<Row>, Trouble> {
    let pairs = std::fs::read_to_string(newest(folder, "-pairs.csv")?)?;
    let mut times = pairs
        .lines()
        .filter_map(|line| line.strip_prefix("coherent-0.5,sphere,512,ours-exact,"));
    let time: f64 = times.next().ok_or("no exact query in the record of pairs")?.parse()?;
    let is_exact = |row: &Row| row.level == "exact" && row.family == "sphere 0.5deg" && row.n == 512;
    let rows = rows.iter().filter(|row| !(is_exact(row) && row.engine != "ours"));
    Ok(rows
        .cloned()
        .map(|row| if is_exact(&row) { Row { ns: time, ..row } } else { row })
        .collect())
}

/// Returns names and texts of the pictures, and prints the table of BENCHMARKS.md.
pub(crate) fn pictures(folder: &Path) -> Result<Vec<(&'static str, String)>, Trouble> {
    let files = [newest(folder, "-accuracy.csv")?, newest(folder, "-shapes.csv")?];
    let rows = record::read(&files[0])?;
    let shapes = record::read(&files[1])?;
    println!("from {} and {}", files[0].display(), files[1].display());
    println!("The table of *What accuracy costs* in BENCHMARKS.md:");
    let sizes = [8, 32, 128, 512, 2048, 8192];
    println!("{}", accuracy::table(&rows, "sphere 0.5deg", &sizes));
    Ok(vec![
        (
            "accuracy.svg",
            text(&accuracy::error_and_time(
                &exact_of_pairs(&rows, folder)?,
                "sphere 0.5deg",
                512,
            ))?,
        ),
        ("motion.svg", text(&accuracy::time_and_motion(&rows, 512))?),
        ("contact-error.svg", text(&accuracy::error_and_gap(&rows, "flush", 8))?),
        ("contact-time.svg", text(&accuracy::time_and_gap(&rows, "flush", 8))?),
        ("geometry.svg", text(&accuracy::geometry(&rows))?),
        ("curved.svg", text(&accuracy::curved(&shapes, "cylinder-ellipsoid"))?),
        ("asking.svg", text(&accuracy::asking(&rows, "asking 0.05deg", 512))?),
    ])
}
