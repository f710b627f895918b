//! Runs the casts of a file, one case per line, and prints one result per line.
//!
//! ```text
//! cargo run --release -p race --example cast -- FILE
//! ```
//!
//! `--help` describes the format of a line.

use clap::Parser;
use lin_canny::Tracker;
use lin_canny::impact::{Impact, Tolerance, cast};
use lin_canny::motion::{MotionError, Steady};
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, UnitQuaternion, Vector3};
use lin_canny::{ConvexPolyhedron, PoseError, Velocity};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Run the casts of a file, one per line
///
/// Prints one result per line: hit SAFE HIT, miss, near SAFE, start or unknown SAFE. A line of the
/// file is
///
///   A-points; B-points; A-start, A-linear, A-angular; B-start, B-linear, B-angular; t_end; tolerance
///
/// Points are `x y z`, separated by commas. A start is `x y z qx qy qz qw`, the pose of the body at
/// time zero; linear is the velocity of the body's origin, angular the angular velocity, both
/// `x y z`. The tolerance is a distance.
#[derive(Parser)]
#[command(verbatim_doc_comment)]
struct Options {
    /// File with the cases
    file: PathBuf,
}

type Trouble = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    truth::command::main(|o: &Options| run(&o.file))
}

fn run(file: &Path) -> Result<(), String> {
    let text = truth::command::read(file)?;
    let mut cases = text
        .lines()
        .enumerate()
        .filter(|(_, l)| !l.trim().is_empty())
        .peekable();
    cases.peek().ok_or(format!("{}: no case", file.display()))?;
    for (k, line) in cases {
        let answer = answer(line).map_err(|e| format!("{}:{}: {e}", file.display(), k + 1))?;
        println!("{answer}");
    }
    Ok(())
}

/// Returns the numbers of a text, separated by spaces and commas.
fn numbers(text: &str) -> Result<Vec<f64>, Trouble> {
    let words = text
        .split(|c: char| c == ',' || c.is_whitespace())
        .filter(|w| !w.is_empty());
    words
        .map(|w| w.parse().map_err(|_| format!("{w} is no number").into()))
        .collect()
}

/// Returns the hull of the points or, if they have no hull, a polygon, a segment or a point.
fn body(text: &str) -> Result<ConvexPolyhedron, Trouble> {
    let list = numbers(text)?;
    if list.is_empty() || list.len() % 3 != 0 {
        return Err("points have three coordinates each".into());
    }
    let points: Vec<_> = list.chunks(3).map(|p| Point3::new(p[0], p[1], p[2])).collect();
    Ok(match *points {
        [p] => ConvexPolyhedron::point(p)?,
        [p, q] => ConvexPolyhedron::segment(p, q)?,
        _ => ConvexPolyhedron::from_points(&points).or_else(|_| ConvexPolyhedron::polygon(&points))?,
    })
}

fn motion(text: &str) -> Result<Steady, Trouble> {
    let list = numbers(text)?;
    let [x, y, z, qx, qy, qz, qw, vx, vy, vz, wx, wy, wz] = list[..] else {
        return Err(format!("a motion has 13 numbers, not {}", list.len()).into());
    };
    let turn = UnitQuaternion::new_normalize(Quaternion::new(qw, qx, qy, qz));
    let start = Isometry3::from_parts(Vector3::new(x, y, z).into(), turn);
    let velocity = Velocity::new(Vector3::new(vx, vy, vz), Vector3::new(wx, wy, wz));
    Steady::new(&start, velocity).map_err(|e| match e {
        MotionError::Pose(PoseError::Rotation { .. }) => "the rotation of the start is no quaternion".into(),
        MotionError::Pose(PoseError::Translation { axis, value, .. }) => {
            format!("coordinate {axis} of the start is {value}").into()
        }
        other => other.into(),
    })
}

/// Adds to an error the part of the line that caused it.
fn named<T>(part: &str, read: Result<T, Trouble>) -> Result<T, Trouble> {
    read.map_err(|e| format!("{part}: {e}").into())
}

fn number(text: &str) -> Result<f64, Trouble> {
    let list = numbers(text)?;
    let [x] = list[..] else {
        return Err(format!("expected one number, not {}", list.len()).into());
    };
    Ok(x)
}

fn answer(line: &str) -> Result<String, Trouble> {
    let parts: Vec<&str> = line.split(';').collect();
    let [a, b, motion_a, motion_b, end, tolerance] = parts[..] else {
        return Err(format!("a line has six parts, not {}", parts.len()).into());
    };
    let (a, b) = (named("points of A", body(a))?, named("points of B", body(b))?);
    let motion_a = named("motion of A", motion(motion_a))?;
    let motion_b = named("motion of B", motion(motion_b))?;
    let (end, tolerance) = (named("t_end", number(end))?, named("tolerance", number(tolerance))?);
    let mut tracker = Tracker::new();
    let mut pair = tracker.pair(&a, &b);
    let found = cast(
        &mut pair,
        &motion_a,
        &motion_b,
        0.0..end,
        Tolerance::Distance(tolerance),
    )?;
    Ok(match found.impact {
        Impact::Hit { safe, hit, .. } => format!("hit {safe:.17e} {hit:.17e}"),
        Impact::Miss => "miss".into(),
        Impact::Undecided { safe, .. } => format!("near {safe:.17e}"),
        Impact::AtStart { .. } => "start".into(),
        Impact::Incomplete { safe } => format!("unknown {safe:.17e}"),
        other => format!("{other:?}"),
    })
}
