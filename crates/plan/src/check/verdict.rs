//! Verdicts about motions, and counts of the work.

use core::fmt;
use std::string::String;
use std::vec::Vec;

use nalgebra::Point3;

use crate::cell::Named;
use crate::cell::margins_and_paddings::RequiredDistance;
use crate::names::CellPair;
use lin_canny::impact::StartContact;

/// The verdict about a motion.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Verdict {
    /// Every pair is proven farther apart than it must keep, and than `clearance`, at all times,
    /// including both ends.
    Free {
        /// The least distance that a pair must keep: the margin, unless pairs have smaller ones.
        clearance: f64,
        /// The pairs that are in contact at the start and do not come closer
        /// ([`Checker::set_start_contact_margin`](crate::Checker::set_start_contact_margin)). They
        /// are proven farther apart than they must keep only after they have left the contact.
        start_contacts: Vec<LeavingPair>,
    },
    /// A pair is proven to be in contact or closer than it must keep.
    Blocked {
        /// Up to this time of the piece, and on all pieces before, all pairs are proven farther apart
        /// than they must keep.
        free_until: f64,
        /// At this time of the piece the pair is proven to be in contact or closer than it must keep.
        contact_at: f64,
        /// Index of the piece: the segment of a path, or the curve of a spline.
        piece: usize,
        /// The pair.
        pair: CellPair,
        /// The distance that the pair must keep, and where it comes from.
        required: RequiredDistance,
        /// Closest points of `pair.a` and `pair.b` in the world, at `free_until`, or at `contact_at`
        /// if `free_until` is 0.
        witnesses: [Point3<f64>; 2],
        /// The pairs that are in contact at the start and do not come closer up to `free_until`, as in
        /// [`Free`](Self::Free). They are not proven apart before they have left the contact. If
        /// `free_until` is 0, the proof ends before it finds all of them.
        start_contacts: Vec<LeavingPair>,
    },
    /// Undecided: a pair is within rounding error of contact or of what it must keep, or the caller
    /// stopped the proof.
    Undecided {
        /// Up to this time of the piece, and on all pieces before, all pairs are proven farther apart
        /// than they must keep.
        free_until: f64,
        /// Index of the piece.
        piece: usize,
        /// The pairs that are in contact at the start and do not come closer, as in
        /// [`Blocked`](Self::Blocked).
        start_contacts: Vec<LeavingPair>,
    },
}

/// A pair that is in contact at the start of a segment, and does not come closer.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LeavingPair {
    /// The pair.
    pub pair: CellPair,
    /// The signed distance at the start, the distance that the pair is proven to keep, and the time
    /// at which it has left the margin.
    pub contact: StartContact,
}

impl Verdict {
    /// Returns the name of the verdict: `free`, `blocked` or `undecided`.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Free { .. } => "free",
            Self::Blocked { .. } => "blocked",
            Self::Undecided { .. } => "undecided",
        }
    }

    /// Returns whether the whole motion is proven free.
    #[must_use]
    pub const fn is_free(&self) -> bool {
        matches!(self, Self::Free { .. })
    }

    /// Returns the time of the piece that is not free up to which all pairs are proven apart; 1 if the
    /// whole motion is free.
    #[must_use]
    pub const fn free_until(&self) -> f64 {
        match *self {
            Self::Free { .. } => 1.0,
            Self::Blocked { free_until, .. } | Self::Undecided { free_until, .. } => free_until,
        }
    }

    /// Returns the index of the piece that is not free; `None` if the whole motion is free.
    #[must_use]
    pub const fn piece(&self) -> Option<usize> {
        match *self {
            Self::Free { .. } => None,
            Self::Blocked { piece, .. } | Self::Undecided { piece, .. } => Some(piece),
        }
    }

    /// Returns the contacts at the start that were accepted
    /// ([`Checker::set_start_contact_margin`](crate::Checker::set_start_contact_margin)), on this piece
    /// and on the pieces before.
    #[must_use]
    pub fn start_contacts(&self) -> &[LeavingPair] {
        match self {
            Self::Free { start_contacts, .. }
            | Self::Blocked { start_contacts, .. }
            | Self::Undecided { start_contacts, .. } => start_contacts,
        }
    }

    /// Returns the verdict with the index of the piece, and the contacts that were left on pieces
    /// before.
    pub(crate) fn on_piece(mut self, index: usize, mut before: Vec<LeavingPair>) -> Self {
        match &mut self {
            Self::Free { start_contacts, .. } => {
                before.append(start_contacts);
                *start_contacts = before;
            }
            Self::Blocked {
                piece, start_contacts, ..
            }
            | Self::Undecided {
                piece, start_contacts, ..
            } => {
                before.append(start_contacts);
                (*piece, *start_contacts) = (index, before);
            }
        }
        self
    }
}

impl fmt::Display for Named<'_, Verdict> {
    /// Writes the verdict with the names of the pair, what it had to keep, and the contacts at the start
    /// that were accepted. Times are fractions of the piece, which is named if it is not the first.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of = |piece: usize| match piece {
            0 => String::new(),
            _ => std::format!(" of piece {piece}"),
        };
        match self.value {
            Verdict::Free { clearance, .. } => write!(f, "free, with a clearance of more than {clearance:?}")?,
            Verdict::Blocked {
                free_until,
                contact_at,
                piece,
                pair,
                required,
                ..
            } => {
                let (pair, meet) = (self.cell.show(pair), self.cell.show(required).meet(""));
                write!(
                    f,
                    "blocked by {pair}, which {meet} at {contact_at:?}{} (free up to {free_until:?})",
                    of(*piece)
                )?;
            }
            Verdict::Undecided { free_until, piece, .. } => {
                write!(f, "undecided{} (free up to {free_until:?})", of(*piece))?;
            }
        }
        for (k, leaving) in self.value.start_contacts().iter().enumerate() {
            let pair = self.cell.show(&leaving.pair);
            write!(f, "{} {pair}", if k == 0 { ", leaving the contact of" } else { "," })?;
        }
        Ok(())
    }
}

/// Counts of the work of a checker since it was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct CheckWork {
    /// Number of segments checked.
    pub segments: u64,
    /// Number of segments proven free.
    pub free: u64,
    /// Number of pairs whose boxes overlapped on a segment or that might be closest at a
    /// configuration.
    pub pairs: u64,
    /// Number of distance queries on segments, including proofs of contact.
    pub queries: u64,
    /// Number of single configurations measured.
    pub configurations: u64,
    /// Number of distance queries at single configurations.
    pub measures: u64,
    /// Number of margin predicates at single configurations.
    pub decisions: u64,
    /// Number of queries of convex hulls that stood for meshes, on segments and at single
    /// configurations. Hulls that are proven apart save the query of the meshes.
    pub hulls: u64,
    /// Number of pairs that boxes of joint values proved apart at a configuration or along a segment
    /// ([`PairBoxes`](crate::PairBoxes)).
    pub lookups: u64,
    /// Number of pairs that were made: all pairs at first, and those that changes added.
    pub pairs_made: u64,
}

impl std::ops::AddAssign for CheckWork {
    /// Adds all counts, with saturation.
    fn add_assign(&mut self, o: Self) {
        let counts = [
            (&mut self.segments, o.segments),
            (&mut self.free, o.free),
            (&mut self.pairs, o.pairs),
            (&mut self.queries, o.queries),
            (&mut self.configurations, o.configurations),
            (&mut self.measures, o.measures),
            (&mut self.decisions, o.decisions),
            (&mut self.hulls, o.hulls),
            (&mut self.lookups, o.lookups),
            (&mut self.pairs_made, o.pairs_made),
        ];
        for (sum, count) in counts {
            *sum = sum.saturating_add(count);
        }
    }
}

impl CheckWork {
    pub(crate) fn since(&self, before: &Self) -> Self {
        Self {
            segments: self.segments - before.segments,
            free: self.free - before.free,
            pairs: self.pairs - before.pairs,
            queries: self.queries - before.queries,
            configurations: self.configurations - before.configurations,
            measures: self.measures - before.measures,
            decisions: self.decisions - before.decisions,
            hulls: self.hulls - before.hulls,
            lookups: self.lookups - before.lookups,
            pairs_made: self.pairs_made - before.pairs_made,
        }
    }
}
