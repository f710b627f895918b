//! A probe flies through ten thousand fixed bodies, and only `within` is enabled: is any body
//! nearer than 0.25?
//!
//! `cargo run --release -p race --example walkthrough -- [--out FILE.svg] [--bodies N] [--frames N]`

use clap::Parser;
use lin_canny::ConvexPolyhedron;
use lin_canny::nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, BodyId, Change, Group, PairQueries, Report, Scene};
use race::plot::{Chart, save_stack};
use race::progress::Progress;
use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use truth::command::{count, file};
use truth::rng::Rng;
use truth::shapes::ellipsoid;

type Trouble = Box<dyn std::error::Error>;

const PROBE: Group = Group::new(0).unwrap();
const WORLD: Group = Group::new(1).unwrap();

/// Clearance to keep.
const CLEARANCE: f64 = 0.25;

/// Frames between two points of the picture.
const EVERY: usize = 6;

/// Height of the field of bodies.
const HEIGHT: f64 = 12.0;

/// Fly a probe through a field of fixed bodies and report when it is too close to one
///
/// Prints the work that this takes, and draws the path.
#[derive(Parser)]
struct Options {
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/walkthrough.svg", value_parser = file("svg"))]
    out: PathBuf,
    /// Number of bodies in the field
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = count(1))]
    bodies: usize,
    /// Number of frames of the flight
    #[arg(long, value_name = "N", default_value_t = 6_000, value_parser = count(1))]
    frames: usize,
}

fn main() -> ExitCode {
    truth::command::main(walkthrough)
}

fn walkthrough(options: &Options) -> Result<(), Trouble> {
    println!("drawing to {}", options.out.display());
    let mut field = Field::new(options.bodies)?;
    let flight = fly(&mut field, options.frames)?;
    tell(options, &flight);
    draw(options, &flight, &field.slab)
}

/// A scene of fixed bodies, and a list of the bodies at about the height of the probe.
struct Field {
    scene: Scene,
    /// Half the side of the field.
    half: f64,
    slab: Vec<(BodyId, (f64, f64))>,
}

impl Field {
    fn new(bodies: usize) -> Result<Self, Trouble> {
        let mut rng = Rng::new(7);
        // Eight cubic units per body.
        let half = 0.5 * (8.0 * bodies as f64 / HEIGHT).sqrt();
        let mut scene = Scene::new();
        let near = PairQueries::none().within(CLEARANCE);
        scene.set_queries(PROBE, WORLD, near)?;
        let shapes = (0..12).map(|k| {
            let axes = [0; 3].map(|_| rng.range(0.2, 0.6));
            let points = ellipsoid(&mut rng, 12 + 6 * k, axes).points;
            let points: Vec<_> = points.into_iter().map(Point3::from).collect();
            ConvexPolyhedron::from_points(&points).map(Arc::new)
        });
        let shapes = shapes.collect::<Result<Vec<_>, _>>()?;
        let mut slab = Vec::new();
        for k in 0..bodies {
            let q = rng.quat();
            let t = [half, half, 0.5 * HEIGHT].map(|reach| rng.range(-reach, reach));
            let body = Body::fixed(shapes[k % shapes.len()].clone()).group(WORLD);
            let id = scene.insert(body, truth::Pose { q, t }.isometry())?;
            if t[2].abs() < 1.0 {
                slab.push((id, (t[0], t[1])));
            }
        }
        Ok(Self { scene, half, slab })
    }
}

/// Results of the flight.
#[derive(Default)]
struct Flight {
    reports: Vec<Report>,
    /// Number of frames in which the probe was too close to a body, and the set of these bodies.
    too_close: usize,
    met: BTreeSet<BodyId>,
    /// Path of the probe where it was free, and where it was not.
    free: Vec<(f64, f64)>,
    close: Vec<(f64, f64)>,
}

fn fly(field: &mut Field, frames: usize) -> Result<Flight, Trouble> {
    let (scene, half) = (&mut field.scene, field.half);
    let probe = Body::moving(solids::prism(16, 0.6, 0.3)?).group(PROBE);
    let probe = scene.insert(probe, path(0.0, half))?;
    let (mut flight, mut within) = (Flight::default(), BTreeSet::new());
    let progress = Progress::new("frames", frames as u64);
    for frame in 0..frames {
        let pose = path(frame as f64 / frames as f64, half);
        scene.set_pose(probe, pose)?;
        flight.reports.push(*scene.step());
        for event in scene.events() {
            let other = if event.a == probe { event.b } else { event.a };
            if event.change == Change::CameWithin {
                within.insert(other);
                flight.met.insert(other);
            } else {
                within.remove(&other);
            }
        }
        let is_free = within.is_empty();
        if frame % EVERY == 0 {
            let at = (pose.translation.x, pose.translation.y);
            // A line is interrupted at a NaN.
            flight.free.push(if is_free { at } else { (f64::NAN, f64::NAN) });
            flight.close.extend((!is_free).then_some(at));
        }
        flight.too_close += usize::from(!is_free);
        progress.step();
    }
    Ok(flight)
}

fn tell(options: &Options, flight: &Flight) {
    let Options { bodies, frames, .. } = options;
    let sum = flight.reports.iter().fold(Report::default(), |mut sum, r| {
        sum += *r;
        sum
    });
    let mean = |v: u64| v as f64 / *frames as f64;
    println!("a probe among {bodies} fixed bodies, {frames} frames, only within({CLEARANCE}) called for");
    println!(
        "{} frames too close, {} bodies; a frame: {:.2} us, {:.2} pairs of boxes, {:.2} asked, {:.2} by the budget",
        flight.too_close,
        flight.met.len(),
        sum.times.total().as_secs_f64() * 1e6 / *frames as f64,
        mean(sum.counts.pairs),
        mean(sum.counts.queries),
        mean(sum.counts.skipped)
    );
    println!("all frames together:\n{sum}");
}

fn draw(options: &Options, flight: &Flight, slab: &[(BodyId, (f64, f64))]) -> Result<(), Trouble> {
    let (touched, others): (Vec<_>, Vec<_>) = slab.iter().partition(|(id, _)| flight.met.contains(id));
    let places = |list: Vec<&(BodyId, (f64, f64))>| list.into_iter().map(|(_, at)| *at).collect::<Vec<_>>();
    let plan = Chart::new(format!(
        "path of the probe, and the bodies at its height ({} in all)",
        options.bodies
    ))
    .axes("x", "y")
    .legend_beside()
    .size(860, 620)
    .backdrop("bodies", places(others))
    .line("path, farther than 0.25 from all", flight.free.iter().copied())
    .dots("path, within 0.25 of a body", flight.close.iter().copied())
    .dots("bodies within 0.25 of the path", places(touched));
    let group = 50;
    let smooth = |value: fn(&Report) -> u64| {
        let mean = |(k, part): (usize, &[Report])| {
            let sum: u64 = part.iter().map(value).sum();
            ((k * group) as f64, sum as f64 / part.len() as f64)
        };
        flight.reports.chunks(group).enumerate().map(mean).collect::<Vec<_>>()
    };
    let work = Chart::new("pairs per frame, mean of fifty frames")
        .axes("frame", "pairs")
        .legend_beside()
        .from_zero()
        .size(860, 300)
        .line("pairs of boxes", smooth(|r| r.counts.pairs))
        .line("pairs queried", smooth(|r| r.counts.queries));
    save_stack(&[&plan, &work], &options.out)?;
    Ok(())
}

/// Returns a pose on a Lissajous curve through the field, with the probe rotated along the curve.
fn path(t: f64, half: f64) -> Isometry3<f64> {
    let angle = t * TAU;
    let at = Vector3::new(
        0.85 * half * (3.0 * angle).sin(),
        0.85 * half * (2.0 * angle).cos(),
        0.5 * (5.0 * angle).sin(),
    );
    let ahead = Vector3::new(3.0 * (3.0 * angle).cos(), -2.0 * (2.0 * angle).sin(), 0.0);
    let turn = UnitQuaternion::rotation_between(&Vector3::x(), &ahead).unwrap_or_default();
    Isometry3::from_parts(Translation3::from(at), turn)
}
