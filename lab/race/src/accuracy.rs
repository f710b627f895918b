//! Charts of time and error of each accuracy level, from the rows of a record.
//!
//! Families name bodies and motion:
//!
//! - `sphere 0.5deg`, `sphere random`, `motion 0.1deg` (spheres too) and `sphere gap 1e-3`
//! - `ball`: a sphere replaced by a hull
//! - `curved cylinder-cone`: curved shapes (n = 0) or their hulls
//! - `nonconvex rings`: n is the number of triangles or pieces
//! - `asking 0.05deg`: one motion, every question
//!
//! Engines and levels are defined by the instrument `accuracy_cost`.

use crate::plot::{Chart, Spread};
use crate::record::{Row, spread};
use std::collections::BTreeMap;

/// Lower limit of the drawn errors; smaller errors and zero are drawn here.
pub const FLOOR: f64 = 1e-18;

/// Engines in the order of their colours, with their names in legends.
const ENGINES: [(&str, &str); 6] = [
    ("ours", "lin-canny, tracked"),
    ("ours-cold", "lin-canny, new tracker each time"),
    ("gjk-cached", "parry's GJK f64, simplex kept"),
    ("gjk-cold", "parry's GJK f64, nothing kept"),
    ("parry-f64", "parry f64"),
    ("parry-f32", "parry f32"),
];

/// The lines of a time chart: engine, level, legend.
const LINES: [(&str, &str, &str); 6] = [
    ("ours", "certified", "ours, certified"),
    ("ours", "walk", "ours, the walk alone"),
    ("ours", "exact", "ours, exact"),
    ("gjk-cached", "closest", "parry's GJK f64, simplex kept"),
    ("parry-f64", "distance", "parry f64"),
    ("parry-f32", "distance", "parry f32"),
];

/// Time and error of one engine and level on one family.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Least, median and greatest nanoseconds per query.
    pub ns: [f64; 3],
    /// Least, median and greatest error, relative to the size of the pair.
    pub err: [f64; 3],
}

/// Returns the cell of the matching rows; `None` if there are none.
pub fn cell(rows: &[Row], engine: &str, level: &str, family: &str, n: usize) -> Option<Cell> {
    let of = |r: &&Row| r.engine == engine && r.level == level && r.family == family && r.n == n;
    let mine: Vec<&Row> = rows.iter().filter(of).collect();
    (!mine.is_empty()).then(|| Cell {
        ns: spread(mine.iter().map(|r| r.ns)),
        err: spread(mine.iter().map(|r| r.err)),
    })
}

/// Returns the levels of an engine on a family, in the order of the record.
fn levels(rows: &[Row], engine: &str, family: &str, n: usize) -> Vec<String> {
    let mut all = Vec::new();
    for r in rows
        .iter()
        .filter(|r| r.engine == engine && r.family == family && r.n == n)
    {
        if !all.contains(&r.level) {
            all.push(r.level.clone());
        }
    }
    all
}

/// Returns a family as words of a title.
fn reported(family: &str) -> String {
    let (what, motion) = family.split_once(' ').unwrap_or((family, ""));
    match motion.strip_suffix("deg") {
        Some(degrees) => {
            let unit = if degrees == "1" { "degree" } else { "degrees" };
            let motion = format!("{degrees} {unit} per frame");
            if what == "asking" {
                motion
            } else {
                format!("{what}, {motion}")
            }
        }
        None => family.replacen(' ', ", ", 1),
    }
}

/// The levels of this crate in pictures.
const LEVELS: [(&str, &str); 3] = [("walk", "nothing proven"), ("certified", "proven"), ("exact", "exact")];

/// Draws error against time: one point for each engine and level, with its spread.
pub fn error_and_time(rows: &[Row], family: &str, n: usize) -> Chart {
    let mut chart = Chart::new(format!(
        "error and time of a query: {}, {n} vertices a body",
        reported(family)
    ))
    .axes(
        "nanoseconds a query",
        format!("error over the size of the pair ({FLOOR:e}: none seen)"),
    )
    .log_x()
    .log_y()
    .size(880, 440)
    .legend_beside();
    for (engine, name) in ENGINES {
        let mut points: Vec<Spread> = Vec::new();
        for level in levels(rows, engine, family, n) {
            let Some(c) = cell(rows, engine, &level, family, n) else {
                continue;
            };
            points.push(Spread {
                x: c.ns,
                y: c.err.map(|e| e.max(FLOOR)),
                word: if engine.starts_with("ours") {
                    let known = LEVELS.iter().find(|(name, _)| *name == level);
                    known.map_or(level, |(_, word)| (*word).to_owned())
                } else {
                    String::new()
                },
            });
        }
        if !points.is_empty() {
            chart = chart.spreads(name, points);
        }
    }
    chart
}

/// The rows of the table: engine, level, description.
const TABLE: [(&str, &str, &str); 7] = [
    ("ours", "walk", "`propose`, tracked"),
    ("ours", "certified", "`closest`, tracked"),
    ("ours", "exact", "`closest_exact`, tracked"),
    ("ours-cold", "certified", "`closest`, a new tracker every time"),
    ("gjk-cached", "closest", "parry's GJK f64, simplex kept"),
    ("parry-f64", "distance", "parry f64"),
    ("parry-f32", "distance", "parry f32"),
];

/// Returns a Markdown table of nanoseconds per query, and the greatest error relative to the size
/// of the pair.
pub fn table(rows: &[Row], family: &str, sizes: &[usize]) -> String {
    let mut out = String::from("| |");
    sizes.iter().for_each(|n| out += &format!(" n = {n} |"));
    out += " greatest error over L |\n|---|";
    sizes.iter().for_each(|_| out += "---:|");
    out += "---:|\n";
    for (engine, level, words) in TABLE {
        let cells: Vec<Option<Cell>> = sizes.iter().map(|&n| cell(rows, engine, level, family, n)).collect();
        let worst = spread(cells.iter().flatten().map(|c| c.err[2]))[2];
        let number = |c: &Option<Cell>| c.as_ref().map_or(String::new(), |c| format!(" {:.0} |", c.ns[1]));
        out += &format!("| {words} |");
        cells.iter().for_each(|c| out += &number(c));
        out += &if worst == 0.0 {
            " none seen |\n".to_owned()
        } else {
            format!(" {worst:.0e} |\n")
        };
    }
    out
}

/// Adds a line for each engine and level, over the rows for which `x` returns an abscissa.
fn lines(mut chart: Chart, rows: &[Row], x: impl Fn(&Row) -> Option<f64>) -> Chart {
    for (engine, level, name) in LINES {
        let mut at: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
        for r in rows.iter().filter(|r| r.engine == engine && r.level == level) {
            if let Some(place) = x(r) {
                at.entry(place.to_bits()).or_default().push(r.ns);
            }
        }
        let points: Vec<(f64, f64)> = at
            .into_iter()
            .map(|(x, ns)| (f64::from_bits(x), spread(ns)[1]))
            .collect();
        if points.len() > 1 {
            chart = chart.curve(name, points);
        }
    }
    chart
}

/// Draws time against the number of vertices.
pub fn time_and_size(rows: &[Row], family: &str) -> Chart {
    let chart = Chart::new(format!("time of a query: {}", reported(family)))
        .axes("vertices a body", "nanoseconds a query")
        .log_x()
        .log_y()
        .size(880, 440)
        .legend_beside();
    lines(chart, rows, |r| (r.family == family).then_some(r.n as f64))
}

/// Draws time against motion per frame: families `motion Xdeg` of `n` vertices.
pub fn time_and_motion(rows: &[Row], n: usize) -> Chart {
    let chart = Chart::new(format!("time of a query: spheres of {n} vertices"))
        .axes("degrees that B orbits and turns a frame", "nanoseconds a query")
        .log_x()
        .log_y()
        .size(880, 440)
        .legend_beside();
    lines(chart, rows, |r| {
        let degrees = r.family.strip_prefix("motion ")?.strip_suffix("deg")?;
        (r.n == n).then(|| degrees.parse().ok())?
    })
}

/// Returns the gap X of a row of `family gap X`.
fn gap_of(row: &Row, family: &str) -> Option<f64> {
    row.family.strip_prefix(family)?.strip_prefix(" gap ")?.parse().ok()
}

/// Draws time against the gap: families `family gap X`.
pub fn time_and_gap(rows: &[Row], family: &str, n: usize) -> Chart {
    let chart = Chart::new(format!("time of a query near contact: {family}, {n} vertices a body"))
        .axes("gap over the size of the pair", "nanoseconds a query")
        .log_x()
        .log_y()
        .size(880, 440)
        .legend_beside();
    lines(chart, rows, |r| gap_of(r, family).filter(|_| r.n == n))
}

/// Draws error against the gap, both relative to the size of the pair.
pub fn error_and_gap(rows: &[Row], family: &str, n: usize) -> Chart {
    let mut chart = Chart::new(format!("error near contact: {family}, {n} vertices a body"))
        .axes("gap over the size of the pair", "error over the size of the pair")
        .log_x()
        .log_y()
        .size(880, 440)
        .legend_beside();
    for (engine, level, name) in LINES {
        let mut at: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
        for r in rows
            .iter()
            .filter(|r| r.engine == engine && r.level == level && r.n == n)
        {
            if let Some(gap) = gap_of(r, family) {
                at.entry(gap.to_bits()).or_default().push(r.err.max(FLOOR));
            }
        }
        let points: Vec<(f64, f64)> = at.into_iter().map(|(x, e)| (f64::from_bits(x), spread(e)[2])).collect();
        if points.len() > 1 {
            chart = chart.curve(name, points);
        }
    }
    let gaps: Vec<f64> = rows.iter().filter_map(|r| gap_of(r, family)).collect();
    let [least, _, most] = spread(gaps);
    chart.line("(as large as the gap)", [(least, least), (most, most)])
}

/// Draws the cost of geometric accuracy: time against the error of hulls that replace spheres.
pub fn geometry(rows: &[Row]) -> Chart {
    let mut chart = Chart::new("a sphere replaced by a hull of 12 to 100,000 vertices")
        .axes(
            "error of the distance of two spheres, over the size of the pair",
            "nanoseconds a query",
        )
        .log_x()
        .log_y()
        .size(880, 440)
        .legend_beside();
    for (engine, level, name) in LINES {
        let of = |r: &&Row| r.family == "ball" && r.engine == engine && r.level == level;
        let mut by_n: BTreeMap<usize, (Vec<f64>, Vec<f64>)> = BTreeMap::new();
        for r in rows.iter().filter(of) {
            let at = by_n.entry(r.n).or_default();
            at.0.push(r.err);
            at.1.push(r.ns);
        }
        let points: Vec<(f64, f64)> = by_n.into_values().map(|(e, t)| (spread(e)[2], spread(t)[1])).collect();
        if points.len() > 1 {
            chart = chart.curve(name, points);
        }
    }
    chart
}

/// Returns the numbers of vertices or pieces in the rows of a family, in order.
fn sizes(rows: &[Row], family: &str) -> Vec<usize> {
    let mut sizes: Vec<usize> = rows.iter().filter(|r| r.family == family).map(|r| r.n).collect();
    sizes.sort_unstable();
    sizes.dedup();
    sizes
}

/// Draws the cost of an exact nonconvex mesh: time against error for the mesh, its hull, and pieces
/// of a decomposition.
pub fn nonconvex(rows: &[Row], scene: &str) -> Chart {
    let family = format!("nonconvex {scene}");
    let mut chart = Chart::new(format!("{scene}: as a mesh, as its hull, and as convex pieces"))
        .axes(
            format!("error of the distance over the size of the pair ({FLOOR:e}: none seen)"),
            "nanoseconds a query",
        )
        .log_x()
        .log_y()
        .size(880, 440)
        .legend_beside();
    let alike = [
        ("ours", "mesh", "ours, the mesh itself"),
        ("ours", "hull", "ours, the convex hull"),
        ("ours", "pieces", "ours, so many pieces of V-HACD"),
        ("parry-f64", "mesh", "parry f64, the mesh itself"),
    ];
    for (engine, level, name) in alike {
        let point = |n: usize| {
            let c = cell(rows, engine, level, &family, n)?;
            Some(Spread {
                x: c.err.map(|e| e.max(FLOOR)),
                y: c.ns,
                word: if level == "pieces" {
                    n.to_string()
                } else {
                    String::new()
                },
            })
        };
        let points: Vec<Spread> = sizes(rows, &family).into_iter().filter_map(point).collect();
        if !points.is_empty() {
            chart = chart.spreads(name, points);
        }
    }
    chart
}

/// Draws the cost of curved shapes: time against error for a pair as itself, and replaced by hulls.
pub fn curved(rows: &[Row], pair: &str) -> Chart {
    let family = format!("curved {pair}");
    let of = |engine: &str, level: &str, n: usize| cell(rows, engine, level, &family, n);
    let sizes = sizes(rows, &family);
    let hulls = sizes.iter().filter_map(|&n| of("ours", "hull", n));
    let hulls: Vec<(f64, f64)> = hulls.map(|c| (c.err[2].max(FLOOR), c.ns[1])).collect();
    let range = match (sizes.iter().find(|&&n| n > 0), sizes.last()) {
        (Some(least), Some(most)) => format!("ours, hulls of {least} to {most} vertices"),
        _ => String::new(),
    };
    let mut chart = Chart::new(format!("{pair}: as curved shapes, and as hulls"))
        .axes("error of the distance over the size of the pair", "nanoseconds a query")
        .log_x()
        .log_y()
        .size(880, 440)
        .legend_beside()
        .curve(range, hulls);
    let alone = [
        ("ours", "certified", "ours, the shapes themselves"),
        ("ours-cold", "certified", "ours, nothing kept"),
        ("gjk-cached", "closest", "parry's GJK f64, direction kept"),
    ];
    for (engine, level, name) in alone {
        if let Some(c) = of(engine, level, 0) {
            let point = Spread {
                x: c.err.map(|e| e.max(FLOOR)),
                y: c.ns,
                word: String::new(),
            };
            chart = chart.spreads(name, [point]);
        }
    }
    chart
}

/// Draws the cost of each question: one line each, with the error of its answers.
pub fn asking(rows: &[Row], family: &str, n: usize) -> Chart {
    let mut chart = Chart::new(format!(
        "what asking less saves: {}, {n} vertices a body",
        reported(family)
    ))
    .axes(
        "nanoseconds a query; beside the question the greatest error seen, over the size of the pair",
        "",
    )
    .log_x()
    .rows()
    .size(880, 440)
    .legend_beside();
    let engines = [
        ("ours", "ours"),
        ("detail", "ours, on inner hulls"),
        ("parry-f64", "parry f64"),
    ];
    let count: usize = engines.iter().map(|e| levels(rows, e.0, family, n).len()).sum();
    let mut line = count as f64;
    for (engine, name) in engines {
        let mut points = Vec::new();
        for level in levels(rows, engine, family, n) {
            let Some(c) = cell(rows, engine, &level, family, n) else {
                continue;
            };
            let error = match c.err[2] {
                e if e.is_nan() => String::new(),
                0.0 => ": none seen".into(),
                e => format!(": {e:.0e}"),
            };
            points.push(Spread {
                x: c.ns,
                y: [line; 3],
                word: level + &error,
            });
            line -= 1.0;
        }
        if !points.is_empty() {
            chart = chart.spreads(name, points);
        }
    }
    chart
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<Row> {
        let row = |engine: &str, level: &str, family: &str, n, ns, err| Row {
            engine: engine.into(),
            level: level.into(),
            family: family.into(),
            n,
            ns,
            err,
        };
        let mut all = vec![
            row("ours", "overlap?", "asking 0.05deg", 8, 30.0, f64::NAN),
            row("ours", "certified", "curved cone-cone", 0, 300.0, 1e-17),
            row("ours", "hull", "curved cone-cone", 16, 80.0, 1e-2),
            row("ours", "hull", "curved cone-cone", 64, 90.0, 1e-3),
        ];
        for k in 1..4 {
            let (n, x) = (8 << k, f64::from(k));
            for (engine, level) in [("ours", "certified"), ("ours", "walk"), ("parry-f64", "distance")] {
                all.push(row(engine, level, "sphere 0.5deg", n as usize, 80.0 + x, 1e-17 * x));
                all.push(row(engine, level, &format!("motion {k}deg"), 8, 90.0 * x, 0.0));
                all.push(row(engine, level, &format!("sphere gap 1e-{k}"), 8, 90.0 * x, 0.0));
                all.push(row(engine, level, "ball", n as usize, 80.0, 0.1 / x));
            }
        }
        all.push(row("ours", "mesh", "nonconvex rings", 900, 3e3, 0.0));
        all.push(row("ours", "pieces", "nonconvex rings", 12, 2e3, 1e-2));
        all
    }

    #[test]
    fn every_picture_shows_its_rows() {
        let rows = rows();
        let pictures = [
            (
                error_and_time(&rows, "sphere 0.5deg", 16),
                vec!["lin-canny, tracked", "nothing proven", "parry f64"],
            ),
            (
                time_and_size(&rows, "sphere 0.5deg"),
                vec!["ours, certified", "parry f64"],
            ),
            (time_and_motion(&rows, 8), vec!["ours, certified"]),
            (time_and_gap(&rows, "sphere", 8), vec!["ours, the walk alone"]),
            (error_and_gap(&rows, "sphere", 8), vec!["ours, the walk alone"]),
            (geometry(&rows), vec!["ours, certified", "parry f64"]),
            (asking(&rows, "asking 0.05deg", 8), vec!["overlap?"]),
            (curved(&rows, "cone-cone"), vec!["hulls of 16 to 64", "themselves"]),
            (nonconvex(&rows, "rings"), vec!["the mesh itself", "pieces of V-HACD"]),
        ];
        for (chart, words) in pictures {
            let svg = chart.svg().unwrap();
            for word in words {
                assert!(svg.contains(word), "{word}");
            }
            assert!(svg.contains("circle") && !svg.contains("NaN"));
        }
    }

    #[test]
    fn the_table_has_a_line_for_each_level() {
        let text = table(&rows(), "sphere 0.5deg", &[16, 32]);
        assert!(text.starts_with("| | n = 16 | n = 32 | greatest error over L |\n|---|---:|---:|---:|\n"));
        assert!(text.contains("| `closest`, tracked | 81 | 82 | 2e-17 |\n"), "{text}");
    }

    #[test]
    fn a_cell_is_the_middle_of_its_rows() {
        let mut rows = rows();
        rows.push(Row {
            ns: 1.0,
            ..rows[4].clone()
        });
        rows.push(Row {
            ns: 1000.0,
            ..rows[4].clone()
        });
        let c = cell(&rows, "ours", "certified", "sphere 0.5deg", 16).unwrap();
        assert_eq!(c.ns, [1.0, 81.0, 1000.0]);
        assert!(cell(&rows, "ours", "none", "sphere 0.5deg", 16).is_none());
    }
}
