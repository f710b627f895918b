//! Line charts as SVG files.
//!
//! A white ground with dark text, so that a chart reads on light and dark pages alike; colours differ in lightness as well
//! as in hue (Okabe and Ito 2008), so that they read in grey too.

use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;
use std::path::Path;

/// Colours of the series, in turn.
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 90, 160),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(150, 110, 0),
    RGBColor(60, 60, 60),
];

/// Dark grey of text and axes.
const INK: RGBColor = RGBColor(40, 40, 40);

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mark {
    Line,
    Dots,
    LineAndDots,
}

/// One curve.
#[derive(Clone, Debug)]
struct Series {
    name: String,
    mark: Mark,
    points: Vec<(f64, f64)>,
}

/// A chart in the making: `Chart::new("t").axes("n", "ns").log_x().line("a", points).save("a.svg")`.
#[derive(Clone, Debug)]
pub struct Chart {
    title: String,
    x_label: String,
    y_label: String,
    log: (bool, bool),
    size: (u32, u32),
    from_zero: bool,
    series: Vec<Series>,
}

impl Chart {
    /// An empty chart of 860 by 480 pixels with linear axes.
    pub fn new(title: impl Into<String>) -> Self {
        let (x_label, y_label) = (String::new(), String::new());
        Self {
            title: title.into(),
            x_label,
            y_label,
            log: (false, false),
            size: (860, 480),
            from_zero: false,
            series: vec![],
        }
    }

    /// Words along the axes.
    pub fn axes(mut self, x: impl Into<String>, y: impl Into<String>) -> Self {
        (self.x_label, self.y_label) = (x.into(), y.into());
        self
    }

    /// Logarithmic x axis: points with `x <= 0` are left out.
    pub fn log_x(mut self) -> Self {
        self.log.0 = true;
        self
    }

    /// Logarithmic y axis: points with `y <= 0` are left out.
    pub fn log_y(mut self) -> Self {
        self.log.1 = true;
        self
    }

    /// Lets a linear y axis start at zero.
    pub fn from_zero(mut self) -> Self {
        self.from_zero = true;
        self
    }

    /// Width and height in pixels.
    pub fn size(mut self, width: u32, height: u32) -> Self {
        self.size = (width, height);
        self
    }

    /// A line; it breaks where a value is not finite.
    pub fn line(self, name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.add(name, Mark::Line, points)
    }

    /// Dots.
    pub fn dots(self, name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.add(name, Mark::Dots, points)
    }

    /// A line through dots: few measured points.
    pub fn curve(self, name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.add(name, Mark::LineAndDots, points)
    }

    fn add(mut self, name: impl Into<String>, mark: Mark, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.series.push(Series {
            name: name.into(),
            mark,
            points: points.into_iter().collect(),
        });
        self
    }

    /// True if the axes can show the point.
    fn shows(&self, (x, y): (f64, f64)) -> bool {
        x.is_finite() && y.is_finite() && (!self.log.0 || x > 0.0) && (!self.log.1 || y > 0.0)
    }

    /// The least interval that holds one coordinate of all shown points, a little wider on y.
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
            (true, true) => lo / (hi / lo).powf(margin)..hi * (hi / lo).powf(margin),
            (true, false) => lo / 2.0..hi * 2.0,
            (false, true) if from == Some(lo) => lo..hi + margin * (hi - lo),
            (false, true) => lo - margin * (hi - lo)..hi + margin * (hi - lo),
            (false, false) => lo - 0.5 - lo.abs() / 2.0..hi + 0.5 + hi.abs() / 2.0,
        }
    }

    /// Writes the chart. Errors are the file's.
    ///
    /// # Errors
    /// What kept the file from being written, with its name.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), String> {
        let path = path.as_ref();
        std::fs::write(path, self.svg()?).map_err(|e| format!("{}: {e}", path.display()))
    }

    /// The chart as SVG text.
    ///
    /// # Errors
    /// What the drawing library has to complain of.
    pub fn svg(&self) -> Result<String, String> {
        let mut text = String::new();
        {
            let root = SVGBackend::with_string(&mut text, self.size).into_drawing_area();
            root.fill(&WHITE).map_err(|e| e.to_string())?;
            let x = self.range(|p| p.0, self.log.0, 0.0, None);
            let y = self.range(
                |p| p.1,
                self.log.1,
                0.05,
                (self.from_zero && !self.log.1).then_some(0.0),
            );
            let done = match self.log {
                (false, false) => self.draw(&root, x, y),
                (true, false) => self.draw(&root, x.log_scale(), y),
                (false, true) => self.draw(&root, x, y.log_scale()),
                (true, true) => self.draw(&root, x.log_scale(), y.log_scale()),
            };
            done.and_then(|()| root.present()).map_err(|e| e.to_string())?;
        }
        Ok(text)
    }

    fn draw<'a, X, Y>(
        &self,
        root: &DrawingArea<SVGBackend<'a>, Shift>,
        x: X,
        y: Y,
    ) -> Result<(), DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>>
    where
        X: AsRangedCoord<Value = f64>,
        Y: AsRangedCoord<Value = f64>,
        X::CoordDescType: ValueFormatter<f64>,
        Y::CoordDescType: ValueFormatter<f64>,
    {
        let font = |size: i32| ("sans-serif", size).into_font().color(&INK);
        let mut chart = ChartBuilder::on(root)
            .caption(&self.title, font(20))
            .margin(12)
            .x_label_area_size(48)
            .y_label_area_size(76)
            .build_cartesian_2d(x, y)?;
        let mut mesh = chart.configure_mesh();
        mesh.x_desc(&self.x_label)
            .y_desc(&self.y_label)
            .label_style(font(14))
            .axis_desc_style(font(15));
        mesh.axis_style(INK)
            .bold_line_style(INK.mix(0.15))
            .light_line_style(INK.mix(0.04));
        mesh.x_label_formatter(&|v| short(*v))
            .y_label_formatter(&|v| short(*v))
            .draw()?;
        for (i, s) in self.series.iter().enumerate() {
            let colour = COLOURS[i % COLOURS.len()];
            let mut runs = s.points.split(|&p| !self.shows(p)).filter(|run| !run.is_empty());
            if s.mark != Mark::Dots {
                for run in runs.by_ref() {
                    chart.draw_series(LineSeries::new(run.iter().copied(), colour.stroke_width(2)))?;
                }
            }
            let dots = if s.mark == Mark::Line { &[][..] } else { &s.points[..] };
            let shown = dots.iter().copied().filter(|&p| self.shows(p));
            let key = move |(x, y)| Rectangle::new([(x, y - 2), (x + 18, y + 2)], colour.filled());
            chart
                .draw_series(shown.map(|p| Circle::new(p, 3, colour.filled())))?
                .label(&s.name)
                .legend(key);
        }
        if self.series.len() > 1 {
            let mut legend = chart.configure_series_labels();
            legend.position(SeriesLabelPosition::UpperLeft).label_font(font(14));
            legend
                .background_style(WHITE.mix(0.85))
                .border_style(INK.mix(0.3))
                .draw()?;
        }
        Ok(())
    }
}

/// A number of an axis: plain where that is short, else with an exponent.
fn short(v: f64) -> String {
    let plain = v == 0.0 || (1e-3..1e5).contains(&v.abs());
    // Twelve digits drop what stepping along the axis has rounded.
    let v: f64 = format!("{v:.11e}").parse().unwrap_or(v);
    if plain { format!("{v}") } else { format!("{v:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart() -> Chart {
        let points = (1..50).map(|i| (i as f64, (i * i) as f64));
        Chart::new("squares & co")
            .axes("n", "n^2")
            .line("exact", points.clone())
            .curve("twice", points.map(|(x, y)| (x, 2.0 * y)))
    }

    #[test]
    fn all_four_kinds_of_axes_draw() {
        for c in [
            chart(),
            chart().log_x(),
            chart().log_y(),
            chart().log_x().log_y().size(400, 300),
        ] {
            let svg = c.svg().unwrap();
            assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
            for word in ["squares &amp; co", "exact", "twice", "n^2", "polyline", "circle"] {
                assert!(svg.contains(word), "{word}");
            }
            assert!(!svg.contains("NaN"));
        }
    }

    #[test]
    fn gaps_zeros_and_emptiness_do_no_harm() {
        let c = Chart::new("gaps")
            .log_y()
            .line("l", [(0.0, 1.0), (1.0, f64::NAN), (2.0, 0.0), (3.0, 1e-9), (4.0, 1e9)]);
        assert!(!c.svg().unwrap().contains("NaN"));
        assert!(Chart::new("none").svg().is_ok());
        assert!(Chart::new("none").log_x().log_y().line("l", []).svg().is_ok());
        assert!(Chart::new("one").dots("d", [(1.0, 0.0)]).from_zero().svg().is_ok());
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [0.1 + 0.2, 0.0, 1e-9, 1200.0, 2e7].map(short),
            ["0.3", "0", "1e-9", "1200", "2e7"]
        );
    }

    #[test]
    fn a_file_that_cannot_be_written_is_named() {
        assert!(chart().save("/no/such/place/a.svg").unwrap_err().contains("a.svg"));
    }
}
