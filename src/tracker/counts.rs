//! What a tracker counts: for itself, which start is the cheaper one; for the caller, what was done.

use crate::pair::outcome::{Solver, Work};
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
    pub answered: [u64; 7],
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

impl core::ops::AddAssign for Totals {
    fn add_assign(&mut self, o: Self) {
        self.queries += o.queries;
        self.warm += o.warm;
        self.steps += o.steps;
        self.depths += o.depths;
        for (mine, theirs) in self.answered.iter_mut().zip(o.answered) {
            *mine += theirs;
        }
    }
}
