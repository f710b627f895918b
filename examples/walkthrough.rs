//! A probe flies through ten thousand fixed bodies, and only `within` is called for: is anything nearer than 0.25?
//!
//! `cargo run --release --example walkthrough -- [--out FILE.svg] [--bodies N] [--frames N]`

use lab::plot::{Chart, save_stack};
use lab::progress::Progress;
use lab::rng::Rng;
use lab::shapes::ellipsoid;
use lin_canny::ConvexPolyhedron;
use lin_canny::nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, Change, Effects, Group, Report, Scene};
use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::sync::Arc;

type Trouble = Box<dyn std::error::Error>;

const PROBE: Group = Group::new(0).unwrap();
const WORLD: Group = Group::new(1).unwrap();

/// The distance to keep.
const CLEARANCE: f64 = 0.25;

/// Frames between two points of the picture.
const EVERY: usize = 6;

/// Height of the field of bodies.
const HEIGHT: f64 = 12.0;

fn main() -> Result<(), Trouble> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let option = |name: &str| {
        let at = arguments.iter().position(|a| a == name)?;
        arguments.get(at + 1).cloned()
    };
    let bodies: usize = option("--bodies").map_or(Ok(10_000), |n| n.parse())?;
    let frames: usize = option("--frames").map_or(Ok(6_000), |n| n.parse())?;
    let mut rng = Rng::new(7);
    // Eight cubic units a body.
    let half = 0.5 * (8.0 * bodies as f64 / HEIGHT).sqrt();

    let mut scene = Scene::new();
    let near = Effects {
        within: Some(CLEARANCE),
        ..Effects::none()
    };
    scene.call_for(PROBE, WORLD, near)?;
    let shapes = (0..12)
        .map(|k| {
            let axes = [0; 3].map(|_| rng.range(0.2, 0.6));
            let points: Vec<_> = ellipsoid(&mut rng, 12 + 6 * k, axes)
                .points
                .into_iter()
                .map(Point3::from)
                .collect();
            ConvexPolyhedron::from_points(&points).map(Arc::new)
        })
        .collect::<Result<Vec<_>, _>>()?;
    let mut slab = Vec::new();
    for k in 0..bodies {
        let q = rng.quat();
        let t = [half, half, 0.5 * HEIGHT].map(|reach| rng.range(-reach, reach));
        let body = Body::fixed(shapes[k % shapes.len()].clone()).group(WORLD);
        let id = scene.insert(body, lab::Pose { q, t }.isometry())?;
        if t[2].abs() < 1.0 {
            slab.push((id, (t[0], t[1])));
        }
    }
    let probe = Body::moving(solids::prism(16, 0.3, 0.6)?).group(PROBE);
    let probe = scene.insert(probe, path(0.0, half))?;

    let mut too_close = 0;
    let (mut way, mut close, mut reports) = (Vec::new(), Vec::new(), Vec::new());
    let (mut within, mut met) = (BTreeSet::new(), BTreeSet::new());
    let progress = Progress::new("frames", frames as u64);
    for frame in 0..frames {
        let pose = path(frame as f64 / frames as f64, half);
        scene.set_pose(probe, pose)?;
        reports.push(*scene.step());
        for event in scene.events() {
            let other = if event.a == probe { event.b } else { event.a };
            if event.change == Change::CameWithin {
                within.insert(other);
                met.insert(other);
            } else {
                within.remove(&other);
            }
        }
        if frame % EVERY == 0 {
            let at = (pose.translation.x, pose.translation.y);
            // A line breaks where it is no number.
            way.push(if within.is_empty() { at } else { (f64::NAN, f64::NAN) });
            close.extend((!within.is_empty()).then_some(at));
        }
        too_close += usize::from(!within.is_empty());
        progress.step();
    }
    drop(progress);

    let sum = reports.iter().fold(Report::default(), |mut sum, r| {
        sum += *r;
        sum
    });
    let mean = |v: u64| v as f64 / frames as f64;
    println!("a probe among {bodies} fixed bodies, {frames} frames, only within({CLEARANCE}) called for");
    println!(
        "{} frames too close, {} bodies; a frame: {:.2} us, {:.2} pairs of boxes, {:.2} asked, {:.2} by the budget",
        too_close,
        met.len(),
        sum.times.total().as_secs_f64() * 1e6 / frames as f64,
        mean(sum.counts.pairs),
        mean(sum.counts.queries),
        mean(sum.counts.skipped)
    );
    println!("all frames together:\n{sum}");
    let out = option("--out").unwrap_or("walkthrough.svg".into());
    let touched: Vec<_> = slab
        .iter()
        .filter(|(id, _)| met.contains(id))
        .map(|(_, at)| *at)
        .collect();
    let others: Vec<_> = slab
        .iter()
        .filter(|(id, _)| !met.contains(id))
        .map(|(_, at)| *at)
        .collect();
    let plan = Chart::new(format!(
        "way of the probe, and bodies within one unit of its mean height ({bodies} in all)"
    ))
    .axes("x", "y")
    .legend_beside()
    .size(860, 620)
    .line("free", way.iter().copied())
    .dots("too close", close.iter().copied())
    .dots("bodies", others)
    .dots("bodies met", touched);
    let group = 50;
    let smooth = |value: &dyn Fn(&Report) -> f64| {
        let mean = |(k, part): (usize, &[Report])| {
            (
                (k * group) as f64,
                part.iter().map(value).sum::<f64>() / part.len() as f64,
            )
        };
        reports.chunks(group).enumerate().map(mean).collect::<Vec<_>>()
    };
    let work = Chart::new("pairs a frame, mean of fifty")
        .axes("frame", "pairs")
        .legend_beside()
        .from_zero()
        .size(860, 300)
        .line("pairs of boxes", smooth(&|r| r.counts.pairs as f64))
        .line("asked", smooth(&|r| r.counts.queries as f64));
    save_stack(&[&plan, &work], &out)?;
    println!("drawn: {out}");
    Ok(())
}

/// A Lissajous curve through the field, the probe turned along it.
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
