//! Picture of each pair of kinds: 0.5 apart on and below the diagonal, 0.15 deep above it.
//!
//! Each pair is seen perpendicular to its normal, which points to the right. Outlines are computed
//! from bounding boxes of the shapes, rotated in steps.

use std::f64::consts::TAU;
use std::path::Path;

use lin_canny::nalgebra::{Isometry3, Rotation3, UnitQuaternion, Vector3};
use lin_canny::shape::curved_kinds;
use lin_canny::{BoxHint, Outcome, PairTracker, RelativePose, Shape};
use lin_canny_record::svg::{Place, Svg};

const CELL: f64 = 118.0;
const MARGIN: f64 = 92.0;
const SIDES: usize = 96;

fn kinds() -> Result<Vec<(&'static str, Shape)>, lin_canny::ShapeError> {
    let mut all = vec![
        ("ball", Shape::ball(0.7)?),
        ("capsule", Shape::capsule(0.6, 0.35)?),
        ("box", Shape::cuboid(Vector3::new(0.8, 0.5, 0.4))?),
        ("rounded box", Shape::cuboid(Vector3::new(0.6, 0.4, 0.3))?.rounded(0.2)?),
    ];
    all.extend(curved_kinds(Vector3::new(0.55, 0.4, 0.7)));
    Ok(all)
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

/// Draws one cell of the picture, centred at `middle`.
fn cell(svg: &mut Svg, (a, b): (&Shape, &Shape), pose: &Isometry3<f64>, o: &Outcome, middle: [f64; 2]) {
    let view = UnitQuaternion::rotation_between(&o.normal, &Vector3::x()).unwrap_or_default();
    let view = Isometry3::from_parts(Default::default(), view);
    let (p, q) = (view * o.point_on_a, view * pose * o.point_on_b);
    let centre = (p.coords + q.coords) / 2.0;
    let at = |[x, y]: [f64; 2]| [middle[0] + 28.0 * (x - centre.x), middle[1] - 28.0 * (y - centre.y)];
    for (shape, pose, class) in [(a, view, "a"), (b, view * pose, "b")] {
        let outline: Vec<Place> = outline(shape, &pose).into_iter().map(at).collect();
        svg.polygon(&outline, &format!("class=\"{class}\""));
    }
    let ends = [p, q].map(|p| at([p.x, p.y]));
    svg.line(ends[0], ends[1], "class=\"w\"");
    for end in ends {
        svg.dot(end, 2.0, "");
    }
}

/// Draws all pairs, and prints a line for each.
pub(crate) fn all(out: &Path) -> Result<(), String> {
    let kinds = kinds().map_err(|e| e.to_string())?;
    let side = MARGIN + CELL * kinds.len() as f64;
    let title = "On and below the diagonal 0.5 apart, above it 0.15 deep; each pair is seen perpendicular to its normal, which runs to the right.";
    let mut svg = Svg::new(side as u32, side as u32, title);
    svg.style(".a{fill:#4477aa55;stroke:#4477aa}.b{fill:#ee667755;stroke:#ee6677}.w{stroke:#222;stroke-width:1.5}");
    svg.words([6.0, 24.0], 12, "start", title);
    println!(
        "{:13} {:13} {:>22}  {:11} {:>9}  features",
        "A", "B", "signed distance", "state", "width"
    );
    for (i, (name_a, a)) in kinds.iter().enumerate() {
        let middle = |k: usize| MARGIN + CELL * (k as f64 + 0.5);
        svg.words([middle(i), 60.0], 12, "middle", name_a);
        svg.words([6.0, middle(i)], 12, "start", name_a);
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
    truth::command::write(out, &svg.finish())?;
    println!("drawn in {}", out.display());
    Ok(())
}
