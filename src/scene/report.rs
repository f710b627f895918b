//! Work and times of a step, as data and as text.

use core::fmt;
use core::ops::AddAssign;
use core::time::Duration;

use super::{Event, PairImpact, Scene};
use crate::base::num::sum_of_counters;
use crate::broad::{self};
use crate::pair::outcome::AnsweredBy;
use crate::pair::outcome::{Outcome, Solver};

/// Work of one step, or the sum over many steps, by stage. Equal calls give equal counts on every
/// machine and with any number of threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct StepWork {
    /// Number of steps.
    pub steps: u64,
    /// Boxes computed, for bodies that moved or whose queries changed.
    pub boxes: u64,
    /// Positions by which entries of the broad phase moved to stay sorted.
    pub swaps: u64,
    /// Pairs of boxes that started to overlap.
    pub began: u64,
    /// Pairs of boxes that stopped overlapping.
    pub ended: u64,
    /// Pairs of boxes after the step.
    pub pairs: u64,
    /// Bodies, after the step, of groups for which no query is enabled. They are never paired. See
    /// [`Scene::set_queries`](super::Scene::set_queries).
    pub without_queries: u64,
    /// Pairs of two fixed bodies, after the step, that are not tested although a query is enabled
    /// between their groups, at any distance. Excluded pairs do not count. See
    /// [`PairQueries::fixed`](field@super::PairQueries::fixed).
    #[cfg_attr(feature = "serde", serde(default))]
    pub fixed_left_out: u64,
    /// Pairs of boxes, after the step, for which more than `boxes` is enabled.
    pub active: u64,
    /// Active pairs whose bodies did not move: the last results remain valid.
    pub resting: u64,
    /// Active pairs decided by the displacement budget.
    pub skipped: u64,
    /// Active pairs that sleep: proven separated until a later tick.
    pub slept: u64,
    /// Active pairs decided by the distance of two bounding balls.
    pub balls: u64,
    /// Look-ahead queries: bounds of the time for which a pair stays separated.
    pub ahead: u64,
    /// Casts of pairs over a tick.
    pub casts: u64,
    /// Impacts found, with and without a distance.
    pub impacts: u64,
    /// Queries of trackers in the narrow phase, including casts and their predicates.
    pub queries: u64,
    /// Number of queries by the solver that answered them, in the order of [`Solver`].
    pub(crate) answered: [u64; Solver::COUNT],
    /// Queries with the result that the bodies are separated.
    pub separated: u64,
    /// Feature pairs tested by walks (`steps` of [`Work`](crate::Work)), and facets of the
    /// polytopes that answered without a walk.
    pub walked: u64,
    /// Certificates computed; a polytope that answers counts as a certificate.
    pub certificates: u64,
    /// Overlaps for which the depth was searched.
    pub depths: u64,
    /// Queried pairs for which `overlap` was decided.
    pub overlaps: u64,
    /// Queried pairs for which `within` was decided.
    pub withins: u64,
    /// Distances stored.
    pub distances: u64,
    /// Distances stored together with features and witnesses.
    pub features: u64,
    /// Manifolds updated.
    pub manifolds: u64,
    /// Manifolds rebuilt. In all other updated manifolds only the points were measured again.
    pub renewed: u64,
    /// Events sent.
    pub events: u64,
}

impl StepWork {
    /// Returns the number of queries that `solver` answered.
    #[must_use]
    pub fn answered_by(&self, solver: Solver) -> u64 {
        self.answered[solver as usize]
    }

    /// Adds the work of a query.
    #[inline]
    pub(super) fn note(&mut self, outcome: &Outcome, facets: usize) {
        let surface = outcome.solver == Solver::Polytope;
        self.queries += 1;
        self.answered[outcome.solver as usize] += 1;
        self.separated += u64::from(outcome.lower > 0.0);
        self.walked += u64::from(outcome.work.steps) + if surface { facets as u64 } else { 0 };
        self.certificates += u64::from(outcome.work.certificates) + u64::from(surface);
        self.depths += u64::from(outcome.work.depths);
    }
}

// Includes `pairs`, `without_queries`, `fixed_left_out` and `active`, so that a sum over steps
// divided by `steps` is their mean.
sum_of_counters!(StepWork {
    steps,
    boxes,
    swaps,
    began,
    ended,
    pairs,
    without_queries,
    fixed_left_out,
    active,
    resting,
    skipped,
    slept,
    balls,
    ahead,
    casts,
    impacts,
    queries,
    answered,
    separated,
    walked,
    certificates,
    depths,
    overlaps,
    withins,
    distances,
    features,
    manifolds,
    renewed,
    events,
});

/// Wall time of one step by stage, or the sum over many steps. Zero without the feature `std`, and
/// on targets without a clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Times {
    /// Boxes of moved bodies, and the update of the broad phase with these boxes.
    pub boxes: Duration,
    /// The search for new and ended pairs in the broad phase, and the update of the pair tables.
    pub pairs: Duration,
    /// Narrow phase of the active pairs, from the budget to the tracker.
    #[cfg_attr(feature = "serde", serde(rename = "look"))]
    pub narrow_phase: Duration,
    /// Sorting of the events.
    pub events: Duration,
}

impl Times {
    /// Returns the sum of all stages.
    #[must_use]
    pub fn total(&self) -> Duration {
        let stages = [self.pairs, self.narrow_phase, self.events];
        stages.into_iter().fold(self.boxes, Duration::saturating_add)
    }
}

impl AddAssign for Times {
    fn add_assign(&mut self, o: Self) {
        self.boxes = self.boxes.saturating_add(o.boxes);
        self.pairs = self.pairs.saturating_add(o.pairs);
        self.narrow_phase = self.narrow_phase.saturating_add(o.narrow_phase);
        self.events = self.events.saturating_add(o.events);
    }
}

/// Work and times of a step; printed as a table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Report {
    /// Work by kind.
    pub counts: StepWork,
    /// Wall time by stage.
    pub times: Times,
}

impl AddAssign for Report {
    fn add_assign(&mut self, o: Self) {
        self.counts += o.counts;
        self.times += o.times;
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (c, t) = (&self.counts, &self.times);
        let us = |d: Duration| d.as_secs_f64() * 1e6;
        if c.without_queries > 0 {
            writeln!(
                f,
                "no query is enabled between the groups of {} bodies and any group; enable one with `Scene::set_queries`",
                c.without_queries / c.steps.max(1)
            )?;
        }
        if c.fixed_left_out > 0 {
            writeln!(
                f,
                "{} pairs of fixed bodies are not tested; enable them with `PairQueries::fixed`",
                c.fixed_left_out / c.steps.max(1)
            )?;
        }
        writeln!(f, "boxes   {:>9.1} us  {} made", us(t.boxes), c.boxes)?;
        writeln!(
            f,
            "pairs   {:>9.1} us  {} ({} began, {} ended), {} swaps",
            us(t.pairs),
            c.pairs,
            c.began,
            c.ended,
            c.swaps
        )?;
        writeln!(
            f,
            "narrow  {:>9.1} us  {} active: {} resting, {} skipped by budget, {} asleep, {} apart by balls, {} queried",
            us(t.narrow_phase),
            c.active,
            c.resting,
            c.skipped,
            c.slept,
            c.balls,
            c.queries
        )?;
        writeln!(
            f,
            "                      {} overlaps, {} withins, {} distances, {} features, {} depths, {} manifolds, {} casts, {} impacts; {} steps, {} certificates; {}",
            c.overlaps,
            c.withins,
            c.distances,
            c.features,
            c.depths,
            c.manifolds,
            c.casts,
            c.impacts,
            c.walked,
            c.certificates,
            AnsweredBy(&c.answered)
        )?;
        write!(f, "events  {:>9.1} us  {}", us(t.events), c.events)
    }
}

/// Reads the wall clock between stages, if the target has a clock.
pub(super) struct Clock {
    #[cfg(feature = "std")]
    last: Option<std::time::Instant>,
}

impl Clock {
    pub(super) fn start() -> Self {
        Self {
            // On a target without a clock, reading it panics.
            #[cfg(feature = "std")]
            last: (!cfg!(all(target_family = "wasm", target_os = "unknown"))).then(std::time::Instant::now),
        }
    }

    /// Returns the time since the start or the last lap.
    pub(super) fn lap(&mut self) -> Duration {
        #[cfg(feature = "std")]
        if let Some(last) = &mut self.last {
            let now = std::time::Instant::now();
            return now.duration_since(core::mem::replace(last, now));
        }
        Duration::ZERO
    }
}

/// Memory of a scene by purpose, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct MemoryUsage {
    /// Tables of bodies.
    pub bodies: usize,
    /// The broad phase, including its slots of pairs.
    pub broad: usize,
    /// Trackers and answers of pairs.
    pub pairs: usize,
    /// Scratch buffers, kept for their capacity.
    pub scratch: usize,
}

impl MemoryUsage {
    /// Returns the total in bytes.
    #[must_use]
    pub fn total(&self) -> usize {
        self.bodies + self.broad + self.pairs + self.scratch
    }
}

impl Scene {
    /// Returns the reserved memory in bytes, without the geometries, which may be shared.
    #[must_use]
    pub fn memory_usage(&self) -> MemoryUsage {
        MemoryUsage {
            bodies: self.bodies.bytes() + self.excluded.bytes(),
            broad: self.broad.memory_usage(),
            pairs: self.pair_tables.bytes(),
            scratch: self.batch.capacity() * size_of::<(broad::BodyId, broad::Aabb)>()
                + self.workspace.memory_usage()
                + self.events.capacity() * size_of::<Event>()
                + self.impacts.capacity() * size_of::<PairImpact>(),
        }
    }
}
