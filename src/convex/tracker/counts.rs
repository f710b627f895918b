//! Counters of a tracker: the costs of warm and cold starts of a walk, and totals for the caller.

use crate::base::callbacks;
use crate::base::num::{Counter, sum_of_counters};
use crate::pair::outcome::AnsweredBy;
use crate::pair::outcome::{Solver, Work};

/// Cost of a cold start (two cube-map look-ups and climbs), in steps of the walk.
///
/// Measured on the walks: about five steps from the support vertices of round bodies, and
/// `1 + 0.085 sqrt(n)` steps per degree of rotation from the last features. Measured for the values
/// 4, 2 and 1 over five motions and thirteen shapes: 2 takes 5 to 16 % less time than 4 at random
/// poses of small bodies, and at most 3 % more elsewhere (flat bodies at 5 degrees, more with 1).
const CLIMBS: u32 = 2;

/// Number of costs over which the running mean of a start is taken.
///
/// Measured for 4, 8, 12, 16 and 24, over round and flat bodies of 8 to 512 vertices that rotate by
/// 0.5, 5 and 25 degrees or have random poses, with [`TRIALS`] and [`FADING`], in instructions:
/// every family takes at most 2.5 % more than with the better of the two starts alone (4, without
/// trials, 7.7 %).
const SAMPLES: u16 = 12;

/// The same number for the first start after a change between warm and cold.
///
/// Measured with [`SAMPLES`]: 2 and 3 alike.
const TRIALS: u16 = 2;

/// Queries after which the mean of the unused start fades to about a third, so that this start is
/// tried again.
///
/// Means of less than this many thirty-seconds of a step (8 steps) fade no further, because starts
/// as cheap as this differ little. Measured for [`SAMPLES`] of 128 and 256.
const FADING: u16 = 256;

/// Cost of the direction of two ellipsoids, in steps of the walk.
const ELLIPSOIDS: u32 = 2;

/// Mean costs of a warm and of a cold start, in steps of the walk.
///
/// The cheaper start is the start of the next query. From the features of the last outcome a walk
/// takes `1 + 0.085 sqrt(n)` steps per degree of rotation. From the support vertices it takes about
/// five on round bodies, independent of the motion. The counter needs neither n nor the motion,
/// because it counts the steps taken.
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

    /// Includes the cost of the start just used in its mean.
    ///
    /// The mean of the other start fades, so that this start is tried again.
    #[inline(always)]
    pub(super) fn learn(&mut self, warm: bool, work: &Work) {
        let steps = work.steps + ELLIPSOIDS * work.ellipsoids;
        let cost = 32 * (steps + if warm { 0 } else { CLIMBS }).min(1000) as u16;
        let (taken, other) = if warm {
            (&mut self.warm, &mut self.cold)
        } else {
            (&mut self.cold, &mut self.warm)
        };
        // The first cost is the mean. The cost of a trial of the other start weighs more than later
        // costs, because its mean is old and has faded; otherwise a failed trial would soon be
        // repeated.
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

/// Work of a tracker since it was made or reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct TrackerWork {
    /// Queries that reached a walk.
    pub queries: u64,
    /// Queries whose walk started from the features of the previous outcome.
    pub warm: u64,
    /// Queries by the solver that computed the outcome, in the order of [`Solver`].
    pub(crate) answered: [u64; Solver::COUNT],
    /// Feature pairs that the walk tested.
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
    /// Adds a query and its work to the counters.
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
