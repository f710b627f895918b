//! Small spinning bodies fly at a thin plate: which methods detect the hits of one time step?
//!
//! ```text
//! cargo run --release -p race --example bullet -- [--out FILE.svg] [--throws N]
//! ```
//!
//! Rods and discs of 10 cm, spinning at up to 300 radians per second, fly past and into a plate of
//! 2 mm, in steps of 1/60 s. Four methods test each step: the end pose alone (discrete), parry's
//! sweep between the end poses (rapier 0.36 uses it for fast bodies), parry's nonlinear cast, and
//! `impact::cast`. Each is judged on the motion that it follows. For `impact::cast`, every miss is
//! checked at 400 instants.

use clap::Parser;
use lin_canny::impact::{Impact, Tolerance, cast};
use lin_canny::motion::{Motion, Nlerp, Steady};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{ConvexPolyhedron, RelativePose, Tracker, Velocity};
use race::plot::Chart;
use std::path::PathBuf;
use std::process::ExitCode;
use truth::casts::solid;
use truth::command::{count, file};
use truth::contacts::plain;
use truth::parry::casts::{Flight, nonlinear, sweep};
use truth::parry::{self, ParryPose};
use truth::rng::Rng;
use truth::shapes;

type Trouble = Box<dyn std::error::Error>;

const STEP: f64 = 1.0 / 60.0;
const SPEEDS: [f64; 7] = [10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0];
const WAYS: [&str; 4] = ["discrete", "parry sweep", "parry nonlinear", "impact::cast"];

/// Compare which methods detect the hits of small spinning bodies on a thin plate, and which miss
/// them
///
/// A step is 1/60 s. Prints a table and draws a picture of the share of missed hits.
#[derive(Parser)]
struct Options {
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/bullet.svg", value_parser = file("svg"))]
    out: PathBuf,
    /// Number of throws per speed
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = count(1))]
    throws: usize,
}

fn main() -> ExitCode {
    truth::command::main(run)
}

/// A body in the form of each library.
struct Body {
    ours: ConvexPolyhedron,
    hull: parry::Hull,
}

fn body(points: &[truth::Point]) -> Result<Body, Trouble> {
    let ours = solid(points);
    let (points, faces) = plain(&ours);
    let hull = parry::mesh(&points, &faces).ok_or("parry makes no body of it")?;
    Ok(Body { ours, hull })
}

fn parry_pose(pose: &Isometry3<f64>) -> ParryPose {
    let (t, q) = (pose.translation.vector, pose.rotation.coords);
    parry::pose(&truth::Pose {
        q: [q.x, q.y, q.z, q.w],
        t: t.into(),
    })
}

/// Returns the start and the velocity of a body that comes near the plate during the step.
fn throw(rng: &mut Rng, speed: f64) -> (Isometry3<f64>, Velocity) {
    let direction = (Vector3::x() + Vector3::from(rng.in_ball()) * 0.3).normalize();
    let velocity = direction * speed;
    // A position in the plane of the plate at some instant of the step, on the plate or next to it.
    let place = Vector3::new(0.0, rng.range(-0.25, 0.25), rng.range(-0.25, 0.25));
    let start = place - velocity * (STEP * rng.range(0.05, 0.95)) - Vector3::x() * 0.11;
    let spin = Vector3::from(rng.unit()) * rng.range(0.0, 300.0);
    let turn = truth::casts::rotation(rng);
    (Isometry3::from_parts(start.into(), turn), Velocity::new(velocity, spin))
}

/// Counts, for each method, the missed hits and all hits at one speed, and the instants that
/// contradict a miss proven by `impact::cast`.
fn judge(bodies: &[Body], plate: &Body, speed: f64, throws: usize) -> Result<([[u32; 2]; 4], u32), Trouble> {
    let mut rng = Rng::new(speed.to_bits());
    let (mut tally, mut wrong) = ([[0; 2]; 4], 0);
    let at = Isometry3::identity();
    let rest = Steady::new(&at, Velocity::default())?;
    let fine = Tolerance::Distance(1e-9);
    for k in 0..throws {
        let body = &bodies[k % bodies.len()];
        let (start, velocity) = throw(&mut rng, speed);
        let flight = Steady::new(&start, velocity)?;
        let end = flight.pose(STEP);
        let meets = |tracker: &mut Tracker, pose: &Isometry3<f64>| -> Result<bool, Trouble> {
            Ok(tracker.intersects(&body.ours, &plate.ours, &RelativePose::new(pose, &at)?))
        };
        let found = cast(
            &mut Tracker::new().pair(&body.ours, &plate.ours),
            &flight,
            &rest,
            0.0..STEP,
            fine,
        )?
        .impact;
        if let Impact::AtStart { .. } = found {
            continue;
        }
        let truth = matches!(found, Impact::Hit { .. });
        if !truth {
            let mut tracker = Tracker::new();
            for k in 0..400 {
                wrong += u32::from(meets(&mut tracker, &flight.pose(STEP * f64::from(k) / 399.0))?);
            }
        }
        let nlerp = Nlerp::new(&start, &end, STEP, Point3::origin())?;
        let swept = matches!(
            cast(
                &mut Tracker::new().pair(&body.ours, &plate.ours),
                &nlerp,
                &rest,
                0.0..STEP,
                fine
            )?
            .impact,
            Impact::Hit { .. }
        );
        let vector = |v: Vector3<f64>| [v.x, v.y, v.z].into();
        let flown = Flight {
            hull: &body.hull,
            poses: [parry_pose(&start), parry_pose(&end)],
            linear: vector(velocity.linear * STEP),
            angular: vector(velocity.angular * STEP),
        };
        let still = Flight {
            hull: &plate.hull,
            poses: [parry_pose(&at); 2],
            linear: vector(Vector3::zeros()),
            angular: vector(Vector3::zeros()),
        };
        let answers = [
            (truth, meets(&mut Tracker::new(), &end)?),
            (swept, sweep(&flown, &still).is_some()),
            (truth, nonlinear(&flown, &still).is_some()),
            (truth, truth),
        ];
        for ([missed, of], (truth, seen)) in tally.iter_mut().zip(answers) {
            *of += u32::from(truth);
            *missed += u32::from(truth && !seen);
        }
    }
    Ok((tally, wrong))
}

fn run(options: &Options) -> Result<(), Trouble> {
    let bodies = [
        body(&shapes::prism(6, 0.005, 0.05).points)?,
        body(&shapes::prism(12, 0.05, 0.004).points)?,
    ];
    let plate = body(&shapes::cuboid([0.001, 0.15, 0.15]).points)?;
    println!("hits missed, of {} steps a speed (m/s), in per cent\n", options.throws);
    println!(
        "{:>6}{:>7}{:>11}{:>14}{:>18}{:>15}",
        "speed", "hits", WAYS[0], WAYS[1], WAYS[2], WAYS[3]
    );
    let mut lines = vec![vec![]; WAYS.len()];
    let mut totals = [[0; 2]; 4];
    let mut wrong = 0;
    for speed in SPEEDS {
        let (tally, bad) = judge(&bodies, &plate, speed, options.throws)?;
        wrong += bad;
        let share = tally.map(|[missed, of]| 100.0 * f64::from(missed) / f64::from(of.max(1)));
        println!(
            "{speed:>6}{:>7}{:>11.1}{:>14.1}{:>18.1}{:>15.1}",
            tally[3][1], share[0], share[1], share[2], share[3]
        );
        for (line, share) in lines.iter_mut().zip(share) {
            line.push((speed, share));
        }
        for (total, way) in totals.iter_mut().zip(tally) {
            *total = [total[0] + way[0], total[1] + way[1]];
        }
    }
    println!("\ninstants that contradict a proven miss: {wrong}");
    let mut chart = Chart::new("Spinning rods and discs at a plate of 2 mm, steps of 1/60 s")
        .axes("speed, metres a second", "hits missed, per cent")
        .log_x()
        .from_zero()
        .size(860, 400)
        .legend_beside();
    for ((name, line), [missed, of]) in WAYS.into_iter().zip(lines).zip(totals) {
        // Lines at zero cover each other, so the legend gives the numbers.
        chart = chart.line(format!("{name}: {missed} of {of}"), line);
    }
    if let Some(folder) = options.out.parent() {
        std::fs::create_dir_all(folder)?;
    }
    chart.save(&options.out)?;
    println!("wrote {}", options.out.display());
    Ok(())
}
