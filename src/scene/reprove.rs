//! Feature `serde`: proves the answers of a scene that was read once more.
//!
//! No claim of a text is believed. A pair keeps its answers if a query at the present poses of its
//! bodies gives the same contact state and predicates, and bounds that agree: that is what the
//! tracker of an uninterrupted scene guarantees as well. Every other pair is tested in the next
//! step, and has no answer until then. A pair stays asleep, or untested while its bodies move, as
//! long as the bounds or a cast prove.
//! Distances and contacts of bodies that moved since the last step belong to poses that a text does
//! not have, so they are among those. Events, impacts and counts of the last step are a record, and
//! claim nothing about the present poses.

use core::iter::zip;

use super::Scene;
use super::answers::StoredAnswer;
use super::body::least_distance;
use super::lookahead::TICKS;
use super::motion::Sweep;
use super::narrow_phase::{StepContext, slack_of};
use super::pair_engine::{ContactAsk, Contacted, PairEngine};
use super::pair_table::{DetailTables, PairFlags, PairHeader, PairTable};
use super::queries::{NEVER, PairPlan};
use crate::base::num::each::Each;
use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::base::tolerance::REPEATED;
use crate::convex::contact::Manifold;
use crate::pair::outcome::{ContactState, Distance, Outcome};
use crate::time::impact::{self, Impact, Tolerance};

impl Scene {
    /// Keeps the answers that a query repeats, and lets the next step test all other pairs.
    pub(super) fn reprove(&mut self) {
        let context = StepContext {
            bodies: &self.bodies,
            table: &self.table,
            budget: self.budget,
            schedule: self.schedule,
        };
        let mut is_whole = context.reprove_tables(&mut self.pair_tables.polyhedra);
        is_whole &= context.reprove_tables(&mut self.pair_tables.mixed);
        // A step without calls tests no pair.
        self.changed |= !is_whole && !self.is_due();
    }
}

/// The answers to all queries of a pair at the poses of its bodies.
struct Repeated {
    state: PairFlags,
    /// How far the bodies may move before an answer changes.
    slack: f64,
    outcome: Option<Outcome>,
}

impl StepContext<'_> {
    /// Returns whether all pairs keep their answers.
    fn reprove_tables<T: PairEngine>(&self, tables: &mut DetailTables<T>) -> bool {
        let mut is_whole = self.reprove_table(&mut tables.predicates);
        is_whole &= self.reprove_table(&mut tables.distances);
        is_whole &= self.reprove_table(&mut tables.features);
        is_whole & self.reprove_table(&mut tables.contacts)
    }

    fn reprove_table<T: PairEngine, A: StoredAnswer>(&self, table: &mut PairTable<T, A>) -> bool {
        let mut is_whole = true;
        for (header, (tracker, answer)) in zip(&mut table.headers, zip(&table.trackers, &mut table.answers)) {
            if self.reprove_row(header, tracker, answer).is_none() {
                (header.state.known, header.state.measured, header.state.sleeps) = (false, false, false);
                is_whole = false;
            }
        }
        is_whole
    }

    /// Returns `None` if the answers of a pair are not proven.
    fn reprove_row<T: PairEngine, A: StoredAnswer>(
        &self,
        header: &mut PairHeader,
        tracker: &T,
        answer: &mut A,
    ) -> Option<()> {
        let pair = [header.a, header.b].each(|i| i as usize);
        // Bodies of a pair that ends in the next step may be gone.
        let [a, b] = pair.each(|i| self.bodies.solids[i].as_ref());
        let shapes = T::shapes(&a?.shape, &b?.shape)?;
        let pose = RelativePose::new(&self.bodies.poses[pair[0]], &self.bodies.poses[pair[1]]).ok()?;
        let plan = self.table.plan(header.groups);
        let is_moved = pair.iter().any(|i| self.bodies.travels[*i].moved == self.bodies.step);
        let mut has_contacts = true;
        if let Some(Some(manifold)) = answer.manifold() {
            let shown = (!is_moved).then_some(&pose);
            has_contacts = repeats(manifold, &mut tracker.clone(), shapes, plan, shown);
            if !has_contacts {
                manifold.forget_bounds();
            }
        }
        let (state, repeated) = (header.state, self.repeated(header, tracker, shapes, &pose, plan));
        let found = &repeated.state;
        let is_same = state.known
            && (state.overlaps, state.within, state.measured) == (found.overlaps, found.within, found.measured);
        let is_told = |outcome: &Outcome| {
            !is_moved
                && has_contacts
                && answer.outcome().is_none_or(|reported| is_consistent(reported, &pose))
                && answer.distance().is_none_or(|reported| agree(&reported, outcome))
        };
        if !is_same || state.measured && !repeated.outcome.as_ref().is_some_and(is_told) {
            return None;
        }
        if !state.sleeps {
            let slack = if state.measured { 0.0 } else { repeated.slack };
            header.wake = header.wake.smaller(self.sum(header) + slack.larger(0.0));
        } else if !self.stays_asleep(header, tracker, shapes, plan) {
            (header.state.sleeps, header.wake) = (false, 0.0);
        }
        Some(())
    }

    /// Answers all queries of a pair.
    fn repeated<T: PairEngine>(
        &self,
        header: &PairHeader,
        tracker: &T,
        shapes: T::Shapes<'_>,
        pose: &RelativePose,
        plan: &PairPlan,
    ) -> Repeated {
        let [a, b] = [header.a, header.b].each(|i| &self.bodies.balls[i as usize]);
        let apart = least_distance(a, b);
        let is_clear = apart > plan.reach && header.wake <= self.sum(header) + (apart - plan.reach);
        if is_clear && !header.state.measured {
            return Repeated {
                state: PairFlags::default(),
                slack: apart - plan.reach,
                outcome: None,
            };
        }
        let mut tracker = tracker.clone();
        let outcome = tracker.measure(shapes, pose, plan.until);
        let mut within = |t: f64| t != NEVER && tracker.decides_within(shapes, pose, &outcome, t);
        let state = PairFlags {
            overlaps: plan.overlap && within(0.0),
            within: within(plan.within),
            measured: within(plan.range),
            ..PairFlags::default()
        };
        Repeated {
            state,
            slack: slack_of(plan, &outcome),
            outcome: Some(outcome),
        }
    }

    /// Returns whether a pair that sleeps is proven separated until it wakes. A pair that does not
    /// sleep on is tested in the next step.
    fn stays_asleep<T: PairEngine>(
        &self,
        header: &PairHeader,
        tracker: &T,
        shapes: T::Shapes<'_>,
        plan: &PairPlan,
    ) -> bool {
        if !self.is_asleep(header) {
            return true;
        }
        let (bodies, length) = (self.bodies, self.bodies.ticks.length);
        let pair = [header.a as usize, header.b as usize];
        // Impacts need the instants of a tick whose step is due.
        let is_swept = plan.has_impacts() && bodies.ticks.is_pending;
        let sweeps = pair.each(|i| match is_swept {
            true => bodies.sweep(i),
            false => Sweep {
                from: bodies.poses[i],
                velocity: bodies.velocity(i),
            },
        });
        let Some(motions) = self.motions(&sweeps) else {
            return false;
        };
        // The pair is tested at the tick `wake`, and separated until the tick before.
        let ticks = header.wake - bodies.ticks.now as f64 - f64::from(u8::from(!is_swept));
        let span = length * ticks.smaller(TICKS as f64 + 1.0);
        let keep = plan.reach + self.margin(header, &motions, span);
        let [x, y] = &motions;
        tracker.clone().over_time(shapes, None, |separation, _| {
            let cast = impact::cast_within(separation, x, y, 0.0..span, Tolerance::Time(length), keep);
            cast.is_ok_and(|cast| cast.impact == Impact::Miss)
        })
    }
}

/// Returns whether a stored distance and a query agree. A bound that the query leaves open is open
/// in the text, too.
fn agree(reported: &Distance, found: &Outcome) -> bool {
    reported.state == found.state
        && reported.lower.is_finite() == found.lower.is_finite()
        && reported.upper.is_finite() == found.upper.is_finite()
        && reported.lower <= found.upper
        && found.lower <= reported.upper
        && reported.lower <= reported.value
        && reported.value <= reported.upper
}

/// Returns whether the witness points of an outcome are as far apart as its distance says, up to
/// rounding, along a unit normal.
fn is_consistent(outcome: &Outcome, pose: &RelativePose) -> bool {
    let on_b = pose.rotation() * outcome.point_on_b.coords + pose.translation();
    let between = on_b - outcome.point_on_a.coords;
    let size = outcome.point_on_a.coords.abs().sum() + on_b.abs().sum() + outcome.distance.abs();
    let normal = outcome.normal.norm_squared() - 1.0;
    // The points of an overlap without a depth are common to both bodies, or anywhere.
    let is_as_far = outcome.distance == 0.0
        || outcome.state == ContactState::Undecided
        || (sqrt(between.norm_squared()) - outcome.distance.abs()).abs() <= REPEATED * size;
    is_as_far && size.is_finite() && normal.abs() <= REPEATED
}

/// Returns whether a manifold is that of a query at the pose at which it was made, and its points
/// are those of the present pose, if that is known.
fn repeats<T: PairEngine>(
    manifold: &Manifold,
    tracker: &mut T,
    shapes: T::Shapes<'_>,
    plan: &PairPlan,
    pose: Option<&RelativePose>,
) -> bool {
    let Some((made_at, options)) = manifold.made_at().zip(plan.manifold.as_ref()) else {
        return false;
    };
    let mut updated = |pose: &RelativePose, mut stored: Option<_>| {
        let outcome = tracker.measure(shapes, pose, plan.until);
        let ask = ContactAsk {
            outcome: &outcome,
            options,
            #[cfg(feature = "meshes")]
            patches: [None; 2],
        };
        let done = tracker.update_manifold(shapes, pose, ask, &mut stored);
        stored.filter(|_| done != Contacted::Nothing)
    };
    let again = updated(&made_at, None);
    if !again.is_some_and(|again| manifold.is_repeated(&again)) {
        return false;
    }
    match pose {
        Some(pose) if manifold.is_fresh() => *pose == made_at,
        Some(pose) => {
            let kept = updated(pose, Some(alloc::boxed::Box::new(manifold.clone())));
            kept.is_some_and(|kept| *kept == *manifold)
        }
        None => true,
    }
}
