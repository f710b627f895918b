//! Picture of the cloth and the body, seen from a corner and painted from far to near.

use lin_canny::Geometry;
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny_record::RenderMesh;
use lin_canny_record::svg::{Place, Svg, View};

const WIDTH: f64 = 330.0;
const HEIGHT: f64 = 330.0;
const SCALE: f64 = 125.0;

/// Distance by which the facets of the body are moved back in the depth order: they are chords of
/// the ball and larger than the squares of the cloth.
const BEHIND: f64 = 0.08;

/// Panels, one next to the other.
pub(crate) struct Picture {
    svg: Svg,
    drawn: usize,
}

/// A polygon to draw: depth, vertices on the page, and colour.
type Drawn = (f64, Vec<Place>, [u8; 3]);

impl Picture {
    pub(crate) fn new(panels: usize) -> Self {
        Self {
            svg: Svg::new(
                WIDTH as u32 * panels as u32,
                HEIGHT as u32,
                "A sheet of cloth falls over a ball on a box",
            ),
            drawn: 0,
        }
    }

    /// Draws a sheet of squares and a body in the next panel.
    pub(crate) fn add(&mut self, body: &Geometry, sheet: &[Point3<f64>], squares: usize) {
        let origin = [WIDTH * (self.drawn as f64 + 0.5), 0.52 * HEIGHT];
        let mut view = View::new(&Vector3::new(0.62, -0.95, 0.62), &Vector3::z(), SCALE, origin);
        view.origin[1] += SCALE * 0.35 * view.axes[1].z;
        let towards = view.axes[2];
        self.drawn += 1;
        let mut all: Vec<Drawn> = Vec::new();
        for (corners, normal) in RenderMesh::from_geometry(body).triangles {
            if normal.dot(&towards) > 0.0 {
                let (depth, corners, colour) = polygon(&corners, normal, &view, [150.0, 165.0, 185.0]);
                all.push((depth - BEHIND, corners, colour));
            }
        }
        let at = |i: usize, j: usize| sheet[i * (squares + 1) + j];
        for (i, j) in (0..squares).flat_map(|i| (0..squares).map(move |j| (i, j))) {
            let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            let normal = (corners[2] - corners[0]).cross(&(corners[3] - corners[1])).normalize();
            let is_front = normal.dot(&towards) > 0.0;
            let (normal, colour) = if is_front {
                (normal, [226.0, 96.0, 72.0])
            } else {
                (-normal, [240.0, 190.0, 120.0])
            };
            all.push(polygon(&corners, normal, &view, colour));
        }
        all.sort_by(|p, q| p.0.total_cmp(&q.0));
        for (_, corners, [r, g, b]) in all {
            let style = format!("fill=\"#{r:02x}{g:02x}{b:02x}\" stroke=\"#40302c\" stroke-width=\"0.25\"");
            self.svg.polygon(&corners, &style);
        }
    }

    pub(crate) fn finish(self) -> String {
        self.svg.finish()
    }
}

fn polygon(corners: &[Point3<f64>], normal: Vector3<f64>, view: &View, colour: [f64; 3]) -> Drawn {
    let depth = corners.iter().map(|p| view.depth(p)).sum::<f64>() / corners.len() as f64;
    let light = 0.5 + 0.5 * normal.dot(&Vector3::new(-0.3, -0.5, 0.81)).max(0.0);
    (
        depth,
        corners.iter().map(|p| view.place(p)).collect(),
        colour.map(|c| (c * light) as u8),
    )
}
