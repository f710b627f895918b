//! Answers about segments, and the work behind them.

use nalgebra::Point3;

use crate::world::WorldPair;

/// The answer about a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Verdict {
    /// Every pair is proven farther apart than `clearance` at every instant, both ends included.
    Free {
        /// The margin of the checker.
        clearance: f64,
    },
    /// A pair is proven to meet, or to come within the margin.
    Blocked {
        /// All pairs are proven apart, farther than the margin, up to here.
        safe: f64,
        /// The pair is proven to meet here, or to be within the margin.
        t: f64,
        /// The pair.
        pair: WorldPair,
        /// The closest points of `pair.a` and `pair.b` at `safe`, in the world; at `t` if `safe`
        /// is the begin.
        witnesses: [Point3<f64>; 2],
    },
    /// Neither proven: rounding hides whether a pair meets.
    Undecided {
        /// All pairs are proven apart up to here.
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

/// The work of a checker since it was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CheckWork {
    /// Segments checked.
    pub segments: u64,
    /// Segments proven free.
    pub free: u64,
    /// Pairs whose boxes met on a segment, or might hold the least distance at a configuration.
    pub pairs: u64,
    /// Distance queries on segments, proofs of contact included.
    pub queries: u64,
    /// Single configurations measured.
    pub configurations: u64,
    /// Distance queries at single configurations.
    pub measures: u64,
    /// Pairs asked at single configurations whether they keep the margin.
    pub decisions: u64,
}

impl std::ops::AddAssign for CheckWork {
    /// Adds all counts. Sums saturate.
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
