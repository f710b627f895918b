//! A row for each pair, and the outputs that are made of rows.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::Path;

use lin_canny::nalgebra::Vector3;
use lin_canny::polyhedron::BoxHint;
use serde::{Deserialize, Serialize};

use crate::error::ClashError;
use crate::model::{Model, Unit};
use crate::rules::larger;

/// How two parts are to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Kind {
    /// Apart, with a gap that is wide enough.
    Apart,
    /// They touch and share no volume.
    Touching,
    /// The gap is less than the pair must keep.
    Close,
    /// The bounds do not decide whether they touch.
    Undecided,
    /// Surfaces cross, and one of the parts has no inside.
    Crossing,
    /// They share a volume.
    Overlapping,
    /// One part is wholly in the other, up to 1e-9 of its volume.
    Inside,
    /// Both are the same solid in the same place, up to 1e-9 of their volume.
    Equal,
}

impl std::fmt::Display for Kind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Apart => "apart",
            Self::Touching => "touching",
            Self::Close => "close",
            Self::Undecided => "undecided",
            Self::Crossing => "crossing",
            Self::Overlapping => "overlapping",
            Self::Inside => "inside",
            Self::Equal => "equal",
        })
    }
}

/// Two parts that are near each other. Lengths are in the unit of the model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Row {
    /// The name of the first part.
    pub a: String,
    /// The name of the second part.
    pub b: String,
    /// How the parts are to each other.
    pub kind: Kind,
    /// Bounds of the gap; zero for parts that touch or overlap.
    pub gap: [f64; 2],
    /// Bounds of the penetration depth: the shortest translation that separates the parts. Zero for parts
    /// that do not overlap, and where a part has no inside.
    pub depth: [f64; 2],
    /// Bounds of the volume that they share, if it was asked for and is known.
    pub volume: Option<[f64; 2]>,
    /// A point of both parts, or the closest point of the first; with a volume, its centre of mass.
    pub point: [f64; 3],
    /// The rule that is broken, or that allows the overlap.
    pub rule: Option<String>,
    /// Whether the pair clashes: it overlaps without a rule that allows it, or breaks a rule.
    pub broken: bool,
    /// Why something is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

impl Row {
    /// Returns the row as a line of JSON.
    #[must_use]
    pub fn to_json(&self) -> String {
        // Numbers that are not finite become null, so that this cannot fail.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Returns what the row says, for people.
    #[must_use]
    pub fn text(&self) -> String {
        let range = |[low, high]: [f64; 2]| match high - low <= 1e-6 * high {
            true => format!("{high:.6}"),
            false => format!("{low:.6} to {high:.6}"),
        };
        let mut text = match self.kind {
            Kind::Apart | Kind::Close | Kind::Undecided => format!("{}, gap {}", self.kind, range(self.gap)),
            Kind::Touching | Kind::Crossing => self.kind.to_string(),
            _ => format!("{}, depth {}", self.kind, range(self.depth)),
        };
        if let Some(volume) = self.volume {
            let _ = write!(text, ", volume {:.6e}", 0.5 * (volume[0] + volume[1]));
        }
        // No minus before a zero.
        let [x, y, z] = self.point.map(|x| if x.abs() < 5e-7 { 0.0 } else { x });
        let _ = write!(text, ", at ({x:.6}, {y:.6}, {z:.6})");
        match &self.rule {
            Some(rule) if self.broken => {
                let _ = write!(text, ", breaks {rule}");
            }
            Some(rule) => {
                let _ = write!(text, ", allowed by {rule}");
            }
            None => {}
        }
        if let Some(note) = &self.note {
            let _ = write!(text, ": {note}");
        }
        text
    }

    /// Returns how bad the row is: broken rows first, deep ones before shallow ones.
    fn badness(&self) -> (bool, Kind, f64, f64) {
        (self.broken, self.kind, self.depth[1], -self.gap[0])
    }

    /// Returns whether the row is worse than an earlier one: of a worse kind, broken only now, or deeper or
    /// closer beyond the bounds of both.
    #[must_use]
    pub fn is_worse_than(&self, earlier: &Self) -> bool {
        self.broken && !earlier.broken
            || self.kind > earlier.kind
            || self.depth[0] > earlier.depth[1]
            || self.kind == Kind::Close && self.gap[1] < earlier.gap[0]
    }
}

/// Returns rows with the worst first.
#[must_use]
pub fn worst_first(rows: &[Row]) -> Vec<&Row> {
    let mut sorted: Vec<&Row> = rows.iter().collect();
    sorted.sort_by(|x, y| {
        let (x, y) = (x.badness(), y.badness());
        (y.0, y.1)
            .cmp(&(x.0, x.1))
            .then(y.2.total_cmp(&x.2))
            .then(y.3.total_cmp(&x.3))
    });
    sorted
}

/// Returns rows as CSV with a header.
#[must_use]
pub fn to_csv(rows: &[Row]) -> String {
    let mut table = csv::Writer::from_writer(Vec::new());
    // Writing to memory does not fail.
    let _ = table.write_record([
        "a",
        "b",
        "kind",
        "gap_lower",
        "gap_upper",
        "depth_lower",
        "depth_upper",
        "volume_lower",
        "volume_upper",
        "x",
        "y",
        "z",
        "rule",
        "broken",
        "note",
    ]);
    for row in rows {
        let [low, high] = row
            .volume
            .map_or([String::new(), String::new()], |v| v.map(|x| x.to_string()));
        let _ = table.write_record([
            row.a.clone(),
            row.b.clone(),
            row.kind.to_string(),
            row.gap[0].to_string(),
            row.gap[1].to_string(),
            row.depth[0].to_string(),
            row.depth[1].to_string(),
            low,
            high,
            row.point[0].to_string(),
            row.point[1].to_string(),
            row.point[2].to_string(),
            row.rule.clone().unwrap_or_default(),
            row.broken.to_string(),
            row.note.clone().unwrap_or_default(),
        ]);
    }
    String::from_utf8(table.into_inner().unwrap_or_default()).unwrap_or_default()
}

/// Returns rows as JUnit XML: a test case for each pair, which fails if the pair clashes and is an error if it
/// is undecided.
#[must_use]
pub fn to_junit(rows: &[Row]) -> String {
    let escaped = |text: &str| {
        let text = text
            .replace('&', "&amp;")
            .replace('<', "&lt;")
            .replace('>', "&gt;")
            .replace('"', "&quot;");
        // XML 1.0 has no other control characters.
        text.replace(|c: char| c.is_control() && c != '\n' && c != '\t', "_")
    };
    let is_undecided = |row: &Row| row.kind == Kind::Undecided && !row.broken;
    let failures = rows.iter().filter(|row| row.broken).count();
    let errors = rows.iter().filter(|row| is_undecided(row)).count();
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n<testsuite name=\"clash\" tests=\"{}\" \
         failures=\"{failures}\" errors=\"{errors}\">\n",
        rows.len()
    );
    for row in rows {
        let name = escaped(&format!("{} - {}", row.a, row.b));
        let _ = write!(text, "<testcase classname=\"clash\" name=\"{name}\"");
        let element = if row.broken {
            "failure"
        } else if is_undecided(row) {
            "error"
        } else {
            text += "/>\n";
            continue;
        };
        let reported = escaped(&row.text());
        let _ = writeln!(
            text,
            "><{element} type=\"{}\" message=\"{reported}\"/></testcase>",
            row.kind
        );
    }
    text + "</testsuite>\n</testsuites>\n"
}

/// What has changed since an earlier output.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Comparison {
    /// Rows that are new, or worse than before.
    pub rows: Vec<Row>,
    /// Earlier rows whose pair is farther apart now, or whose parts are gone.
    pub gone: Vec<Row>,
}

impl Comparison {
    /// Compares rows with the text of an earlier output of JSON lines. Parts are known by their names.
    ///
    /// # Errors
    /// Returns an error with the file and the line if a line is no row.
    pub fn new(rows: &[Row], earlier: &str, file: &Path) -> Result<Self, ClashError> {
        let mut known: HashMap<(String, String), Row> = HashMap::new();
        let mut order = Vec::new();
        for (k, line) in earlier.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
            let row: Row = serde_json::from_str(line).map_err(|reason| ClashError::Baseline {
                file: file.to_owned(),
                line: k + 1,
                reason: reason.to_string(),
            })?;
            let names = key(&row);
            order.push(names.clone());
            known.insert(names, row);
        }
        let mut found = Self::default();
        for row in rows {
            let before = known.remove(&key(row));
            if before.is_none_or(|before| row.is_worse_than(&before)) {
                found.rows.push(row.clone());
            }
        }
        found.gone = order.iter().filter_map(|names| known.remove(names)).collect();
        Ok(found)
    }
}

/// Returns the names of a pair in one order.
fn key(row: &Row) -> (String, String) {
    let (a, b) = (row.a.clone(), row.b.clone());
    if a <= b { (a, b) } else { (b, a) }
}

/// Returns whether the longest side of a model, in metres, is so large or small that its unit may be wrong.
#[must_use]
pub fn is_unlikely_size(model: &Model, unit: Unit) -> bool {
    let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    for part in model.parts() {
        let (a, b) = part.geometry.aabb_at(&part.pose, &mut BoxHint::default());
        low = low.zip_map(&a.coords, |x, y| -larger(-x, -y));
        high = high.zip_map(&b.coords, larger);
    }
    let longest = (high - low).amax() / unit.per_metre();
    longest.is_finite() && !(1e-3..=1e3).contains(&longest)
}
