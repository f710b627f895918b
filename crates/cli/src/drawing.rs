//! Drawings of two links as SVG: triangles from back to front, seen across the closest points.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{Geometry, HalfSpace};
use lin_canny_record::RenderMesh;
use lin_canny_record::svg::{Place, Svg, View};

/// Width and height in pixels, and the space around the bodies.
const SIZE: [f64; 2] = [420.0, 280.0];
const BORDER: f64 = 20.0;

/// Largest number of triangles of a body that is drawn as it is.
const MOST_TRIANGLES: usize = 400;

/// Largest number of points that are drawn of a cloud.
const MOST_POINTS: usize = 500;

/// Number of cubes along the longest side of a body in which vertices are merged at first.
const CUBES: u32 = 32;

/// Directions to the reader and to the light, not of unit length.
const TOWARDS: Vector3<f64> = Vector3::new(1.0, -0.75, 0.62);
const LIGHT: Vector3<f64> = Vector3::new(0.5, -0.9, 1.6);

/// Part of the view along the line between the closest points.
const TILT: f64 = 0.2;

/// Number of tones of a colour.
const TONES: usize = 8;

/// The style sheet of all drawings on a page.
pub(crate) fn style() -> String {
    let mut style = String::new();
    for (side, hue) in [('a', 205), ('b', 28)] {
        for tone in 0..TONES {
            let light = 46 + 42 * tone / (TONES - 1);
            let _ = write!(
                style,
                ".{side}{tone}{{fill:hsl({hue},55%,{light}%);stroke:hsl({hue},55%,{light}%)}}"
            );
        }
    }
    style
        + "svg polygon{stroke-width:.4;stroke-linejoin:round}.dot{stroke:none}.gap{stroke:#c00000;stroke-width:1.6}\
           .end{fill:#c00000;stroke:white;stroke-width:.6}"
}

/// Two links at their poses in the world.
#[derive(Default)]
pub(crate) struct Drawing {
    /// Triangles with their unit normals, and the link of each.
    triangles: Vec<([Point3<f64>; 3], Vector3<f64>, usize)>,
    /// Points of clouds, and the link of each.
    dots: Vec<(Point3<f64>, usize)>,
}

impl Drawing {
    /// Adds a body of the first link (0) or of the second (1).
    ///
    /// A body with many triangles is drawn with fewer: its vertices are merged in the cubes of a
    /// grid (Rossignac and Borrel 1993). A half-space is drawn as a square about the foot of
    /// `near`.
    pub(crate) fn body(&mut self, geometry: &Geometry, pose: &Isometry3<f64>, link: usize, near: (Point3<f64>, f64)) {
        let mesh = match geometry {
            Geometry::HalfSpace(space) => square(space, pose, near),
            Geometry::Cloud(cloud) if cloud.len() > MOST_POINTS => {
                let points = cloud.points();
                let step = points.len().div_ceil(MOST_POINTS);
                self.dots.extend(points.iter().step_by(step).map(|p| (pose * p, link)));
                return;
            }
            _ => RenderMesh::from_geometry(geometry).triangles,
        };
        let placed = coarse(mesh)
            .into_iter()
            .map(|(t, n)| (t.map(|p| pose * p), pose * n, link));
        self.triangles.extend(placed);
    }

    /// Returns the SVG for a page of HTML, with a line between the closest points.
    pub(crate) fn svg(&self, title: &str, points: Option<[Point3<f64>; 2]>) -> String {
        let view = self.view(points);
        let light = LIGHT.normalize();
        // What is drawn, and how near it is.
        let mut seen: Vec<(f64, Vec<Place>, String)> = Vec::new();
        for (corners, normal, link) in &self.triangles {
            if normal.dot(&view.axes[2]) <= 0.0 {
                continue;
            }
            let tone = (0.5 * (1.0 + normal.dot(&light)) * TONES as f64) as usize;
            let class = format!("class=\"{}{}\"", ['a', 'b'][*link], tone.min(TONES - 1));
            let depth = corners.iter().map(|p| view.depth(p)).sum::<f64>() / 3.0;
            seen.push((depth, corners.iter().map(|p| view.place(p)).collect(), class));
        }
        for (point, link) in &self.dots {
            let class = format!("class=\"{}2 dot\"", ['a', 'b'][*link]);
            seen.push((view.depth(point), vec![view.place(point)], class));
        }
        seen.sort_by(|x, y| x.0.total_cmp(&y.0));
        let mut svg = Svg::new(SIZE[0] as u32, SIZE[1] as u32, title);
        for (_, places, class) in seen {
            match places[..] {
                [place] => svg.dot(place, 0.5, &class),
                _ => svg.polygon(&places, &class),
            }
        }
        if let Some([p, q]) = points.map(|points| points.map(|p| view.place(&p))) {
            svg.line(p, q, "class=\"gap\"");
            for end in [p, q] {
                svg.dot(end, 2.8, "class=\"end\"");
            }
        }
        svg.inline()
    }

    /// Returns the view in which everything fills the picture, across the line between the points.
    fn view(&self, points: Option<[Point3<f64>; 2]>) -> View {
        let gap = points.and_then(|[p, q]| (q - p).try_normalize(f64::MIN_POSITIVE));
        let gap = gap.map_or(Vector3::zeros(), |gap| if gap.z < 0.0 { -gap } else { gap });
        let across = TOWARDS - gap * TOWARDS.dot(&gap);
        let across = if across.norm() > 0.3 { across } else { Vector3::y() };
        // A little along the gap as well, so that faces which bound it are seen.
        let towards = across.normalize() + gap * TILT;
        let corners = self.triangles.iter().flat_map(|(corners, ..)| corners);
        let all = corners
            .chain(self.dots.iter().map(|(p, _)| p))
            .chain(points.iter().flatten());
        let all: Vec<Point3<f64>> = all.copied().collect();
        let room = SIZE.map(|length| length - 2.0 * BORDER);
        View::fitting(&towards, &all, SIZE.map(|length| 0.5 * length), room)
    }
}

/// Corners and unit normal.
type Triangle = ([Point3<f64>; 3], Vector3<f64>);

/// Returns the triangles of a body, or fewer if they are many.
fn coarse(all: Vec<Triangle>) -> Vec<Triangle> {
    let mut cubes = CUBES;
    let mut few = all;
    while few.len() > MOST_TRIANGLES && cubes > 1 {
        few = merged(&few, cubes);
        cubes /= 2;
    }
    few
}

/// Merges the vertices in each cube of a grid.
fn merged(all: &[Triangle], cubes: u32) -> Vec<Triangle> {
    let corners = || all.iter().flat_map(|(corners, _)| corners);
    let none = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    let (low, high) = corners().fold(none, |(low, high), p| (low.inf(&p.coords), high.sup(&p.coords)));
    let side = (high - low).max() / f64::from(cubes);
    let key = |p: &Point3<f64>| [0, 1, 2].map(|k| ((p[k] - low[k]) / side) as u32);
    let mut first = BTreeMap::new();
    for p in corners() {
        first.entry(key(p)).or_insert(*p);
    }
    let moved = all.iter().map(|(corners, _)| corners.map(|p| first[&key(&p)]));
    let with_normals = moved.filter_map(|[p, q, r]| {
        let normal = (q - p).cross(&(r - p)).try_normalize(0.0)?;
        Some(([p, q, r], normal))
    });
    with_normals.collect()
}

/// Returns both sides of a square of the plane of a half-space, about the foot of a ball.
fn square(space: &HalfSpace, pose: &Isometry3<f64>, (centre, radius): (Point3<f64>, f64)) -> Vec<Triangle> {
    let n = space.normal().into_inner();
    let local = pose.inverse_transform_point(&centre);
    let foot = local - n * n.dot(&(local - space.foot()));
    let mut aside = Vector3::zeros();
    aside[n.iamin()] = 1.0;
    let u = n.cross(&aside).normalize() * (1.2 * radius);
    let v = n.cross(&u);
    let [p, q, r, s] = [foot - u - v, foot + u - v, foot + u + v, foot - u + v];
    vec![([p, q, r], n), ([p, r, s], n), ([p, r, q], -n), ([p, s, r], -n)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use lin_canny::polyhedron::solids;

    /// Returns the numbers of all polygons and circles of a drawing.
    fn numbers(svg: &str) -> Vec<f64> {
        let shapes = svg
            .lines()
            .filter(|line| line.starts_with("<polygon") || line.starts_with("<circle"));
        let values = shapes.flat_map(|line| line.split(['"', ' ', ',']));
        values.filter_map(|word| word.parse().ok()).collect()
    }

    #[test]
    fn bodies_fill_the_picture_and_stay_inside() {
        let ball = solids::geodesic_sphere(4, 1.0).expect("a ball");
        let near = (Point3::origin(), 1.0);
        let far = Isometry3::translation(3.0, 0.5, -0.2);
        let mut drawing = Drawing::default();
        drawing.body(&ball.clone().into(), &Isometry3::identity(), 0, near);
        drawing.body(&ball.into(), &far, 1, near);
        assert!(drawing.triangles.len() <= 2 * MOST_TRIANGLES && drawing.triangles.len() > 100);
        let gap = far.translation.vector.normalize();
        let svg = drawing.svg(
            "two balls",
            Some([Point3::from(gap), Point3::from(far.translation.vector - gap)]),
        );
        let all = numbers(&svg);
        let widest = all.iter().copied().fold(0.0, f64::max);
        assert!(all.iter().all(|x| (0.0..=SIZE[0]).contains(x)), "{svg}");
        assert!(widest > SIZE[0] - BORDER - 20.0, "{widest}");
        // The gap is seen at its true length, in proportion to the length of both bodies.
        let circles: Vec<Vec<f64>> = svg
            .lines()
            .filter(|line| line.contains("class=\"end\""))
            .map(numbers)
            .collect();
        let length = (circles[0][0] - circles[1][0]).hypot(circles[0][1] - circles[1][1]);
        let truth = (3.0f64.hypot(0.5).hypot(0.2) - 2.0) / 5.0 * (SIZE[0] - 2.0 * BORDER);
        assert!((length - truth).abs() < 0.1 * truth, "{length} {truth}");
    }

    #[test]
    fn every_kind_of_body_is_drawn() {
        let points: Vec<Point3<f64>> = (0..2000).map(|k| Point3::new(f64::from(k) * 1e-3, 0.0, 0.1)).collect();
        let ball = lin_canny::Shape::ball(0.01).expect("a ball");
        let cloud = lin_canny::Cloud::new(&points, ball).expect("a cloud");
        let floor = HalfSpace::new(Vector3::z(), -1.0).expect("a plane");
        let mut drawing = Drawing::default();
        assert!(numbers(&drawing.svg("nothing", None)).is_empty());
        drawing.body(&cloud.into(), &Isometry3::identity(), 0, (Point3::origin(), 1.0));
        drawing.body(
            &floor.into(),
            &Isometry3::identity(),
            1,
            (Point3::new(1.0, 0.0, 0.0), 2.0),
        );
        let svg = drawing.svg("a floor", None);
        let count = |class: &str| svg.matches(class).count();
        assert_eq!((count("\"a2 dot\""), count("class=\"b")), (MOST_POINTS, 2));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}
