//! Two gears in mesh: how much of them overlaps while one turns, with proven bounds, and a picture
//! of the curves in which their surfaces cross.

use std::f64::consts::TAU;
use std::fmt::Write;

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{Mesh, PairTracker, RelativePose};

/// Number of teeth, and the points of the outline: four per tooth.
const TEETH: u32 = 12;
const POINTS: u32 = 4 * TEETH;

/// Returns the outline of a gear, counter-clockwise.
fn outline() -> impl Iterator<Item = Point3<f64>> {
    (0..POINTS).map(|k| {
        let angle = TAU * f64::from(k) / f64::from(POINTS);
        let radius = if k % 4 < 2 { 1.15 } else { 0.95 };
        Point3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
    })
}

/// Returns a gear of thickness 0.4: two fans around the axis, and the sides.
fn gear() -> Result<Mesh, lin_canny::MeshError> {
    let up = Vector3::new(0.0, 0.0, 0.4);
    let mut points: Vec<_> = outline().chain(outline().map(|p| p + up)).collect();
    points.extend([Point3::origin(), Point3::origin() + up]);
    let mut triangles = Vec::new();
    for k in 0..POINTS {
        let next = (k + 1) % POINTS;
        triangles.extend([[2 * POINTS, next, k], [2 * POINTS + 1, k + POINTS, next + POINTS]]);
        triangles.extend([[k, next, next + POINTS], [k, next + POINTS, k + POINTS]]);
    }
    Mesh::new(&points, &triangles)
}

/// Returns a closed line of a picture, seen obliquely from above.
fn line(points: impl Iterator<Item = Point3<f64>>, style: &str) -> String {
    let mut ends = String::new();
    for p in points {
        let (x, y) = (p.x + 0.15 * p.z, 0.6 * p.y + 0.8 * p.z);
        let _ = write!(ends, "{:.2},{:.2} ", 150.0 + 120.0 * x, 145.0 - 120.0 * y);
    }
    format!("<polygon points=\"{}\" style=\"{style}\"/>\n", ends.trim_end())
}

/// Returns a picture of a gear: its sides from the back to the front, and its top.
fn drawn(pose: &Isometry3<f64>, colour: &str) -> String {
    let up = Vector3::new(0.0, 0.0, 0.4);
    let corners: Vec<_> = outline().map(|p| pose * p).collect();
    let mut sides: Vec<_> = corners.iter().zip(corners.iter().cycle().skip(1)).collect();
    sides.sort_by(|a, b| (b.0.y + b.1.y).total_cmp(&(a.0.y + a.1.y)));
    let style = format!("fill:{colour};fill-opacity:.25;stroke:{colour};stroke-opacity:.6;stroke-width:.6");
    let side = |(p, q): (&Point3<f64>, &Point3<f64>)| line([*p, *q, q + up, p + up].into_iter(), &style);
    let sides: String = sides.into_iter().map(side).collect();
    let top = corners.iter().map(|p| p + up);
    sides + &line(top, &format!("fill:{colour};fill-opacity:.35;stroke:{colour}"))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let gear = gear()?;
    let mut pair = PairTracker::new();
    let mut picture = String::from("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"560\" height=\"240\">\n");
    for step in 0..6 {
        let turn = TAU / f64::from(TEETH) * f64::from(step) / 6.0;
        let pose = Isometry3::new(Vector3::new(2.12, 0.0, 0.1), Vector3::new(0.0, 0.0, turn));
        let relative = RelativePose::from_isometry(&pose)?;
        let found = pair.overlap(&gear, &gear, &relative)?;
        println!(
            "turned by {:4.1} degrees: volume {:.9} (bounds {:.1e} apart)",
            turn.to_degrees(),
            found.volume(),
            found.upper - found.lower
        );
        if step == 5 {
            let curves = pair.overlap_loops(&gear, &gear, &relative)?;
            println!("    {} curves, in the picture", curves.loops.len());
            picture += &drawn(&Isometry3::identity(), "#4477aa");
            picture += &drawn(&pose, "#ee6677");
            for curve in curves.loops {
                picture += &line(
                    curve.into_iter(),
                    "fill:#222;fill-opacity:.3;stroke:#222;stroke-width:2",
                );
            }
        }
    }
    picture += "</svg>\n";
    std::fs::create_dir_all("target")?;
    std::fs::write("target/overlap.svg", picture)?;
    println!("wrote target/overlap.svg");
    Ok(())
}
