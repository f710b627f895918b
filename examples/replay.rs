//! Answers a recorded query at every level: `replay [--trace] [FILE]`, from the standard input without a file.
//!
//! The text is what [`Tracker::replay`] writes and what a failed debug assertion prints; lines before its title are
//! passed over, so the message of a panic can be given as it is.

use std::io::{IsTerminal, Read};

use lin_canny::{RelativePose, Replay, ReplayError, Solver, Tracker};

fn read(file: Option<String>) -> std::io::Result<String> {
    match file {
        Some(file) => std::fs::read_to_string(file),
        None => {
            let mut text = String::new();
            std::io::stdin().read_to_string(&mut text)?;
            Ok(text)
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (flags, files): (Vec<String>, Vec<String>) = std::env::args().skip(1).partition(|w| w.starts_with("--"));
    let nothing_to_read = files.is_empty() && std::io::stdin().is_terminal();
    if nothing_to_read || files.len() > 1 || flags.iter().any(|f| f != "--trace") {
        return Err(
            "usage: replay [--trace] [FILE], FILE as written by Tracker::replay (some are in tests/replays)".into(),
        );
    }
    let text = read(files.into_iter().next())?;
    let start = text.find("lin-canny replay").unwrap_or(0);
    let query: Replay = text[start..].parse().map_err(|e: ReplayError| e.to_string())?;
    println!(
        "A: {} vertices, {} faces. B: {} vertices, {} faces. Recorded at level {}, start {}.",
        query.a.vertex_count(),
        query.a.face_count(),
        query.b.vertex_count(),
        query.b.face_count(),
        query.level,
        query.start.map_or("cold".to_owned(), |f| f.to_string()),
    );
    if !flags.is_empty() {
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
            o.class, o.distance, o.lower, o.upper, o.features, o.solver, o.work
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
