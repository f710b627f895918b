//! Reader and writer of case files: queries of bodies, with or without exact values.
//! `tests/CASES.md` defines the format.
//!
//! Files may be large, so [`Reader`] returns one line at a time and stores no more than that line.

use crate::queries::{QueryCase, RawQuery};
use crate::shapes::Shape;
use crate::verdict::ContactState;
use crate::{Face, Point, Pose};
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;
use std::{error, fmt};

/// One line of a case file.
#[derive(Clone, Debug)]
pub enum Line {
    /// The first line.
    Header(Header),
    /// A body; it precedes the first case that refers to it.
    Shape(SuiteShape),
    /// A pair of convex bodies.
    Case(Box<Case>),
    /// Another query (version 2).
    Query(Box<QueryCase>),
}

/// Name and seed of a file.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize)]
pub struct Header {
    /// Version of the format: 1, or 2 with meshes and queries of them.
    pub version: u32,
    /// Name of the file's kind.
    #[serde(default)]
    pub name: String,
    /// Seed of its generator.
    #[serde(default)]
    pub seed: u64,
}

/// A body and the number by which cases refer to it.
#[derive(Clone, Debug)]
pub struct SuiteShape {
    /// Number, unique in the file.
    pub id: usize,
    /// Points and faces; a flat body has no faces.
    pub shape: Shape,
    /// Whether the body is a closed mesh of triangles and not the hull of its points.
    pub is_mesh: bool,
}

/// Two bodies at two poses.
#[derive(Clone, Debug)]
pub struct Case {
    /// Number, unique in the file.
    pub id: u64,
    /// Family of cases.
    pub family: String,
    /// Accuracy within the family.
    pub level: String,
    /// Motion to which the case belongs; `None` for a single case.
    pub sequence: Option<u64>,
    /// Number of the frame in its motion.
    pub frame: u64,
    /// Number of the body A.
    pub a: usize,
    /// Number of the body B.
    pub b: usize,
    /// World pose of A, its quaternion as written: unit up to 1e-6.
    pub pose_a: Pose,
    /// World pose of B.
    pub pose_b: Pose,
    /// The exact values, unless the file is blind.
    pub truth: Option<Truth>,
}

/// Exact values of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// Exact contact state.
    pub state: ContactState,
    /// Signed distance, correctly rounded.
    pub distance: f64,
    /// Remainder lost by rounding.
    pub remainder: f64,
    /// Unit normal from A to B.
    pub normal: Option<Point>,
    /// Witness points in the world frame.
    pub witnesses: Option<(Point, Point)>,
    /// Size of the pair, to which tolerances are relative.
    pub size: Option<f64>,
    /// Number of normals of equal depth.
    pub ties: Option<u64>,
}

/// Error of a file: its line (from 1; 0 before the first) and the reason.
#[derive(Debug)]
pub struct SuiteError {
    /// Number of the line.
    pub line: usize,
    /// What is wrong.
    pub reason: String,
}

impl fmt::Display for SuiteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "case file, line {}: {}", self.line, self.reason)
    }
}

impl error::Error for SuiteError {}

/// Kind of a line, parsed before the rest.
#[derive(Deserialize)]
struct Kind<'a> {
    t: &'a str,
}

#[derive(Deserialize, Serialize)]
struct RawShape {
    id: usize,
    #[serde(default)]
    name: String,
    v: Vec<f64>,
    #[serde(default)]
    f: Vec<Face>,
}

#[derive(Deserialize, Serialize)]
struct RawCase {
    id: u64,
    #[serde(default)]
    fam: String,
    #[serde(default)]
    lvl: String,
    #[serde(default = "alone")]
    seq: i64,
    #[serde(default)]
    frame: u64,
    a: usize,
    b: usize,
    qa: [f64; 4],
    ta: Point,
    qb: [f64; 4],
    tb: Point,
    #[serde(skip_serializing_if = "Option::is_none")]
    cls: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    s_lo: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    n: Option<Point>,
    #[serde(skip_serializing_if = "Option::is_none")]
    wa: Option<Point>,
    #[serde(skip_serializing_if = "Option::is_none")]
    wb: Option<Point>,
    #[serde(skip_serializing_if = "Option::is_none")]
    ties: Option<u64>,
    #[serde(rename = "L", skip_serializing_if = "Option::is_none")]
    size: Option<f64>,
}

fn alone() -> i64 {
    -1
}

impl RawShape {
    fn check(self, is_mesh: bool) -> Result<SuiteShape, String> {
        if is_mesh && self.f.iter().any(|f| f.len() != 3) {
            return Err(format!("mesh {} has a face that is no triangle", self.id));
        }
        let (points, rest) = self.v.as_chunks::<3>();
        if !rest.is_empty() {
            return Err(format!(
                "shape {} has {} coordinates, not a multiple of 3",
                self.id,
                self.v.len()
            ));
        }
        if let Some(i) = self.f.iter().flatten().find(|&&i| i as usize >= points.len()) {
            return Err(format!(
                "a face of shape {} names point {i} of {}",
                self.id,
                points.len()
            ));
        }
        Ok(SuiteShape {
            id: self.id,
            shape: Shape {
                name: self.name,
                points: points.to_vec(),
                faces: self.f,
            },
            is_mesh,
        })
    }
}

impl RawCase {
    fn check(self) -> Result<Case, String> {
        let truth = match (&self.cls, self.s) {
            (None, None) => None,
            (Some(word), Some(distance)) => Some(Truth {
                state: ContactState::from_word(word).ok_or_else(|| format!("class {word:?} of case {}", self.id))?,
                distance,
                remainder: self.s_lo.unwrap_or(0.0),
                normal: self.n,
                witnesses: self.wa.zip(self.wb),
                size: self.size,
                ties: self.ties,
            }),
            _ => return Err(format!("case {} has only one of cls and s", self.id)),
        };
        Ok(Case {
            id: self.id,
            family: self.fam,
            level: self.lvl,
            sequence: u64::try_from(self.seq).ok(),
            frame: self.frame,
            a: self.a,
            b: self.b,
            pose_a: Pose { q: self.qa, t: self.ta },
            pose_b: Pose { q: self.qb, t: self.tb },
            truth,
        })
    }
}

impl From<&SuiteShape> for RawShape {
    fn from(s: &SuiteShape) -> Self {
        Self {
            id: s.id,
            name: s.shape.name.clone(),
            v: s.shape.points.concat(),
            f: s.shape.faces.clone(),
        }
    }
}

impl From<&Case> for RawCase {
    fn from(c: &Case) -> Self {
        let truth = c.truth.as_ref();
        let (wa, wb) = truth.and_then(|t| t.witnesses).unzip();
        Self {
            id: c.id,
            fam: c.family.clone(),
            lvl: c.level.clone(),
            seq: c.sequence.map_or(-1, |s| s as i64),
            frame: c.frame,
            a: c.a,
            b: c.b,
            qa: c.pose_a.q,
            ta: c.pose_a.t,
            qb: c.pose_b.q,
            tb: c.pose_b.t,
            cls: truth.map(|t| t.state.word().to_owned()),
            s: truth.map(|t| t.distance),
            s_lo: truth.map(|t| t.remainder),
            n: truth.and_then(|t| t.normal),
            wa,
            wb,
            ties: truth.and_then(|t| t.ties),
            size: truth.and_then(|t| t.size),
        }
    }
}

/// A line with its kind, as it is written.
#[derive(Serialize)]
struct Tagged<T> {
    t: &'static str,
    #[serde(flatten)]
    rest: T,
}

/// Writes one line of a case file.
pub fn write(out: &mut impl Write, line: &Line) -> io::Result<()> {
    let text = match line {
        Line::Header(rest) => serde_json::to_string(&Tagged { t: "suite", rest }),
        Line::Shape(shape) => serde_json::to_string(&Tagged {
            t: if shape.is_mesh { "mesh" } else { "shape" },
            rest: RawShape::from(shape),
        }),
        Line::Case(case) => serde_json::to_string(&Tagged {
            t: "case",
            rest: RawCase::from(&**case),
        }),
        Line::Query(case) => serde_json::to_string(&Tagged {
            t: case.query.kind(),
            rest: RawQuery::from(&**case),
        }),
    };
    writeln!(out, "{}", text?)
}

/// Parses one line; `None` for an empty line and for unknown kinds.
fn parse(text: &str) -> Result<Option<Line>, String> {
    if text.trim().is_empty() {
        return Ok(None);
    }
    let json = |e: serde_json::Error| e.to_string();
    let kind: Kind = serde_json::from_str(text).map_err(json)?;
    Ok(match kind.t {
        "suite" => Some(Line::Header(serde_json::from_str(text).map_err(json)?)),
        kind @ ("shape" | "mesh") => Some(Line::Shape(
            serde_json::from_str::<RawShape>(text)
                .map_err(json)?
                .check(kind == "mesh")?,
        )),
        kind @ ("point" | "meshes" | "cast" | "ray") => Some(Line::Query(Box::new(
            serde_json::from_str::<RawQuery>(text).map_err(json)?.check(kind)?,
        ))),
        "case" => Some(Line::Case(Box::new(
            serde_json::from_str::<RawCase>(text).map_err(json)?.check()?,
        ))),
        _ => None,
    })
}

/// Iterator over the lines of a case file. It stops after the first error.
pub struct Reader<R> {
    input: R,
    line: usize,
    buffer: String,
    failed: bool,
}

impl Reader<BufReader<File>> {
    /// Opens a file.
    pub fn open(path: impl AsRef<Path>) -> io::Result<Self> {
        Ok(Self::new(BufReader::with_capacity(1 << 20, File::open(path)?)))
    }
}

impl<R: BufRead> Reader<R> {
    /// Reads from memory, a pipe or a file.
    pub fn new(input: R) -> Self {
        Self {
            input,
            line: 0,
            buffer: String::new(),
            failed: false,
        }
    }

    /// Returns the next line of a known kind.
    fn advance(&mut self) -> Result<Option<Line>, String> {
        loop {
            self.buffer.clear();
            self.line += 1;
            if self.input.read_line(&mut self.buffer).map_err(|e| e.to_string())? == 0 {
                return Ok(None);
            }
            let line = parse(&self.buffer)?;
            match &line {
                Some(Line::Header(h)) if !(1..=2).contains(&h.version) => {
                    return Err(format!("version {} is not known", h.version));
                }
                Some(_) => return Ok(line),
                None => {}
            }
        }
    }
}

impl<R: BufRead> Iterator for Reader<R> {
    type Item = Result<Line, SuiteError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let line = self.advance().map_err(|reason| SuiteError {
            line: self.line,
            reason,
        });
        self.failed = line.is_err();
        line.transpose()
    }
}

/// One line of an answer file, as a grading program prints it. `None` is written as `-`.
#[derive(Clone, Copy, Debug)]
pub struct Answer<'a> {
    /// Number of the case.
    pub id: u64,
    /// `sep`, `touch`, `pen`, or the reason why there is no answer: `none`, `unsup`, `panic`,
    /// `noshape`.
    pub status: &'a str,
    /// Signed distance.
    pub distance: Option<f64>,
    /// Witness points of A and B.
    pub witnesses: Option<(Point, Point)>,
    /// Normal from A to B.
    pub normal: Option<Point>,
    /// Time of the query alone.
    pub nanoseconds: u64,
}

impl fmt::Display for Answer<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.id, self.status)?;
        let (on_a, on_b) = self.witnesses.unzip();
        let vector = |p: Option<Point>| p.map_or([None; 3], |p| p.map(Some));
        let numbers = [self.distance]
            .into_iter()
            .chain([on_a, on_b, self.normal].into_iter().flat_map(vector));
        for x in numbers {
            match x {
                Some(x) => write!(f, " {x:e}")?, // shortest digits that give the same bits
                None => f.write_str(" -")?,
            }
        }
        write!(f, " {}", self.nanoseconds)
    }
}

#[cfg(test)]
#[path = "suite_tests.rs"]
mod tests;
