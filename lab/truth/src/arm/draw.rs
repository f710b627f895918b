//! Picture of a scene in three dimensions: convex bodies, drawn from back to front.

use std::fmt::Write as _;

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{ConvexPolyhedron, Geometry, PairTracker, RelativePose, Tracker};

use super::Trouble;

/// Width and height of the picture, and the height of the caption.
const SIZE: [f64; 2] = [860.0, 520.0];
const CAPTION: f64 = 36.0;

/// Opacity of an obstacle in front of the robot.
const GLASS: f64 = 0.12;

/// Steps of an outline from pole to pole.
const LATITUDES: u32 = 18;

/// Length of a line of sight from a point of a cloud.
const FAR: f64 = 10.0;

/// Directions to the viewer and to the light, not of unit length.
const VIEWER: Vector3<f64> = Vector3::new(1.0, -0.75, 0.62);
const LIGHT: Vector3<f64> = Vector3::new(0.5, -0.9, 1.6);

/// Bodies at their poses, and two points to connect.
pub struct Picture<'a> {
    /// Text above the picture.
    pub caption: String,
    /// Shapes, with whether each belongs to the robot.
    pub bodies: Vec<(&'a ConvexPolyhedron, bool)>,
    /// Poses of the shapes, in the same order.
    pub poses: Vec<Isometry3<f64>>,
    /// Points joined by a red line.
    pub points: [Point3<f64>; 2],
    /// Points of a cloud, which bodies in front of them hide.
    pub cloud: Vec<Point3<f64>>,
}

/// Returns the hull of the points of a convex geometry closest to far points all around, for
/// pictures only.
pub fn outline(geometry: &Geometry) -> Result<ConvexPolyhedron, Trouble> {
    if let Some(body) = geometry.as_polyhedron() {
        return Ok(body.clone());
    }
    let (centre, radius) = geometry.bounding_ball();
    let (eye, mut tracker) = (ConvexPolyhedron::point(Point3::origin())?, PairTracker::new());
    let mut points = vec![];
    for k in 0..=LATITUDES {
        let height = std::f64::consts::PI * f64::from(k) / f64::from(LATITUDES);
        for j in 0..2 * LATITUDES {
            let turn = std::f64::consts::PI * f64::from(j) / f64::from(LATITUDES);
            let way = Vector3::new(height.sin() * turn.cos(), height.sin() * turn.sin(), height.cos());
            let from = RelativePose::from_isometry(&Isometry3::from(centre + way * (100.0 * radius)))?;
            points.push(tracker.closest(geometry, &eye, &from).point_on_a);
        }
    }
    Ok(ConvexPolyhedron::from_points(&points)?)
}

/// A parallel projection: axes to the right and up in the picture, and towards the viewer.
struct View {
    right: Vector3<f64>,
    up: Vector3<f64>,
    near: Vector3<f64>,
    /// Pixels per unit, and the position of the origin.
    scale: f64,
    origin: [f64; 2],
}

impl View {
    /// Returns the view in which all points fill the picture.
    fn of(points: &[Point3<f64>]) -> Self {
        let near = VIEWER.normalize();
        let right = Vector3::z().cross(&near).normalize();
        let up = near.cross(&right);
        let span = |axis: &Vector3<f64>| {
            let along = points.iter().map(|p| p.coords.dot(axis));
            along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
        };
        let ((left, end), (low, high)) = (span(&right), span(&up));
        let room = [SIZE[0] - 40.0, SIZE[1] - CAPTION - 20.0];
        let scale = (room[0] / (end - left)).min(room[1] / (high - low));
        let middle = [0.5 * (left + end), 0.5 * (low + high)];
        let origin = [
            0.5 * SIZE[0] - scale * middle[0],
            CAPTION + 0.5 * room[1] + scale * middle[1],
        ];
        Self {
            right,
            up,
            near,
            scale,
            origin,
        }
    }

    fn place(&self, p: &Point3<f64>) -> [f64; 2] {
        [
            self.origin[0] + self.scale * p.coords.dot(&self.right),
            self.origin[1] - self.scale * p.coords.dot(&self.up),
        ]
    }
}

impl Picture<'_> {
    /// Returns the picture above a chart, which is a separate SVG.
    pub fn above(&self, chart: &str) -> String {
        let size = |word: &str| {
            let value = chart.split_once(word).and_then(|(_, rest)| rest.split('"').nth(1));
            value.and_then(|v| v.parse::<f64>().ok()).unwrap_or(SIZE[0])
        };
        let mut svg = self.begun([SIZE[0].max(size("width=")), SIZE[1] + size("height=")]);
        // Inside another picture, the size of the chart comes from its attributes: its style is for
        // pages.
        let chart = chart.replacen("height:auto", "", 1).replacen("max-width:100%;", "", 1);
        let chart = chart.replacen("<svg ", &format!("<svg y=\"{}\" ", SIZE[1]), 1);
        let _ = writeln!(svg, "{chart}\n</svg>");
        svg
    }

    /// Returns the picture alone.
    pub fn alone(&self) -> String {
        self.begun(SIZE) + "</svg>\n"
    }

    /// Returns an SVG with the picture at its top, without the closing tag.
    fn begun(&self, [width, height]: [f64; 2]) -> String {
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             font-family=\"sans-serif\" role=\"img\">\n<title>{0}</title>\n<rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n\
             <text x=\"20\" y=\"24\" font-size=\"17\">{0}</text>\n",
            escaped(&self.caption)
        );
        self.draw(&mut svg);
        svg
    }

    fn draw(&self, svg: &mut String) {
        let placed = self.bodies.iter().zip(&self.poses);
        let corners = placed.flat_map(|((shape, _), pose)| shape.vertex_points().map(move |p| pose * p));
        let view = View::of(&corners.chain(self.cloud.iter().copied()).collect::<Vec<_>>());
        for k in self.order(&view) {
            let opacity = if self.hides_robot(k, &view) { GLASS } else { 1.0 };
            self.draw_body(k, opacity, &view, svg);
        }
        self.draw_cloud(&view, svg);
        let [p, q] = self.points.map(|p| view.place(&p));
        let _ = writeln!(
            svg,
            "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"#c00\" stroke-width=\"3\"/>",
            p[0], p[1], q[0], q[1]
        );
        for [x, y] in [p, q] {
            let _ = writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4.5\" fill=\"#c00\"/>");
        }
    }

    fn draw_cloud(&self, view: &View, svg: &mut String) {
        let seen = self.cloud.iter().filter(|p| !self.is_hidden(p, view));
        let dots = seen.map(|p| view.place(p)).map(|[x, y]| format!("M{x:.1} {y:.1}h0"));
        let dots: String = dots.collect();
        if !dots.is_empty() {
            let _ = writeln!(
                svg,
                "<path d=\"{dots}\" stroke=\"#17805b\" stroke-opacity=\"0.6\" stroke-width=\"1.9\" stroke-linecap=\"round\"/>"
            );
        }
    }

    /// Returns whether a body is between a point and the viewer.
    fn is_hidden(&self, p: &Point3<f64>, view: &View) -> bool {
        let Ok(sight) = ConvexPolyhedron::segment(*p, p + view.near * FAR) else {
            return false;
        };
        let mut bodies = self.bodies.iter().zip(&self.poses);
        bodies.any(|((shape, _), pose)| {
            let pose = RelativePose::new_normalized(&Isometry3::identity(), pose);
            pose.is_ok_and(|pose| Tracker::new().intersects(&sight, shape, &pose))
        })
    }

    /// Returns whether an obstacle is between a body of the robot and the viewer.
    fn hides_robot(&self, k: usize, view: &View) -> bool {
        let robot = |&j: &usize| self.bodies[j].1;
        !self.bodies[k].1
            && (0..self.bodies.len())
                .filter(robot)
                .any(|j| self.may_hide(k, j, view) && self.is_behind(j, k, view))
    }

    /// Returns whether the first of two bodies is behind the other, by the normal of their distance
    /// or depth.
    fn is_behind(&self, i: usize, j: usize, view: &View) -> bool {
        let Ok(pose) = RelativePose::new(&self.poses[i], &self.poses[j]) else {
            return false;
        };
        let found = Tracker::new().closest(self.bodies[i].0, self.bodies[j].0, &pose);
        (self.poses[i] * found.normal.into_inner()).dot(&view.near) > 0.0
    }

    /// Draws the faces that face the viewer.
    fn draw_body(&self, k: usize, opacity: f64, view: &View, svg: &mut String) {
        let ((shape, is_of_robot), pose) = (self.bodies[k], &self.poses[k]);
        let hue = if is_of_robot { 205 } else { 35 };
        let light = LIGHT.normalize();
        for face in shape.faces() {
            let Some((normal, _)) = shape.face_plane(face) else {
                continue;
            };
            let normal = pose * normal.into_inner();
            if normal.dot(&view.near) <= 0.0 {
                continue;
            }
            let rim = shape.face_vertices(face).filter_map(|v| shape.vertex(v));
            let path = rim.map(|p| view.place(&(pose * p)));
            let path: Vec<_> = path.map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
            let tone = 62.0 + 22.0 * normal.dot(&light);
            let edge = tone - 14.0;
            let glass = if opacity < 1.0 {
                format!(" fill-opacity=\"{opacity}\"")
            } else {
                String::new()
            };
            let _ = writeln!(
                svg,
                "<polygon points=\"{}\" fill=\"hsl({hue},50%,{tone:.0}%)\" stroke=\"hsl({hue},45%,{edge:.0}%)\" stroke-width=\"0.6\"{glass}/>",
                path.join(" ")
            );
        }
    }

    /// Returns the bodies from back to front. If bodies hide each other in a cycle, the one with
    /// the farthest centre comes first.
    fn order(&self, view: &View) -> Vec<usize> {
        let depth = |k: usize| (self.poses[k] * self.bodies[k].0.centroid()).coords.dot(&view.near);
        let mut left: Vec<usize> = (0..self.bodies.len()).collect();
        left.sort_by(|&i, &j| depth(i).total_cmp(&depth(j)));
        let mut order = Vec::new();
        while !left.is_empty() {
            let next = left.iter().position(|&i| {
                left.iter()
                    .all(|&j| i == j || !self.may_hide(i, j, view) || self.is_behind(i, j, view))
            });
            order.push(left.remove(next.unwrap_or(0)));
        }
        order
    }

    /// Returns whether the boxes of two bodies in the picture overlap.
    fn may_hide(&self, i: usize, j: usize, view: &View) -> bool {
        let span = |k: usize, axis: usize| {
            let along = self.bodies[k]
                .0
                .vertex_points()
                .map(|p| view.place(&(self.poses[k] * p))[axis]);
            along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
        };
        (0..2).all(|axis| {
            let ((low_i, high_i), (low_j, high_j)) = (span(i, axis), span(j, axis));
            low_i <= high_j && low_j <= high_i
        })
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}
