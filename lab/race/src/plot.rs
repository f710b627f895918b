//! Line charts as SVG files.
//!
//! Text is dark on a white background, so a chart is readable on light and dark pages. Colours
//! differ in lightness as well as in hue (Okabe and Ito 2008), so they are distinct in grey too.

mod draw;

use plotters::prelude::*;
use std::path::Path;

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mark {
    Line,
    Dots,
    LineAndDots,
    Spread,
    Backdrop,
}

/// A measured point with its range, and an optional word next to it.
#[derive(Clone, Debug)]
pub struct Spread {
    /// Least, median and greatest x.
    pub x: [f64; 3],
    /// Least, median and greatest y.
    pub y: [f64; 3],
    /// The word, or empty.
    pub word: String,
}

/// One series.
#[derive(Clone, Debug)]
struct Series {
    name: String,
    mark: Mark,
    /// Three points for each spread: the median, the least ends, the greatest ends.
    points: Vec<(f64, f64)>,
    words: Vec<String>,
}

/// A chart under construction:
/// `Chart::new("t").axes("n", "ns").log_x().line("a", points).save("a.svg")`.
#[derive(Clone, Debug)]
pub struct Chart {
    title: String,
    x_label: String,
    y_label: String,
    log: (bool, bool),
    size: (u32, u32),
    from_zero: bool,
    beside: bool,
    low: bool,
    rows: bool,
    whole: bool,
    series: Vec<Series>,
}

impl Chart {
    /// Returns an empty chart of 860 by 480 pixels with linear axes.
    pub fn new(title: impl Into<String>) -> Self {
        let (x_label, y_label) = (String::new(), String::new());
        Self {
            title: title.into(),
            x_label,
            y_label,
            log: (false, false),
            size: (860, 480),
            from_zero: false,
            beside: false,
            low: false,
            rows: false,
            whole: false,
            series: vec![],
        }
    }

    /// Returns the chart with a title computed from its title.
    pub fn titled(mut self, title: impl FnOnce(&str) -> String) -> Self {
        self.title = title(&self.title);
        self
    }

    /// Sets the labels of the axes.
    pub fn axes(mut self, x: impl Into<String>, y: impl Into<String>) -> Self {
        (self.x_label, self.y_label) = (x.into(), y.into());
        self
    }

    /// Makes the x axis logarithmic: points with `x <= 0` are left out.
    pub fn log_x(mut self) -> Self {
        self.log.0 = true;
        self
    }

    /// Makes the y axis logarithmic: points with `y <= 0` are left out.
    pub fn log_y(mut self) -> Self {
        self.log.1 = true;
        self
    }

    /// Lets a linear y axis start at zero.
    pub fn from_zero(mut self) -> Self {
        self.from_zero = true;
        self
    }

    /// Puts the legend to the right of the axes, where it hides nothing.
    pub fn legend_beside(mut self) -> Self {
        self.beside = true;
        self
    }

    /// Puts the legend into the lower right corner instead of the upper left.
    pub fn legend_low(mut self) -> Self {
        self.low = true;
        self
    }

    /// Makes the chart a list of rows: y is the row number, and its axis has no numbers.
    pub fn rows(mut self) -> Self {
        self.rows = true;
        self
    }

    /// Declares the values of y as counts: its axis has no fractions.
    pub fn counts(mut self) -> Self {
        self.whole = true;
        self
    }

    /// Adds small pale dots behind all later series.
    pub fn backdrop(self, name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.add(name, Mark::Backdrop, points)
    }

    /// Sets width and height in pixels.
    pub fn size(mut self, width: u32, height: u32) -> Self {
        self.size = (width, height);
        self
    }

    /// Adds a line, interrupted where a value is not finite.
    pub fn line(self, name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.add(name, Mark::Line, points)
    }

    /// Adds dots.
    pub fn dots(self, name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.add(name, Mark::Dots, points)
    }

    /// Adds a line through dots, for a few measured points.
    pub fn curve(self, name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.add(name, Mark::LineAndDots, points)
    }

    /// Adds dots with bars from the least to the greatest of both coordinates, and words next to
    /// them.
    pub fn spreads(mut self, name: impl Into<String>, list: impl IntoIterator<Item = Spread>) -> Self {
        let list: Vec<Spread> = list.into_iter().collect();
        let places = |s: &Spread| [1, 0, 2].map(|k| (s.x[k], s.y[k]));
        self = self.add(name, Mark::Spread, list.iter().flat_map(places));
        if let Some(last) = self.series.last_mut() {
            last.words = list.into_iter().map(|s| s.word).collect();
        }
        self
    }

    fn add(mut self, name: impl Into<String>, mark: Mark, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.series.push(Series {
            name: name.into(),
            mark,
            points: points.into_iter().collect(),
            words: vec![],
        });
        self
    }

    /// Returns whether the axes can show the point.
    fn shows(&self, (x, y): (f64, f64)) -> bool {
        x.is_finite() && y.is_finite() && (!self.log.0 || x > 0.0) && (!self.log.1 || y > 0.0)
    }

    /// Returns the least interval that contains one coordinate of all shown points, widened by a
    /// margin.
    fn range(
        &self,
        pick: impl Fn((f64, f64)) -> f64,
        log: bool,
        margin: f64,
        from: Option<f64>,
    ) -> std::ops::Range<f64> {
        let all = self
            .series
            .iter()
            .flat_map(|s| &s.points)
            .copied()
            .filter(|&p| self.shows(p))
            .map(pick);
        let (lo, hi) = all
            .chain(from)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        match (log, lo < hi) {
            _ if lo > hi => 1.0..10.0, // nothing to show
            (true, _) => {
                // At least a factor of three, so that the axis has some numbers.
                let wide = (3.0 * lo / hi).max(1.0).sqrt() * (hi / lo).powf(margin);
                lo / wide..hi * wide
            }
            (false, true) if from == Some(lo) => lo..hi + margin * (hi - lo),
            (false, true) => lo - margin * (hi - lo)..hi + margin * (hi - lo),
            (false, false) => lo - 0.5 - lo.abs() / 2.0..hi + 0.5 + hi.abs() / 2.0,
        }
    }

    /// Writes the chart.
    ///
    /// # Errors
    /// Returns an error with the name of the file if it cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), String> {
        save_stack(&[self], path)
    }

    /// Returns the chart as SVG text.
    ///
    /// # Errors
    /// Returns the error of the drawing library.
    pub fn svg(&self) -> Result<String, String> {
        stack(&[self])
    }
}

/// Returns charts stacked vertically as SVG text, as wide as the widest.
///
/// # Errors
/// Returns the error of the drawing library.
pub fn stack(charts: &[&Chart]) -> Result<String, String> {
    let width = charts.iter().map(|c| c.size.0).max().unwrap_or(0);
    let ends: Vec<u32> = charts
        .iter()
        .scan(0, |end, c| Some(std::mem::replace(end, *end + c.size.1) + c.size.1))
        .collect();
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (width, *ends.last().unwrap_or(&0))).into_drawing_area();
        let inner = || {
            root.fill(&WHITE)?;
            for (c, end) in charts.iter().zip(&ends) {
                let from = (end - c.size.1) as i32;
                c.draw_on(&root.clone().shrink((0, from), c.size))?;
            }
            root.present()
        };
        inner().map_err(|e| e.to_string())?;
    }
    // For screen readers, and for pages narrower than the chart.
    let titles: Vec<String> = charts.iter().map(|c| escaped(&c.title)).collect();
    let text = text.replacen("<svg ", "<svg role=\"img\" style=\"max-width:100%;height:auto\" ", 1);
    Ok(text.replacen(">\n", &format!(">\n<title>{}</title>\n", titles.join("; ")), 1))
}

/// Escapes text for SVG.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Writes charts stacked vertically to a file, for example quantities of different units over the
/// same time.
///
/// # Errors
/// Returns an error with the name of the file if it cannot be written.
pub fn save_stack(charts: &[&Chart], path: impl AsRef<Path>) -> Result<(), String> {
    let path = path.as_ref();
    truth::command::write(path, &stack(charts)?)
}

#[cfg(test)]
#[path = "plot_tests.rs"]
mod tests;
