//! Drawing of a chart.

use super::{Chart, Mark, Series};
use plotters::coord::Shift;
use plotters::coord::combinators::WithKeyPoints;
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;

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

/// Colour of a backdrop.
const PALE: RGBColor = RGBColor(200, 205, 200);

/// Dark grey of text and axes.
const INK: RGBColor = RGBColor(40, 40, 40);

/// Drawing area of a chart.
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Error of the drawing library.
type Trouble<'a> = DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>;

/// Width of a legend to the right of the axes.
const BESIDE: i32 = 250;

/// Size of a title, and largest width of a letter in units of it.
pub(super) const TITLE: f64 = 20.0;
const LETTER: f64 = 0.42;

impl Chart {
    pub(super) fn draw_on<'a>(&self, area: &Area<'a>) -> Result<(), Trouble<'a>> {
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
            mesh.disable_y_mesh().set_tick_mark_size(LabelAreaPosition::Left, 0);
        }
        // Rounding makes an axis miss zero; a logarithmic axis has no zero.
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
            if self.rows || self.whole && (v - v.round()).abs() > 1e-9 * high {
                String::new()
            } else {
                tick(*v, self.log.1, high)
            }
        };
        mesh.x_label_formatter(&|v| tick(*v, self.log.0, wide))
            .y_label_formatter(&number)
            .draw()?;
        for (i, s) in self.series.iter().enumerate() {
            self.draw_series(&mut chart, s, colour(i, s))?;
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

    /// Returns the size at which the title is no wider than the axes: the library would cut off its
    /// start.
    pub(super) fn title_size(&self) -> i32 {
        let room = self.size.0 as i32 - 24 - if self.beside { BESIDE - 12 } else { 0 };
        let letters = self.title.chars().count().max(1) as f64;
        TITLE.min(f64::from(room) / (LETTER * letters)) as i32
    }

    /// Draws lines, the bars of spreads, and dots. Dots of spreads are at their medians.
    fn draw_series<'a, X, Y>(
        &self,
        chart: &mut ChartContext<'_, SVGBackend<'a>, Cartesian2d<X, Y>>,
        s: &Series,
        colour: RGBColor,
    ) -> Result<(), Trouble<'a>>
    where
        X: Ranged<ValueType = f64>,
        Y: Ranged<ValueType = f64>,
    {
        if s.has_line() {
            for run in s.points.split(|&p| !self.shows(p)).filter(|run| !run.is_empty()) {
                chart.draw_series(LineSeries::new(run.iter().copied(), colour.stroke_width(2)))?;
            }
        }
        let is_spread = s.mark == Mark::Spread;
        for bar in s.points.chunks_exact(3).filter(|_| is_spread) {
            let [(x, y), (x0, y0), (x1, y1)] = [bar[0], bar[1], bar[2]];
            for line in [[(x0, y), (x1, y)], [(x, y0), (x, y1)]] {
                if line.iter().all(|&p| self.shows(p)) {
                    chart.draw_series(LineSeries::new(line, colour.stroke_width(1)))?;
                }
            }
        }
        let dots = if s.mark == Mark::Line { &[][..] } else { &s.points[..] };
        let shown = dots.iter().step_by(if is_spread { 3 } else { 1 }).copied();
        let shown = shown.filter(|&p| self.shows(p));
        let radius = if s.mark == Mark::Backdrop { 2 } else { 3 };
        let drawn = chart.draw_series(shown.map(|p| Circle::new(p, radius, colour.filled())))?;
        let annotated = drawn.label(&s.name);
        if s.has_line() {
            annotated.legend(move |(x, y)| Rectangle::new([(x, y - 2), (x + 18, y + 2)], colour.filled()));
        } else {
            annotated.legend(move |(x, y)| Circle::new((x + 9, y), 4, colour.filled()));
        }
        Ok(())
    }

    /// Writes words next to the points of spreads, each at the first position where it hides no
    /// other word.
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

    /// Draws the legend to the right of the axes.
    fn legend_on<'a>(&self, area: &Area<'a>) -> Result<(), Trouble<'a>> {
        let left = area.dim_in_pixel().0 as i32 - BESIDE + 14;
        for (i, s) in self.series.iter().enumerate() {
            let top = 52 + 22 * i as i32;
            let colour = colour(i, s).filled();
            if s.has_line() {
                area.draw(&Rectangle::new([(left, top + 5), (left + 18, top + 9)], colour))?;
            } else {
                area.draw(&Circle::new((left + 9, top + 7), 4, colour))?;
            }
            let style = ("sans-serif", 14).into_font().color(&INK);
            area.draw(&Text::new(s.name.clone(), (left + 26, top), style))?;
        }
        Ok(())
    }
}

/// Returns the colour of a series by its number; a backdrop is pale.
fn colour(number: usize, series: &Series) -> RGBColor {
    if series.mark == Mark::Backdrop {
        PALE
    } else {
        COLOURS[number % COLOURS.len()]
    }
}

impl Series {
    fn has_line(&self) -> bool {
        matches!(self.mark, Mark::Line | Mark::LineAndDots)
    }
}

/// Returns a logarithmic axis with our numbers: the library marks only powers of ten, which a
/// narrow axis may lack.
fn log_axis(range: std::ops::Range<f64>) -> WithKeyPoints<LogCoord<f64>> {
    let ticks = log_ticks(range.start, range.end);
    range.log_scale().with_key_points(ticks)
}

/// Returns about ten powers of ten at most and, if they are few, some of their multiples.
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

/// Formats a number of an axis: plain if that is short, otherwise with an exponent.
pub(super) fn short(v: f64) -> String {
    let plain = v == 0.0 || (1e-3..1e5).contains(&v.abs());
    // Twelve digits remove the rounding errors of stepping along the axis.
    let v: f64 = format!("{v:.11e}").parse().unwrap_or(v);
    if plain { format!("{v}") } else { format!("{v:e}") }
}
