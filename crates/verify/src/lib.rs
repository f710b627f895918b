//! [The format]: mod@format
//! [The lemmas]: mod@proof
//!
#![doc = include_str!("../README.md")]

mod balls;
mod bernstein;
mod cells;
mod check;
mod claim;
mod cover;
mod cuts;
mod distance;
mod ellipsoid;
mod file;
mod groups;
mod half_space;
mod hops;
mod inside;
mod int;
mod json;
mod lines;
mod meet;
mod motion;
mod near;
mod pairs;
mod plane;
mod points;
mod polynomial;
mod pose;
mod range;
mod real;
mod report;
mod rules;
mod scene;
mod sha256;
mod taylor;
mod turn;
mod vectors;

#[doc = include_str!("../docs/format.md")]
pub mod format {}

#[doc = include_str!("../docs/proof.md")]
pub mod proof {}

use std::io::BufRead;

pub use report::{Failure, Report, StatedFile, Statement, Unreadable, Verdict};

/// Why a line is not accepted.
#[derive(Debug)]
pub(crate) enum Stop {
    /// It is not of the format.
    Bad(String),
    /// What it claims is not proven.
    Fails(String),
}

impl Stop {
    fn bad<T>(why: impl Into<String>) -> Result<T, Self> {
        Err(Self::Bad(why.into()))
    }

    fn fails<T>(why: impl Into<String>) -> Result<T, Self> {
        Err(Self::Fails(why.into()))
    }
}

/// Checks a receipt.
///
/// The reader is read to its end, one line at a time. Memory grows with the scene, not with the
/// certificates.
///
/// # Errors
/// Returns an error if the text cannot be read, or is not a receipt of a known version.
pub fn verify(receipt: impl BufRead) -> Result<Verdict, Unreadable> {
    check::run(receipt, None)
}

/// Checks the evidence of a receipt on another scene.
///
/// Bodies, joints, legs and names of files are those of `other`, a receipt of any claim, whose evidence
/// is not evaluated; usually its claim is `scene`. Claim, interval, margin and ignored pairs are those
/// of `receipt`. The result never rests on a hash: each certificate is evaluated again.
///
/// Each of the two files must keep the rules of the format by itself. The claim of `receipt` must keep
/// them on the other scene, too: a range, for example, is never proven for a body that is steady.
///
/// A failure means that the proof does not hold on the other scene. It does not mean that bodies
/// collide there.
///
/// # Errors
/// Returns an error if one of the texts cannot be read, or is not a receipt of a known version. The
/// error of the other scene starts with "other scene".
pub fn verify_on(receipt: impl BufRead, other: impl BufRead) -> Result<Verdict, Unreadable> {
    let other = file::scene(other).map_err(|why| match why {
        Unreadable::Line { line, why } => Unreadable::Line {
            line,
            why: format!("other scene: {why}"),
        },
        io @ Unreadable::Io(_) => io,
    })?;
    check::run(receipt, Some(other))
}
