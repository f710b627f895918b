//! Writes the hard cases that the viewer's page shows: small solids of `tests/corpus/`, each with
//! the exact value and parry's answer.
//!
//! ```text
//! cargo run --release -p race --bin hard_cases -- --out crates/viewer/cases.json
//! ```

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use serde_json::{Value, json};
use truth::command::{file, write};
use truth::corpus::{self, Case};
use truth::{Pose, parry};

/// Largest number of cases taken per family in which parry errs.
const MOST_OF_A_FAMILY: usize = 3;

/// Cases that are always taken.
const NAMED: [&str; 4] = [
    "boxes-face-to-face",
    "boxes-gap-1e-8",
    "boxes-gap-1e-12",
    "boxes-gap-1e-14",
];

/// Largest number of points of a body.
const MOST_POINTS: usize = 40;

/// Write the hard cases for the web page of the viewer
#[derive(Parser)]
struct Options {
    /// Output file
    #[arg(long, value_name = "FILE.json", default_value = "target/cases.json", value_parser = file("json"))]
    out: PathBuf,
}

fn main() -> ExitCode {
    truth::command::main(run)
}

fn run(options: &Options) -> Result<(), String> {
    std::panic::set_hook(Box::new(|_| {})); // a panic of parry counts as an answer
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/corpus");
    let mut taken: Vec<(String, Value)> = Vec::new();
    for case in corpus::load(&folder) {
        let is_small = case.a.points.len().max(case.b.points.len()) <= MOST_POINTS;
        let Some(distance) = case
            .distance
            .filter(|_| is_small && case.a.points.len().min(case.b.points.len()) > 3)
        else {
            continue;
        };
        let parry = parry_of(&case);
        let errs = parry.is_none_or(|d| (d - distance).abs() > 1e-9 * distance.abs() + 1e-13 * case.size());
        let of_family = taken.iter().filter(|(family, _)| *family == case.family).count();
        let is_motion = case.motion.is_some();
        if NAMED.contains(&case.name.as_str()) || (errs && !is_motion && of_family < MOST_OF_A_FAMILY) {
            taken.push((case.family.clone(), entry(&case, distance, parry)));
        }
    }
    let list: Vec<Value> = taken.into_iter().map(|(_, value)| value).collect();
    let lines: Vec<String> = list.iter().map(Value::to_string).collect();
    write(&options.out, &format!("[\n{}\n]\n", lines.join(",\n")))?;
    println!("{} cases: {}", list.len(), options.out.display());
    Ok(())
}

fn entry(case: &Case, distance: f64, parry: Option<f64>) -> Value {
    let pose = |p: &Pose| [p.t[0], p.t[1], p.t[2], p.q[0], p.q[1], p.q[2], p.q[3]];
    json!({
        "name": case.name,
        "family": case.family,
        "a": case.a.points,
        "b": case.b.points,
        "pose_a": pose(&case.pose_a),
        "pose_b": pose(&case.pose_b),
        "class": case.state.word(),
        "distance": distance,
        "parry": parry,
    })
}

/// Returns parry's signed distance in `f64`, of parry's hulls; `None` if parry gives none.
fn parry_of(case: &Case) -> Option<f64> {
    let ask = || {
        let (a, b) = (parry::hull(&case.a.points)?, parry::hull(&case.b.points)?);
        let distance = parry::signed_distance(&a, &case.pose_a, &b, &case.pose_b);
        distance.is_finite().then_some(distance)
    };
    catch_unwind(AssertUnwindSafe(ask)).ok().flatten()
}
