//! The page: one HTML file with its pictures inside.

use std::fmt::Write as _;
use std::sync::Arc;

use lin_canny_study::{Study, StudyError};

use super::tables::Tables;
use super::{charts, scene};

const STYLE: &str = "body{font:15px/1.5 sans-serif;max-width:900px;margin:2em auto;padding:0 1em;color:#222;background:#fff}\
table{border-collapse:collapse;margin:1em 0}td,th{padding:.2em .8em;text-align:right;border-bottom:1px solid #ddd}\
td.w,th.w{text-align:left}svg{max-width:100%;height:auto}h2{margin-top:2em}";

/// Largest number of pairs in the table.
const PAIRS: usize = 20;

pub(super) fn page(study: &Arc<Study>, tables: &Tables, map: &[String]) -> Result<String, StudyError> {
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Clearances</title><style>{STYLE}</style>\n\
         <h1>Clearances of {} configurations</h1>\n<p>{}. Robot, cell and options: <code>{}</code>.</p>\n",
        tables.rows,
        escaped(&tables.headline()),
        study.fingerprint()
    );
    page += "<h2>Histogram</h2>\n";
    page += &charts::histogram(tables)?;
    if let [x, y] = map {
        let limits = |name: &String| {
            let found = study.coordinates().iter().find(|c| c.name == *name);
            found.map_or([0.0, 1.0], |c| c.limits)
        };
        let (x_name, y_name) = (escaped(x), escaped(y));
        let _ = writeln!(
            page,
            "<h2>Map over two joints</h2>\n<p>The rows by {x_name} and {y_name}: blue where none is in contact, red where all \
             are, pale between; white without a row.</p>"
        );
        page += &charts::map(tables, [x, y], [limits(x), limits(y)])?;
    }
    page += &pairs(tables);
    page += &worst(study, tables);
    if let Some(row) = tables.worst.first() {
        page += "<h2>The worst row</h2>\n";
        page += &scene::picture(study, row)?;
    }
    page += "</html>\n";
    Ok(page)
}

fn pairs(tables: &Tables) -> String {
    let mut text = String::from(
        "<h2>Closest pairs</h2>\n<table><tr><th class=\"w\">pair<th>rows<th>in contact<th>least clearance</tr>\n",
    );
    for pair in tables.pairs.iter().take(PAIRS) {
        let [a, b] = pair.pair.each_ref().map(|name| escaped(name));
        let _ = writeln!(
            text,
            "<tr><td class=\"w\">{a} – {b}<td>{}<td>{}<td>{:.6}</tr>",
            pair.rows, pair.contacts, pair.least
        );
    }
    text += "</table>\n";
    if tables.pairs.len() > PAIRS {
        let _ = writeln!(
            text,
            "<p>{} more pairs are the closest of fewer rows.</p>",
            tables.pairs.len() - PAIRS
        );
    }
    text
}

fn worst(study: &Arc<Study>, tables: &Tables) -> String {
    let mut text =
        String::from("<h2>Worst rows</h2>\n<table><tr><th>row<th class=\"w\">pair<th>clearance<th>proven at least");
    for coordinate in study.coordinates() {
        let _ = write!(text, "<th>{}", escaped(&coordinate.name));
    }
    text += "</tr>\n";
    for (k, row) in tables.worst.iter().enumerate() {
        let [a, b] = row.pair.each_ref().map(|name| escaped(name));
        let id = row.id.clone().unwrap_or_else(|| (k + 1).to_string());
        let _ = write!(
            text,
            "<tr><td>{}<td class=\"w\">{a} – {b}<td>{:.6}<td>{:.6}",
            escaped(&id),
            row.distance,
            row.lower
        );
        for value in &row.configuration {
            let _ = write!(text, "<td>{value:.4}");
        }
        text += "</tr>\n";
    }
    text + "</table>\n"
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
