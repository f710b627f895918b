//! A few shapes as SVG text.
//!
//! The text has no blank lines, so that it can be embedded in documentation. The background is
//! white, so that pictures are readable on light and dark pages.

use std::fmt::Write as _;

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

/// A picture under construction.
pub struct Svg {
    text: String,
}

impl Svg {
    /// Returns an empty page of a size in pixels.
    pub fn new(width: u32, height: u32, title: &str) -> Self {
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\" style=\"max-width:100%\" font-family=\"sans-serif\" role=\"img\">\n"
        );
        let _ = writeln!(text, "<title>{title}</title>");
        let _ = writeln!(
            text,
            "<rect width=\"{width}\" height=\"{height}\" rx=\"8\" fill=\"#ffffff\"/>"
        );
        Self { text }
    }

    /// Draws a closed polygon.
    pub fn polygon(&mut self, corners: &[Place], style: &str) {
        let points: Vec<String> = corners.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(self.text, "<polygon points=\"{}\" {style}/>", points.join(" "));
    }

    /// Draws an open polyline.
    pub fn polyline(&mut self, corners: &[Place], style: &str) {
        let points: Vec<String> = corners.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(
            self.text,
            "<polyline points=\"{}\" fill=\"none\" {style}/>",
            points.join(" ")
        );
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
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\" fill=\"{INK}\">{words}</text>"
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

    /// Returns the text of the picture.
    pub fn finish(mut self) -> String {
        self.text += "</svg>\n";
        self.text
    }
}
