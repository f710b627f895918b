//! Compares depths of parry in `f32`, rapier's precision, with certified depths, for small parts.
//!
//! The parts are pairs of hulls of 24 points, from 1 m down to 2 mm. Both engines get the same hull
//! and the same `f32` poses. The hull has the points that parry keeps, so a vertex that parry drops
//! is not an error here. The certified depth is proven to 1e-13 of the size.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3};
use lin_canny::{ContactState, ConvexPolyhedron, RelativePose, Tracker};
use parry3d::math::{Pose, Rotation, Vector};
use parry3d::query::contact;
use parry3d::shape;
use race::plot::Chart;
use truth::command::{count, file};
use truth::rng::Rng;

/// Measure the errors of parry's f32 depths for overlapping hulls from 1 m down to 1 mm
///
/// Prints how many depths are wrong by more than 1 % of the size and how many overlaps are missed,
/// and draws a picture.
#[derive(Parser)]
struct Options {
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/small_parts.svg", value_parser = file("svg"))]
    out: PathBuf,
    /// Number of poses per size
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = count(1))]
    poses: usize,
    /// Random seed of hulls and poses
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

/// Diameters of the parts in metres.
const SIZES: [f64; 10] = [1.0, 0.3, 0.1, 0.05, 0.03, 0.02, 0.01, 0.006, 0.003, 0.002];

/// Poses per pair of hulls.
const POSES_PER_PAIR: usize = 25;

fn main() -> ExitCode {
    truth::command::main(run)
}

/// The same hull in both engines.
struct Part {
    parry: shape::ConvexPolyhedron,
    ours: ConvexPolyhedron,
}

impl Part {
    /// Returns the hull of 24 random points on a sphere; `None` if an engine rejects the points.
    fn random(rng: &mut Rng, diameter: f64) -> Option<Self> {
        let on_sphere = |rng: &mut Rng| {
            let [x, y, z] = rng.unit().map(|c| (0.5 * diameter * c) as f32);
            Vector::new(x, y, z)
        };
        let points: Vec<Vector> = (0..24).map(|_| on_sphere(rng)).collect();
        let parry = shape::ConvexPolyhedron::from_convex_hull(&points)?;
        let kept: Vec<Point3<f64>> = parry.points().iter().map(|p| wide(p).into()).collect();
        let ours = ConvexPolyhedron::from_points(&kept).ok()?;
        Some(Self { parry, ours })
    }
}

fn wide(v: &Vector) -> [f64; 3] {
    v.to_array().map(f64::from)
}

/// Counts and errors of the depths at one size.
#[derive(Default)]
struct Tally {
    overlaps: usize,
    wrong: usize,
    missed: usize,
    /// Certified results whose bounds differ by more than 1e-12 of the size.
    open: usize,
    /// Greatest error, divided by the diameter.
    worst: f64,
}

impl Tally {
    /// Compares the depths at one random pose, if the parts overlap by more than 1 % of their size.
    fn compare(&mut self, a: &Part, b: &Part, diameter: f64, rng: &mut Rng) -> Result<(), String> {
        let [x, y, z, w] = rng.quat().map(|c| c as f32);
        let rotation = Rotation::from_xyzw(x, y, z, w).normalize();
        let length = diameter * rng.range(0.1, 0.9);
        let [x, y, z] = rng.unit().map(|c| (c * length) as f32);
        let pose = Pose::from_parts(Vector::new(x, y, z), rotation);
        let [i, j, k, w] = pose.rotation.to_array().map(f64::from);
        let turn = lin_canny::nalgebra::UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
        let same = Isometry3::from_parts(Translation3::from(wide(&pose.translation)), turn);
        let poses = RelativePose::from_isometry(&same).map_err(|e| e.to_string())?;
        let truth = Tracker::new().distance(&a.ours, &b.ours, &poses);
        if truth.state != ContactState::Overlapping || -truth.upper < 0.01 * diameter {
            return Ok(());
        }
        self.overlaps += 1;
        self.open += usize::from(!(truth.upper - truth.lower <= 1e-12 * diameter));
        let found = contact(&Pose::identity(), &a.parry, &pose, &b.parry, 0.0).map_err(|e| e.to_string())?;
        let Some(found) = found else {
            self.missed += 1;
            return Ok(());
        };
        let error = (f64::from(found.dist) - truth.value).abs() / diameter;
        // A NaN counts as wrong.
        self.wrong += usize::from(!(error <= 0.01));
        self.worst = self.worst.max(error);
        Ok(())
    }

    fn percent(&self, count: usize) -> f64 {
        100.0 * count as f64 / self.overlaps.max(1) as f64
    }
}

fn run(o: &Options) -> Result<(), String> {
    println!("drawing to {}\n", o.out.display());
    println!("     size  overlaps  depth wrong by > 1 %   worst    no contact");
    let mut tallies = Vec::new();
    for (k, &diameter) in SIZES.iter().enumerate() {
        let mut rng = Rng::of_case(o.seed, k as u64);
        let mut tally = Tally::default();
        for _ in 0..o.poses.div_ceil(POSES_PER_PAIR) {
            let (Some(a), Some(b)) = (Part::random(&mut rng, diameter), Part::random(&mut rng, diameter)) else {
                continue;
            };
            for _ in 0..POSES_PER_PAIR {
                tally.compare(&a, &b, diameter, &mut rng)?;
            }
        }
        println!(
            "{:>6} mm  {:>8}  {:>17.1} %  {:>7.1e}  {:>9.1} %",
            (1000.0 * diameter).round(),
            tally.overlaps,
            tally.percent(tally.wrong),
            tally.worst,
            tally.percent(tally.missed)
        );
        tallies.push((1000.0 * diameter, tally));
    }
    draw(o, &tallies)
}

fn draw(o: &Options, tallies: &[(f64, Tally)]) -> Result<(), String> {
    let share = |count: fn(&Tally) -> usize| -> Vec<(f64, f64)> {
        tallies.iter().map(|(mm, t)| (*mm, t.percent(count(t)))).collect()
    };
    if let Some(folder) = o.out.parent() {
        std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    Chart::new("overlapping hulls of 24 points: depths wrong by over 1 % of the size, and overlaps missed")
        .axes("diameter of the part in mm", "percent of overlaps")
        .log_x()
        .from_zero()
        .size(860, 400)
        .legend_beside()
        .curve("parry f32: depth wrong", share(|t| t.wrong))
        .curve("parry f32: no contact", share(|t| t.missed))
        .curve("lin-canny: not proven", share(|t| t.open))
        .save(&o.out)
}
