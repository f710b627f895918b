//! Verdicts about segments, and counts of the work.

use nalgebra::Point3;

use crate::world::WorldPair;

/// The verdict about a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Verdict {
    /// Every pair is proven farther apart than `clearance` at all times, including both ends.
    Free {
        /// The margin of the checker.
        clearance: f64,
    },
    /// A pair is proven to be in contact or within the margin.
    Blocked {
        /// Up to this time all pairs are proven farther apart than the margin.
        safe: f64,
        /// At this time the pair is proven to be in contact or within the margin.
        t: f64,
        /// The pair.
        pair: WorldPair,
        /// Closest points of `pair.a` and `pair.b` in the world, at `safe`, or at `t` if `safe` is
        /// 0.
        witnesses: [Point3<f64>; 2],
    },
    /// Undecided: a pair is within rounding error of contact or of the margin.
    Undecided {
        /// Up to this time all pairs are proven farther apart than the margin.
        t: f64,
    },
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
        ];
        for (sum, count) in counts {
            *sum = sum.saturating_add(count);
        }
    }
}
