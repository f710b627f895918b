//! Picture of a scene in three dimensions: convex bodies, drawn from back to front.

#![allow(dead_code, reason = "no example uses all of it")]

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{ConvexPolyhedron, Geometry, PairTracker, RelativePose, Tracker};

use lin_canny_robot::record::svg::{Svg, View};
use truth::arm::Trouble;

/// Width and height of the picture, and the height of the caption.
const SIZE: [f64; 2] = [860.0, 520.0];
const CAPTION: f64 = 36.0;

/// Opacity of an obstacle in front of the robot.
const GLASS: f64 = 0.12;

/// Steps of an outline from pole to pole.
const LATITUDES: u32 = 18;

/// Length of a line of sight from a point of a cloud.
const FAR: f64 = 10.0;

/// Directions to the reader and to the light, not of unit length.
const TOWARDS: Vector3<f64> = Vector3::new(1.0, -0.75, 0.62);
const LIGHT: Vector3<f64> = Vector3::new(0.5, -0.9, 1.6);

/// Bodies at their poses, and two points to connect.
pub(crate) struct Picture<'a> {
    /// Text above the picture.
    pub(crate) caption: String,
    /// Shapes, with whether each belongs to the robot.
    pub(crate) bodies: Vec<(&'a ConvexPolyhedron, bool)>,
    /// Poses of the shapes, in the same order.
    pub(crate) poses: Vec<Isometry3<f64>>,
    /// Points joined by a red line.
    pub(crate) points: [Point3<f64>; 2],
    /// Points of a cloud, which bodies in front of them hide.
    pub(crate) cloud: Vec<Point3<f64>>,
}

/// Returns the hull of the points of a convex geometry closest to far points all around, for
/// pictures only.
pub(crate) fn outline(geometry: &Geometry) -> Result<ConvexPolyhedron, Trouble> {
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

impl Picture<'_> {
    /// Returns the picture above a chart, which is a separate SVG.
    pub(crate) fn above(&self, chart: &str) -> String {
        let size = |word: &str| {
            let value = chart.split_once(word).and_then(|(_, rest)| rest.split('"').nth(1));
            value.and_then(|v| v.parse::<f64>().ok()).unwrap_or(SIZE[0])
        };
        let mut svg = self.begun([SIZE[0].max(size("width=")), SIZE[1] + size("height=")]);
        // Inside another picture, the size of the chart comes from its attributes: its style is for
        // pages.
        let chart = chart.replacen("height:auto", "", 1).replacen("max-width:100%;", "", 1);
        svg.inset([0.0, SIZE[1]], &chart);
        svg.finish()
    }

    /// Returns the picture alone.
    pub(crate) fn alone(&self) -> String {
        self.begun(SIZE).finish()
    }

    /// Returns a page with the picture at its top.
    fn begun(&self, [width, height]: [f64; 2]) -> Svg {
        let mut svg = Svg::new(width as u32, height as u32, &self.caption);
        svg.words([20.0, 24.0], 17, "start", &self.caption);
        self.draw(&mut svg);
        svg
    }

    fn draw(&self, svg: &mut Svg) {
        let placed = self.bodies.iter().zip(&self.poses);
        let corners = placed.flat_map(|((shape, _), pose)| shape.vertex_points().map(move |p| pose * p));
        let points: Vec<_> = corners.chain(self.cloud.iter().copied()).collect();
        let room = [SIZE[0] - 40.0, SIZE[1] - CAPTION - 20.0];
        let view = View::fitting(&TOWARDS, &points, [0.5 * SIZE[0], CAPTION + 0.5 * room[1]], room);
        for k in self.order(&view) {
            let opacity = if self.hides_robot(k, &view) { GLASS } else { 1.0 };
            self.draw_body(k, opacity, &view, svg);
        }
        let seen = self.cloud.iter().filter(|p| !self.is_hidden(p, &view));
        let dots: Vec<_> = seen.map(|p| view.place(p)).collect();
        svg.points(&dots, "stroke=\"#17805b\" stroke-opacity=\"0.6\" stroke-width=\"1.9\"");
        let [p, q] = self.points.map(|p| view.place(&p));
        svg.line(p, q, "stroke=\"#c00\" stroke-width=\"3\"");
        for end in [p, q] {
            svg.dot(end, 4.5, "fill=\"#c00\"");
        }
    }

    /// Returns whether a body is between a point and the reader.
    fn is_hidden(&self, p: &Point3<f64>, view: &View) -> bool {
        let Ok(sight) = ConvexPolyhedron::segment(*p, p + view.axes[2] * FAR) else {
            return false;
        };
        let mut bodies = self.bodies.iter().zip(&self.poses);
        bodies.any(|((shape, _), pose)| {
            let pose = RelativePose::new_normalized(&Isometry3::identity(), pose);
            pose.is_ok_and(|pose| Tracker::new().intersects(&sight, shape, &pose))
        })
    }

    /// Returns whether an obstacle is between a body of the robot and the reader.
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
        (self.poses[i] * found.normal.into_inner()).dot(&view.axes[2]) > 0.0
    }

    /// Draws the faces that face the reader.
    fn draw_body(&self, k: usize, opacity: f64, view: &View, svg: &mut Svg) {
        let ((shape, is_of_robot), pose) = (self.bodies[k], &self.poses[k]);
        let hue = if is_of_robot { 205 } else { 35 };
        let light = LIGHT.normalize();
        for face in shape.faces() {
            let Some((normal, _)) = shape.face_plane(face) else {
                continue;
            };
            let normal = pose * normal.into_inner();
            if normal.dot(&view.axes[2]) <= 0.0 {
                continue;
            }
            let rim = shape.face_vertices(face).filter_map(|v| shape.vertex(v));
            let rim: Vec<_> = rim.map(|p| view.place(&(pose * p))).collect();
            let tone = 62.0 + 22.0 * normal.dot(&light);
            let edge = tone - 14.0;
            let glass = if opacity < 1.0 {
                format!(" fill-opacity=\"{opacity}\"")
            } else {
                String::new()
            };
            let style = format!(
                "fill=\"hsl({hue},50%,{tone:.0}%)\" stroke=\"hsl({hue},45%,{edge:.0}%)\" stroke-width=\"0.6\"{glass}"
            );
            svg.polygon(&rim, &style);
        }
    }

    /// Returns the bodies from back to front. If bodies hide each other in a cycle, the one with
    /// the farthest centre comes first.
    fn order(&self, view: &View) -> Vec<usize> {
        let depth = |k: usize| (self.poses[k] * self.bodies[k].0.centroid()).coords.dot(&view.axes[2]);
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
