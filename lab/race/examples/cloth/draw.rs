//! Picture of the cloth and the body, seen from a corner and painted from far to near.

use std::fmt::Write as _;

use lin_canny::Geometry;
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny_record::RenderMesh;

const WIDTH: f64 = 330.0;
const HEIGHT: f64 = 330.0;
const SCALE: f64 = 125.0;

/// Distance by which the facets of the body are moved back in the depth order: they are chords of
/// the ball and larger than the squares of the cloth.
const BEHIND: f64 = 0.08;

/// Panels, one next to the other.
pub(crate) struct Picture {
    svg: String,
    panels: usize,
    drawn: usize,
}

/// A polygon to draw: depth, vertices on the page, and colour.
type Drawn = (f64, Vec<[f64; 2]>, [u8; 3]);

impl Picture {
    pub(crate) fn new(panels: usize) -> Self {
        Self {
            svg: String::new(),
            panels,
            drawn: 0,
        }
    }

    /// Draws a sheet of squares and a body in the next panel.
    pub(crate) fn add(&mut self, body: &Geometry, sheet: &[Point3<f64>], squares: usize) {
        let left = WIDTH * (self.drawn as f64 + 0.5);
        self.drawn += 1;
        let mut all: Vec<Drawn> = Vec::new();
        for (corners, normal) in RenderMesh::from_geometry(body).triangles {
            if normal.dot(&toward()) > 0.0 {
                let (depth, corners, colour) = polygon(&corners, normal, left, [150.0, 165.0, 185.0]);
                all.push((depth - BEHIND, corners, colour));
            }
        }
        let at = |i: usize, j: usize| sheet[i * (squares + 1) + j];
        for (i, j) in (0..squares).flat_map(|i| (0..squares).map(move |j| (i, j))) {
            let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            let normal = (corners[2] - corners[0]).cross(&(corners[3] - corners[1])).normalize();
            let is_front = normal.dot(&toward()) > 0.0;
            let (normal, colour) = if is_front {
                (normal, [226.0, 96.0, 72.0])
            } else {
                (-normal, [240.0, 190.0, 120.0])
            };
            all.push(polygon(&corners, normal, left, colour));
        }
        all.sort_by(|p, q| p.0.total_cmp(&q.0));
        for (_, corners, [r, g, b]) in all {
            let _ = write!(self.svg, "<path fill=\"#{r:02x}{g:02x}{b:02x}\" d=\"");
            for (k, [x, y]) in corners.iter().enumerate() {
                let _ = write!(self.svg, "{}{x:.1} {y:.1}", if k == 0 { "M" } else { "L" });
            }
            self.svg.push_str("Z\"/>\n");
        }
    }

    pub(crate) fn finish(self) -> String {
        let width = WIDTH * self.panels as f64;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {HEIGHT}\" width=\"{width}\">\n\
             <title>A sheet of cloth falls over a ball on a box</title>\n\
             <rect width=\"{width}\" height=\"{HEIGHT}\" fill=\"#ffffff\"/>\n<g stroke=\"#40302c\" stroke-width=\"0.25\">\n{}</g>\n</svg>\n",
            self.svg
        )
    }
}

/// Returns the direction to the eye; `right` and `up` are the axes of the page.
fn toward() -> Vector3<f64> {
    Vector3::new(0.62, -0.95, 0.62).normalize()
}

fn right() -> Vector3<f64> {
    Vector3::z().cross(&toward()).normalize()
}

fn up() -> Vector3<f64> {
    toward().cross(&right())
}

fn polygon(corners: &[Point3<f64>], normal: Vector3<f64>, left: f64, colour: [f64; 3]) -> Drawn {
    let place = |p: &Point3<f64>| {
        let v = p.coords - Vector3::new(0.0, 0.0, 0.35);
        [left + SCALE * right().dot(&v), 0.52 * HEIGHT - SCALE * up().dot(&v)]
    };
    let depth = corners.iter().map(|p| toward().dot(&p.coords)).sum::<f64>() / corners.len() as f64;
    let light = 0.5 + 0.5 * normal.dot(&Vector3::new(-0.3, -0.5, 0.81)).max(0.0);
    (
        depth,
        corners.iter().map(place).collect(),
        colour.map(|c| (c * light) as u8),
    )
}
