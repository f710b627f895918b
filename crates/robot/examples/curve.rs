//! Proofs of curves: a quintic from rest to rest that meets a fence, and a trajectory of ROS above it, also while a crate
//! moves through the cell.
//!
//! `cargo run --release -p lin-canny-robot --example curve`

use std::error::Error;
use std::f64::consts::FRAC_PI_2;

use lin_canny::nalgebra::{Isometry3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny_robot::plan::{Cell, Checker, JointCurve, JointMotion, TimedPoses, Verdict};
use lin_canny_robot::{CellFile, LoadOptions, Packages, Robot, Trajectory};

/// A message `JointTrajectory`: up next to the fence, over it, and down on the other side.
const TRAJECTORY: &str = "
joint_names: [turn, lift, elbow, roll, bend, twist]
points:
- positions: [0.6, 0.9, 1.2, 0, 0.8, 0]
  velocities: [0, 0, 0, 0, 0, 0]
  time_from_start: {sec: 0, nanosec: 0}
- positions: [0.6, 0.3, 1.2, 0, 0.8, 0.5]
  velocities: [0, 0, 0, 0, 0, 0]
  time_from_start: {sec: 1, nanosec: 0}
- positions: [-0.6, 0.3, 1.2, 0, 0.8, 0.5]
  velocities: [0, 0, 0, 0, 0, 0]
  time_from_start: {sec: 2, nanosec: 0}
- positions: [-0.6, 0.9, 1.2, 0, 0.8, 0]
  velocities: [0, 0, 0, 0, 0, 0]
  time_from_start: {sec: 3, nanosec: 500000000}
";

fn main() -> Result<(), Box<dyn Error>> {
    truth::command::no_options(
        "Prove curves of an arm: a quintic that meets a fence, and a trajectory of ROS above it, among a moving crate",
    );
    let (packages, options) = (Packages::default(), LoadOptions::default());
    let arm = Robot::parse(include_str!("arm.urdf"), "arm.urdf", &packages, &options)?;
    let cell = CellFile::parse(include_str!("cell.json"), "cell.json", &packages, &options)?;
    let mut setup = Cell::new();
    setup.add_robot("", &arm, Isometry3::identity())?;
    setup.exclude_adjacent();
    cell.add_to(&mut setup)?;
    let mut checker = Checker::of_robots(setup.clone())?;

    let trajectory = Trajectory::parse_timed(TRAJECTORY, "carry.yaml", arm.coordinates(), &[])?;
    let (Some(from), Some(to)) = (trajectory.rows.first(), trajectory.rows.last()) else {
        return Err("the trajectory has no points".into());
    };
    let rest = [&[0.0; 6][..]; 2];
    let quintic = JointCurve::quintic([&from[..], &to[..]], rest, rest, 2.0)?;
    match checker.certify(&JointMotion::curve(&quintic))? {
        Verdict::Blocked {
            free_until: safe,
            contact_at: t,
            pair,
            ..
        } => {
            let (safe, t, pair) = (2.0 * safe, 2.0 * t, checker.show(&pair));
            println!("from rest to rest in 2 s: free up to {safe:.6} s, {pair} meet at {t:.6} s");
        }
        other => println!("from rest to rest in 2 s: {other:?}"),
    }

    let curves = trajectory.curves()?;
    let motion = JointMotion::spline(&curves)?;
    let verdict = checker.certify(&motion)?;
    println!("trajectory of {} cubics: free = {}", curves.len(), verdict.is_free());
    if !verdict.is_free() {
        println!("  {}", checker.show(&verdict));
    }

    // A controller whose joints are off by so much at any time.
    for radius in [0.001, 0.01, 0.1] {
        let is_free = checker.certify(&motion.clone().with_tube(&[radius; 6])?)?.is_free();
        println!("tracking error of {radius} rad: free = {is_free}");
    }

    // A crate is lowered behind the fence in 2 s, turned by a right angle, and waits. The trajectory may start later.
    let at = |z: f64, turn: f64| Isometry3::new(Vector3::new(0.62, -0.35, z), Vector3::z() * turn);
    let lowered = [at(1.5, 0.0), at(0.45, FRAC_PI_2), at(0.45, FRAC_PI_2)];
    let poses = TimedPoses::new(&[0.0, 2.0, 9.0], &lowered)?;
    checker
        .cell_mut()
        .add_moving_obstacle("crate", solids::cuboid(Vector3::repeat(0.1))?, poses)?;
    let times = trajectory.times.ok_or("the points have times")?;
    for delay in [0.0, 1.0, 2.0] {
        let times: Vec<f64> = times.iter().map(|time| time + delay).collect();
        let found = match checker.certify(&motion.clone().with_times(&times)?)? {
            Verdict::Blocked {
                contact_at,
                piece,
                pair,
                ..
            } => {
                let time = times[piece] + contact_at * (times[piece + 1] - times[piece]);
                format!("{} meet at {time:.6} s", checker.show(&pair))
            }
            verdict => format!("{} for all times", verdict.name()),
        };
        println!("started at {delay} s: {found}");
    }
    Ok(())
}
