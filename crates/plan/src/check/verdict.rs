//! Verdicts about segments, and counts of the work.

use core::fmt;
use std::vec::Vec;

use nalgebra::Point3;

use crate::cell::world::Named;
use crate::names::WorldPair;
use lin_canny::impact::StartContact;

/// The verdict about a segment.
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
        /// Up to this time all pairs are proven farther apart than they must keep.
        safe: f64,
        /// At this time the pair is proven to be in contact or closer than it must keep.
        t: f64,
        /// The pair.
        pair: WorldPair,
        /// Closest points of `pair.a` and `pair.b` in the world, at `safe`, or at `t` if `safe` is
        /// 0.
        witnesses: [Point3<f64>; 2],
    },
    /// Undecided: a pair is within rounding error of contact or of what it must keep.
    Undecided {
        /// Up to this time all pairs are proven farther apart than they must keep.
        t: f64,
    },
}

/// A pair that is in contact at the start of a segment, and does not come closer.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct LeavingPair {
    /// The pair.
    pub pair: WorldPair,
    /// The signed distance at the start, the distance that the pair is proven to keep, and the time
    /// at which it has left the margin.
    pub contact: StartContact,
}

impl Verdict {
    /// Returns whether the whole segment is proven free.
    #[must_use]
    pub fn is_free(&self) -> bool {
        matches!(self, Self::Free { .. })
    }

    /// Returns the time up to which all pairs are proven apart.
    #[must_use]
    pub fn safe(&self) -> f64 {
        match *self {
            Self::Free { .. } => 1.0,
            Self::Blocked { safe, .. } => safe,
            Self::Undecided { t } => t,
        }
    }
}

impl fmt::Display for Named<'_, Verdict> {
    /// Writes the verdict with the names of the pair; times are fractions of the segment.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self.value {
            Verdict::Free {
                clearance,
                ref start_contacts,
            } => {
                write!(f, "free, with a clearance of more than {clearance:?}")?;
                for (k, leaving) in start_contacts.iter().enumerate() {
                    let pair = self.world.show(&leaving.pair);
                    write!(f, "{} {pair}", if k == 0 { ", leaving the contact of" } else { "," })?;
                }
                Ok(())
            }
            Verdict::Blocked { safe, t, pair, .. } => {
                let pair = self.world.show(&pair);
                write!(f, "blocked by {pair} at {t:?} (free up to {safe:?})")
            }
            Verdict::Undecided { t } => write!(f, "undecided (free up to {t:?})"),
        }
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
