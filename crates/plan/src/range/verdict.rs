//! Verdicts over ranges of joints, and the cells from which a proof goes on.

use core::fmt;
use std::vec::Vec;

use nalgebra::Vector3;

use crate::cell::Named;
use crate::names::CellPair;

/// How far a proof over a range goes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RangeOptions {
    /// Most cells that are searched for each pair. The default is 20,000.
    pub cells: u64,
    /// Width to which the least clearance of a pair is proven; `None` (the default) proves only
    /// that the pair keeps its distance.
    pub width: Option<ClearanceWidth>,
    /// Random configurations that are measured before the first cell, to find a contact and a
    /// free configuration. The default is 300.
    pub samples: u32,
    /// Random seed of the samples.
    pub seed: u64,
}

impl Default for RangeOptions {
    fn default() -> Self {
        Self {
            cells: 20_000,
            width: None,
            samples: 300,
            seed: 1,
        }
    }
}

impl RangeOptions {
    /// Sets the most cells for each pair.
    #[must_use]
    pub fn cells(self, cells: u64) -> Self {
        Self { cells, ..self }
    }

    /// Sets the width to which the least clearance is proven.
    #[must_use]
    pub fn width(self, width: ClearanceWidth) -> Self {
        let width = Some(width);
        Self { width, ..self }
    }

    /// Sets the number of random configurations.
    #[must_use]
    pub fn samples(self, samples: u32) -> Self {
        Self { samples, ..self }
    }

    /// Sets the seed of the samples.
    #[must_use]
    pub fn seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }
}

/// Width to which a least clearance is proven.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ClearanceWidth {
    /// A length.
    Length(f64),
    /// A share of the clearance, from 0 to 1.
    Share(f64),
}

/// The verdict about a pair over a range of configurations.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum RangeVerdict {
    /// At every configuration the pair is proven farther apart than it must keep.
    Never,
    /// At every configuration the pair is proven to be in contact or closer than it must keep.
    Always,
    /// The pair does both: each witness is decided by the exact predicate of
    /// [`Checker::is_free_at`](crate::Checker::is_free_at).
    Both {
        /// A configuration at which the pair keeps its distance.
        free: Vec<f64>,
        /// A configuration at which the pair is in contact or closer than it must keep.
        touching: Vec<f64>,
    },
    /// The budget ended before a verdict.
    Open {
        /// Share of the volume of the range that is left.
        share: f64,
    },
}

impl RangeVerdict {
    /// Returns the name of the verdict: `never`, `always`, `both` or `open`.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Never => "never",
            Self::Always => "always",
            Self::Both { .. } => "both",
            Self::Open { .. } => "open",
        }
    }
}

/// A cell that is left: a box of configurations, over the coordinates that move the pair.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct RangeCell {
    /// Lower ends.
    pub low: Vec<f64>,
    /// Upper ends.
    pub high: Vec<f64>,
    /// Lower bound of the distance of the pair over the cell; minus infinity if nothing is known.
    #[cfg_attr(feature = "serde", serde(with = "infinite"))]
    pub lower: f64,
    /// The plane that proved most for the cell's parent: the number of joints before its frame, and
    /// its normal there.
    pub plane: Option<(usize, Vector3<f64>)>,
    /// How often the range was halved.
    pub level: u32,
}

/// The answer about a pair over a range of configurations.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct RangeAnswer {
    /// The pair.
    pub pair: CellPair,
    /// The range: least and greatest value of each coordinate.
    pub range: Vec<[f64; 2]>,
    /// The verdict.
    pub verdict: RangeVerdict,
    /// Indices of the coordinates that move the pair; others are not divided.
    pub coordinates: Vec<usize>,
    /// Proven lower bound of the distance over the whole range. It is zero if the pair is in contact
    /// or closer than it must keep at some configuration.
    pub lower: f64,
    /// Least distance that was found; zero in contact.
    #[cfg_attr(feature = "serde", serde(with = "infinite"))]
    pub upper: f64,
    /// The configuration at which `upper` was found.
    pub at: Vec<f64>,
    /// Number of cells that were searched.
    pub cells: u64,
    /// Number of distance queries.
    pub queries: u64,
    /// The cells that are left; [`RangeProver::resume`](crate::RangeProver::resume) goes on
    /// with them.
    pub open: Vec<RangeCell>,
    /// A configuration at which the pair keeps its distance, and one at which it does not, if they
    /// were found.
    pub witnesses: [Option<Vec<f64>>; 2],
    /// The least bound of a cell that was proven free, and whether a cell was proven blocked.
    #[cfg_attr(feature = "serde", serde(with = "infinite"))]
    pub(super) least_free: f64,
    pub(super) has_blocked: bool,
    /// Whether configurations were sampled.
    pub(super) has_samples: bool,
    /// Number of cells with a contact without depth.
    pub(super) flat: u32,
    /// Hash of the bodies of the pair, the joints between them and the distance to keep.
    pub(super) fingerprint: u64,
}

impl RangeAnswer {
    /// Returns whether the pair is proven to keep its distance at every configuration.
    #[must_use]
    pub fn is_never(&self) -> bool {
        self.verdict == RangeVerdict::Never
    }

    /// Returns whether the bodies touch without depth all over a part of the range, as flush links
    /// about their joint do.
    ///
    /// Such an answer stays open: no bound proves them apart, and the rounding of a pose decides
    /// whether they touch. More cells do not help. If the links are adjacent, exclude the pair.
    #[must_use]
    pub fn is_flush(&self) -> bool {
        matches!(self.verdict, RangeVerdict::Open { .. }) && self.flat > 0
    }

    /// Returns the share of the volume of the range that is left.
    #[must_use]
    pub fn open_share(&self) -> f64 {
        match self.verdict {
            RangeVerdict::Open { share } => share,
            _ => 0.0,
        }
    }
}

impl fmt::Display for Named<'_, RangeAnswer> {
    /// Writes the names of the pair, the verdict and its clearance.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let answer = self.value;
        let pair = self.cell.show(&answer.pair);
        let required = self.cell.required_distance(answer.pair);
        let meet = self.cell.show(&required).meet("");
        match &answer.verdict {
            RangeVerdict::Never => write!(f, "{pair} never {meet}: {:?} to {:?} apart", answer.lower, answer.upper),
            RangeVerdict::Always => write!(f, "{pair} always {meet}"),
            RangeVerdict::Both { touching, .. } => write!(f, "{pair} {meet} at {touching:?}"),
            RangeVerdict::Open { share } => {
                let lower = answer.lower;
                write!(
                    f,
                    "{pair} are undecided on {share:?} of the range, and at least {lower:?} apart"
                )
            }
        }
    }
}

/// Numbers that may be infinite, which JSON cannot hold.
#[cfg(feature = "serde")]
mod infinite {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
        let finite = Some(*value).filter(|x| x.is_finite());
        (finite, *value > 0.0).serialize(to)
    }

    pub(super) fn deserialize<'d, D: Deserializer<'d>>(from: D) -> Result<f64, D::Error> {
        let (finite, is_positive) = <(Option<f64>, bool)>::deserialize(from)?;
        Ok(finite.unwrap_or(if is_positive { f64::INFINITY } else { f64::NEG_INFINITY }))
    }
}
