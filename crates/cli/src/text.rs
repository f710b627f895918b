//! What the commands print and write.

use std::path::Path;

use lin_canny_robot::plan::{CellPair, Checker, ConfigurationSpace};
use lin_canny_robot::{Coordinate, Trajectory};

use crate::end::ToolError;

/// Writes a file.
pub(crate) fn write(file: &Path, text: &str) -> Result<(), ToolError> {
    std::fs::write(file, text).map_err(|reason| ToolError::Write {
        file: file.to_owned(),
        reason,
    })
}

pub(crate) fn names<C: ConfigurationSpace>(checker: &Checker<C>, pair: CellPair) -> [String; 2] {
    [pair.a, pair.b].map(|part| checker.name(part).to_owned())
}

/// Returns a distance in metres to five digits, and how far from it both bounds are at most.
///
/// Minus infinity is a lower bound that is not known.
pub(crate) fn distance(lower: f64, upper: f64) -> String {
    if !upper.is_finite() {
        return format!("at least {} m", five_digits(lower - 6e-5 * lower.abs()));
    }
    if !lower.is_finite() {
        // Five digits are off by at most a part of 5e-5.
        return format!("at most {} m", five_digits(upper + 6e-5 * upper.abs()));
    }
    let text = five_digits(0.5 * (lower + upper));
    let value = text.parse().unwrap_or(upper);
    match f64::max(upper - value, value - lower) {
        0.0 => format!("{text} m"),
        // Two digits are off by at most 5 %.
        width => format!("{text} +- {:.1e} m", 1.06 * width),
    }
}

fn five_digits(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        size if size < 1e-3 => format!("{x:.4e}"),
        size => format!("{x:.0$}", f64::max(4.0 - size.log10().floor(), 0.0) as usize),
    }
}

/// Returns the values of a configuration with the names of the coordinates.
pub(crate) fn configuration(coordinates: &[Coordinate], values: &[f64]) -> String {
    let each = coordinates.iter().zip(values);
    let each: Vec<String> = each.map(|(c, value)| format!("{}={value}", c.name)).collect();
    each.join(" ")
}

/// Returns the position of a fraction of a segment, with its time if the file has times.
pub(crate) fn place(t: f64, time: Option<f64>) -> String {
    let time = time.map_or(String::new(), |time| format!(", time {time:.6}"));
    format!("at {t:.6} of the segment{time}")
}

/// Returns a fraction of a segment, rounded down.
pub(crate) fn fraction_below(t: f64) -> String {
    format!("{:.6}", (t * 1e6).floor() / 1e6)
}

/// Returns the time in the file at a fraction of the segment after row `k`.
pub(crate) fn time_at(rows: &Trajectory, k: usize, t: f64) -> Option<f64> {
    let times = rows.times.as_ref()?;
    Some(times[k] + (times[k + 1] - times[k]) * t)
}

/// A CSV table in memory.
pub(crate) struct Table(csv::Writer<Vec<u8>>);

impl Table {
    pub(crate) fn new<'a>(columns: impl IntoIterator<Item = &'a str>) -> Self {
        let mut table = Self(csv::Writer::from_writer(Vec::new()));
        table.row(columns);
        table
    }

    /// Writing to memory does not fail.
    pub(crate) fn row(&mut self, cells: impl IntoIterator<Item = impl AsRef<[u8]>>) {
        let _ = self.0.write_record(cells);
    }

    pub(crate) fn text(self) -> String {
        let bytes = self.0.into_inner().unwrap_or_default();
        String::from_utf8_lossy(&bytes).into_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::distance;

    #[test]
    fn printed_bounds_enclose_the_bounds() {
        assert_eq!(distance(0.25, 0.25), "0.25000 m");
        assert_eq!(distance(0.013_592_1, 0.013_592_3), "0.013592 +- 3.2e-7 m");
        assert_eq!(distance(2e-9, 2e-9), "2.0000e-9 m");
        assert_eq!(distance(f64::NEG_INFINITY, 0.0), "at most 0 m");
        assert_eq!(distance(f64::NEG_INFINITY, 0.123_451), "at most 0.12346 m");
        for k in -60..60 {
            let x = 0.3 * 1.7f64.powi(k);
            for (lower, upper) in [(x, x), (x, x * 1.001), (-x, x), (-x, -0.9 * x)] {
                let text = distance(lower, upper);
                let mut words = text.split(' ').filter_map(|word| word.parse::<f64>().ok());
                let [value, width] = [(); 2].map(|()| words.next().unwrap_or_default());
                let is_inside = value - width <= lower && upper <= value + width;
                assert!(is_inside, "{text} does not enclose {lower} to {upper}");
                assert!(width <= 1.2 * (upper - lower) + 1e-4 * x, "{text}");
            }
        }
    }
}
