//! Writes a page of hard cases: small solids of `tests/corpus/`, a case in each frame, with the
//! answer of the library, the exact value and parry's answer.
//!
//! `cargo run --release -p race --bin hard_cases -- --page target/cases.html`

use std::error::Error;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use lin_canny::nalgebra::Point3;
use lin_canny::{ConvexPolyhedron, Geometry, PairTracker, RelativePose};
use lin_canny_record::{PageOptions, Recorder, Recording, page, poses};
use truth::command::{file, write};
use truth::corpus::{self, Case};
use truth::{Point, Pose, parry};

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

/// Write a page of hard cases, with the exact value and parry's answer
#[derive(Parser)]
struct Options {
    /// Output page: one HTML file, for any browser with WebGL 2
    #[arg(long, value_name = "FILE.html", default_value = "target/cases.html", value_parser = file("html"))]
    page: PathBuf,
}

fn main() -> ExitCode {
    truth::command::main(run)
}

fn run(options: &Options) -> Result<(), Box<dyn Error>> {
    std::panic::set_hook(Box::new(|_| {})); // a panic of parry counts as an answer
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/corpus");
    let mut recorder = Recorder::new(Vec::new(), "Hard cases")?;
    let mut taken: Vec<String> = Vec::new();
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
        let of_family = taken.iter().filter(|family| **family == case.family).count();
        let is_motion = case.motion.is_some();
        if NAMED.contains(&case.name.as_str()) || (errs && !is_motion && of_family < MOST_OF_A_FAMILY) {
            record(&mut recorder, &case, distance, parry)?;
            taken.push(case.family.clone());
        }
    }
    let recording = Recording::read(recorder.finish()?.as_slice())?;
    write(&options.page, &page(&recording, &PageOptions::default()))?;
    println!("{} cases: {}", taken.len(), options.page.display());
    Ok(())
}

/// Adds a frame with the two bodies of a case, which the next frame no longer shows.
fn record(to: &mut Recorder<Vec<u8>>, case: &Case, distance: f64, parry: Option<f64>) -> Result<(), Box<dyn Error>> {
    let hull = |points: &[Point]| {
        let points: Vec<Point3<f64>> = points.iter().copied().map(Point3::from).collect();
        ConvexPolyhedron::from_points(&points).map(Geometry::from)
    };
    let bodies = [hull(&case.a.points)?, hull(&case.b.points)?];
    let pose = |Pose { t, q }: &Pose| poses::pose([t[0], t[1], t[2], q[0], q[1], q[2], q[3]]).ok_or("an invalid pose");
    let poses = [pose(&case.pose_a)?, pose(&case.pose_b)?];
    let a = to.body("a", &bodies[0], &poses[0])?;
    let b = to.body("b", &bodies[1], &poses[1])?;
    let pose = RelativePose::new_normalized(&poses[0], &poses[1])?;
    to.answer(a, b, &PairTracker::new().closest(&bodies[0], &bodies[1], &pose))?;
    let parry = parry.map_or("none".into(), |d| format!("{d:e}"));
    to.note(format!(
        "{} ({})\nexact: {distance}\nparry: {parry}",
        case.name, case.family
    ));
    to.end_frame()?;
    to.remove(a)?;
    Ok(to.remove(b)?)
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
