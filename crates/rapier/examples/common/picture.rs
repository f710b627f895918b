//! Pictures of hulls: each visible face filled, far bodies first.

use std::fmt::Write as _;

use lin_canny_rapier::lin_canny_parry::lin_canny::ConvexPolyhedron;
use lin_canny_rapier::lin_canny_parry::lin_canny::nalgebra::{Isometry3, Vector3};

/// A picture in the making, on a white ground so that it reads on light and dark pages.
pub(crate) struct Picture {
    text: String,
    size: [f64; 2],
}

/// Where a scene stands on the page: a view from above at an angle, without perspective.
#[derive(Clone, Copy)]
pub(crate) struct View {
    /// Place of the origin of the world on the page.
    pub(crate) origin: [f64; 2],
    /// Pixels a unit of length.
    pub(crate) scale: f64,
    /// Angle of the view above the horizon, in radians.
    pub(crate) above: f64,
    /// Angle of the view about the vertical.
    pub(crate) about: f64,
}

impl View {
    /// Returns the directions right, up and towards the viewer.
    fn axes(&self) -> [Vector3<f64>; 3] {
        let ((s, c), (t, d)) = (self.about.sin_cos(), self.above.sin_cos());
        let towards = Vector3::new(d * s, t, d * c);
        let right = Vector3::new(c, 0.0, -s);
        [right, towards.cross(&right), towards]
    }
}

/// A body to be drawn.
pub(crate) struct Drawn<'a> {
    pub(crate) body: &'a ConvexPolyhedron,
    pub(crate) pose: Isometry3<f64>,
    pub(crate) color: [f64; 3],
}

impl Picture {
    pub(crate) fn new(width: u32, height: u32, title: &str) -> Self {
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             style=\"max-width:100%\" font-family=\"sans-serif\" role=\"img\">\n<title>{title}</title>\n"
        );
        let _ = writeln!(
            text,
            "<rect width=\"{width}\" height=\"{height}\" rx=\"8\" fill=\"#ffffff\"/>"
        );
        Self {
            text,
            size: [f64::from(width), f64::from(height)],
        }
    }

    /// Writes a word; `anchor` is start, middle or end.
    pub(crate) fn word(&mut self, [x, y]: [f64; 2], size: u32, anchor: &str, word: &str) {
        let _ = writeln!(
            self.text,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\" fill=\"#282828\">{word}</text>"
        );
    }

    pub(crate) fn line(&mut self, [x, y]: [f64; 2], [u, v]: [f64; 2]) {
        let _ = writeln!(
            self.text,
            "<line x1=\"{x:.1}\" y1=\"{y:.1}\" x2=\"{u:.1}\" y2=\"{v:.1}\" stroke=\"#9aa0a6\" stroke-width=\"1.5\"/>"
        );
    }

    /// Draws bodies, those far from the viewer first; what falls off the page is left out.
    pub(crate) fn bodies(&mut self, view: &View, bodies: &[Drawn]) {
        let [right, up, towards] = view.axes();
        let mut order: Vec<&Drawn> = bodies.iter().collect();
        let near = |d: &Drawn| towards.dot(&(d.pose * d.body.centroid()).coords);
        order.sort_by(|x, y| near(x).total_cmp(&near(y)));
        for d in order {
            let place = |p: Vector3<f64>| {
                [
                    view.origin[0] + view.scale * right.dot(&p),
                    view.origin[1] - view.scale * up.dot(&p),
                ]
            };
            for f in d.body.faces() {
                let Some((n, _)) = d.body.face_plane(f) else { continue };
                let n = d.pose.rotation * n.into_inner();
                let rim = d.body.face_vertices(f).filter_map(|v| d.body.vertex(v));
                let rim: Vec<[f64; 2]> = rim.map(|p| place((d.pose * p).coords)).collect();
                let on_page = |p: &[f64; 2]| (0..2).all(|k| (0.0..=self.size[k]).contains(&p[k]));
                if n.dot(&towards) > 0.0 && rim.iter().all(on_page) {
                    self.face(&rim, d.color, &n);
                }
            }
        }
    }

    fn face(&mut self, rim: &[[f64; 2]], color: [f64; 3], n: &Vector3<f64>) {
        let light = Vector3::new(-0.4, 0.8, 0.45).normalize();
        let shade = 0.55 + 0.45 * n.dot(&light).max(0.0);
        let [r, g, b] = color.map(|c| (255.0 * c * shade) as u8);
        let points: Vec<String> = rim.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(
            self.text,
            "<polygon points=\"{}\" fill=\"#{r:02x}{g:02x}{b:02x}\" stroke=\"#{r:02x}{g:02x}{b:02x}\" stroke-width=\"0.5\"/>",
            points.join(" ")
        );
    }

    pub(crate) fn finish(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }
}

/// Colours of Okabe and Ito 2008.
pub(crate) const BLUE: [f64; 3] = [0.0, 0.45, 0.70];
pub(crate) const ORANGE: [f64; 3] = [0.90, 0.45, 0.05];
pub(crate) const GREY: [f64; 3] = [0.80, 0.82, 0.84];
