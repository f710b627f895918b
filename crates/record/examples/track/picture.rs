//! Picture of a run: both bodies in the closest frame with their closest features, above the curves
//! of distance and steps.

use std::path::Path;

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{ConvexPolyhedron, Feature, Mesh, MeshKind};
use lin_canny_record::svg::{BLUE, GREEN, GREY, INK, ORANGE, SKY, Svg};

/// Width of the picture in pixels.
const WIDTH: f64 = 860.0;

/// Height of the view of the bodies.
const VIEW: f64 = 520.0;

/// Height of a chart.
const CHART: f64 = 150.0;

/// Direction to the light, in the axes of the view: right, up, towards the reader.
const LIGHT: [f64; 3] = [-0.3, 0.6, 0.74];

/// Triangles of a mesh above which its hull is drawn.
const MOST: usize = 20_000;

/// A body in the world.
pub(crate) struct Drawn {
    faces: Vec<Vec<Point3<f64>>>,
    /// Vertices of the closest edge or face.
    closest: Vec<Point3<f64>>,
    /// Whether faces that face away are hidden.
    is_closed: bool,
}

impl Drawn {
    /// Returns a convex body with its closest feature.
    pub(crate) fn convex(body: &ConvexPolyhedron, pose: &Isometry3<f64>, closest: Feature) -> Self {
        let ends = match closest {
            Feature::Vertex(_) => vec![],
            Feature::Edge(e) => body.edge_vertices(e).into_iter().flatten().collect(),
            Feature::Face(f) => body.face_vertices(f).collect(),
        };
        let points = |vertices: Vec<_>| {
            vertices
                .into_iter()
                .filter_map(|v| Some(pose * body.vertex(v)?))
                .collect()
        };
        let faces = body.faces().filter(|&f| body.face_plane(f).is_some());
        Self {
            faces: faces.map(|f| points(body.face_vertices(f).collect())).collect(),
            closest: points(ends),
            is_closed: true,
        }
    }

    /// Returns a mesh, or its hull if it has too many triangles to draw.
    pub(crate) fn mesh(mesh: &Mesh, pose: &Isometry3<f64>) -> Self {
        let hull = (mesh.triangle_count() > MOST).then(|| mesh.hull().ok()).flatten();
        if let Some(hull) =
            hull.and_then(|hull| Some(Self::convex(&hull, pose, Feature::Vertex(hull.vertices().next()?))))
        {
            return hull;
        }
        Self {
            faces: mesh
                .triangles()
                .map(|(_, corners)| corners.map(|p| pose * p).to_vec())
                .collect(),
            closest: vec![],
            is_closed: mesh.kind() == MeshKind::Solid,
        }
    }
}

/// The two bodies in the shown frame, and their closest points in the world.
pub(crate) struct Shown {
    pub(crate) bodies: [Drawn; 2],
    /// Direction from A to B.
    pub(crate) normal: Vector3<f64>,
    pub(crate) points: [Point3<f64>; 2],
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
pub(crate) fn draw(shown: &Shown, curves: &[Curve], file: &Path) -> Result<(), String> {
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
fn bodies(svg: &mut Svg, shown: &Shown) {
    // Bodies that overlap may have no normal.
    let normal = shown.normal.try_normalize(0.5).unwrap_or_else(Vector3::x);
    let up = normal.cross(&least_axis(&normal)).normalize();
    let axes = [normal, up, normal.cross(&up)];
    let seen = |p: Point3<f64>| axes.map(|axis| axis.dot(&p.coords));
    let corners: Vec<[f64; 3]> = shown
        .bodies
        .iter()
        .flat_map(|body| body.faces.iter().flatten())
        .map(|p| seen(*p))
        .collect();
    let span = |k: usize| {
        let (lo, hi) = corners.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), c| {
            (lo.min(c[k]), hi.max(c[k]))
        });
        ((lo + hi) / 2.0, hi - lo)
    };
    let [(x, wide), (y, tall)] = [span(0), span(1)];
    let scale = ((WIDTH - 60.0) / wide).min((VIEW - 80.0) / tall);
    let place = |p: Point3<f64>| {
        let c = seen(p);
        [WIDTH / 2.0 + scale * (c[0] - x), VIEW / 2.0 + 15.0 - scale * (c[1] - y)]
    };
    // From back to front.
    let mut faces = vec![];
    for (body, colour) in shown.bodies.iter().zip([[0.34, 0.71, 0.91], [0.91, 0.70, 0.45]]) {
        for face in &body.faces {
            let Some(mut facing) = facing(face).map(|normal| axes.map(|axis| axis.dot(&normal))) else {
                continue;
            };
            if facing[2] <= 0.0 && body.is_closed {
                continue;
            }
            if facing[2] < 0.0 {
                facing = facing.map(|x| -x);
            }
            let depth = face.iter().map(|p| seen(*p)[2]).sum::<f64>() / face.len() as f64;
            let light = 0.55 + 0.45 * facing.iter().zip(LIGHT).map(|(a, b)| a * b).sum::<f64>().max(0.0);
            faces.push((depth, face, colour.map(|c| (255.0 * light * c) as u8)));
        }
    }
    faces.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, face, [r, g, b]) in faces {
        let fill = format!("fill=\"rgb({r},{g},{b})\" stroke=\"{INK}\" stroke-width=\"0.6\" stroke-linejoin=\"round\"");
        svg.polygon(&face.iter().map(|p| place(*p)).collect::<Vec<_>>(), &fill);
    }
    for body in &shown.bodies {
        let rim: Vec<_> = body.closest.iter().map(|p| place(*p)).collect();
        match rim.len() {
            0 => {}
            2 => svg.polyline(&rim, &format!("stroke=\"{ORANGE}\" stroke-width=\"3\"")),
            _ => svg.polygon(
                &rim,
                &format!("stroke=\"{ORANGE}\" stroke-width=\"3\" fill=\"none\" stroke-linejoin=\"round\""),
            ),
        }
    }
    let ends = shown.points.map(place);
    svg.line(ends[0], ends[1], &format!("stroke=\"{GREEN}\" stroke-width=\"2\""));
    for end in ends {
        svg.dot(end, 4.0, &format!("fill=\"{GREEN}\""));
    }
    let words = if shown.bodies.iter().all(|body| body.closest.is_empty()) {
        "A blue, B orange; the closest points are joined; seen at right angles to the gap"
    } else {
        "A blue, B orange; the closest features are outlined, the closest points joined; seen at right angles to the gap"
    };
    svg.words([20.0, VIEW - 12.0], 13, "start", words);
}

/// Returns the normal of a face, if the face has an area.
fn facing(face: &[Point3<f64>]) -> Option<Vector3<f64>> {
    let next = face.iter().cycle().skip(1);
    let area: Vector3<f64> = face
        .iter()
        .zip(next)
        .map(|(p, q)| (p - face[0]).cross(&(q - face[0])))
        .sum();
    area.try_normalize(0.0)
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
