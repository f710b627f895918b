//! Look-ahead queries: how long a pair stays separated at the velocities of the bodies; and impacts
//! within a tick.
//!
//! A look-ahead query bounds the time for which a rotating plane stays between the bodies
//! ([`separation`](crate::separation)). The pair then sleeps for the whole ticks of that time, by
//! the rules of [`schedule`](crate::schedule). If a pair is proven separated until the end of tick
//! m, it is queried again at tick m + 1. Three events end a sleep early: a body of the pair is
//! disturbed, a tick has another length, or the queries change. Every step visits every header, so
//! a step sees its disturbances at once, and the pair needs no epoch.
//!
//! **Rounding.** The proof is about the motion itself. Each tick computes a pose from the last
//! pose, so after k ticks a pose differs from the motion by at most k times the error of one tick.
//! This error is below the drift of [`Steady`] over all these ticks. A rotation error does not
//! grow, because bodies rotate around their origins. For at most [`TICKS`] ticks, as many drifts
//! are added to the distance that the query must prove.
//!
//! For impacts the query starts at the start of the tick and covers the instants between. If it
//! proves less than the tick, the tick is cast, once for each distance
//! ([`impact::cast_within`]).

use super::answers::PairImpact;
use super::motion::Sweep;
use super::narrow_phase::{StepContext, Tally};
use super::pair_engine::PairEngine;
use super::pair_table::{PairFlags, PairHeader};
use super::queries::PairPlan;
use super::report::StepWork;
use crate::base::motion::{Motion, Steady, Velocity};
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::pair::outcome::Outcome;
use crate::time::impact::{self, Impact};
use crate::time::schedule::ticks;
use crate::time::separation::PairMotion;

/// The largest number of ticks that a look-ahead query proves. Longer proofs save little: each
/// proof contains the rounding of all its ticks, and velocities seldom stay constant for longer.
pub(super) const TICKS: u64 = 64;

impl StepContext<'_> {
    /// Returns whether a sleeping pair still sleeps.
    #[inline]
    pub(super) fn is_asleep(&self, header: &PairHeader) -> bool {
        let bodies = self.bodies;
        self.schedule
            && !bodies.ticks.is_changed
            && !bodies.is_disturbed(header.a)
            && !bodies.is_disturbed(header.b)
            && (bodies.ticks.now as f64) < header.wake
    }

    /// Lets a pair sleep that is proven separated from now on; returns whether the pair sleeps.
    pub(super) fn sleep<T: PairEngine>(
        &self,
        header: &mut PairHeader,
        tracker: &mut T,
        shapes: T::Shapes<'_>,
        plan: &PairPlan,
        outcome: &Outcome,
        counts: &mut StepWork,
    ) -> bool {
        let (bodies, length) = (self.bodies, self.bodies.ticks.length);
        let pair = [header.a as usize, header.b as usize];
        let is_steered = |i: &usize| bodies.moving.get(*i).is_some_and(|m| m.is_steered(bodies.step));
        let is_called = self.schedule && bodies.ticks.is_pending && length > 0.0;
        if !is_called || !(outcome.lower > plan.reach) || pair.iter().any(is_steered) {
            return false;
        }
        let sweeps = pair.each(|i| Sweep {
            from: bodies.poses[i],
            velocity: bodies.velocity(i),
        });
        let Some(motions) = self.motions(&sweeps) else {
            return false;
        };
        let span = length * TICKS as f64;
        let keep = plan.reach + self.margin(header, &motions, span);
        let [x, y] = &motions;
        let flight = PairMotion {
            pose_a: x.pose(0.0),
            pose_b: y.pose(0.0),
            model_a: x.model(0.0, span),
            model_b: y.model(0.0, span),
            span,
            required: keep,
        };
        counts.ahead += 1;
        let free = tracker.over_time(shapes, Some(outcome), |separation, seen| {
            let apart = flight.apart(separation).span;
            let by_plane = seen.map_or(0.0, |seen| separation.free_for(&seen, &flight).span);
            apart.larger(by_plane)
        });
        let whole = ticks(free, length).min(TICKS);
        if whole > 0 {
            header.state.sleeps = true;
            header.wake = bodies.ticks.later(whole + 1);
        }
        whole > 0
    }

    /// Queries a pair from the start of the last tick. If the pair is proven farther apart than all
    /// thresholds for at least one tick, the pair sleeps and the result is true. Otherwise the
    /// impacts of the tick are recorded: at most one for each distance of the plan.
    pub(super) fn sweep_pair<T: PairEngine>(
        &self,
        header: &mut PairHeader,
        tracker: &mut T,
        shapes: T::Shapes<'_>,
        plan: &PairPlan,
        tally: &mut Tally,
    ) -> bool {
        let bodies = self.bodies;
        let length = bodies.ticks.length.abs();
        let sweeps = [header.a, header.b].each(|i| bodies.sweep(i as usize));
        let is_still = |sweep: &Sweep| sweep.velocity == Velocity::default();
        if !bodies.ticks.is_pending || length == 0.0 || sweeps.iter().all(is_still) {
            return false;
        }
        // A velocity beyond the range of motions proves nothing.
        let mut found = plan
            .impacts
            .each(|asked| asked.map(|_| Impact::Incomplete { safe: 0.0 }));
        if let Some(motions) = self.motions(&sweeps) {
            let ticks_ahead = if self.is_foreseen(header) { TICKS } else { 1 };
            let span = length * ticks_ahead as f64;
            let keep = plan.reach + self.margin(header, &motions, span);
            let [x, y] = &motions;
            let ahead = tracker.over_time(shapes, None, |separation, _| {
                impact::ahead(separation, [x, y], length, span, keep, &plan.impacts)
            });
            if let Ok(ahead) = ahead {
                let counts = &mut tally.counts;
                counts.ahead += 1;
                counts.queries += u64::from(ahead.queries);
                found = ahead.casts;
                let casts = found.iter().flatten().count() as u64;
                if casts == 0 && self.is_foreseen(header) {
                    counts.separated += u64::from(ahead.queries);
                    return self.sleep_from_start(header, ahead.until);
                }
                counts.casts += casts;
            }
        }
        for (asked, impact) in plan.impacts.iter().zip(found) {
            let (Some((distance, _)), Some(impact)) = (*asked, impact) else {
                continue;
            };
            if !matches!(impact, Impact::AtStart { .. } | Impact::Miss) {
                tally.impacts.push(PairImpact {
                    a: bodies.id(header.a),
                    b: bodies.id(header.b),
                    pair: header.pair,
                    impact,
                    distance,
                });
            }
        }
        false
    }

    /// Returns whether the motions of the last tick continue: neither body was disturbed after the
    /// tick.
    fn is_foreseen(&self, header: &PairHeader) -> bool {
        let bodies = self.bodies;
        let is_late = |i: u32| bodies.moving.get(i as usize).is_some_and(|m| m.is_late(bodies.step));
        self.schedule && bodies.ticks.length > 0.0 && !is_late(header.a) && !is_late(header.b)
    }

    /// Lets a pair sleep that is proven separated from the start of the last tick until a later
    /// time; returns whether this covers the tick.
    fn sleep_from_start(&self, header: &mut PairHeader, until: f64) -> bool {
        let whole = ticks(until, self.bodies.ticks.length).min(TICKS);
        if whole > 0 {
            header.state = PairFlags {
                known: true,
                sleeps: true,
                ..PairFlags::default()
            };
            header.wake = self.bodies.ticks.later(whole);
        }
        whole > 0
    }

    pub(super) fn motions(&self, sweeps: &[Sweep; 2]) -> Option<[Steady; 2]> {
        Some([sweeps[0].motion()?, sweeps[1].motion()?])
    }

    /// Returns an upper bound of the difference between the poses of both bodies and their motions,
    /// after as many ticks as a pair may sleep.
    pub(super) fn margin(&self, header: &PairHeader, motions: &[Steady; 2], span: f64) -> f64 {
        let drift = |i: u32, motion: &Steady| {
            let reach = self.bodies.solids[i as usize].as_ref().map_or(0.0, |s| s.reach());
            motion.model(0.0, span).drift(reach).at(span)
        };
        TICKS as f64 * (drift(header.a, &motions[0]) + drift(header.b, &motions[1]))
    }
}
