//! Records of measurements: one row per pass, as CSV.
//!
//! Rows with the same engine, level, family and number of vertices are repetitions: time and error
//! of different stretches of one motion. A table shows their median, and their range is the spread.

use std::fmt::Write as _;
use std::path::Path;

/// The first line of a file.
pub const COLUMNS: &str = "engine,level,family,n,ns,err";

/// One measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Engine.
    pub engine: String,
    /// Level of accuracy, or question.
    pub level: String,
    /// Bodies and motion.
    pub family: String,
    /// Vertices of a body.
    pub n: usize,
    /// Nanoseconds per query; NaN if not timed.
    pub ns: f64,
    /// Largest error relative to the size of the pair; NaN if not measured.
    pub err: f64,
}

/// Returns the least, median and greatest number, without NaNs; NaN if there is none.
pub fn spread(values: impl IntoIterator<Item = f64>) -> [f64; 3] {
    let mut all: Vec<f64> = values.into_iter().filter(|v| !v.is_nan()).collect();
    all.sort_by(f64::total_cmp);
    match all.len() {
        0 => [f64::NAN; 3],
        n => [all[0], all[n / 2], all[n - 1]],
    }
}

/// Returns the rows as text.
pub fn text(rows: &[Row]) -> String {
    let mut out = format!("{COLUMNS}\n");
    let number = |x: f64, digits: usize| {
        if x.is_nan() {
            String::new()
        } else {
            format!("{x:.digits$e}")
        }
    };
    for r in rows {
        let ns = if r.ns.is_nan() {
            String::new()
        } else {
            format!("{:.1}", r.ns)
        };
        let err = number(r.err, 2);
        let _ = writeln!(out, "{},{},{},{},{ns},{err}", r.engine, r.level, r.family, r.n);
    }
    out
}

/// Reads a file of rows.
///
/// # Errors
/// Returns an error that names the file, and the line that is not a row.
pub fn read(path: impl AsRef<Path>) -> Result<Vec<Row>, String> {
    let path = path.as_ref();
    let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    parse(&text).map_err(|e| format!("{}: {e}", path.display()))
}

fn parse(text: &str) -> Result<Vec<Row>, String> {
    let mut lines = text.lines().enumerate();
    if lines.next().is_none_or(|(_, l)| l != COLUMNS) {
        return Err(format!("the first line is not {COLUMNS}"));
    }
    lines
        .map(|(k, l)| row(l).ok_or(format!("line {} is no row", k + 1)))
        .collect()
}

fn row(line: &str) -> Option<Row> {
    let words: Vec<&str> = line.split(',').collect();
    let [engine, level, family, n, ns, err] = words[..] else {
        return None;
    };
    let number = |w: &str| if w.is_empty() { Some(f64::NAN) } else { w.parse().ok() };
    Some(Row {
        engine: engine.into(),
        level: level.into(),
        family: family.into(),
        n: n.parse().ok()?,
        ns: number(ns)?,
        err: number(err)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let row = |ns, err| Row {
            engine: "ours".into(),
            level: "walk".into(),
            family: "sphere".into(),
            n: 8,
            ns,
            err,
        };
        let rows = vec![row(12.5, 1e-17), row(900.0, 0.0)];
        assert_eq!(parse(&text(&rows)).unwrap(), rows);
        let open = parse(&text(&[row(f64::NAN, f64::NAN)])).unwrap();
        assert!(open[0].ns.is_nan() && open[0].err.is_nan());
        assert!(parse("a,b\n").is_err());
        assert_eq!(
            parse(&format!("{COLUMNS}\na,b,c,1,2\n")).unwrap_err(),
            "line 2 is no row"
        );
    }

    #[test]
    fn the_spread_leaves_out_what_is_not_there() {
        assert_eq!(spread([3.0, f64::NAN, 1.0, 2.0]), [1.0, 2.0, 3.0]);
        assert!(spread([])[1].is_nan());
    }
}
