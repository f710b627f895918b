//! The page of an audit: one HTML file with a table and a drawing of each pair.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use lin_canny::nalgebra::Point3;
use lin_canny::{PairTracker, RelativePose};
use lin_canny_record::escaped;
use lin_canny_robot::plan::{CellBody, Checker, JointTree, PlanError};
use lin_canny_robot::{AuditVerdict, Coordinate, LinkAudit};

use crate::drawing::{self, Drawing};
use crate::text::distance;

const STYLE: &str = "body{font:15px/1.5 sans-serif;max-width:1320px;margin:2em auto;padding:0 1em;color:#222;background:#fff}\
table{border-collapse:collapse;margin:1em 0}td,th{padding:.2em .8em;text-align:right;border-bottom:1px solid #ddd}\
td.w,th.w{text-align:left}.bad{color:#c00000;font-weight:bold}main{display:flex;flex-wrap:wrap;gap:1em}\
figure{width:420px;margin:0;border:1px solid #ddd}svg{width:100%;height:auto;display:block}\
figcaption{padding:.5em;overflow-wrap:anywhere}code{font-size:12px}";

/// The content of the page.
pub(crate) struct AuditPage<'a> {
    pub(crate) robot: &'a str,
    pub(crate) coordinates: &'a [Coordinate],
    pub(crate) found: &'a [LinkAudit],
    /// The reason for which an SRDF or an option excludes a pair.
    pub(crate) reason: &'a dyn Fn(&[String; 2]) -> Option<&'a str>,
    /// What a pair does that does not keep its required distance.
    pub(crate) meet: &'a str,
}

impl AuditPage<'_> {
    /// Returns the page. Pairs whose exclusion is refuted come first, decided ones last.
    pub(crate) fn html(&self, checker: &Checker<JointTree>) -> Result<String, PlanError> {
        let mut rows: Vec<&LinkAudit> = self.found.iter().collect();
        let order = |one: &LinkAudit| match one.verdict {
            _ if self.is_refuted(one) => 0,
            AuditVerdict::Open => 1,
            AuditVerdict::Both => 2,
            AuditVerdict::Never => 3,
            _ => 4,
        };
        rows.sort_by(|x, y| order(x).cmp(&order(y)).then(x.lower.total_cmp(&y.lower)));
        let robot = escaped(self.robot);
        let mut page = format!(
            "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/><title>Audit of {robot}</title>\
             <style>{STYLE}{}</style></head><body>\n<h1>Which links of {robot} can ever meet?</h1>\n",
            drawing::style()
        );
        let count = |verdict| rows.iter().filter(|one| one.verdict == verdict).count();
        let _ = writeln!(
            page,
            "<p>{} pairs over the whole limits of the joints: {} never {}, {} always, {} do both, {} are open. \
             Lengths are metres. Refuted exclusions: {}.</p>",
            rows.len(),
            count(AuditVerdict::Never),
            self.meet,
            count(AuditVerdict::Always),
            count(AuditVerdict::Both),
            count(AuditVerdict::Open),
            rows.iter().filter(|one| self.is_refuted(one)).count(),
        );
        page += "<table><tr><th class=\"w\">pair</th><th>joints</th><th class=\"w\">verdict</th><th class=\"w\">excluded as</th>\
                 <th>least clearance</th><th>cells</th><th>ms</th></tr>\n";
        for (k, one) in rows.iter().enumerate() {
            page += &self.row(k, one);
        }
        page += "</table>\n<p>Each drawing shows both links at the configuration of the least clearance that was found, \
                 with their closest points. Bodies with many triangles are drawn with fewer.</p>\n<main>\n";
        for (k, one) in rows.iter().enumerate() {
            page += &self.figure(k, one, checker)?;
        }
        Ok(page + "</main></body></html>\n")
    }

    fn is_refuted(&self, one: &LinkAudit) -> bool {
        (self.reason)(&one.names).is_some_and(|claim| one.refutes(claim))
    }

    fn row(&self, k: usize, one: &LinkAudit) -> String {
        let claim = (self.reason)(&one.names).map_or(String::new(), escaped);
        let class = if self.is_refuted(one) { "w bad" } else { "w" };
        format!(
            "<tr><td class=\"w\"><a href=\"#pair{k}\">{}</a></td><td>{}</td><td class=\"w\">{}</td><td class=\"{class}\">{claim}</td>\
             <td>{}</td><td>{}</td><td>{:.1}</td></tr>\n",
            escaped(&title(one)),
            one.joints,
            one.verdict,
            clearance(one, self.meet),
            one.cells,
            one.time.as_secs_f64() * 1e3,
        )
    }

    fn figure(&self, k: usize, one: &LinkAudit, checker: &Checker<JointTree>) -> Result<String, PlanError> {
        let svg = picture(one, checker)?;
        let title = escaped(&title(one));
        let moving: BTreeSet<usize> = one.answers.iter().flat_map(|a| a.coordinates.iter().copied()).collect();
        let values = moving.into_iter().filter_map(|c| {
            let (coordinate, value) = (self.coordinates.get(c)?, one.at.get(c)?);
            Some(format!("{}={value}", escaped(&coordinate.name)))
        });
        Ok(format!(
            "<figure id=\"pair{k}\">{svg}<figcaption><b>{title}</b>: {}, {}<br/><code>{}</code></figcaption></figure>\n",
            one.verdict,
            clearance(one, self.meet),
            values.collect::<Vec<_>>().join(" "),
        ))
    }
}

/// Draws all bodies of both links at the configuration of the least distance.
fn picture(one: &LinkAudit, checker: &Checker<JointTree>) -> Result<String, PlanError> {
    let mut links: BTreeMap<CellBody, usize> = BTreeMap::new();
    let (mut points, mut least) = (None, f64::INFINITY);
    for answer in &one.answers {
        let ids = [answer.pair.a, answer.pair.b];
        let [a, b] = ids.map(|id| checker.cell().geometry(id));
        let (Some(a), Some(b)) = (a, b) else { continue };
        links.extend(ids.into_iter().zip([0, 1]));
        let [first, second] = ids.map(|id| checker.pose(id, &one.at));
        let (first, second) = (first?, second?);
        let pose = RelativePose::new(&first, &second)?;
        let found = PairTracker::new().closest(a, b, &pose);
        if found.distance < least {
            least = found.distance;
            points = Some([first * found.point_on_a, second * found.point_on_b]);
        }
    }
    // A half-space is drawn below or next to the other link.
    let mut near = (Point3::origin(), 1.0);
    for id in links.keys() {
        let ball = checker.cell().geometry(*id).map(|geometry| geometry.bounding_ball());
        if let Some((centre, radius)) = ball.filter(|(_, radius)| radius.is_finite()) {
            near = (checker.pose(*id, &one.at)? * centre, radius);
        }
    }
    let mut drawing = Drawing::default();
    for (id, link) in links {
        if let Some(geometry) = checker.cell().geometry(id) {
            drawing.body(geometry, &checker.pose(id, &one.at)?, link, near);
        }
    }
    Ok(drawing.svg(&title(one), points))
}

fn title(one: &LinkAudit) -> String {
    let [a, b] = &one.names;
    format!("{a} – {b}")
}

/// Says how near the links come, as far as it is known.
fn clearance(one: &LinkAudit, meet: &str) -> String {
    match one.verdict {
        AuditVerdict::Never => distance(one.lower, one.upper),
        AuditVerdict::Open => format!("{:.1e} open, at least {}", one.open, distance(one.lower, one.lower)),
        _ => meet.to_owned(),
    }
}
