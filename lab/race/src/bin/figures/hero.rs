//! Draws the first picture of the README: a tracked pair with a Voronoi region, and the cost per
//! frame.

use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{ContactState, ConvexPolyhedron, FaceId, Feature, Outcome, RelativePose, Tracker};
use race::plot::Chart;
use truth::motion::orbit_and_spin;
use truth::rng::Rng;

use crate::Trouble;
use lin_canny_record::svg::{BLUE, GREEN, INK, ORANGE, Place, Svg};

/// Frames of the motion on the left; the last one is drawn.
const FRAMES: usize = 90;

/// Axes of the view: right, up, and towards the eye.
struct Camera {
    axes: [Vector3<f64>; 3],
    scale: f64,
    centre: Place,
}

impl Camera {
    fn new(towards: Vector3<f64>, scale: f64, centre: Place) -> Self {
        let towards = towards.normalize();
        let right = Vector3::z().cross(&towards).normalize();
        Self {
            axes: [right, towards.cross(&right), towards],
            scale,
            centre,
        }
    }

    fn see(&self, p: &Point3<f64>) -> Place {
        let [x, y] = [0, 1].map(|k| self.axes[k].dot(&p.coords) * self.scale);
        [self.centre[0] + x, self.centre[1] - y]
    }
}

/// A body at its pose.
struct Stage<'a> {
    camera: &'a Camera,
    body: &'a ConvexPolyhedron,
    pose: Isometry3<f64>,
}

impl Stage<'_> {
    fn rim(&self, face: FaceId) -> Vec<Place> {
        let vertices = self.body.face_vertices(face).filter_map(|v| self.body.vertex(v));
        vertices.map(|p| self.camera.see(&(self.pose * p))).collect()
    }

    fn towards_eye(&self, face: FaceId) -> f64 {
        let normal = self
            .body
            .face_plane(face)
            .map_or(Vector3::zeros(), |p| p.0.into_inner());
        (self.pose.rotation * normal).dot(&self.camera.axes[2])
    }

    /// Draws the faces that face the eye, lit from there.
    fn draw(&self, svg: &mut Svg, rgb: [f64; 3]) {
        for f in self.body.faces().filter(|&f| self.towards_eye(f) > 0.0) {
            let light = 0.55 + 0.45 * self.towards_eye(f);
            let [r, g, b] = rgb.map(|c| (c * light) as u8);
            let style =
                format!("fill=\"rgb({r},{g},{b})\" stroke=\"#ffffff\" stroke-width=\"1\" stroke-linejoin=\"round\"");
            svg.polygon(&self.rim(f), &style);
        }
    }

    fn mark(&self, svg: &mut Svg, feature: Feature, colour: &str, opacity: f64) {
        match feature {
            Feature::Vertex(v) => {
                let at = self.body.vertex(v).map(|p| self.camera.see(&(self.pose * p)));
                svg.dot(
                    at.unwrap_or_default(),
                    5.0,
                    &format!("fill=\"{colour}\" fill-opacity=\"{opacity:.2}\""),
                );
            }
            Feature::Edge(e) => {
                let ends = self
                    .body
                    .edge_vertices(e)
                    .into_iter()
                    .flatten()
                    .filter_map(|v| self.body.vertex(v));
                let ends: Vec<Place> = ends.map(|p| self.camera.see(&(self.pose * p))).collect();
                let style = format!(
                    "stroke=\"{colour}\" stroke-opacity=\"{opacity:.2}\" stroke-width=\"4\" stroke-linecap=\"round\""
                );
                svg.polyline(&ends, &style);
            }
            Feature::Face(f) => {
                svg.polygon(
                    &self.rim(f),
                    &format!("fill=\"{colour}\" fill-opacity=\"{:.2}\"", 0.8 * opacity),
                );
            }
        }
    }

    /// Draws the Voronoi region of a face: the prism over it, up to `height`.
    fn region(&self, svg: &mut Svg, face: FaceId, height: f64) {
        let normal = self
            .body
            .face_plane(face)
            .map_or(Vector3::zeros(), |p| p.0.into_inner());
        let corners: Vec<Point3<f64>> = self
            .body
            .face_vertices(face)
            .filter_map(|v| self.body.vertex(v))
            .collect();
        let at = |p: &Point3<f64>, h: f64| self.camera.see(&(self.pose * (p + normal * h)));
        let dashed = format!("stroke=\"{BLUE}\" stroke-width=\"1\" stroke-dasharray=\"4 3\" stroke-opacity=\"0.7\"");
        for (p, q) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            let side = [at(p, 0.0), at(q, 0.0), at(q, height), at(p, height)];
            svg.polygon(&side, &format!("fill=\"{BLUE}\" fill-opacity=\"0.07\""));
            svg.line(at(p, 0.0), at(p, height), &dashed);
        }
    }
}

/// Moves B down onto a face of A while it rotates, and tracks the pair.
fn motion(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    pose_a: &Isometry3<f64>,
) -> Result<(Vec<Outcome>, Isometry3<f64>), Trouble> {
    let (mut tracker, mut seen, mut pose) = (Tracker::new(), Vec::new(), Isometry3::identity());
    for k in 0..FRAMES {
        let left = 1.0 - k as f64 / (FRAMES - 1) as f64;
        let turn = UnitQuaternion::from_euler_angles(0.35 + 0.9 * left, 0.5 - 0.7 * left, 0.3 + 0.8 * left);
        let place = Vector3::new(0.14 + 1.25 * left, -0.12 + 1.5 * left, 1.92 - 0.9 * left * left);
        pose = Isometry3::from_parts(place.into(), turn);
        seen.push(tracker.closest(a, b, &RelativePose::new(pose_a, &pose)?));
    }
    Ok((seen, pose))
}

fn scene(svg: &mut Svg) -> Result<(), Trouble> {
    let camera = Camera::new(Vector3::new(1.0, -1.7, 0.8), 92.0, [208.0, 262.0]);
    let a = solids::dodecahedron(1.25)?;
    let b = solids::octahedron(0.8)?;
    // The dodecahedron lies on a face.
    let (normal, _) = a
        .faces()
        .find_map(|f| a.face_plane(f))
        .ok_or("a dodecahedron has faces")?;
    let lay = UnitQuaternion::rotation_between(&normal, &-Vector3::z_axis()).unwrap_or_default();
    let pose_a = Isometry3::from_parts(Default::default(), lay);
    let (seen, pose_b) = motion(&a, &b, &pose_a)?;
    let last = seen.last().ok_or("a motion has frames")?;
    let [lower, upper] = [(&a, pose_a), (&b, pose_b)].map(|(body, pose)| Stage {
        camera: &camera,
        body,
        pose,
    });
    lower.draw(svg, [190.0, 205.0, 220.0]);
    // The features of A that were closest during the motion, older ones fainter.
    let mut trail: Vec<Feature> = seen.iter().map(|o| o.features.a).collect();
    trail.dedup();
    for (k, feature) in trail.iter().enumerate() {
        lower.mark(svg, *feature, ORANGE, 0.25 + 0.65 * (k + 1) as f64 / trail.len() as f64);
    }
    if let Feature::Face(f) = last.features.a {
        lower.region(svg, f, 0.75);
    }
    upper.draw(svg, [150.0, 210.0, 185.0]);
    upper.mark(svg, last.features.b, GREEN, 1.0);
    let way: Vec<Place> = seen.iter().map(|o| camera.see(&(pose_a * o.point_on_a))).collect();
    svg.polyline(
        &way,
        &format!("stroke=\"{INK}\" stroke-width=\"1.5\" stroke-dasharray=\"2 3\""),
    );
    let (p, q) = (
        camera.see(&(pose_a * last.point_on_a)),
        camera.see(&(pose_b * last.point_on_b)),
    );
    svg.line(p, q, &format!("stroke=\"{INK}\" stroke-width=\"2.5\""));
    svg.dot(p, 3.5, &format!("fill=\"{INK}\""));
    svg.words([20.0, 30.0], 17, "start", "the closest features are tracked");
    let steps: u32 = seen.iter().map(|o| o.work.steps).sum();
    let reported = format!(
        "{} frames, {} features of A met, {steps} looks in all",
        seen.len(),
        trail.len()
    );
    svg.words([20.0, 396.0], 13, "start", &reported);
    svg.words(
        [20.0, 414.0],
        13,
        "start",
        &format!(
            "{}: distance {:.6} +- {:.0e}",
            last.features,
            last.distance,
            (last.upper - last.lower) / 2.0
        ),
    );
    Ok(())
}

/// Returns the mean number of walk steps per frame of two hulls that orbit and spin.
fn looks(n: usize, degrees: f64) -> Result<f64, Trouble> {
    let hull = |seed| solids::random_hull(n, Vector3::new(1.0, 1.0, 1.0), seed);
    let (a, b) = (hull(1)?, hull(2)?);
    let mut tracker = Tracker::new();
    for f in orbit_and_spin(&mut Rng::new(5), 3000, degrees, (1.0, 1.0), (0.05, 0.4), 300) {
        let o = tracker.closest(&a, &b, &RelativePose::new(&f.a.isometry(), &f.b.isometry())?);
        assert_eq!(o.state, ContactState::Separated);
    }
    Ok(tracker.work().steps as f64 / tracker.work().queries as f64)
}

fn cost() -> Result<String, Trouble> {
    let degrees = [0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 90.0];
    let mut chart = Chart::new("feature pairs looked at in a frame")
        .axes("degrees that B orbits and spins a frame", "looks a frame")
        .log_x()
        .log_y()
        .legend_low()
        .size(440, 400);
    for n in [20, 200, 2000] {
        let curve: Result<Vec<_>, Trouble> = degrees.iter().map(|&d| Ok((d, looks(n, d)?))).collect();
        chart = chart.curve(format!("{n} vertices"), curve?);
    }
    Ok(chart.svg()?)
}

pub(crate) fn picture() -> Result<String, Trouble> {
    let mut svg = Svg::new(
        880,
        430,
        "Two polyhedra with their closest features, and the cost of a frame",
    );
    scene(&mut svg)?;
    svg.inset([430.0, 15.0], &cost()?);
    Ok(svg.finish())
}
