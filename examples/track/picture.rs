//! Picture of a run: both bodies in the closest frame with their closest features, above the curves
//! of distance and steps.

use std::path::Path;

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{ConvexPolyhedron, Feature, Outcome};
use lin_canny_record::svg::{BLUE, GREEN, GREY, INK, ORANGE, SKY, Svg};

/// Width of the picture in pixels.
const WIDTH: f64 = 860.0;

/// Height of the view of the bodies.
const VIEW: f64 = 520.0;

/// Height of a chart.
const CHART: f64 = 150.0;

/// Direction to the light, in the axes of the view: right, up, towards the reader.
const LIGHT: [f64; 3] = [-0.3, 0.6, 0.74];

/// The two bodies, their world poses and the outcome in the shown frame.
pub(crate) struct Shown<'a> {
    pub(crate) bodies: [&'a ConvexPolyhedron; 2],
    pub(crate) poses: &'a [Isometry3<f64>; 2],
    pub(crate) outcome: &'a Outcome,
    pub(crate) title: String,
}

/// A series of numbers over the frames, and its name.
pub(crate) struct Curve {
    pub(crate) name: &'static str,
    /// Frame and value.
    pub(crate) points: Vec<(usize, f64)>,
}

/// Writes the picture.
///
/// # Errors
/// Returns an error if the file cannot be written.
pub(crate) fn draw(shown: &Shown<'_>, curves: &[Curve], file: &Path) -> Result<(), String> {
    let height = VIEW + CHART * curves.len() as f64;
    let mut svg = Svg::new(WIDTH as u32, height as u32, &shown.title);
    svg.words([20.0, 30.0], 16, "start", &shown.title);
    bodies(&mut svg, shown);
    for (k, curve) in curves.iter().enumerate() {
        chart(&mut svg, VIEW + CHART * k as f64, curve);
    }
    truth::command::write(file, &svg.finish())
}

/// Draws both bodies seen perpendicular to the normal, so that the gap between them has its full
/// width.
fn bodies(svg: &mut Svg, shown: &Shown<'_>) {
    let normal = shown.poses[0] * shown.outcome.normal.into_inner();
    let up = normal.cross(&least_axis(&normal)).normalize();
    let axes = [normal, up, normal.cross(&up)];
    let seen = |p: Point3<f64>| axes.map(|axis| axis.dot(&p.coords));
    let corners: Vec<[f64; 3]> = (0..2)
        .flat_map(|k| shown.bodies[k].vertex_points().map(move |p| shown.poses[k] * p))
        .map(seen)
        .collect();
    let span = |k: usize| {
        let (lo, hi) = corners.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), c| {
            (lo.min(c[k]), hi.max(c[k]))
        });
        ((lo + hi) / 2.0, hi - lo)
    };
    let [(x, wide), (y, tall)] = [span(0), span(1)];
    let scale = ((WIDTH - 60.0) / wide).min((VIEW - 80.0) / tall);
    let place = |c: [f64; 3]| [WIDTH / 2.0 + scale * (c[0] - x), VIEW / 2.0 + 15.0 - scale * (c[1] - y)];
    let features = [shown.outcome.features.a, shown.outcome.features.b];
    for (k, colour) in [(0, [0.34, 0.71, 0.91]), (1, [0.91, 0.70, 0.45])] {
        let (body, pose) = (shown.bodies[k], &shown.poses[k]);
        let path =
            |points: &mut dyn Iterator<Item = Point3<f64>>| points.map(|p| place(seen(pose * p))).collect::<Vec<_>>();
        for face in body.faces() {
            let Some((normal, _)) = body.face_plane(face) else {
                continue;
            };
            let plane = axes.map(|axis| axis.dot(&(pose * normal.into_inner())));
            if plane[2] > 0.0 {
                let light = 0.55 + 0.45 * plane.iter().zip(LIGHT).map(|(a, b)| a * b).sum::<f64>().max(0.0);
                let [r, g, b] = colour.map(|c| (255.0 * light * c) as u8);
                let fill = format!(
                    "fill=\"rgb({r},{g},{b})\" stroke=\"{INK}\" stroke-width=\"0.6\" stroke-linejoin=\"round\""
                );
                svg.polygon(
                    &path(&mut body.face_vertices(face).filter_map(|v| body.vertex(v))),
                    &fill,
                );
            }
        }
        let lit = format!("stroke=\"{ORANGE}\" stroke-width=\"3\" fill=\"none\" stroke-linejoin=\"round\"");
        match features[k] {
            Feature::Vertex(_) => {}
            Feature::Edge(e) => {
                let ends = body.edge_vertices(e).into_iter().flatten();
                svg.polyline(
                    &path(&mut ends.filter_map(|v| body.vertex(v))),
                    &format!("stroke=\"{ORANGE}\" stroke-width=\"3\""),
                );
            }
            Feature::Face(f) => svg.polygon(&path(&mut body.face_vertices(f).filter_map(|v| body.vertex(v))), &lit),
        }
    }
    let ends = [
        shown.poses[0] * shown.outcome.point_on_a,
        shown.poses[1] * shown.outcome.point_on_b,
    ]
    .map(|p| place(seen(p)));
    svg.line(ends[0], ends[1], &format!("stroke=\"{GREEN}\" stroke-width=\"2\""));
    for end in ends {
        svg.dot(end, 4.0, &format!("fill=\"{GREEN}\""));
    }
    let words = "A blue, B orange; the closest features are outlined, the closest points joined; seen at right angles to the gap";
    svg.words([20.0, VIEW - 12.0], 13, "start", words);
}

/// Returns the axis of the world along which a direction has its least component.
fn least_axis(n: &Vector3<f64>) -> Vector3<f64> {
    let mut axis = Vector3::zeros();
    axis[n.iamin()] = 1.0;
    axis
}

/// Draws one curve from zero, with its largest value and the number of frames at its axes.
fn chart(svg: &mut Svg, top: f64, curve: &Curve) {
    let [left, right, base, roof] = [70.0, WIDTH - 20.0, top + CHART - 28.0, top + 24.0];
    let frames = curve.points.last().map_or(0, |p| p.0);
    let most = curve.points.iter().fold(0.0_f64, |m, p| m.max(p.1));
    let place = |&(frame, value): &(usize, f64)| {
        let along = frame as f64 / frames.max(1) as f64;
        [
            left + (right - left) * along,
            base - (base - roof) * value.max(0.0) / most.max(f64::MIN_POSITIVE),
        ]
    };
    let line = format!("stroke=\"{GREY}\" stroke-width=\"1\"");
    svg.line([left, base], [right, base], &line);
    svg.line([left, roof], [right, roof], &format!("{line} stroke-dasharray=\"2 4\""));
    svg.polyline(
        &curve.points.iter().map(place).collect::<Vec<_>>(),
        &format!("stroke=\"{BLUE}\" stroke-width=\"1.5\""),
    );
    svg.words([left, roof - 8.0], 13, "start", curve.name);
    svg.words([left - 6.0, roof + 4.0], 12, "end", &format!("{most:.3}"));
    svg.words([left - 6.0, base + 4.0], 12, "end", "0");
    svg.words([right, base + 18.0], 12, "end", &format!("frame {frames}"));
    svg.rect([left, base - 1.0], [right - left, 1.0], &format!("fill=\"{SKY}\""));
}
