//! Picture of each pair of kinds: 0.5 apart on and below the diagonal, 0.15 deep above it.
//!
//! Each pair is seen perpendicular to its normal, which points to the right. Outlines are computed
//! from bounding boxes of the shapes, rotated in steps.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

use lin_canny::nalgebra::{Isometry3, Rotation3, UnitQuaternion, Vector3};
use lin_canny::{BoxHint, Outcome, PairTracker, RelativePose, Shape};

const CELL: f64 = 118.0;
const MARGIN: f64 = 92.0;
const SIDES: usize = 96;

fn kinds() -> Result<Vec<(&'static str, Shape)>, lin_canny::ShapeError> {
    Ok(vec![
        ("ball", Shape::ball(0.7)?),
        ("capsule", Shape::capsule(0.6, 0.35)?),
        ("box", Shape::cuboid(Vector3::new(0.8, 0.5, 0.4))?),
        ("rounded box", Shape::cuboid(Vector3::new(0.6, 0.4, 0.3))?.rounded(0.2)?),
        ("cylinder", Shape::cylinder(0.6, 0.5)?),
        ("cone", Shape::cone(0.7, 0.6)?),
        ("ellipsoid", Shape::ellipsoid(Vector3::new(0.9, 0.6, 0.35))?),
    ])
}

/// Returns the pose of the second shape, moved along the normal until the signed distance is
/// `goal`.
fn placed(a: &Shape, b: &Shape, k: usize, goal: f64) -> Result<(Isometry3<f64>, Outcome), String> {
    let turn = UnitQuaternion::from_euler_angles(0.7 * k as f64, 0.4 + 0.3 * k as f64, 1.1 * k as f64);
    let mut pose = Isometry3::from_parts(Vector3::new(2.4, 1.2, 0.8).into(), turn);
    let mut tracker = PairTracker::new();
    let mut closest = |pose: &Isometry3<f64>| {
        let pose = RelativePose::from_isometry(pose).map_err(|e| e.to_string())?;
        Ok::<_, String>(tracker.closest(a, b, &pose))
    };
    let mut o = closest(&pose)?;
    for _ in 0..3 {
        pose.translation.vector -= *o.normal * (o.distance - goal);
        o = closest(&pose)?;
    }
    Ok((pose, o.outcome))
}

/// Returns the outline of a shape seen along z, from its support values.
fn outline(shape: &Shape, pose: &Isometry3<f64>) -> Vec<[f64; 2]> {
    let height = |k: usize| {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), -TAU * k as f64 / SIDES as f64);
        let turned = Isometry3::from_parts(Default::default(), turn.into()) * pose;
        shape.aabb_at(&turned, &mut BoxHint::default()).1.x
    };
    let heights: Vec<f64> = (0..SIDES).map(height).collect();
    let corner = |k: usize| {
        let (s, t) = (TAU * k as f64 / SIDES as f64, TAU * (k + 1) as f64 / SIDES as f64);
        let (h, g) = (heights[k], heights[(k + 1) % SIDES]);
        let area = (t - s).sin();
        [(h * t.sin() - g * s.sin()) / area, (g * s.cos() - h * t.cos()) / area]
    };
    (0..SIDES).map(corner).collect()
}

fn path(points: &[[f64; 2]], at: impl Fn([f64; 2]) -> [f64; 2]) -> String {
    let at = points.iter().map(|&p| at(p)).map(|[x, y]| format!("{x:.1},{y:.1}"));
    at.collect::<Vec<_>>().join(" ")
}

/// Draws one cell of the picture, centred at `middle`.
fn cell(svg: &mut String, (a, b): (&Shape, &Shape), pose: &Isometry3<f64>, o: &Outcome, middle: [f64; 2]) {
    let view = UnitQuaternion::rotation_between(&o.normal, &Vector3::x()).unwrap_or_default();
    let view = Isometry3::from_parts(Default::default(), view);
    let (p, q) = (view * o.point_on_a, view * pose * o.point_on_b);
    let centre = (p.coords + q.coords) / 2.0;
    let at = |[x, y]: [f64; 2]| [middle[0] + 28.0 * (x - centre.x), middle[1] - 28.0 * (y - centre.y)];
    for (shape, pose, class) in [(a, view, "a"), (b, view * pose, "b")] {
        let _ = writeln!(
            svg,
            r#"<polygon class="{class}" points="{}"/>"#,
            path(&outline(shape, &pose), at)
        );
    }
    let (p, q) = (at([p.x, p.y]), at([q.x, q.y]));
    let _ = writeln!(
        svg,
        r#"<path class="w" d="M{:.1} {:.1}L{:.1} {:.1}"/><circle cx="{:.1}" cy="{:.1}" r="2"/><circle cx="{:.1}" cy="{:.1}" r="2"/>"#,
        p[0], p[1], q[0], q[1], p[0], p[1], q[0], q[1]
    );
}

/// Draws all pairs, and prints a line for each.
pub(crate) fn all(out: &Path) -> Result<(), String> {
    let kinds = kinds().map_err(|e| e.to_string())?;
    let side = MARGIN + CELL * kinds.len() as f64;
    let mut svg = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {side} {side}" font-family="sans-serif" font-size="12">
<style>.a{{fill:#4477aa55;stroke:#4477aa}}.b{{fill:#ee667755;stroke:#ee6677}}.w{{stroke:#222;stroke-width:1.5}}text{{fill:#222}}</style>
<rect width="100%" height="100%" fill="white"/>
<text x="6" y="24">On and below the diagonal 0.5 apart, above it 0.15 deep; each pair is seen perpendicular to its normal, which runs to the right.</text>
"#
    );
    println!(
        "{:13} {:13} {:>22}  {:11} {:>9}  features",
        "A", "B", "signed distance", "state", "width"
    );
    for (i, (name_a, a)) in kinds.iter().enumerate() {
        let middle = |k: usize| MARGIN + CELL * (k as f64 + 0.5);
        let _ = writeln!(
            svg,
            r#"<text x="{:.0}" y="60" text-anchor="middle">{name_a}</text>"#,
            middle(i)
        );
        let _ = writeln!(svg, r#"<text x="6" y="{:.0}">{name_a}</text>"#, middle(i));
        for (k, (name_b, b)) in kinds.iter().enumerate() {
            let goal = if k <= i { 0.5 } else { -0.15 };
            let (pose, o) = placed(a, b, i + 2 * k, goal)?;
            cell(&mut svg, (a, b), &pose, &o, [middle(k), middle(i)]);
            println!(
                "{name_a:13} {name_b:13} {:22.16} {:12} {:9.1e}  {}",
                o.distance,
                o.state,
                o.upper - o.lower,
                o.features
            );
        }
    }
    svg += "</svg>\n";
    truth::command::write(out, &svg)?;
    println!("drawn in {}", out.display());
    Ok(())
}
