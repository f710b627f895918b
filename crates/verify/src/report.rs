//! What a check says.

use std::fmt;

/// The answer about a receipt that could be read.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Verdict {
    /// Everything that it claims is proven.
    Holds(Report),
    /// Something is not proven.
    Fails(Failure),
}

impl Verdict {
    /// Returns whether the receipt holds.
    #[must_use]
    pub fn holds(&self) -> bool {
        matches!(self, Self::Holds(_))
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Holds(report) => report.fmt(f),
            Self::Fails(failure) => failure.fmt(f),
        }
    }
}

/// What is proven, and what was not looked at. The text is the answer, not "ok".
///
/// `{}` writes one line for all pairs with one statement, `{:#}` a line for each pair.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Report {
    /// What is proven: the claims, and pairs that keep more than all pairs must.
    pub proven: Vec<Statement>,
    /// What a reader could think to be proven.
    pub not_looked_at: Vec<Statement>,
    /// Files that the writer of the scene says to have read. Their hashes were not compared.
    pub files: Vec<StatedFile>,
    /// Number of lines of evidence.
    pub certificates: usize,
    /// Number of claims that needed the wide integers.
    pub wide: usize,
}

/// A statement about some pairs of bodies, or about the whole.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Statement {
    /// The statement.
    pub text: String,
    /// The names of the bodies of each pair, as `A against B`; empty for a statement about the whole.
    pub pairs: Vec<String>,
}

impl From<String> for Statement {
    fn from(text: String) -> Self {
        let pairs = Vec::new();
        Self { text, pairs }
    }
}

impl Statement {
    /// Writes the statement about all of its pairs in one line, or a line for each pair.
    fn write(&self, f: &mut fmt::Formatter, head: &str) -> fmt::Result {
        let Self { text, pairs } = self;
        match &pairs[..] {
            [] => writeln!(f, "{head}: {text}"),
            [first, _, ..] if !f.alternate() => {
                writeln!(f, "{head}: {} pairs: {text}, such as {first}", pairs.len())
            }
            all => all.iter().try_for_each(|pair| writeln!(f, "{head}: {pair}: {text}")),
        }
    }
}

/// A file that the writer of a receipt says to have read.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct StatedFile {
    /// Its name.
    pub name: String,
    /// SHA-256 of its bytes, in 64 hex digits.
    pub sha256: String,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "holds: {} certificates", self.certificates)?;
        self.proven.iter().try_for_each(|x| x.write(f, "proven"))?;
        self.not_looked_at
            .iter()
            .try_for_each(|x| x.write(f, "not looked at"))?;
        for file in &self.files {
            writeln!(f, "not compared: file {} with SHA-256 {}", file.name, file.sha256)?;
        }
        Ok(())
    }
}

/// The first thing that is not proven.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Failure {
    /// Line of the file, from 1.
    pub line: usize,
    /// Number of the certificate, from 1: lines of evidence, legs not counted. `None` if no single
    /// certificate is to blame.
    pub certificate: Option<usize>,
    /// Number of further failures.
    pub more: usize,
    /// The receipt was checked on another scene.
    pub stale: bool,
    /// What is not proven: bodies, time and reason.
    pub text: String,
}

impl Failure {
    pub(crate) fn new(line: usize, certificate: Option<usize>, stale: bool, text: String) -> Self {
        Self {
            line,
            certificate,
            more: 0,
            stale,
            text,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: ", if self.stale { "stale" } else { "does not hold" })?;
        match self.certificate {
            Some(number) => write!(f, "certificate {number}, {}", self.text)?,
            None => write!(f, "{}", self.text)?,
        }
        write!(f, " (line {}", self.line)?;
        match self.more {
            0 => writeln!(f, ")"),
            more => writeln!(f, "; {more} further failures)"),
        }
    }
}

/// Why a text is not a receipt.
#[derive(Debug)]
#[non_exhaustive]
pub enum Unreadable {
    /// The reader failed.
    Io(std::io::Error),
    /// A line is not of the format, or of another version of it.
    Line {
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong.
        why: String,
    },
}

impl fmt::Display for Unreadable {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Io(error) => write!(f, "cannot be read: {error}"),
            Self::Line { line, why } => write!(f, "cannot be read: line {line}: {why}"),
        }
    }
}

impl std::error::Error for Unreadable {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Io(error) => Some(error),
            Self::Line { .. } => None,
        }
    }
}
