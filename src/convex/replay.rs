//! A query as a text that reproduces it bit for bit: for a report, a corpus, a debugger.
//!
//! ```text
//! lin-canny replay 1
//! level certified                           walk, certified or exact
//! body A 8                                  and its number of vertices
//! vertex bff0000000000000 0000000000000000 3fe0000000000000    # -1 0 0.5
//! ...                                       in the order of the vertex ids
//! polygon 0 2 1 3                           only for a polygon: the vertices of its first side
//! round 3fb999999999999a    # 0.1           only for a rounded body: the radius
//! body B
//! ...
//! pose A 0000000000000000 ... (seven numbers: quaternion x y z w, translation)    # in decimal
//! pose B ...
//! start v3 e12                              or: start cold
//! facet v3 f5                               only after an overlap: the deepest facet, the features
//! stand e1 e7                               of the witnesses if different, and the cached surface:
//! surface 2 3-5 0-1 2-2 0 1 2 1 1 1 ...     its initial number of triangles, vertices of A and B
//!                                           of each point, and per triangle three point indices
//!                                           and three adjacent triangles
//! ```
//!
//! Numbers are the bits of an f64 in hexadecimal. Text after `#` and empty lines are ignored.

use alloc::vec::Vec;
use core::fmt;
use core::str::FromStr;

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion};

use crate::base::num::each::Each;
use crate::base::pose::{Operand, PoseError, RelativePose};
use crate::body::polyhedron::{BuildError, ConvexPolyhedron, EdgeId, FaceId, Feature, FeaturePair, VertexId};
use crate::body::shape::{Shape, is_rounding};
use crate::convex::depth::{Memory, RawMemory};
use crate::pair::outcome::Accuracy;

const TITLE: &str = "lin-canny replay 1";

/// A reproducible query: both bodies, their poses, the cached state of the tracker, and the
/// accuracy.
///
/// `Display` writes the text, `FromStr` parses it. The parsed bodies have the original vertices
/// under their original ids and give bit-identical outcomes. The caller's own vertex indices and
/// the build reports are not included.
///
/// ```
/// use lin_canny::nalgebra::Isometry3;
/// use lin_canny::{Accuracy, RelativePose, Replay, Tracker, polyhedron::solids};
///
/// let (a, b) = (solids::octahedron(0.1)?, solids::icosahedron(0.3)?);
/// let pose = RelativePose::from_isometry(&Isometry3::translation(0.4, 0.5, 0.6))?;
/// let mut pair = Tracker::new();
/// let text = pair.replay(&a, &b, &pose, Accuracy::Certified).to_string();
/// let again: Replay = text.parse()?;
/// let answer = again.tracker().closest(&again.a, &again.b, &again.pose);
/// assert_eq!(answer, pair.closest(&a, &b, &pose));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// First body.
    pub a: ConvexPolyhedron,
    /// Second body.
    pub b: ConvexPolyhedron,
    /// Radii by which the bodies are rounded, in the caller's unit; zero for the query of a
    /// [`Tracker`](crate::Tracker).
    pub rounding_radii: [f64; 2],
    /// Relative pose of both bodies.
    pub pose: RelativePose,
    /// Features cached by the tracker; `None` for a cold start.
    pub start: Option<FeaturePair>,
    /// Surface of an overlap cached by the tracker.
    pub(crate) surface: Memory,
    /// Requested accuracy.
    pub accuracy: Accuracy,
}

impl Replay {
    /// Returns the bodies as shapes, rounded by the recorded radii; a radius that no shape can have
    /// counts as zero.
    #[must_use]
    pub fn shapes(&self) -> [Shape; 2] {
        [(&self.a, self.rounding_radii[0]), (&self.b, self.rounding_radii[1])].each(|(body, round)| {
            let sharp = Shape::from(body.clone());
            sharp.clone().rounded(round).unwrap_or(sharp)
        })
    }
}

/// Error returned if a text is no replay. Lines are counted from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// The first line is not the title of this format and version.
    #[error("the first line is not \"lin-canny replay 1\"")]
    Title,
    /// A line differs from the expected content; line 0 is the end of the text.
    #[error("line {line} is invalid (expected {expected})")]
    Line {
        /// Line number.
        line: usize,
        /// Expected content.
        expected: &'static str,
    },
    /// The vertices do not form a body.
    #[error("body {which}: {error}")]
    Body {
        /// Invalid body.
        which: Operand,
        /// Error of the build.
        error: BuildError,
    },
    /// A pose is invalid.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// The start names features missing from the bodies.
    #[error("the start is not a pair of features of these bodies: {0}")]
    Start(FeaturePair),
}

impl fmt::Display for Accuracy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Accuracy::Walk => "walk",
            Accuracy::Certified => "certified",
            Accuracy::Exact => "exact",
        })
    }
}

impl fmt::Display for Replay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{TITLE}\nlevel {}", self.accuracy)?;
        let [round_a, round_b] = self.rounding_radii;
        for (which, body, round) in [(Operand::A, &self.a, round_a), (Operand::B, &self.b, round_b)] {
            writeln!(f, "body {which} {}", body.vertex_count())?;
            for p in body.vertex_points() {
                numbers(f, "vertex", &[p.x, p.y, p.z])?;
            }
            let side = body.first_side();
            if !side.is_empty() {
                f.write_str("polygon")?;
                side.iter().try_for_each(|v| write!(f, " {v}"))?;
                writeln!(f)?;
            }
            if round != 0.0 {
                numbers(f, "round", &[round])?;
            }
        }
        for (word, p) in [("pose A", &self.pose.a), ("pose B", &self.pose.b)] {
            let ([x, y, z, w], [tx, ty, tz]) = (p.q(), p.t());
            numbers(f, word, &[x, y, z, w, tx, ty, tz])?;
        }
        match self.start {
            Some(pair) => writeln!(f, "start {} {}", pair.a, pair.b)?,
            None => writeln!(f, "start cold")?,
        }
        let Some((facet, witness_features, built, points, triangles)) = self.surface.parts() else {
            return Ok(());
        };
        writeln!(f, "facet {} {}", facet.a, facet.b)?;
        if let Some(pair) = witness_features {
            writeln!(f, "stand {} {}", pair.a, pair.b)?;
        }
        write!(f, "surface {built}")?;
        points.iter().try_for_each(|[a, b]| write!(f, " {}-{}", a.0, b.0))?;
        let mut triangles = triangles.iter().flatten();
        triangles.try_for_each(|k| write!(f, " {k}"))?;
        writeln!(f)
    }
}

/// Writes a word, the bits of some numbers, and the numbers in decimal.
fn numbers(f: &mut fmt::Formatter<'_>, word: &str, values: &[f64]) -> fmt::Result {
    f.write_str(word)?;
    values.iter().try_for_each(|x| write!(f, " {:016x}", x.to_bits()))?;
    f.write_str("    #")?;
    values.iter().try_for_each(|x| write!(f, " {x:?}"))?;
    writeln!(f)
}

impl FromStr for Replay {
    type Err = ReplayError;

    fn from_str(text: &str) -> Result<Self, ReplayError> {
        let mut lines = Lines::new(text);
        if lines.peek().is_none_or(|(_, l)| l != TITLE) {
            return Err(ReplayError::Title);
        }
        lines.take();
        let accuracy = match lines.word("level", "a level")? {
            (_, "walk") => Accuracy::Walk,
            (_, "certified") => Accuracy::Certified,
            (_, "exact") => Accuracy::Exact,
            (line, _) => return Err(expected(line, "walk, certified or exact")),
        };
        let ((a, round_a), (b, round_b)) = (lines.body(Operand::A)?, lines.body(Operand::B)?);
        let pose = RelativePose::new(&lines.pose("pose A")?, &lines.pose("pose B")?)?;
        let start = match lines.word("start", "a start")? {
            (_, "cold") => None,
            (line, words) => {
                let pair = features(words).ok_or(expected(line, "two features, as v3 e12, or cold"))?;
                if !a.has(pair.a) || !b.has(pair.b) {
                    return Err(ReplayError::Start(pair));
                }
                Some(pair)
            }
        };
        let surface = lines.surface()?;
        match lines.take() {
            Some((line, _)) => Err(expected(line, "the end")),
            None => Ok(Self {
                a,
                b,
                rounding_radii: [round_a, round_b],
                pose,
                start,
                surface,
                accuracy,
            }),
        }
    }
}

/// Lines with content, with their line numbers.
struct Lines<'a> {
    rest: Vec<(usize, &'a str)>,
    next: usize,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str) -> Self {
        let bare = |l: &'a str| l.split('#').next().unwrap_or(l).trim();
        let lines = text.lines().enumerate().map(|(i, l)| (i + 1, bare(l)));
        Self {
            rest: lines.filter(|(_, l)| !l.is_empty()).collect(),
            next: 0,
        }
    }

    fn peek(&self) -> Option<(usize, &'a str)> {
        self.rest.get(self.next).copied()
    }

    fn take(&mut self) -> Option<(usize, &'a str)> {
        let line = self.peek();
        self.next += 1;
        line
    }

    /// Returns the rest of the next line, which must begin with `word`.
    fn word(&mut self, word: &str, content: &'static str) -> Result<(usize, &'a str), ReplayError> {
        let at = self.peek().map_or(0, |(line, _)| line);
        self.word_if_there(word).ok_or(expected(at, content))
    }

    /// Returns the rest of the next line if the line begins with `word`.
    fn word_if_there(&mut self, word: &str) -> Option<(usize, &'a str)> {
        let (line, text) = self.peek()?;
        let rest = text.strip_prefix(word).filter(|r| r.starts_with(' ') || r.is_empty())?;
        self.next += 1;
        Some((line, rest.trim()))
    }

    /// Parses a body and the radius by which the body is rounded.
    fn body(&mut self, which: Operand) -> Result<(ConvexPolyhedron, f64), ReplayError> {
        let title = if which == Operand::A { "body A" } else { "body B" };
        let (line, count) = self.word(title, "a body")?;
        let mut points = Vec::new();
        while let Some((line, text)) = self.word_if_there("vertex") {
            points.push(Point3::from(bits::<3>(line, text)?));
        }
        if count.parse() != Ok(points.len()) {
            return Err(expected(line, "the count of the vertices that follow"));
        }
        let mut side = Vec::new();
        if let Some((line, text)) = self.word_if_there("polygon") {
            for word in text.split_whitespace() {
                side.push(word.parse().map_err(|_| expected(line, "the number of a vertex"))?);
            }
        }
        let body = ConvexPolyhedron::rebuilt(&points, &side).map_err(|error| ReplayError::Body { which, error })?;
        let Some((line, text)) = self.word_if_there("round") else {
            return Ok((body, 0.0));
        };
        match bits::<1>(line, text)? {
            [round] if is_rounding(round) => Ok((body, round)),
            _ => Err(expected(line, "a radius of zero, or between 1e-100 and 1e100")),
        }
    }

    /// Parses the optional lines of an overlap; returns an empty cache if the data is no closed
    /// surface.
    fn surface(&mut self) -> Result<Memory, ReplayError> {
        let Some((line, text)) = self.word_if_there("facet") else {
            return Ok(Memory::default());
        };
        let facet = Some(features(text).ok_or(expected(line, "two features, as v3 f5"))?);
        let mut witness_features = None;
        if let Some((line, text)) = self.word_if_there("stand") {
            witness_features = Some(features(text).ok_or(expected(line, "two features, as v3 f5"))?);
        }
        let (line, text) = self.word("surface", "a surface")?;
        let wrong = || expected(line, "pairs of vertices, and six numbers a triangle");
        let number = |w: &str| w.parse::<u32>().map_err(|_| wrong());
        let (mut points, mut rest) = (Vec::new(), Vec::new());
        for word in text.split_whitespace() {
            match word.split_once('-') {
                Some((a, b)) => points.push([VertexId(number(a)?), VertexId(number(b)?)]),
                None => rest.push(number(word)?),
            }
        }
        let (built, rest) = rest.split_first().ok_or_else(wrong)?;
        let (triangles, []) = rest.as_chunks::<6>() else {
            return Err(wrong());
        };
        Ok(Memory::from(RawMemory {
            points,
            triangles: triangles.to_vec(),
            facet,
            witness_features,
            built: *built,
        }))
    }

    fn pose(&mut self, word: &str) -> Result<Isometry3<f64>, ReplayError> {
        let (line, text) = self.word(word, "a pose")?;
        let [x, y, z, w, tx, ty, tz] = bits::<7>(line, text)?;
        let q = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
        Ok(Isometry3::from_parts(Translation3::new(tx, ty, tz), q))
    }
}

fn expected(line: usize, expected: &'static str) -> ReplayError {
    ReplayError::Line { line, expected }
}

/// Parses `N` numbers from their bits.
fn bits<const N: usize>(line: usize, text: &str) -> Result<[f64; N], ReplayError> {
    let wrong = expected(line, "numbers of sixteen hexadecimal digits");
    let word = |w: &str| (w.len() == 16).then(|| u64::from_str_radix(w, 16).ok().map(f64::from_bits))?;
    let numbers: Option<Vec<f64>> = text.split_whitespace().map(word).collect();
    numbers.and_then(|n| n.try_into().ok()).ok_or(wrong)
}

/// Parses two feature names, such as `v3 e12`.
fn features(text: &str) -> Option<FeaturePair> {
    let feature = |word: &str| {
        let id = word.get(1..)?.parse().ok()?;
        match word.get(..1)? {
            "v" => Some(Feature::Vertex(VertexId(id))),
            "e" => Some(Feature::Edge(EdgeId(id))),
            "f" => Some(Feature::Face(FaceId(id))),
            _ => None,
        }
    };
    let mut words = text.split_whitespace();
    let pair = FeaturePair {
        a: feature(words.next()?)?,
        b: feature(words.next()?)?,
    };
    words.next().is_none().then_some(pair)
}
