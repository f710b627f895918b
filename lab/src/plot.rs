//! Line charts as SVG files.
//!
//! A white ground with dark text, so that a chart reads on light and dark pages alike; colours differ in lightness as well
//! as in hue (Okabe and Ito 2008), so that they read in grey too.

use plotters::coord::Shift;
use plotters::coord::combinators::WithKeyPoints;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;
use std::path::Path;

/// Colours of the series, in turn.
const COLOURS: [RGBColor; 8] = [
    RGBColor(0, 90, 160),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(150, 110, 0),
    RGBColor(60, 60, 60),
    RGBColor(170, 170, 170),
];

/// Dark grey of text and axes.
const INK: RGBColor = RGBColor(40, 40, 40);

/// Where a chart is drawn.
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// What the drawing library complains of.
type Trouble<'a> = DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>;

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mark {
    Line,
    Dots,
    LineAndDots,
    Spread,
}

/// A measured point with its ends, and a word beside it (or none).
#[derive(Clone, Debug)]
pub struct Spread {
    /// Least, middle and greatest x.
    pub x: [f64; 3],
    /// Least, middle and greatest y.
    pub y: [f64; 3],
    /// The word.
    pub word: String,
}

/// One curve.
#[derive(Clone, Debug)]
struct Series {
    name: String,
    mark: Mark,
    /// For spreads three each: the middle, the least ends, the greatest.
    points: Vec<(f64, f64)>,
    words: Vec<String>,
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
    beside: bool,
    low: bool,
    rows: bool,
    series: Vec<Series>,
}

/// Width of a legend beside the axes.
const BESIDE: i32 = 250;

/// Size of a title, and how wide one of its letters is at most, in sizes.
const TITLE: f64 = 20.0;
const LETTER: f64 = 0.42;

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
            beside: false,
            low: false,
            rows: false,
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

    /// Lines of words: y counts them, and its axis has no numbers.
    pub fn rows(mut self) -> Self {
        self.rows = true;
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

    /// Dots with bars from the least to the greatest of both coordinates, and words beside them.
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
            (true, _) => {
                // At least a factor of three, so that some numbers fall on the axis.
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
    /// What kept the file from being written, with its name.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), String> {
        save_stack(&[self], path)
    }

    /// The chart as SVG text.
    ///
    /// # Errors
    /// What the drawing library has to complain of.
    pub fn svg(&self) -> Result<String, String> {
        stack(&[self])
    }

    fn draw_on<'a>(&self, area: &Area<'a>) -> Result<(), Trouble<'a>> {
        let with_words = self.series.iter().any(|s| s.mark == Mark::Spread);
        let x = self.range(|p| p.0, self.log.0, if with_words { 0.04 } else { 0.0 }, None);
        let y = self.range(
            |p| p.1,
            self.log.1,
            0.05,
            (self.from_zero && !self.log.1).then_some(0.0),
        );
        match self.log {
            (false, false) => self.draw(area, x, y),
            (true, false) => self.draw(area, log_axis(x), y),
            (false, true) => self.draw(area, x, log_axis(y)),
            (true, true) => self.draw(area, log_axis(x), log_axis(y)),
        }
    }

    fn draw<'a, X, Y>(&self, area: &Area<'a>, x: X, y: Y) -> Result<(), Trouble<'a>>
    where
        X: AsRangedCoord<Value = f64>,
        Y: AsRangedCoord<Value = f64>,
        X::CoordDescType: ValueFormatter<f64>,
        Y::CoordDescType: ValueFormatter<f64>,
    {
        let font = |size: i32| ("sans-serif", size).into_font().color(&INK);
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, font(self.title_size()))
            .margin(12)
            .margin_right(if self.beside { BESIDE } else { 12 })
            .x_label_area_size(48)
            .y_label_area_size(if self.rows { 20 } else { 76 })
            .build_cartesian_2d(x, y)?;
        let mut mesh = chart.configure_mesh();
        mesh.x_desc(&self.x_label)
            .y_desc(&self.y_label)
            .label_style(font(14))
            .axis_desc_style(font(15));
        mesh.axis_style(INK)
            .bold_line_style(INK.mix(0.15))
            .light_line_style(INK.mix(0.04));
        if self.rows {
            mesh.disable_y_mesh();
        }
        // Stepping along an axis misses zero by rounding; a logarithmic one has no zero.
        let largest = |at: fn(&(f64, f64)) -> f64| {
            let all = self.series.iter().flat_map(|s| &s.points);
            all.fold(0.0f64, |m, p| m.max(at(p).abs()))
        };
        let tick = |v: f64, log: bool, largest: f64| {
            let is_zero = !log && v.abs() < 1e-9 * largest;
            short(if is_zero { 0.0 } else { v })
        };
        let (wide, high) = (largest(|p| p.0), largest(|p| p.1));
        let number = |v: &f64| {
            if self.rows {
                String::new()
            } else {
                tick(*v, self.log.1, high)
            }
        };
        mesh.x_label_formatter(&|v| tick(*v, self.log.0, wide))
            .y_label_formatter(&number)
            .draw()?;
        for (i, s) in self.series.iter().enumerate() {
            let colour = COLOURS[i % COLOURS.len()];
            let mut runs = s.points.split(|&p| !self.shows(p)).filter(|run| !run.is_empty());
            if matches!(s.mark, Mark::Line | Mark::LineAndDots) {
                for run in runs.by_ref() {
                    chart.draw_series(LineSeries::new(run.iter().copied(), colour.stroke_width(2)))?;
                }
            }
            // Of a spread the middle is the dot.
            let every = if s.mark == Mark::Spread { 3 } else { 1 };
            let dots = if s.mark == Mark::Line { &[][..] } else { &s.points[..] };
            for bar in s.points.chunks_exact(3).filter(|_| every == 3) {
                let [(x, y), (x0, y0), (x1, y1)] = [bar[0], bar[1], bar[2]];
                for line in [[(x0, y), (x1, y)], [(x, y0), (x, y1)]] {
                    if line.iter().all(|&p| self.shows(p)) {
                        chart.draw_series(LineSeries::new(line, colour.stroke_width(1)))?;
                    }
                }
            }
            let shown = dots.iter().step_by(every).copied().filter(|&p| self.shows(p));
            let key = move |(x, y)| Rectangle::new([(x, y - 2), (x + 18, y + 2)], colour.filled());
            chart
                .draw_series(shown.map(|p| Circle::new(p, 3, colour.filled())))?
                .label(&s.name)
                .legend(key);
        }
        let pixel = |p: &(f64, f64)| chart.backend_coord(p);
        self.write_words(area, pixel)?;
        if self.series.len() > 1 && self.beside {
            self.legend_on(area)?;
        } else if self.series.len() > 1 {
            let mut legend = chart.configure_series_labels();
            let corner = if self.low {
                SeriesLabelPosition::LowerRight
            } else {
                SeriesLabelPosition::UpperLeft
            };
            legend.position(corner).label_font(font(14));
            legend
                .background_style(WHITE.mix(0.85))
                .border_style(INK.mix(0.3))
                .draw()?;
        }
        Ok(())
    }

    /// The size at which the title is no wider than the axes: the library would cut off its beginning.
    fn title_size(&self) -> i32 {
        let room = self.size.0 as i32 - 24 - if self.beside { BESIDE - 12 } else { 0 };
        let letters = self.title.chars().count().max(1) as f64;
        TITLE.min(f64::from(room) / (LETTER * letters)) as i32
    }

    /// Words beside the points of spreads, each in the first place where it hides no other.
    fn write_words<'a>(&self, area: &Area<'a>, pixel: impl Fn(&(f64, f64)) -> (i32, i32)) -> Result<(), Trouble<'a>> {
        let (origin, size) = (area.get_base_pixel(), area.dim_in_pixel());
        let right = size.0 as i32 - if self.beside { BESIDE } else { 12 };
        let mut taken: Vec<[i32; 4]> = Vec::new();
        for s in self.series.iter().filter(|s| s.mark == Mark::Spread) {
            for (bar, word) in s.points.chunks_exact(3).zip(&s.words) {
                if word.is_empty() || !self.shows(bar[0]) {
                    continue;
                }
                let (x, y) = pixel(&bar[0]);
                let (x, y) = (x - origin.0, y - origin.1);
                let width = 7 * word.chars().count() as i32;
                let left = if x + 8 + width > right { x - 8 - width } else { x + 8 };
                let beside = self.rows.then_some(y - 7);
                let rows = beside
                    .into_iter()
                    .chain((0..12).flat_map(|k| [y - 16 - 14 * k, y + 4 + 14 * k]));
                let free = |top: &i32| {
                    let clear =
                        |t: &[i32; 4]| left >= t[2] || left + width <= t[0] || *top >= t[3] || *top + 13 <= t[1];
                    *top > 30 && *top + 62 < size.1 as i32 && taken.iter().all(clear)
                };
                let top = rows.clone().find(free).unwrap_or(y - 16);
                taken.push([left, top, left + width, top + 13]);
                let style = ("sans-serif", 12).into_font().color(&INK);
                area.draw(&Text::new(word.clone(), (left, top), style))?;
            }
        }
        Ok(())
    }

    /// The legend to the right of the axes.
    fn legend_on<'a>(&self, area: &Area<'a>) -> Result<(), Trouble<'a>> {
        let left = area.dim_in_pixel().0 as i32 - BESIDE + 14;
        for (i, s) in self.series.iter().enumerate() {
            let top = 52 + 22 * i as i32;
            let colour = COLOURS[i % COLOURS.len()];
            area.draw(&Rectangle::new(
                [(left, top + 5), (left + 18, top + 9)],
                colour.filled(),
            ))?;
            let style = ("sans-serif", 14).into_font().color(&INK);
            area.draw(&Text::new(s.name.clone(), (left + 26, top), style))?;
        }
        Ok(())
    }
}

/// A logarithmic axis with numbers of our choice: the library marks powers of ten only, which a narrow axis may lack.
fn log_axis(range: std::ops::Range<f64>) -> WithKeyPoints<LogCoord<f64>> {
    let ticks = log_ticks(range.start, range.end);
    range.log_scale().with_key_points(ticks)
}

/// Powers of ten, some ten at most, and where they are few some of their multiples.
fn log_ticks(lo: f64, hi: f64) -> Vec<f64> {
    let (first, last) = (lo.log10().floor() as i32, hi.log10().ceil() as i32);
    let digits: &[f64] = match (hi / lo).log10() {
        d if d < 1.0 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0],
        d if d < 3.0 => &[1.0, 2.0, 5.0],
        _ => &[1.0],
    };
    let step = 1 + (last - first) as usize / 10;
    let powers = (first..=last).step_by(step).map(|e| 10f64.powi(e));
    powers
        .flat_map(|p| digits.iter().map(move |d| d * p))
        .filter(|t| (lo..=hi).contains(t))
        .collect()
}

/// Charts beneath one another as SVG text, as wide as the widest.
///
/// # Errors
/// What the drawing library has to complain of.
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
    Ok(text)
}

/// Writes charts beneath one another to a file: quantities of different units over the same time, say.
///
/// # Errors
/// What kept the file from being written, with its name.
pub fn save_stack(charts: &[&Chart], path: impl AsRef<Path>) -> Result<(), String> {
    let path = path.as_ref();
    std::fs::write(path, stack(charts)?).map_err(|e| format!("{}: {e}", path.display()))
}

/// A number of an axis: plain where that is short, else with an exponent.
fn short(v: f64) -> String {
    let plain = v == 0.0 || (1e-3..1e5).contains(&v.abs());
    // Twelve digits drop what stepping along the axis has rounded.
    let v: f64 = format!("{v:.11e}").parse().unwrap_or(v);
    if plain { format!("{v}") } else { format!("{v:e}") }
}

#[cfg(test)]
#[path = "plot_tests.rs"]
mod tests;
