//! Counters of a tracker: costs of the two ways to start a walk, and totals for the caller.

use crate::base::callbacks;
use crate::base::num::{Counter, sum_of_counters};
use crate::pair::outcome::AnsweredBy;
use crate::pair::outcome::{Solver, Work};

/// Cost of a cold start, two cube-map look-ups and climbs, in steps of the walk. Measured of the
/// walks: some five steps from the support vertices of round bodies, and from the last features
/// `1 + 0.085 sqrt(n)` steps a degree turned. Measured of 4, 2 and 1 over five motions and thirteen
/// shapes: 2 takes 5 to 16 % less time than 4 at random poses of small bodies, and at most 3 %
/// more elsewhere (flat bodies at 5 degrees, more with 1).
const CLIMBS: u32 = 2;

/// Costs of a start of which the running mean is taken. Measured of 4, 8, 12, 16 and 24 over round
/// and flat bodies of 8 to 512 vertices that turn by 0.5, 5 and 25 degrees or stand at random
/// poses, with [`TRIALS`] and [`FADING`], in instructions: every family takes at most 2.5 % more
/// than with the better of the two starts alone (4, without trials, 7.7 %).
const SAMPLES: u16 = 12;

/// The same of the first start after the other way. Measured with [`SAMPLES`]: 2 and 3 alike.
const TRIALS: u16 = 2;

/// Queries in which the mean of the way not taken fades to some third, so that this way is tried
/// again. Means of less than this many thirty-seconds of a step, 8 steps, fade no further: ways as
/// cheap differ little. Measured with [`SAMPLES`] of 128 and 256.
const FADING: u16 = 256;

/// Cost of the direction of two ellipsoids, in steps of the walk. Not measured.
const ELLIPSOIDS: u32 = 2;

/// Mean costs of the two ways to start, in steps of the walk: the cheaper way is the start of the
/// next query.
///
/// From the features of the last answer a walk takes `1 + 0.085 sqrt(n)` steps a degree turned;
/// from the support vertices some five on round bodies, whatever happened in between. Counting the
/// steps actually taken needs neither n nor the motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Starts {
    /// Running means in thirty-seconds of a step.
    warm: u16,
    cold: u16,
    /// Whether the last start was warm.
    #[cfg_attr(feature = "serde", serde(default))]
    was_warm: bool,
}

impl Starts {
    #[inline(always)]
    pub(super) fn prefer_warm(self) -> bool {
        self.warm <= self.cold
    }

    /// Includes the cost of the way taken in its mean; the mean of the other way fades, so that
    /// this way is tried again.
    #[inline(always)]
    pub(super) fn learn(&mut self, warm: bool, work: &Work) {
        let steps = work.steps + ELLIPSOIDS * work.ellipsoids;
        let cost = 32 * (steps + if warm { 0 } else { CLIMBS }).min(1000) as u16;
        let (taken, other) = if warm {
            (&mut self.warm, &mut self.cold)
        } else {
            (&mut self.cold, &mut self.warm)
        };
        // The first cost is the mean. That of a trial of the other way weighs more than later ones,
        // as the mean is of long ago and has faded: or a trial that fails would be repeated soon.
        let samples = if warm == self.was_warm { SAMPLES } else { TRIALS };
        *taken = if *taken == 0 {
            cost
        } else {
            *taken - *taken / samples + cost / samples
        };
        *other -= *other / FADING;
        self.was_warm = warm;
    }
}

/// Work of a tracker since the tracker was made or reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct TrackerWork {
    /// Queries that reached a walk.
    pub queries: u64,
    /// Queries whose walk started from the features of the previous answer.
    pub warm: u64,
    /// Queries by the solver that answered, in the order of [`Solver`].
    pub(crate) answered: [u64; Solver::COUNT],
    /// Feature pairs tested.
    pub steps: u64,
    /// Overlaps whose depth was searched.
    pub depths: u64,
}

impl TrackerWork {
    /// Returns how many queries `solver` answered.
    #[must_use]
    pub fn answered_by(&self, solver: Solver) -> u64 {
        self.answered[solver as usize]
    }
}

/// Prints queries, the share of warm starts, steps and depths, and the solvers that answered.
impl core::fmt::Display for TrackerWork {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "{} queries, {} warm, {} steps, {} depths; {}",
            self.queries,
            self.warm,
            self.steps,
            self.depths,
            AnsweredBy(&self.answered)
        )
    }
}

impl TrackerWork {
    /// Counts a query and its work.
    #[inline(always)]
    pub(crate) fn note(&mut self, warm: bool, solver: Solver, work: &Work) {
        self.queries.count(1);
        self.warm.count(u64::from(warm));
        self.answered[solver as usize].count(1);
        self.steps.count(u64::from(work.steps));
        self.depths.count(u64::from(work.depths));
        if matches!(solver, Solver::Gjk | Solver::DoubleDouble | Solver::Exact) {
            callbacks::fell_back(&solver, work.steps);
        }
    }
}

sum_of_counters!(TrackerWork {
    queries,
    warm,
    answered,
    steps,
    depths
});
