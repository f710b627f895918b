//! Plans a path of a rigid robot among obstacles, from a file. Every segment is proven free.
//!
//! ```text
//! cargo run --release -p lin-canny-plan --example plan -- FILE.json --out PATH.csv
//! ```
//!
//! `--help` describes the file.

use clap::Parser;
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, UnitQuaternion, Vector3};
use lin_canny::{ConvexPolyhedron, Geometry, Progress};
use lin_canny_plan::{
    Cell, Checker, ConfigurationSpace, JointMotion, Path, PlanError, PlanOptions, RigidSpace, RrtConnect, Shortcuts,
};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Plan the path of a rigid robot among obstacles with RRT-Connect
///
/// Shortens the path and writes one configuration per row, `x,y,z,qx,qy,qz,qw`, below a header with
/// these names. Between two rows the origin of the robot moves along a straight line, and the robot
/// rotates by the smaller angle about a fixed axis (slerp). Every segment is proven free over its
/// whole length.
///
/// The file is JSON:
///   { "robot": points of a hull [[x,y,z], ...], or a list of hulls,
///     "obstacles": list of hulls,
///     "start": [x,y,z,qx,qy,qz,qw], "goal": the same,
///     "bounds": [[x0,y0,z0],[x1,y1,z1]] of the robot's origin,
///     "seed": number (default 0), "seconds": time limit of the search (default 10) }
///
/// Exit codes: 0 a path was written, 2 the file is invalid, 3 no path was found in time.
#[derive(Parser)]
#[command(verbatim_doc_comment)]
struct Options {
    /// JSON file with the robot and its obstacles
    file: PathBuf,
    /// Output file with the path
    #[arg(long, value_name = "PATH.csv", default_value = "target/plan.csv", value_parser = truth::command::file("csv"))]
    out: PathBuf,
}

/// What the file asks for.
struct Job {
    cell: Cell,
    space: RigidSpace,
    ends: [Vec<f64>; 2],
    seed: u64,
    limit: Duration,
}

fn main() -> ExitCode {
    let options = Options::parse();
    let job = read(&options.file).and_then(|job| truth::command::writable(&options.out).map(|()| job));
    let found = job.map_err(|why| (2, why));
    match found.and_then(|job| run(&job, &options.out).map_err(|why| (1, why))) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(3),
        Err((code, why)) => {
            eprintln!("error: {why}");
            ExitCode::from(code)
        }
    }
}

fn read(file: &std::path::Path) -> Result<Job, String> {
    let text = truth::command::read(file)?;
    let job = serde_json::from_str(&text)
        .map_err(|e| e.to_string())
        .and_then(|value| job(&value));
    job.map_err(|e| format!("{}: {e}", file.display()))
}

fn job(file: &Value) -> Result<Job, String> {
    if !file.is_object() {
        return Err("not an object".into());
    }
    for name in ["robot", "obstacles", "start", "goal", "bounds"] {
        if file[name].is_null() {
            return Err(format!("{name} is missing"));
        }
    }
    let robot = hulls(&file["robot"], "robot")?;
    if robot.is_empty() {
        return Err("robot has no hull".into());
    }
    let mut cell = Cell::new();
    // A radian counts as the farthest point of the robot from its origin.
    let points = robot.iter().flat_map(ConvexPolyhedron::vertex_points);
    let radius = points.map(|p| p.coords.norm()).fold(0.0, f64::max);
    let bodies = robot.len();
    for (k, hull) in robot.into_iter().enumerate() {
        cell.robot_body(format!("robot[{k}]"), hull);
    }
    for (k, hull) in hulls(&file["obstacles"], "obstacles")?.into_iter().enumerate() {
        cell.add_obstacle(format!("obstacles[{k}]"), Geometry::from(hull), Isometry3::identity())
            .map_err(|e| e.to_string())?;
    }
    let [low, high] = bounds(&file["bounds"])?;
    let space = RigidSpace::new(
        [0, 1, 2].map(|k| [low[k], high[k]]),
        radius.max(f64::MIN_POSITIVE),
        bodies,
    );
    let job = Job {
        cell,
        space: space.map_err(|e| format!("bounds: {e}"))?,
        ends: [pose(&file["start"], "start")?, pose(&file["goal"], "goal")?],
        seed: seed(&file["seed"])?,
        limit: seconds(&file["seconds"])?,
    };
    check(&job)?;
    Ok(job)
}

/// Refuses ends that are out of bounds or in contact, by the name of the end.
fn check(job: &Job) -> Result<(), String> {
    let mut checker = Checker::new(job.space.clone(), job.cell.clone()).map_err(|e| e.to_string())?;
    for (q, end) in job.ends.iter().zip(["start", "goal"]) {
        let near = checker.clearance(q).map_err(|e| format!("{end}: {e}"))?;
        if let Some(near) = near.filter(|near| !(near.lower > 0.0)) {
            let [a, b] = [near.pair.a, near.pair.b].map(|part| checker.name(part));
            return Err(format!("{end}: {a} and {b} are in contact"));
        }
    }
    Ok(())
}

/// A list of hulls, or the points of a single one.
fn hulls(value: &Value, name: &str) -> Result<Vec<ConvexPolyhedron>, String> {
    let list = value.as_array().ok_or(format!("{name} is no list"))?;
    let is_point = |v: &Value| {
        v.as_array()
            .is_some_and(|p| p.iter().all(Value::is_number) && !p.is_empty())
    };
    if list.first().is_some_and(is_point) {
        return Ok(vec![hull(value, name)?]);
    }
    let each = list.iter().enumerate();
    each.map(|(k, points)| hull(points, &format!("{name}[{k}]"))).collect()
}

fn hull(value: &Value, name: &str) -> Result<ConvexPolyhedron, String> {
    let list = value.as_array().ok_or(format!("{name} is no list of points"))?;
    let point = |(k, v): (usize, &Value)| {
        let [x, y, z] = numbers(v, &format!("{name}[{k}]"))?;
        Ok(Point3::new(x, y, z))
    };
    let points: Vec<Point3<f64>> = list.iter().enumerate().map(point).collect::<Result<_, String>>()?;
    let body = match points[..] {
        [p] => ConvexPolyhedron::point(p),
        [p, q] => ConvexPolyhedron::segment(p, q),
        [_, _, _] => ConvexPolyhedron::polygon(&points),
        _ => ConvexPolyhedron::from_points(&points).or_else(|e| ConvexPolyhedron::polygon(&points).map_err(|_| e)),
    };
    body.map_err(|e| format!("{name}: {e}"))
}

fn numbers<const N: usize>(value: &Value, name: &str) -> Result<[f64; N], String> {
    let list = value.as_array().ok_or(format!("{name} is no list of {N} numbers"))?;
    let all: Option<Vec<f64>> = list.iter().map(Value::as_f64).collect();
    let all = all.ok_or(format!("{name} holds something that is no number"))?;
    let count = all.len();
    all.try_into()
        .map_err(|_| format!("{name} has {count} numbers, not {N}"))
}

fn seed(value: &Value) -> Result<u64, String> {
    match value {
        Value::Null => Ok(0),
        _ => value.as_u64().ok_or("seed is no whole number of at least zero".into()),
    }
}

fn seconds(value: &Value) -> Result<Duration, String> {
    let seconds = match value {
        Value::Null => 10.0,
        _ => value.as_f64().ok_or("seconds is no number")?,
    };
    Duration::try_from_secs_f64(seconds).map_err(|e| format!("seconds: {e}"))
}

fn bounds(value: &Value) -> Result<[[f64; 3]; 2], String> {
    let Some([low, high]) = value.as_array().map(Vec::as_slice) else {
        return Err("bounds is no list of two corners".into());
    };
    let [low, high] = [numbers(low, "bounds[0]")?, numbers(high, "bounds[1]")?];
    if let Some(k) = (0..3).find(|&k| low[k] > high[k]) {
        return Err(format!(
            "bounds: {} is above {} in {}",
            low[k],
            high[k],
            ["x", "y", "z"][k]
        ));
    }
    if low == high {
        return Err("bounds hold a single point".into());
    }
    Ok([low, high])
}

/// A configuration; a quaternion that was rounded to few digits is normalised.
fn pose(value: &Value, name: &str) -> Result<Vec<f64>, String> {
    let [x, y, z, i, j, k, w]: [f64; 7] = numbers(value, name)?;
    let q = Quaternion::new(w, i, j, k);
    if !((q.norm() - 1.0).abs() < 1e-3) {
        return Err(format!("{name}: the quaternion has length {}", q.norm()));
    }
    let turn = UnitQuaternion::new_normalize(q);
    Ok(RigidSpace::configuration(&Isometry3::from_parts(
        Vector3::new(x, y, z).into(),
        turn,
    )))
}

/// Searches, shortens and writes; false if no path was found.
fn run(job: &Job, out: &std::path::Path) -> Result<bool, String> {
    let said = |e: PlanError| e.to_string();
    let mut checker = Checker::new(job.space.clone(), job.cell.clone()).map_err(said)?;
    let options = PlanOptions::default().seed(job.seed).unlimited();
    let began = Instant::now();
    let [start, goal] = &job.ends;
    let plan = RrtConnect::new(&options)
        .progress(&mut |_| Progress::stop_if(began.elapsed() >= job.limit))
        .plan(&mut checker, start, goal)
        .map_err(said)?;
    let (work, took) = (plan.work, began.elapsed());
    println!(
        "{} samples; {} of {} segments proven free; {} nodes; {:.2?}",
        work.samples,
        work.extensions[1],
        work.extensions[0],
        plan.roadmap.nodes.len(),
        took
    );
    let Some(found) = plan.path else {
        println!("no path found in {took:.1?}: there may be one nevertheless");
        return Ok(false);
    };
    let path = shortened(&mut checker, &found, job.seed).map_err(said)?;
    truth::command::write(out, &rows(&path))?;
    println!("written: {}", out.display());
    Ok(true)
}

/// A shorter path; says how long and how clear.
fn shortened(checker: &mut Checker<RigidSpace>, found: &[Vec<f64>], seed: u64) -> Result<Path, PlanError> {
    let path = Shortcuts::new(200, seed).shorten(checker, found)?;
    let (length, short) = (checker.space().path_length(found), checker.space().path_length(&path));
    let mut least = f64::INFINITY;
    for ends in path.windows(2) {
        least = least.min(
            checker
                .clearance_along(&JointMotion::segment(&ends[0], &ends[1]), 0.05)?
                .lower,
        );
    }
    println!(
        "path: {} configurations, length {short:.3} ({length:.3} before shortening), proven clearance {least:.2e}",
        path.len()
    );
    Ok(path)
}

fn rows(path: &[Vec<f64>]) -> String {
    let mut rows = String::from("x,y,z,qx,qy,qz,qw\n");
    for q in path {
        let words: Vec<String> = q.iter().map(|x| format!("{x:?}")).collect();
        let _ = writeln!(rows, "{}", words.join(","));
    }
    rows
}
