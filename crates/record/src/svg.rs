//! Pictures as SVG: a few shapes, and a view of things in space.
//!
//! The text has no blank lines, so that it can be embedded in documentation. The background is
//! white, so that pictures are readable on light and dark pages.

use std::fmt::Write as _;

use lin_canny::nalgebra::{Point3, Vector3};

use crate::markup::escaped;

/// Colour of text and outlines.
pub const INK: &str = "#282828";
/// Dark blue.
pub const BLUE: &str = "#005aa0";
/// Light blue.
pub const SKY: &str = "#56b4e9";
/// Orange.
pub const ORANGE: &str = "#d55e00";
/// Green.
pub const GREEN: &str = "#009e73";
/// Grey.
pub const GREY: &str = "#9aa0a6";

/// A position on the page.
pub type Place = [f64; 2];

/// A picture under construction. Styles are attributes such as `fill="#005aa0"`.
pub struct Svg {
    text: String,
}

impl Svg {
    /// Returns an empty page of a size in pixels.
    #[must_use]
    pub fn new(width: u32, height: u32, title: &str) -> Self {
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\" style=\"max-width:100%\" font-family=\"sans-serif\" role=\"img\">\n"
        );
        let _ = writeln!(text, "<title>{}</title>", escaped(title));
        let _ = writeln!(
            text,
            "<rect width=\"{width}\" height=\"{height}\" rx=\"8\" fill=\"#ffffff\"/>"
        );
        Self { text }
    }

    /// Adds a style sheet for the classes of the shapes that follow.
    pub fn style(&mut self, sheet: &str) {
        let _ = writeln!(self.text, "<style>{sheet}</style>");
    }

    /// Draws a closed polygon.
    pub fn polygon(&mut self, corners: &[Place], style: &str) {
        let _ = writeln!(self.text, "<polygon points=\"{}\" {style}/>", list(corners));
    }

    /// Draws an open polyline.
    pub fn polyline(&mut self, corners: &[Place], style: &str) {
        let points = list(corners);
        let _ = writeln!(self.text, "<polyline points=\"{points}\" fill=\"none\" {style}/>");
    }

    /// Draws a segment.
    pub fn line(&mut self, [x1, y1]: Place, [x2, y2]: Place, style: &str) {
        let _ = writeln!(
            self.text,
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" {style}/>"
        );
    }

    /// Draws a disc of a radius in pixels.
    pub fn dot(&mut self, [x, y]: Place, radius: f64, style: &str) {
        let _ = writeln!(
            self.text,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" {style}/>"
        );
    }

    /// Draws many points as discs as wide as the stroke.
    pub fn points(&mut self, places: &[Place], style: &str) {
        let dots: String = places.iter().map(|[x, y]| format!("M{x:.1} {y:.1}h0")).collect();
        if !dots.is_empty() {
            let _ = writeln!(self.text, "<path d=\"{dots}\" stroke-linecap=\"round\" {style}/>");
        }
    }

    /// Draws a rectangle from its upper left corner and its size.
    pub fn rect(&mut self, [x, y]: Place, [w, h]: Place, style: &str) {
        let _ = writeln!(
            self.text,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{w:.1}\" height=\"{h:.1}\" {style}/>"
        );
    }

    /// Writes words; `anchor` is `start`, `middle` or `end`.
    pub fn words(&mut self, [x, y]: Place, size: u32, anchor: &str, words: &str) {
        let _ = writeln!(
            self.text,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\" fill=\"{INK}\">{}</text>",
            escaped(words)
        );
    }

    /// Inserts another picture.
    pub fn inset(&mut self, [x, y]: Place, svg: &str) {
        let inner = svg.replacen("<svg ", &format!("<svg x=\"{x}\" y=\"{y}\" "), 1);
        inner
            .lines()
            .filter(|l| !l.trim().is_empty())
            .for_each(|l| self.text += &format!("{l}\n"));
    }

    /// Returns the picture for a page of HTML, which has the namespace already.
    #[must_use]
    pub fn inline(self) -> String {
        self.finish().replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1)
    }

    /// Returns the text of the picture.
    #[must_use]
    pub fn finish(mut self) -> String {
        self.text += "</svg>\n";
        self.text
    }
}

fn list(corners: &[Place]) -> String {
    let points: Vec<String> = corners.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
    points.join(" ")
}

/// A view of things in space, without perspective.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Unit directions to the right and up on the page, and to the reader.
    pub axes: [Vector3<f64>; 3],
    /// Pixels per unit of length.
    pub scale: f64,
    /// The position of the origin on the page.
    pub origin: Place,
}

impl View {
    /// Returns a view from a direction, with `vertical` upright on the page.
    #[must_use]
    pub fn new(towards: &Vector3<f64>, vertical: &Vector3<f64>, scale: f64, origin: Place) -> Self {
        let towards = towards.try_normalize(0.0).unwrap_or_else(Vector3::z);
        let right = vertical.cross(&towards).try_normalize(1e-3).unwrap_or_else(Vector3::x);
        Self {
            axes: [right, towards.cross(&right), towards],
            scale,
            origin,
        }
    }

    /// Returns the view from a direction, z upright, in which points fill a rectangle of the page
    /// with the given middle and size.
    #[must_use]
    pub fn fitting(towards: &Vector3<f64>, points: &[Point3<f64>], middle: Place, size: Place) -> Self {
        let mut view = Self::new(towards, &Vector3::z(), 1.0, middle);
        let span = |axis: &Vector3<f64>| {
            let along = points.iter().map(|p| p.coords.dot(axis));
            along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
        };
        let [(left, end), (low, high)] = [0, 1].map(|k| span(&view.axes[k]));
        let scale = (size[0] / (end - left)).min(size[1] / (high - low));
        // A single point, or nothing, has no scale.
        view.scale = if scale.is_finite() && scale > 0.0 { scale } else { 1.0 };
        let half = |x: f64| if x.is_finite() { 0.5 * x * view.scale } else { 0.0 };
        view.origin = [middle[0] - half(left + end), middle[1] + half(low + high)];
        view
    }

    /// Returns the position of a point on the page.
    #[must_use]
    pub fn place(&self, p: &Point3<f64>) -> Place {
        let [x, y] = [0, 1].map(|k| self.scale * p.coords.dot(&self.axes[k]));
        [self.origin[0] + x, self.origin[1] - y]
    }

    /// Returns how near a point is to the reader.
    #[must_use]
    pub fn depth(&self, p: &Point3<f64>) -> f64 {
        p.coords.dot(&self.axes[2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_fill_the_rectangle_and_texts_are_escaped() {
        let points = [[0.0, 0.0, 0.0], [2.0, 1.0, 0.5], [-1.0, 3.0, 4.0]].map(Point3::from);
        let view = View::fitting(&Vector3::new(1.0, -0.75, 0.62), &points, [200.0, 100.0], [300.0, 80.0]);
        let places = points.map(|p| view.place(&p));
        let span = |k: usize| {
            places
                .iter()
                .map(|p| p[k])
                .fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)))
        };
        let ((left, right), (top, bottom)) = (span(0), span(1));
        assert!(
            (left + right - 400.0).abs() < 1e-9 && (top + bottom - 200.0).abs() < 1e-9,
            "{places:?}"
        );
        assert!(
            ((right - left) - 300.0).abs().min(((bottom - top) - 80.0).abs()) < 1e-9,
            "{places:?}"
        );
        for alone in [&points[..1], &[]] {
            let view = View::fitting(&Vector3::z(), alone, [5.0, 6.0], [10.0, 10.0]);
            assert!(view.place(&points[0]).iter().all(|x| x.is_finite()), "{view:?}");
        }
        let mut svg = Svg::new(10, 20, "<a>");
        svg.words([1.0, 2.0], 12, "start", "x & y");
        svg.points(&[], "");
        let text = svg.inline();
        assert!(
            text.contains("<title>&lt;a&gt;</title>") && text.contains(">x &amp; y</text>") && !text.contains("http")
        );
    }
}
