//! What a tracker counts: for itself, which start is the cheaper one; for the caller, what was done.

use crate::pair::outcome::{Solver, Work};
use crate::pair::world::AnsweredBy;
use crate::tuning::tracker::{CLIMBS, ELLIPSOIDS};

/// What the two ways to start have cost lately, in steps of the walk: which of them a query takes.
///
/// From the features of the last answer a walk takes `1 + 0.085 sqrt(n)` steps a degree turned; from the support
/// vertices some five on round bodies, whatever happened in between. Counting what it really took needs neither n nor
/// the motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Starts {
    /// Running means in sixteenths of a step.
    warm: u16,
    cold: u16,
}

impl Starts {
    #[inline(always)]
    pub(super) fn prefer_warm(self) -> bool {
        self.warm <= self.cold
    }

    /// Takes the cost of the way taken into its mean; what is known of the other fades, so that it is tried again.
    #[inline(always)]
    pub(super) fn learn(&mut self, warm: bool, work: &Work) {
        let steps = work.steps + ELLIPSOIDS * work.ellipsoids;
        let cost = 16 * (steps + if warm { 0 } else { CLIMBS }).min(1000) as u16;
        let (taken, other) = if warm {
            (&mut self.warm, &mut self.cold)
        } else {
            (&mut self.cold, &mut self.warm)
        };
        // The first cost is the mean; later ones weigh a quarter.
        *taken = if *taken == 0 {
            cost
        } else {
            *taken - *taken / 4 + cost / 4
        };
        *other -= *other / 128;
    }
}

/// What a tracker has done since it was made or reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Totals {
    /// Queries that came as far as a walk.
    pub queries: u64,
    /// Of these, how many started from the features of the answer before.
    pub warm: u64,
    /// Queries by the solver that answered, in the order of [`Solver`].
    pub(crate) answered: [u64; Solver::COUNT],
    /// Feature pairs looked at.
    pub steps: u64,
    /// Overlaps whose depth was searched for.
    pub depths: u64,
}

impl Totals {
    /// How many queries `solver` answered.
    #[must_use]
    pub fn answered_by(&self, solver: Solver) -> u64 {
        self.answered[solver as usize]
    }
}

/// Queries, the share of warm starts, steps and depths, and the solvers that answered.
impl core::fmt::Display for Totals {
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

impl Totals {
    /// Counts a query and its work. A counter stays at its end: a file may have put it there.
    #[inline(always)]
    pub(super) fn note(&mut self, warm: bool, solver: Solver, work: &Work) {
        let add = |counter: &mut u64, by: u64| *counter = counter.saturating_add(by);
        add(&mut self.queries, 1);
        add(&mut self.warm, u64::from(warm));
        add(&mut self.answered[solver as usize], 1);
        add(&mut self.steps, u64::from(work.steps));
        add(&mut self.depths, u64::from(work.depths));
    }
}

impl core::ops::AddAssign for Totals {
    /// Sums that stay at their end.
    fn add_assign(&mut self, o: Self) {
        let add = |counter: &mut u64, by: u64| *counter = counter.saturating_add(by);
        add(&mut self.queries, o.queries);
        add(&mut self.warm, o.warm);
        add(&mut self.steps, o.steps);
        add(&mut self.depths, o.depths);
        for (mine, theirs) in self.answered.iter_mut().zip(o.answered) {
            add(mine, theirs);
        }
    }
}
