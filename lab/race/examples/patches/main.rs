//! Tracks a pot of rational patches and a twisted B-spline blade that swings around the pot.
//!
//! ```text
//! cargo run --release -p race --example patches -- [--frames N] [--width W] [--out FILE.svg]
//! ```
//!
//! Prints the cost of intervals of several widths, and their errors against the narrowest. Then
//! draws the front of one frame and the closest points of all frames (to `target/patches.svg` by
//! default).

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::surface::{BezierSurface, Nurbs, SurfaceError, SurfacePart, revolution};
use lin_canny::{PairOutcome, PairTracker, QueryOptions, RelativePose};
use truth::Point;
use truth::command::{count, file, number};
use truth::pose::dot;

/// Draw the front of a frame and the closest points while a blade swings around a pot
#[derive(Parser)]
struct Options {
    /// Number of frames of half a degree
    #[arg(long, value_name = "N", default_value_t = 240, value_parser = count(1))]
    frames: usize,
    /// Width of the distance interval in the picture
    #[arg(long, value_name = "W", default_value_t = 1e-9, value_parser = number(0.0))]
    width: f64,
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/patches.svg", value_parser = file("svg"))]
    out: PathBuf,
}

/// Axes of the view: towards the viewer, to the right, and up.
const VIEW: [Point; 3] = [[0.36, -0.80, 0.48], [0.91, 0.41, 0.0], [-0.20, 0.44, 0.88]];

fn main() -> ExitCode {
    truth::command::main(run)
}

fn pot() -> Result<BezierSurface, SurfaceError> {
    let curves = truth::nets::pot();
    let curves: Vec<&[[f64; 3]]> = curves.iter().map(Vec::as_slice).collect();
    revolution(&curves)
}

fn blade() -> Result<BezierSurface, SurfaceError> {
    let points: Vec<_> = truth::nets::blade(6).into_iter().map(Point3::from).collect();
    let along = [0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0, 3.0];
    let round = [0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0, 4.0, 4.0];
    BezierSurface::from_nurbs(&Nurbs {
        degrees: [3, 3],
        knots: [&along, &round],
        points: &points,
        ..Nurbs::default()
    })
}

/// Returns the pose of the blade around the pot, at half a degree per frame.
fn pose(k: usize) -> Isometry3<f64> {
    let phase = (0.5 * k as f64).to_radians();
    let turn = UnitQuaternion::from_euler_angles(0.4 + 0.5 * phase, 0.3 * phase.sin(), 1.3 * phase);
    Isometry3::from_parts(Vector3::new(1.75 * phase.cos(), 1.75 * phase.sin(), 0.35).into(), turn)
}

fn run(options: &Options) -> Result<(), String> {
    let (pot, blade) = (pot().map_err(|e| e.to_string())?, blade().map_err(|e| e.to_string())?);
    println!(
        "pot: {} patches, blade: {} patches",
        pot.patches().len(),
        blade.patches().len()
    );
    let poses: Vec<Isometry3<f64>> = (0..options.frames).map(pose).collect();
    let at: Vec<RelativePose> = poses
        .iter()
        .map(|p| RelativePose::from_isometry(p).map_err(|e| e.to_string()))
        .collect::<Result<_, _>>()?;
    let narrow = track(&pot, &blade, &at, 1e-11).0;
    println!(
        "{:>8} {:>10} {:>10} {:>10} {:>8} {:>8} {:>8}",
        "width", "widest", "error", "us/frame", "gaps", "splits", "front"
    );
    for exponent in [-2, -4, -6, -8, -10] {
        let width = 10.0_f64.powi(exponent);
        let (found, tracker, us) = track(&pot, &blade, &at, width);
        let widest = found.iter().map(|o| o.upper - o.lower).fold(0.0, f64::max);
        let errors = found.iter().zip(&narrow).map(|(o, n)| (o.distance - n.distance).abs());
        let (work, each) = (tracker.work(), |x: u64| x as f64 / at.len() as f64);
        println!(
            "{width:>8.0e} {widest:>10.1e} {:>10.1e} {us:>10.1} {:>8.1} {:>8.1} {:>8}",
            errors.fold(0.0, f64::max),
            each(work.surfaces.gaps),
            each(work.surfaces.splits),
            tracker.front_len()
        );
    }
    let (found, tracker, _) = track(&pot, &blade, &at, options.width);
    let last = poses.len() - 1;
    let svg = picture(&pot, &blade, &tracker, &found, &poses[last]);
    truth::command::write(&options.out, &svg)?;
    println!("drawn: {}", options.out.display());
    Ok(())
}

/// Returns the outcomes of all frames, the tracker after them, and the time per frame in µs.
fn track(
    a: &BezierSurface,
    b: &BezierSurface,
    at: &[RelativePose],
    width: f64,
) -> (Vec<PairOutcome>, PairTracker, f64) {
    let mut tracker = PairTracker::new();
    let began = Instant::now();
    let found = at
        .iter()
        .map(|at| tracker.closest_with(a, b, at, &QueryOptions::new().width(width)))
        .collect();
    let us = began.elapsed().as_secs_f64() * 1e6 / at.len() as f64;
    (found, tracker, us)
}

/// Returns the position of a point on the page.
fn project(p: Point3<f64>) -> [f64; 2] {
    let p: Point = p.into();
    [385.0 + 165.0 * dot(p, VIEW[1]), 400.0 - 165.0 * dot(p, VIEW[2])]
}

/// Draws the patches of both surfaces, the surface parts of the front, and the closest points of
/// all frames.
fn picture(
    a: &BezierSurface,
    b: &BezierSurface,
    tracker: &PairTracker,
    found: &[PairOutcome],
    pose: &Isometry3<f64>,
) -> String {
    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 760 620\" font-family=\"sans-serif\">\n\
         <rect width=\"760\" height=\"620\" fill=\"#fff\"/>\n",
    );
    let identity = Isometry3::identity();
    for (body, (surface, place, hue)) in [(a, &identity, 205), (b, pose, 28)].into_iter().enumerate() {
        let whole = (0..surface.patches().len() as u32).map(|k| part(k, [0.0, 1.0], [0.0, 1.0]));
        whole.for_each(|p| outline(&mut svg, surface, place, &p, &format!("hsl({hue} 40% 78%)"), 0.7));
        let mut seen = BTreeSet::new();
        for pair in tracker.surface_front(a, b) {
            let p = pair[body];
            if p.patch.is_some()
                && seen.insert([p.u[0], p.u[1], p.v[0], p.v[1], f64::from(p.patch.unwrap_or(0))].map(f64::to_bits))
            {
                outline(&mut svg, surface, place, &p, &format!("hsl({hue} 80% 40%)"), 0.6);
            }
        }
    }
    for o in found {
        let [x, y] = project(o.point_on_a);
        let _ = writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"1.6\" fill=\"#c00\"/>");
    }
    if let Some(o) = found.last() {
        let ([x, y], [s, t]) = (project(o.point_on_a), project(pose * o.point_on_b));
        let _ = writeln!(
            svg,
            "<path d=\"M{x:.1} {y:.1}L{s:.1} {t:.1}\" stroke=\"#c00\" stroke-width=\"2.5\"/>"
        );
        let _ = writeln!(
            svg,
            "<text x=\"20\" y=\"36\" font-size=\"17\">{} pairs of parts prove the distance {:.9} to {:.0e}</text>\n\
             <text x=\"20\" y=\"600\" font-size=\"14\">dark: parts of the front; red dots: closest points on the pot, frame by frame</text>",
            tracker.front_len(),
            o.distance,
            o.upper - o.lower
        );
    }
    svg.push_str("</svg>\n");
    svg
}

fn part(patch: u32, u: [f64; 2], v: [f64; 2]) -> SurfacePart {
    SurfacePart {
        patch: Some(patch),
        u,
        v,
    }
}

/// Draws the boundary of a part of a surface.
fn outline(
    svg: &mut String,
    surface: &BezierSurface,
    place: &Isometry3<f64>,
    p: &SurfacePart,
    colour: &str,
    width: f64,
) {
    let Some(patch) = p.patch.and_then(|k| surface.patches().get(k as usize)) else {
        return;
    };
    let at = |t: f64, [low, high]: [f64; 2]| low + t * (high - low);
    let corner = |k: usize| {
        let t = (k % 8) as f64 / 8.0;
        let (u, v) = [(t, 0.0), (1.0, t), (1.0 - t, 1.0), (0.0, 1.0 - t)][k / 8 % 4];
        project(place * patch.point(at(u, p.u), at(v, p.v)))
    };
    let path = (0..32)
        .map(corner)
        .fold(String::new(), |s, [x, y]| format!("{s} {x:.1},{y:.1}"));
    let _ = writeln!(
        svg,
        "<polygon points=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"/>"
    );
}
