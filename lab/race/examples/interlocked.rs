//! Two interlocked rings tumble: time per frame compared with parry, and a picture of one front.
//!
//! `cargo run --release -p race --example interlocked` prints the table, and draws the front of one
//! frame with the closest points.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use lin_canny::nalgebra::Point3;
use lin_canny::{Mesh, PairOutcome, PairTracker, RelativePose};
use parry3d_f64::math::Vector;
use parry3d_f64::query;
use parry3d_f64::shape::TriMesh;
use truth::command::{file, write};
use truth::pose::{cross, dot, norm, quat, quat_mul, scale, sub, unit, unit_quat};
use truth::soups::{self, Soup};
use truth::{Point, Pose};

type Trouble = Box<dyn std::error::Error>;

const FRAMES: usize = 720;

/// parry is queried once in this many frames.
const SPARSE: usize = 90;

/// Axes of the view: towards the viewer, to the right, and up.
const VIEW: [Point; 3] = [[0.36, -0.80, 0.48], [0.91, 0.41, 0.0], [-0.20, 0.44, 0.88]];

/// Measure the time per frame of two interlocked rings, compared with parry, and draw the front of
/// a frame
#[derive(Parser)]
struct Options {
    /// Output picture
    #[arg(long, value_name = "FILE.svg", default_value = "target/interlocked.svg", value_parser = file("svg"))]
    out: PathBuf,
}

fn main() -> ExitCode {
    truth::command::main(run)
}

fn run(options: &Options) -> Result<(), Trouble> {
    println!("drawing to {}", options.out.display());
    println!(
        "{:>9} {:>10} {:>10} {:>12} {:>7} {:>7} {:>7} {:>9}",
        "triangles", "ours, us", "cold, us", "parry, us", "front", "failed", "bounds", "measured"
    );
    for n in [12, 24, 48, 96] {
        race(&soups::torus(2 * n, n, 0.3))?;
    }
    let ring = soups::torus(48, 20, 0.3);
    Ok(write(&options.out, &picture(&ring)?)?)
}

/// Returns the pose of one ring through the other, at half a degree per frame.
fn pose(k: usize) -> Pose {
    let phase = (0.5 * k as f64).to_radians();
    let upright = quat([1.0, 0.0, 0.0], 1.4);
    let spin = quat_mul(quat([0.0, 1.0, 0.0], phase), upright);
    Pose {
        q: unit_quat(quat_mul(quat([0.0, 0.0, 1.0], 0.3 * phase.sin()), spin)),
        t: [1.05 + 0.1 * phase.sin(), 0.1 * phase.cos(), 0.05],
    }
}

fn mesh(soup: &Soup) -> Result<Mesh, Trouble> {
    let points: Vec<_> = soup.points.iter().map(|p| Point3::from(*p)).collect();
    Ok(Mesh::new(&points, &soup.triangles)?)
}

/// Prints one line of the table.
fn race(ring: &Soup) -> Result<(), Trouble> {
    let m = mesh(ring)?;
    let at: Vec<_> = (0..FRAMES)
        .map(|k| RelativePose::from_isometry(&pose(k).isometry()))
        .collect::<Result<_, _>>()?;
    let mut tracker = PairTracker::new();
    let start = Instant::now();
    let ours: Vec<PairOutcome> = at.iter().map(|at| tracker.closest(&m, &m, at)).collect();
    let tracked = start.elapsed().as_secs_f64() * 1e6 / FRAMES as f64;
    let start = Instant::now();
    at.iter().for_each(|at| {
        PairTracker::new().closest(&m, &m, at);
    });
    let cold = start.elapsed().as_secs_f64() * 1e6 / FRAMES as f64;
    let points = ring.points.iter().map(|p| Vector::new(p[0], p[1], p[2])).collect();
    let other = TriMesh::new(points, ring.triangles.clone())?;
    let start = Instant::now();
    let mut worst: f64 = 0.0;
    for k in (0..FRAMES).step_by(SPARSE) {
        let d = query::distance(&Default::default(), &other, &truth::parry::pose(&pose(k)), &other)?.distance;
        worst = worst.max((d - ours[k].distance).abs());
    }
    let parry = start.elapsed().as_secs_f64() * 1e6 / (FRAMES / SPARSE) as f64;
    let (w, each) = (tracker.work(), |x: u64| x as f64 / FRAMES as f64);
    println!(
        "{:>9} {tracked:>10.1} {cold:>10.1} {parry:>12.0} {:>7} {:>7.1} {:>7.1} {:>9.1}   parry differs by {worst:.0e}",
        ring.triangles.len(),
        tracker.front_len(),
        each(w.trees.failed),
        each(w.trees.bounds),
        each(w.trees.measured),
    );
    Ok(())
}

/// Returns the position of a point on the page, and its depth towards the viewer.
fn project(p: Point) -> (f64, f64, f64) {
    (
        330.0 + 190.0 * dot(p, VIEW[1]),
        300.0 - 190.0 * dot(p, VIEW[2]),
        dot(p, VIEW[0]),
    )
}

/// Draws both rings, the boxes of the front, and the closest points.
fn picture(ring: &Soup) -> Result<String, Trouble> {
    let m = mesh(ring)?;
    let mut tracker = PairTracker::new();
    let mut last = None;
    for k in 0..60 {
        last = Some(tracker.closest(&m, &m, &RelativePose::from_isometry(&pose(k).isometry())?));
    }
    let (found, at) = (last.ok_or("no frame")?, pose(59));
    let mut faces: Vec<(f64, String)> = Vec::new();
    for (body, place, hue) in [(0, Pose::IDENTITY, 205), (1, at, 28)] {
        for t in 0..ring.triangles.len() {
            faces.extend(face(ring.corners(t).map(|p| place.apply(p)), hue));
        }
        let nodes: BTreeSet<u32> = tracker.mesh_front().map(|pair| pair[body]).collect();
        for node in nodes {
            let corners = m.node_box(node).ok_or("no such node")?;
            faces.extend(frame(corners.map(|p| place.apply(p.into())), hue));
        }
    }
    faces.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut svg =
        String::from("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 860 600\" font-family=\"sans-serif\">\n");
    faces.iter().for_each(|f| svg.push_str(&f.1));
    let (p, q) = (
        project(found.point_on_a.into()),
        project(at.apply(found.point_on_b.into())),
    );
    writeln!(
        svg,
        "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"#c00\" stroke-width=\"3\"/>",
        p.0, p.1, q.0, q.1
    )?;
    for (x, y, _) in [p, q] {
        writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"#c00\"/>")?;
    }
    let text = format!(
        "{} pairs of boxes prove that no two of {} x {} triangles are nearer than the red line",
        tracker.front_len(),
        m.triangle_count(),
        m.triangle_count()
    );
    writeln!(svg, "<text x=\"20\" y=\"580\" font-size=\"15\">{text}</text>\n</svg>")?;
    Ok(svg)
}

/// Returns a triangle as a polygon with its depth, if it faces the viewer.
fn face(t: [Point; 3], hue: u32) -> Option<(f64, String)> {
    let n = unit(cross(sub(t[1], t[0]), sub(t[2], t[0])));
    let light = dot(n, VIEW[0]);
    let at = t.map(project);
    let path = at
        .iter()
        .fold(String::new(), |s, p| format!("{s} {:.1},{:.1}", p.0, p.1));
    let depth = at.iter().map(|p| p.2).sum::<f64>() / 3.0;
    let tone = 45.0 + 40.0 * light;
    let polygon = format!(
        "<polygon points=\"{path}\" fill=\"hsl({hue},55%,{tone:.0}%)\" stroke=\"hsl({hue},40%,45%)\" stroke-width=\"0.3\"/>\n"
    );
    (light > 0.0).then_some((depth, polygon))
}

/// Returns the edges of a box with its depth, unless the box is too small to be seen.
fn frame(corners: [Point; 8], hue: u32) -> Option<(f64, String)> {
    let at = corners.map(project);
    let edges = (0..8)
        .flat_map(|i| [1, 2, 4].map(|bit| (i, i | bit)))
        .filter(|(i, j)| i != j);
    let path = edges.fold(String::new(), |s, (i, j)| {
        format!("{s}M{:.1} {:.1}L{:.1} {:.1}", at[i].0, at[i].1, at[j].0, at[j].1)
    });
    let depth = at.iter().map(|p| p.2).fold(f64::MIN, f64::max);
    let size = norm(scale(sub(corners[7], corners[0]), 190.0));
    let line = format!("<path d=\"{path}\" fill=\"none\" stroke=\"hsl({hue},90%,25%)\" stroke-width=\"0.6\"/>\n");
    (size > 6.0).then_some((depth, line))
}
