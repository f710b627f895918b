//! Measures time and error of every accuracy level of this crate and of parry, against exact
//! arithmetic.
//!
//! ```text
//! cargo run --release -p race --bin accuracy_cost -- [--csv FILE] [--out FOLDER] [--quick] [--only PART] [--mesh A --mesh B]
//! ```
//!
//! | part | what it measures |
//! |---|---|
//! | `levels` | cost and error of each level, bodies of 8 to 8192 vertices, tracked and cold |
//! | `motion` | the same against the motion per frame |
//! | `gap` | the same against the gap, and which solver answers near contact |
//! | `geometry` | a sphere replaced by hulls of 12 to 100,000 vertices: the cost of a finer shape |
//! | `curved` | curved shapes as themselves, and replaced by hulls |
//! | `nonconvex` | nonconvex meshes as they are, as hulls and as pieces of V-HACD |
//! | `asking` | one motion, every question from "overlap?" to exact, and inner hulls with a bound |
//!
//! Every engine gets two world poses and the same vertices and faces. It returns the distance and,
//! if it computes them, both witness points in the world frame. Errors are relative to the size L
//! of the pair (both radii plus the distance of the origins).

mod asking;
mod curved;
mod engines;
mod geometry;
mod measure;
mod nonconvex;
mod options;
mod parts;
mod truth;

use std::path::Path;
use std::process::ExitCode;

use options::Options;
use race::accuracy;
use race::plot::Chart;
use race::progress::Progress;
use race::record::{self, Row};

type Trouble = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    ::truth::command::main(run)
}

fn run(options: &Options) -> Result<(), Trouble> {
    options.check()?;
    let with_geometry = options.meshes().is_none();
    let steps = parts::count(options)
        + if with_geometry { geometry::count(options) } else { 0 }
        + asking::count(options)
        + curved::count(options)
        + nonconvex::count(options);
    let progress = Progress::new("accuracy_cost", steps);
    let (mut rows, mut charts): (Vec<Row>, Vec<(&str, Chart)>) = (Vec::new(), Vec::new());
    if options.does("levels") {
        parts::levels(options, &mut rows, &progress)?;
        charts.extend(pictures_of_levels(options, &rows));
    }
    if options.does("motion") {
        let n = parts::motion(options, &mut rows, &progress)?;
        charts.push(("motion.svg", accuracy::time_and_motion(&rows, n)));
    }
    if options.does("gap") {
        let names = [
            ["gap-time.svg", "gap-error.svg", "gap-layers.svg"],
            ["flush-time.svg", "flush-error.svg", "flush-layers.svg"],
        ];
        let found = parts::gap(options, &mut rows, &progress)?;
        for ((family, (n, layers)), names) in parts::near(options).iter().zip(found).zip(names) {
            charts.push((names[0], accuracy::time_and_gap(&rows, family, n)));
            charts.push((names[1], accuracy::error_and_gap(&rows, family, n)));
            charts.push((names[2], layers));
        }
    }
    if options.does("geometry") && with_geometry {
        geometry::run(options, &mut rows, &progress)?;
        charts.push(("geometry.svg", accuracy::geometry(&rows)));
    }
    if options.does("curved") && with_geometry {
        curved::run(options, &mut rows, &progress)?;
        charts.push(("curved.svg", accuracy::curved(&rows, "cylinder-ellipsoid")));
    }
    if options.does("nonconvex") && with_geometry {
        nonconvex::run(options, &mut rows, &progress)?;
        charts.push(("nonconvex.svg", accuracy::nonconvex(&rows, "rings")));
        charts.push(("nonconvex-gears.svg", accuracy::nonconvex(&rows, "gears")));
    }
    if options.does("asking") {
        let n = asking::run(options, &mut rows, &progress)?;
        charts.push(("asking-slow.svg", accuracy::asking(&rows, "asking 0.05deg", n)));
        charts.push(("asking-quick.svg", accuracy::asking(&rows, "asking 1deg", n)));
    }
    drop(progress);
    if let Some(meshes) = options.meshes() {
        charts = charts
            .into_iter()
            .map(|(file, c)| (file, c.titled(|t| own(t, meshes))))
            .collect();
    }
    save(&charts, &options.out)?;
    if let Some(file) = &options.csv {
        std::fs::write(file, record::text(&rows)).map_err(|e| format!("{}: {e}", file.display()))?;
        println!("{} rows: {}", rows.len(), file.display());
    }
    Ok(())
}

/// Returns a title about spheres as a title about the caller's meshes, named by their files.
fn own(title: &str, meshes: [&str; 2]) -> String {
    let name = |file: &str| {
        Path::new(file)
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned()
    };
    let [a, b] = meshes.map(name);
    let what = title.split(": ").next().unwrap_or(title);
    let details = title.split_once(": ").map_or("", |(_, rest)| rest);
    // Shape and number of vertices describe the built-in bodies.
    let is_detail = |part: &&str| !["sphere", "mesh"].contains(part) && !part.contains("vertices");
    let details = details.split(", ").filter(is_detail);
    let all: Vec<String> = std::iter::once(format!("{what}: {a} and {b}"))
        .chain(details.map(Into::into))
        .collect();
    all.join(", ")
}

fn pictures_of_levels(options: &Options, rows: &[Row]) -> Vec<(&'static str, Chart)> {
    let (shape, n) = match options.meshes() {
        Some(_) => ("mesh", rows.first().map_or(0, |r| r.n)),
        None => ("sphere", parts::MIDDLE),
    };
    let picture = |motion: &str, n| accuracy::error_and_time(rows, &format!("{shape} {motion}"), n);
    let mut all = vec![
        ("error-time.svg", picture("0.05deg", n)),
        ("error-time-quick.svg", picture("0.5deg", n)),
        ("error-time-random.svg", picture("random", n)),
    ];
    if options.meshes().is_none() {
        all.push(("error-time-small.svg", picture("0.5deg", 8)));
        all.push(("size.svg", accuracy::time_and_size(rows, "sphere 0.5deg")));
    }
    all
}

fn save(charts: &[(&str, Chart)], folder: &Path) -> Result<(), Trouble> {
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    for (name, chart) in charts {
        chart.save(folder.join(name))?;
    }
    let names: Vec<&str> = charts.iter().map(|c| c.0).collect();
    println!("\ndrawn in {}: {}", folder.display(), names.join(", "));
    Ok(())
}
