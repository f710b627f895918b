//! Repeats a recorded query at every level of accuracy: `replay [--trace] [FILE]`.
//!
//! Without a file it reads the standard input. The text is the output of [`Tracker::replay`] or of
//! a failed debug assertion. Text before its title is skipped, so the whole message of a panic is
//! accepted.

use std::io::{IsTerminal, Read};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use lin_canny::{RelativePose, Replay, ReplayError, Solver, Tracker};

/// Repeat a query from Tracker::replay or from a failed debug assertion, at every level of accuracy
///
/// Some recorded queries are in tests/replays.
#[derive(Parser)]
struct Options {
    /// Print the feature pairs of the walk, one per line
    #[arg(long)]
    trace: bool,
    /// File with the text of the query [default: standard input]
    file: Option<PathBuf>,
}

fn main() -> ExitCode {
    truth::command::main(run)
}

fn read(file: Option<&Path>) -> Result<String, String> {
    if let Some(file) = file {
        return truth::command::read(file);
    }
    if std::io::stdin().is_terminal() {
        return Err("a file is needed, or a text on the standard input".into());
    }
    let mut text = String::new();
    let read = std::io::stdin().read_to_string(&mut text);
    read.map(|_| text).map_err(|e| format!("standard input: {e}"))
}

fn run(o: &Options) -> Result<(), String> {
    let text = read(o.file.as_deref())?;
    let start = text.find("lin-canny replay").unwrap_or(0);
    let query: Replay = text[start..].parse().map_err(|e: ReplayError| e.to_string())?;
    println!(
        "A: {} vertices, {} faces. B: {} vertices, {} faces. Recorded at level {}, start {}.",
        query.a.vertex_count(),
        query.a.face_count(),
        query.b.vertex_count(),
        query.b.face_count(),
        query.accuracy,
        query.start.map_or("cold".to_owned(), |f| f.to_string()),
    );
    if o.trace {
        trace(&query);
    }
    for (name, start) in [
        ("the recorded start", query.tracker()),
        ("a cold start", Tracker::new()),
    ] {
        println!("\nfrom {name}:");
        answers(&query, &start);
    }
    Ok(())
}

fn answers(q: &Replay, start: &Tracker) {
    let (a, b, pose): (_, _, &RelativePose) = (&q.a, &q.b, &q.pose);
    let mut pair = start.clone();
    let p = pair.propose(a, b, pose);
    let distance = p.distance.map_or("overlap".to_owned(), |d| format!("{d:?}"));
    println!(
        "  walk       {distance}  {}  by {:?}; {:?}",
        p.features, p.solver, p.work
    );
    println!(
        "             witnesses {} {}, normal {:?}",
        p.point_on_a,
        p.point_on_b,
        p.normal.as_slice()
    );
    let mut pair = start.clone();
    let certified = pair.closest(a, b, pose);
    let mut pair = start.clone();
    let exact = pair.closest_exact(a, b, pose);
    for (name, o) in [("certified", certified), ("exact", exact)] {
        println!(
            "  {name:<10} {:?} {:?} in [{:?}, {:?}]  {}  by {:?}; {:?}",
            o.state, o.distance, o.lower, o.upper, o.features, o.solver, o.work
        );
        println!(
            "             witnesses {} {}, normal {:?}",
            o.point_on_a,
            o.point_on_b,
            o.normal.as_slice()
        );
        if o.solver == Solver::Far {
            println!("             too far apart or too near for a walk");
        }
    }
}

fn trace(q: &Replay) {
    let (way, ended) = q.tracker().trace(&q.a, &q.b, &q.pose);
    let way: Vec<String> = way.iter().map(ToString::to_string).collect();
    println!("walk: {}{}", way.join("  "), if ended { "" } else { "  (handed over)" });
}
